#include "pliant/systems/parameter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMost = std::numeric_limits<double>::max();
constexpr double kLeast = std::numeric_limits<double>::denorm_min();

TEST(Range, SaysWhatItHolds) {
  EXPECT_EQ(kAnyNumber.text(), "finite");
  EXPECT_EQ(kPositive.text(), "> 0");
  EXPECT_EQ(kNotNegative.text(), ">= 0");
  EXPECT_EQ(kLimit.text(), "> 0");
  EXPECT_EQ(Between(0, 0.99).text(), "from 0 to 0.99");
  EXPECT_EQ(Between(-3, -1).text(), "from -3 to -1");
  EXPECT_EQ((Range{.least = 0, .most = 1, .without_least = true}).text(), "above 0 to 1");
  EXPECT_EQ((Range{.most = 5}).text(), "<= 5");
}

TEST(Range, HasItsEndsUnlessItSaysOtherwise) {
  EXPECT_TRUE(Between(-1, 1).Contains(-1));
  EXPECT_TRUE(Between(-1, 1).Contains(1));
  EXPECT_FALSE(Between(-1, 1).Contains(std::nextafter(-1, -2)));
  EXPECT_FALSE(Between(-1, 1).Contains(std::nextafter(1, 2)));
  EXPECT_TRUE(Between(2, 2).Contains(2));
  EXPECT_FALSE(Between(1, -1).Contains(0));
  EXPECT_TRUE(kNotNegative.Contains(0));
  EXPECT_TRUE(kNotNegative.Contains(-0.0));
  EXPECT_FALSE(kNotNegative.Contains(-kLeast));
  EXPECT_FALSE(kPositive.Contains(0));
  EXPECT_TRUE(kPositive.Contains(kLeast));
}

TEST(Range, HoldsInfinityOnlyWhereItIsALimit) {
  for (const Range& range : {kAnyNumber, kPositive, kNotNegative}) {
    EXPECT_TRUE(range.Contains(kMost));
    EXPECT_FALSE(range.Contains(kInfinity));
    EXPECT_FALSE(range.Contains(-kInfinity));
  }
  EXPECT_TRUE(kAnyNumber.Contains(-kMost));
  EXPECT_TRUE(kLimit.Contains(kUnbounded));
  EXPECT_FALSE(kLimit.Contains(0));
  EXPECT_FALSE(kLimit.Contains(-kInfinity));
}

TEST(Range, NeverHoldsNan) {
  for (const Range& range : {kAnyNumber, kPositive, kNotNegative, kLimit, Between(-1, 1),
                             Range{.least = -kInfinity, .most = kInfinity}})
    EXPECT_FALSE(range.Contains(kToBeGiven));
}

TEST(RequireInRange, SaysWhereWhatAndInWhichUnit) {
  const auto error = [](std::string_view where, double value, std::string_view unit,
                        const Range& range) {
    return ErrorOf([&] { RequireInRange(where, "gain", value, unit, range); });
  };
  EXPECT_EQ(error("", 1, "", kPositive), "no error");
  EXPECT_EQ(error("", 0, "", kPositive), "gain must be > 0, got 0");
  EXPECT_EQ(error("", 0, "N·m", kPositive), "gain must be > 0 N·m, got 0");
  EXPECT_EQ(error("elbow", -1, "", kNotNegative), "elbow: gain must be >= 0, got -1");
  EXPECT_EQ(error("elbow", 2, "1/s", Between(0, 1)), "elbow: gain must be from 0 to 1 1/s, got 2");
  EXPECT_EQ(error("", NAN, "", kAnyNumber), "gain must be finite, got nan");
  EXPECT_EQ(error("", -kInfinity, "m", kAnyNumber), "gain must be finite m, got -inf");
  EXPECT_EQ(error("", kInfinity, "A", kLimit), "no error");
}

struct Gear {
  double ratio = kToBeGiven;
  double stiffness = 100;
  bool locked = false;

  template <class F>
  void Parameters(F&& f) {
    f("ratio", ratio, "", kPositive);
    f("stiffness", stiffness, "N·m/rad", kLimit);
    f("locked", locked, "", kAnyNumber);
  }
};

struct WithoutParameters {
  double ratio;
};

/// A name, a value and a range, but no unit.
struct WithoutUnits {
  double ratio;

  template <class F>
  requires std::invocable<F, std::string_view, double&, Range>
  void Parameters(F&& f) { f("ratio", ratio, kPositive); }
};

static_assert(HasParameters<Gear>);
static_assert(!HasParameters<WithoutParameters>);
static_assert(!HasParameters<WithoutUnits>);
static_assert(!HasParameters<double>);

TEST(RequireInRange, NamesTheFirstParameterOutOfItsRange) {
  const auto error = [](std::string_view where, const Gear& gear) {
    return ErrorOf([&] { RequireInRange(where, gear); });
  };
  EXPECT_EQ(error("elbow", {.ratio = 1}), "no error");
  EXPECT_EQ(error("elbow", {.ratio = 1, .locked = true}), "no error");  // flags have no range
  EXPECT_EQ(error("elbow", {}), "elbow: ratio must be > 0, got nan");
  EXPECT_EQ(error("elbow", {.ratio = -1, .stiffness = -2}), "elbow: ratio must be > 0, got -1");
  EXPECT_EQ(error("", {.ratio = 1, .stiffness = -2}), "stiffness must be > 0 N·m/rad, got -2");
}

TEST(RequireOneForEach, SaysHowManyThereAre) {
  const Joints joints{"shoulder", "elbow"};
  const auto error = [&](std::ptrdiff_t found) {
    return ErrorOf([&] { RequireOneForEach(joints, "gain", found); });
  };
  EXPECT_EQ(error(2), "no error");
  EXPECT_EQ(error(0), "gain has an element for each of the 2 joints, got 0");
  EXPECT_EQ(error(3), "gain has an element for each of the 2 joints, got 3");
}

}  // namespace
}  // namespace pliant
