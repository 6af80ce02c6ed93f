#include "pliant/systems/time_text.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(TimeText, HasThreeDigitsAndTheUnitThatFits) {
  EXPECT_EQ(TimeText(0), "0 ns");
  EXPECT_EQ(TimeText(850e-9), "850 ns");
  EXPECT_EQ(TimeText(999.6e-9), "1 µs");
  EXPECT_EQ(TimeText(21.34e-6), "21.3 µs");
  EXPECT_EQ(TimeText(1e-3), "1 ms");
  EXPECT_EQ(TimeText(1.5), "1.5 s");
  EXPECT_EQ(TimeText(-2e-6), "-2 µs");
  EXPECT_EQ(TimeText(12345), "12345 s");
}

}  // namespace
}  // namespace pliant
