#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pliant/tests/plants/all_kinds.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::Pair;

AllKinds Filled(const std::string& text) {
  AllKinds all;
  ParameterFile::ReadText(text, "a.yaml").Fill(all);
  return all;
}

std::string ErrorIn(const std::string& text) {
  return ErrorOf([&] { Filled(text); });
}

TEST(ParameterFill, TakesNumbersWithTheirUnitOrAMultipleOfIt) {
  for (const char* text : {"0.5", "0.5 s", "0.5s", "500 ms", "500ms", "5e5 us", "+.5", "'0.5 s'"})
    EXPECT_DOUBLE_EQ(Filled("time: " + std::string(text)).time, 0.5) << text;
  EXPECT_DOUBLE_EQ(Filled("time: 2 min").time, 120);
  EXPECT_DOUBLE_EQ(Filled("angle: 90 deg").angle, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(Filled("angle: -90deg").angle, -std::numbers::pi / 2);
  EXPECT_EQ(Filled("number: -1.5e-3").number, -1.5e-3);
  EXPECT_EQ(Filled("limit: .inf").limit, kUnbounded);
  EXPECT_EQ(Filled("limit: 3 N").limit, 3);
  EXPECT_EQ(Filled("fixed: [1 mm, 2 cm, 3]").fixed, Eigen::Vector3d(1e-3, 2e-2, 3));
}

TEST(ParameterFill, RefusesNumbersWithAnotherUnit) {
  EXPECT_EQ(ErrorIn("time: 5 m"), "a.yaml:1:7: expected a number [s], got '5 m'");
  EXPECT_EQ(ErrorIn("time: 5 S"), "a.yaml:1:7: expected a number [s], got '5 S'");
  EXPECT_EQ(ErrorIn("angle: 5 deg/s"), "a.yaml:1:8: expected a number [rad], got '5 deg/s'");
  EXPECT_EQ(ErrorIn("number: 5 m"), "a.yaml:1:9: expected a number without a unit, got '5 m'");
  EXPECT_EQ(ErrorIn("count: 3 s"), "a.yaml:1:8: expected a number without a unit, got '3 s'");
  EXPECT_EQ(ErrorIn("fixed: [1, 2 s, 3]"), "a.yaml:1:12: expected a number [m], got '2 s'");
}

TEST(ParameterFill, RefusesWhatIsNoNumber) {
  for (const char* text : {"heavy", "--5", "+-5", "'-'", ".", "s", "''", "1e999", "'1 0 '"})
    EXPECT_THAT(ErrorIn("time: " + std::string(text)),
                testing::StartsWith("a.yaml:1:7: expected a number [s], got '"))
        << text;
  EXPECT_EQ(ErrorIn("number: 0x10"), "a.yaml:1:9: expected a number without a unit, got '0x10'");
  EXPECT_EQ(ErrorIn("time: [1]"), "a.yaml:1:7: expected a number [s], got a list");
  EXPECT_EQ(ErrorIn("time: {a: 1}"), "a.yaml:1:7: expected a number [s], got a map");
  EXPECT_EQ(ErrorIn("time: ~"), "a.yaml:1:7: expected a number [s], got nothing");
}

TEST(ParameterFill, RefusesNumbersOutOfTheirRange) {
  EXPECT_EQ(ErrorIn("time: -1 ms"), "a.yaml:1:7: time must be >= 0 s, got -0.001");
  EXPECT_EQ(ErrorIn("number: .nan"), "a.yaml:1:9: number must be finite, got nan");
  EXPECT_EQ(ErrorIn("number: -.inf"), "a.yaml:1:9: number must be finite, got -inf");
  EXPECT_EQ(ErrorIn("limit: 0"), "a.yaml:1:8: limit must be > 0 N, got 0");
  EXPECT_EQ(ErrorIn("count: 11"), "a.yaml:1:8: count must be from -10 to 10, got 11");
  EXPECT_EQ(ErrorIn("fixed: [1, .inf, 3]"), "a.yaml:1:12: fixed must be finite m, got inf");
  EXPECT_EQ(ErrorIn("maybe: 0 s"), "a.yaml:1:8: maybe must be > 0 s, got 0");
  EXPECT_EQ(ErrorIn("spring: {stiffness: 0}"), "a.yaml:1:21: stiffness must be > 0 N/m, got 0");
}

TEST(ParameterFill, TakesWholeNumbersThatFit) {
  EXPECT_EQ(Filled("count: -4").count, -4);
  EXPECT_EQ(Filled("count: 1e1").count, 10);
  EXPECT_EQ(Filled("seed: 9007199254740992").seed, 9007199254740992u);
  EXPECT_EQ(ErrorIn("count: 1.5"),
            "a.yaml:1:8: expected a whole number from -2147483648 to 2147483647, got 1.5");
  for (const char* text : {"-1", "1e30", "18446744073709551616", "0.1"})
    EXPECT_EQ(ErrorIn("seed: " + std::string(text)),
              "a.yaml:1:7: expected a whole number from 0 to 18446744073709551615, got " +
                  std::string(text));
}

TEST(ParameterFill, TakesFlags) {
  for (const char* text : {"true", "True", "TRUE", "yes", "on"})
    EXPECT_TRUE(Filled("flag: " + std::string(text)).flag) << text;
  for (const char* text : {"false", "no", "Off"})
    EXPECT_FALSE(Filled("flag: " + std::string(text)).flag) << text;
  EXPECT_EQ(ErrorIn("flag: 1"), "a.yaml:1:7: expected true or false, got '1'");
  EXPECT_EQ(ErrorIn("flag: []"), "a.yaml:1:7: expected true or false, got a list");
  EXPECT_EQ(ErrorIn("flag:"), "a.yaml:1:1: expected true or false, got nothing");
}

TEST(ParameterFill, TakesWordsAsTheyStand) {
  EXPECT_EQ(Filled("word: true").word, "true");
  EXPECT_EQ(Filled("word: 1.50").word, "1.50");
  EXPECT_EQ(Filled("word: 'τ = ~'").word, "τ = ~");
  EXPECT_EQ(Filled("word: '~'").word, "~");
  EXPECT_EQ(Filled("word: >-\n  one\n  two").word, "one two");
  EXPECT_EQ(ErrorIn("word: ''"), "a.yaml:1:7: 'word' says nothing");
  EXPECT_EQ(ErrorIn("word: ~"), "a.yaml:1:7: expected a word, got nothing");
  EXPECT_EQ(ErrorIn("word: {}"), "a.yaml:1:7: expected a word, got a map");
  EXPECT_EQ(ErrorIn("words: [a, [b]]"), "a.yaml:1:12: expected a word, got a list");
}

TEST(ParameterFill, TakesOneOfTheWordsOfAnEnumeration) {
  EXPECT_EQ(Filled("colour: green").colour, Colour::Green);
  EXPECT_EQ(Filled("colour: true").colour, Colour::True);
  EXPECT_EQ(ErrorIn("colour: gren"),
            "a.yaml:1:9: expected one of red, green, true, got 'gren'; did you mean 'green'?");
  EXPECT_EQ(ErrorIn("colour: [red]"), "a.yaml:1:9: expected a word, got a list");
}

TEST(ParameterFill, TakesTimesAndRatesForDurations) {
  EXPECT_EQ(Filled("period: 1 ms").period, Duration(1ms));
  EXPECT_EQ(Filled("period: 1.5ms").period, Duration(1500us));
  EXPECT_EQ(Filled("period: 30 Hz").period, Hertz(30));
  EXPECT_EQ(Filled("period: 2 min").period, Duration(120s));
  EXPECT_EQ(Filled("period: 0 s").period, Duration());
  for (const char* text : {"1", "1 m", "-1 ms", "0 Hz", "29.97 Hz", "2e9 Hz", "1e10 s", ".inf s",
                           ".inf", "nan s", "soon", "[1 ms]"})
    EXPECT_THAT(ErrorIn("period: " + std::string(text)),
                testing::StartsWith(
                    "a.yaml:1:9: expected a time such as 1 ms or a rate such as 30 Hz, got "))
        << text;
}

TEST(ParameterFill, TakesVectorsAndMatricesOfTheirSize) {
  EXPECT_EQ(Filled("dynamic: [1, 2]").dynamic, Eigen::Vector2d(1, 2));
  EXPECT_EQ(Filled("dynamic: []").dynamic.size(), 0);
  EXPECT_EQ(Filled("matrix: [[1, 2], [3, 4]]").matrix,
            (Eigen::Matrix2d() << 1, 2, 3, 4).finished());
  EXPECT_EQ(ErrorIn("fixed: [1, 2]"), "a.yaml:1:8: expected a list of 3, got one of 2");
  EXPECT_EQ(ErrorIn("fixed: 1"), "a.yaml:1:8: expected a list, got '1'");
  EXPECT_EQ(ErrorIn("dynamic: [1, 2, 3, 4, 5]"),
            "a.yaml:1:10: expected a list of at most 4, got one of 5");
  EXPECT_EQ(ErrorIn("matrix: [[1, 2]]"), "a.yaml:1:9: expected a list of 2, got one of 1");
  EXPECT_EQ(ErrorIn("matrix: [[1, 2], [3]]"), "a.yaml:1:18: expected a list of 2, got one of 1");
  EXPECT_EQ(ErrorIn("matrix: [[1, 2], [3, x]]"), "a.yaml:1:22: expected a number, got 'x'");
}

TEST(ParameterFill, TakesANumberAListOrRowsForAMatrixOfAnySize) {
  EXPECT_EQ(Filled("any: 0.5").any, Eigen::MatrixXd::Constant(1, 1, 0.5));
  EXPECT_EQ(Filled("any: [1, 2, 3]").any, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(Filled("any: [[1, 2, 3], [4, 5, 6]]").any,
            (Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(Filled("any: []").any.size(), 0);
  EXPECT_EQ(Filled("any: ~").any.size(), 0);
  EXPECT_EQ(ErrorIn("any: x"), "a.yaml:1:6: expected a number, got 'x'");
  EXPECT_EQ(ErrorIn("any: [1, [2]]"), "a.yaml:1:10: expected a number, got a list");
  EXPECT_EQ(ErrorIn("any: [[1, 2], 3]"), "a.yaml:1:15: expected a list, got '3'");
  EXPECT_EQ(ErrorIn("any: [[1, 2], [3]]"), "a.yaml:1:15: expected a list of 2, got one of 1");
  EXPECT_EQ(ErrorIn("any: [1, 2, 3, 4]"), "a.yaml:1:6: expected a list of at most 3, got one of 4");
  EXPECT_EQ(ErrorIn("any: [[1, 2, 3, 4, 5]]"),
            "a.yaml:1:7: expected a list of at most 4, got one of 5");
}

TEST(ParameterFill, LeavesOutWhatIsOptional) {
  EXPECT_EQ(Filled("").maybe, 2.5);
  EXPECT_EQ(Filled("maybe: ~").maybe, std::nullopt);
  EXPECT_EQ(Filled("maybe:").maybe, std::nullopt);
  EXPECT_EQ(Filled("maybe: 20 ms").maybe, 20e-3);
  EXPECT_EQ(Filled("maybe_spring: {stiffness: 2}").maybe_spring, Spring{2});
  EXPECT_EQ(ErrorIn("maybe_spring: {damping: 2}"), "a.yaml:1:15: 'stiffness' is missing");
}

TEST(ParameterFill, TakesListsOfStructs) {
  EXPECT_THAT(Filled("springs:\n- stiffness: 1\n- {stiffness: 2 N/m, damping: 0}\n").springs,
              ElementsAre(Spring{1}, Spring{2, 0}));
  EXPECT_TRUE(Filled("springs:").springs.empty());
  EXPECT_EQ(ErrorIn("springs:\n- stiffness: 1\n- damping: 1\n"),
            "a.yaml:3:3: 'stiffness' is missing");
  EXPECT_EQ(ErrorIn("springs: {stiffness: 1}"), "a.yaml:1:10: expected a list, got a map");
  EXPECT_EQ(ErrorIn("springs: [1]"), "a.yaml:1:11: expected a map, got '1'");
}

TEST(ParameterFill, TakesTheAlternativeThatATagNames) {
  EXPECT_EQ(std::get<Spring>(Filled("either: !Spring {stiffness: 4}").either), Spring{4});
  EXPECT_EQ(std::get<Rope>(Filled("either: !Rope").either), Rope{});
  EXPECT_EQ(std::get<Rope>(Filled("either: !Rope {}").either), Rope{});
  const AllKinds all = Filled("parts:\n  - !Rope {colour_of: x}\n  - !Spring\n    stiffness: 1\n");
  EXPECT_THAT(all.parts, ElementsAre(Rope{"x"}, Spring{1}));
  EXPECT_EQ(ErrorIn("either: {stiffness: 4}"),
            "a.yaml:1:9: expected a tag that says what it is: one of !Spring, !Rope");
  EXPECT_EQ(ErrorIn("either: !Sprig {stiffness: 4}"),
            "a.yaml:1:9: there is no !Sprig here; did you mean 'Spring'?\n"
            "  known: !Spring, !Rope");
  EXPECT_EQ(ErrorIn("either: !Spring {}"), "a.yaml:1:9: 'stiffness' is missing");
  EXPECT_EQ(ErrorIn("either: !Rope 4"), "a.yaml:1:9: expected a map, got '4'");
}

TEST(ParameterFill, RefusesUnknownKeysWithTheNearest) {
  EXPECT_EQ(ErrorIn("spring: {stifness: 4}"),
            "a.yaml:1:10: there is no 'stifness' here; did you mean 'stiffness'?\n"
            "  known: stiffness, damping");
  EXPECT_EQ(ErrorIn("either: !Rope {color_of: 4}"),
            "a.yaml:1:16: there is no 'color_of' here; did you mean 'colour_of'?\n"
            "  known: colour_of");
  EXPECT_EQ(ErrorIn("- 1"), "a.yaml:1:1: expected a map, got a list");
}

TEST(ParameterFill, KeepsTheYamlOfOverrides) {
  EXPECT_THAT(
      Filled("set: {a.b: 1, c: [x, {d: 2 s}], e: \"true\", f: ~, g: !Rope {h: 'a: #'}}").set,
      ElementsAre(Pair("a.b", "1"), Pair("c", "[x, {d: 2 s}]"), Pair("e", "\"true\""),
                  Pair("f", "~"), Pair("g", "!Rope {h: \"a: #\"}")));
}

}  // namespace
}  // namespace pliant
