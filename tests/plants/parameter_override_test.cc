#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/tests/plants/all_kinds.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::ElementsAre;

std::string AfterSetting(const std::string& text, const Overrides& set) {
  ParameterFile file = ParameterFile::ReadText(text, "a.yaml");
  for (const auto& [path, yaml] : set) file.Set(path, yaml, "--set " + path);
  return file.yaml();
}

std::string ErrorAfter(const std::string& text, const std::string& path, const std::string& yaml) {
  return ErrorOf([&] {
    ParameterFile file = ParameterFile::ReadText(text, "a.yaml");
    file.Set(path, yaml, "--set " + path);
    AllKinds all;
    file.Fill(all);
  });
}

TEST(ParameterOverride, StandsInForTheValueAtItsPath) {
  EXPECT_EQ(AfterSetting("a: 1\nb: 2\n", {{"a", "3 s"}}), "{a: 3 s, b: 2}");
  EXPECT_EQ(AfterSetting("a: {b: {c: 1, d: 2}}", {{"a.b.c", "3"}}), "{a: {b: {c: 3, d: 2}}}");
  EXPECT_EQ(AfterSetting("a: [1, {b: 2}]", {{"a.1.b", "3"}, {"a.0", "[4]"}}), "{a: [[4], {b: 3}]}");
  EXPECT_EQ(AfterSetting("a: !Rope {b: 1}", {{"a.b", "2"}}), "{a: !Rope {b: 2}}");
  EXPECT_EQ(AfterSetting("a: {b: 1}", {{"a", "{c: 1}"}, {"a.c", "2"}}), "{a: {c: 2}}");
}

TEST(ParameterOverride, MakesWhatIsNotThere) {
  EXPECT_EQ(AfterSetting("", {{"a.b.c", "3"}}), "{a: {b: {c: 3}}}");
  EXPECT_EQ(AfterSetting("a:\n", {{"a.b", "3"}}), "{a: {b: 3}}");
  EXPECT_EQ(AfterSetting("a: !Rope\n", {{"a.b", "3"}}), "{a: !Rope {b: 3}}");
  EXPECT_EQ(AfterSetting("a: {b: 1}", {{"a.c", "~"}}), "{a: {b: 1, c: ~}}");
}

TEST(ParameterOverride, LeavesOtherUsersOfAnAliasAlone) {
  const std::string text = "a: &x {v: 1, w: [1, 2]}\nb: *x\nc: &y 5\nd: *y\n";
  EXPECT_EQ(AfterSetting(text, {{"b.v", "2"}}),
            "{a: {v: 1, w: [1, 2]}, b: {v: 2, w: [1, 2]}, c: 5, d: 5}");
  EXPECT_EQ(AfterSetting(text, {{"a.w.1", "7"}}),
            "{a: {v: 1, w: [1, 7]}, b: {v: 1, w: [1, 2]}, c: 5, d: 5}");
  EXPECT_EQ(AfterSetting(text, {{"c", "6"}}),
            "{a: {v: 1, w: [1, 2]}, b: {v: 1, w: [1, 2]}, c: 6, d: 5}");
}

TEST(ParameterOverride, RefusesPathsThatLeadNowhere) {
  const auto error = [](const std::string& path) {
    return ErrorOf([&] { AfterSetting("a: {b: 1, c: [1, 2]}", {{path, "3"}}); });
  };
  EXPECT_EQ(error("a.c.2"),
            "--set a.c.2: '2' is none of the 2 elements, which are numbered from 0");
  for (const char* index : {"-1", "1x", "first", "99999999999999999999999"})
    EXPECT_EQ(error("a.c." + std::string(index)),
              "--set a.c." + std::string(index) + ": '" + index +
                  "' is none of the 2 elements, which are numbered from 0");
  EXPECT_EQ(error("a.b.c"), "--set a.b.c: there is nothing inside '1' to set as 'c'");
  for (const char* path : {"", ".", "a.", ".a", "a..b"})
    EXPECT_EQ(error(path),
              "--set " + std::string(path) + ": expected a path such as controller.pose.stiffness");
}

TEST(ParameterOverride, IsNamedInMessagesWithoutAPlace) {
  EXPECT_EQ(ErrorAfter("time: 1", "time", "-1"), "--set time: time must be >= 0 s, got -1");
  EXPECT_EQ(ErrorAfter("", "fixed", "[1, x, 2]"), "--set fixed: expected a number [m], got 'x'");
  EXPECT_EQ(ErrorAfter("", "spring.stifness", "1"),
            "--set spring.stifness: there is no 'stifness' here; did you mean 'stiffness'?\n"
            "  known: stiffness, damping");
  EXPECT_EQ(ErrorAfter("", "maybe_spring.damping", "1"),
            "--set maybe_spring.damping: 'stiffness' is missing");
  EXPECT_THAT(
      ErrorAfter("", "sprig.damping", "1"),
      testing::StartsWith("--set sprig.damping: there is no 'sprig' here; did you mean 'spring'?"));
  EXPECT_THAT(ErrorAfter("", "time", "[1"), testing::StartsWith("--set time: "));
  EXPECT_EQ(ErrorAfter("", "time", "{a: 1, a: 2}"), "--set time: 'a' is given twice");
  // What the file itself says keeps its place.
  EXPECT_EQ(ErrorAfter("time: 1\nspring: {stiffness: 0}", "spring.damping", "1"),
            "a.yaml:2:21: stiffness must be > 0 N/m, got 0");
  EXPECT_THAT(ErrorAfter("tim: 1", "time", "2"),
              testing::StartsWith("a.yaml:1:1: there is no 'tim' here; did you mean 'time'?"));
}

TEST(ParameterOverride, LeavesACopyOfTheFileAsItWas) {
  ParameterFile file = ParameterFile::ReadText("a: {b: 1}");
  const ParameterFile copy = file, inner = file["a"];
  file.Set("a.b", "2", "--set");
  EXPECT_EQ(copy.yaml(), "{a: {b: 1}}");
  EXPECT_EQ(inner.yaml(), "{b: 1}");
  EXPECT_EQ(file.yaml(), "{a: {b: 2}}");
}

}  // namespace
}  // namespace pliant
