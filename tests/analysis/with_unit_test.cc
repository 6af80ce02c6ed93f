#include "pliant/analysis/with_unit.h"

#include <gtest/gtest.h>

#include <cmath>

#include <limits>

namespace pliant {
namespace {

TEST(WithUnit, ChoosesThePrefixAPersonWould) {
  EXPECT_EQ(WithUnit(0.00123, "m"), "1.23 mm");
  EXPECT_EQ(WithUnit(1.234e-5, "m"), "12.3 µm");
  EXPECT_EQ(WithUnit(4.2e-5, "m/s"), "42.0 µm/s");
  EXPECT_EQ(WithUnit(-0.0305, "rad"), "-30.5 mrad");
  EXPECT_EQ(WithUnit(12345, "N"), "12.3 kN");
  EXPECT_EQ(WithUnit(0.0127, "N·m"), "12.7 mN·m");
  EXPECT_EQ(WithUnit(12345, "s"), "12345 s");
}

TEST(WithUnit, LeavesUnitsThatTakeNoPrefix) {
  EXPECT_EQ(WithUnit(0.00423, "m²"), "0.00423 m²");
  EXPECT_EQ(WithUnit(0.423, "kg"), "0.423 kg");
  EXPECT_EQ(WithUnit(95.94, "%"), "95.9 %");
  EXPECT_EQ(WithUnit(2.857, ""), "2.86");
}

TEST(WithUnit, RoundsBeforeItChooses) {
  EXPECT_EQ(WithUnit(999.6e-6, "m"), "1.00 mm");
  EXPECT_EQ(WithUnit(0.9996, "m"), "1.00 m");
  EXPECT_EQ(WithUnit(999.6, "N"), "1.00 kN");
  EXPECT_EQ(WithUnit(1e-3, "s"), "1.00 ms");
}

TEST(WithUnit, ShowsWhatIsNoNumber) {
  EXPECT_EQ(WithUnit(0, "m"), "0 m");
  EXPECT_EQ(WithUnit(std::numeric_limits<double>::quiet_NaN(), "m"), "not a number");
  EXPECT_EQ(WithUnit(-std::numeric_limits<double>::infinity(), "m"), "-∞ m");
  EXPECT_EQ(WithUnit(3.2e-14, "m"), "3.20e-14 m");
}

TEST(UnitFor, IsTheUnitThatTheTextHas) {
  const auto unit = [](double value, const char* of) { return UnitFor(value, of); };
  EXPECT_EQ(unit(0.0221, "m").unit, "mm");
  EXPECT_EQ(unit(0.0221, "m").factor, 1e-3);
  EXPECT_EQ(unit(-12345, "N").unit, "kN");
  EXPECT_EQ(unit(0.01, "m²").unit, "m²");
  EXPECT_EQ(unit(0, "m").factor, 1);
  EXPECT_EQ(unit(std::nan(""), "m").unit, "m");
}

}  // namespace
}  // namespace pliant
