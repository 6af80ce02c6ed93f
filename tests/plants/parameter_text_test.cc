#include "pliant/plants/parameter_text.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "pliant/systems/random.h"
#include "pliant/tests/plants/all_kinds.h"

namespace pliant {
namespace {

/// Random choices, one after the other.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}

  std::size_t Below(std::size_t n) {
    return static_cast<std::size_t>(random_.Uniform(k_++) * static_cast<double>(n));
  }
  std::uint64_t Bits() { return Below(1u << 22) << 42 ^ Below(1u << 22) << 21 ^ Below(1u << 22); }
  /// Any finite double, with those of most interest more often.
  double Number() {
    constexpr double kEdges[] = {0,     -0.0, 1,       0.1,      5e-324, -2.2e-308, 1e300,
                                 -1e22, 1e21, 1 / 3.0, 123456.0, 4e-310, 1e-5,      1e17};
    if (Below(3) == 0) return kEdges[Below(std::size(kEdges))];
    const double any = std::bit_cast<double>(Bits());
    return any - any == 0 ? any : 1.5;
  }
  std::string Word() {
    static const std::vector<std::string> kParts{"true",
                                                 "1",
                                                 "~",
                                                 "null",
                                                 " ",
                                                 "#",
                                                 " #",
                                                 ":",
                                                 ": ",
                                                 "\"",
                                                 "'",
                                                 "\\",
                                                 "\n",
                                                 "\t",
                                                 "-",
                                                 "- ",
                                                 "{",
                                                 "}",
                                                 "[",
                                                 "]",
                                                 ",",
                                                 "&a",
                                                 "*a",
                                                 "!Push",
                                                 "|",
                                                 ">",
                                                 "%",
                                                 "@",
                                                 "`",
                                                 "é",
                                                 "τ_e",
                                                 "日本",
                                                 "\x01",
                                                 "\x7f",
                                                 "\r",
                                                 "0x10",
                                                 "\xc2\x85",
                                                 "\xe2\x80\xa8",
                                                 "\xf0\x9f\x98\x80",
                                                 "?",
                                                 "---",
                                                 "...",
                                                 ".inf",
                                                 "1e3"};
    std::string word;
    for (std::size_t n = 1 + Below(4); n > 0; --n) word += kParts[Below(kParts.size())];
    return word;
  }
  Duration Time() {
    static const std::vector<Duration> kAll{Duration(), Hertz(30),     1ns,      1500us,
                                            1ms,        Hertz(1000),   90min,    Hertz(7),
                                            1234567ns,  Hertz(999983), Hertz(3), 9'000'000'000s};
    return kAll[Below(kAll.size())];
  }
  Spring Coil() { return {std::abs(Number()) + 1e-300, std::abs(Number())}; }
  std::variant<Spring, Rope> Part() {
    if (Below(2)) return Coil();
    return Rope{Word()};
  }

 private:
  const RandomStream random_;
  std::uint64_t k_ = 0;
};

AllKinds Random(std::uint64_t seed) {
  Dice dice(seed);
  AllKinds all;
  all.number = dice.Number();
  all.time = std::abs(dice.Number());
  all.angle = dice.Number();
  all.limit = dice.Below(2) ? kUnbounded : 1e-3;
  all.count = static_cast<int>(dice.Below(21)) - 10;
  all.seed = dice.Bits() >> 11;  // a whole number that is a double
  all.flag = dice.Below(2);
  all.word = dice.Word();
  all.colour = static_cast<Colour>(dice.Below(3));
  all.period = dice.Time();
  for (double& x : all.fixed) x = dice.Number();
  all.dynamic.resize(static_cast<Eigen::Index>(dice.Below(5)));
  for (double& x : all.dynamic) x = dice.Number();
  for (double& x : all.matrix.reshaped()) x = dice.Number();
  const auto rows = static_cast<Eigen::Index>(dice.Below(4));
  all.any.resize(rows, rows == 0 ? 0 : static_cast<Eigen::Index>(1 + dice.Below(4)));
  for (double& x : all.any.reshaped()) x = dice.Number();
  all.maybe.reset();
  if (dice.Below(2)) all.maybe = 0.25;
  if (dice.Below(2)) all.maybe_spring = dice.Coil();
  all.spring = dice.Coil();
  for (std::size_t n = dice.Below(3); n > 0; --n) all.springs.push_back(dice.Coil());
  for (std::size_t n = dice.Below(3); n > 0; --n) all.words.push_back(dice.Word());
  all.either = dice.Part();
  for (std::size_t n = dice.Below(3); n > 0; --n) all.parts.push_back(dice.Part());
  return all;
}

void ExpectSame(double a, double b, const std::string& text) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << text;
}

TEST(ParametersText, ReadsBackBitForBit) {
  for (std::uint64_t seed = 0; seed < 2000 && !testing::Test::HasFailure(); ++seed) {
    const AllKinds all = Random(seed);
    const std::string text = ParametersText(all);
    AllKinds back;
    ParameterFile::ReadText(text).Fill(back);
    ExpectSame(back.number, all.number, text);
    ExpectSame(back.time, all.time, text);
    ExpectSame(back.angle, all.angle, text);
    ExpectSame(back.limit, all.limit, text);
    for (int i = 0; i < 3; ++i) ExpectSame(back.fixed(i), all.fixed(i), text);
    ASSERT_EQ(back.dynamic.size(), all.dynamic.size());
    for (int i = 0; i < all.dynamic.size(); ++i) ExpectSame(back.dynamic(i), all.dynamic(i), text);
    for (int i = 0; i < 4; ++i)
      ExpectSame(back.matrix(i / 2, i % 2), all.matrix(i / 2, i % 2), text);
    EXPECT_EQ(back.any, all.any) << text;
    EXPECT_EQ(back.count, all.count) << text;
    EXPECT_EQ(back.seed, all.seed) << text;
    EXPECT_EQ(back.flag, all.flag) << text;
    EXPECT_EQ(back.word, all.word) << text;
    EXPECT_EQ(back.colour, all.colour) << text;
    EXPECT_EQ(back.period, all.period) << text;
    EXPECT_EQ(back.maybe, all.maybe) << text;
    EXPECT_EQ(back.maybe_spring, all.maybe_spring) << text;
    EXPECT_EQ(back.spring, all.spring) << text;
    EXPECT_EQ(back.springs, all.springs) << text;
    EXPECT_EQ(back.words, all.words) << text;
    EXPECT_EQ(back.either, all.either) << text;
    EXPECT_EQ(back.parts, all.parts) << text;
    EXPECT_EQ(ParametersText(back), text);
  }
}

TEST(ParametersText, KeepsOverridesThatWereRead) {
  AllKinds all, back;
  ParameterFile::ReadText(
      "set: {a.b: 'x: y', '#': [1, ~, '~', {n: 2}], \"d\\n\": !Rope, e: !Rope {f: \" g\"}, "
      "h: 'null', i: '-', j: '-1', k: '- 1', l: a b, m: 'a ', 'null': 3}")
      .Fill(all);
  const std::string text = ParametersText(all);
  ParameterFile::ReadText(text).Fill(back);
  EXPECT_EQ(back.set, all.set) << text;
}

}  // namespace
}  // namespace pliant
