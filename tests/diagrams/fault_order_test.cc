#include "pliant/diagrams/fault_order.h"

#include <gtest/gtest.h>

#include <random>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const std::vector<FaultOrder::Kind> kKnown{{"lost"}, {"late"}, {"torque_sensor_dead", true}};

TEST(FaultOrder, SaysWhatWhenAndOfWhichJoint) {
  EXPECT_EQ(FaultOrder::Of("lost@1+0.5", kKnown), (FaultOrder{"lost", 1, 0.5, {}}));
  EXPECT_EQ(FaultOrder::Of("late@0+1e3", kKnown), (FaultOrder{"late", 0, 1000, {}}));
  EXPECT_EQ(FaultOrder::Of("torque_sensor_dead@1+2:4", kKnown),
            (FaultOrder{"torque_sensor_dead", 1, 2, 4}));
}

TEST(FaultOrder, IsShownFromItsStartUntilItsEnd) {
  const std::vector<FaultOrder> orders{{"lost", 1, 0.5, {}}, {"late", 3, 1, {}}};
  for (const auto& [t, shows] :
       {std::pair{0.99, false}, {1.0, true}, {1.49, true}, {1.5, false}, {3.5, false}})
    EXPECT_EQ(Shows(orders, "lost", t), shows) << t;
  EXPECT_TRUE(Shows(orders, "late", 3.5));
}

TEST(FaultOrder, SaysWhatIsWrongWithOneThatIsNone) {
  const auto error = [](const std::string& text) {
    return ErrorOf([&] { FaultOrder::Of(text, kKnown); });
  };
  EXPECT_EQ(error("lost"),
            "the fault 'lost' does not say when; expected KIND@START+DURATION in seconds, such as "
            "'lost@1+0.5'");
  EXPECT_EQ(error("lots@1+1"),
            "the fault 'lots@1+1' is of no kind that is known; did you mean 'lost'?; expected one "
            "of lost, late, torque_sensor_dead");
  for (const char* const start : {"lost@+1", "lost@x+1", "lost@-1+1", "lost@nan+1", "lost@inf+1"})
    EXPECT_EQ(error(start), std::string("the fault '") + start +
                                "' has no start; expected seconds >= 0 behind '@'");
  for (const char* const end : {"lost@1", "lost@1+", "lost@1+0", "lost@1+-1", "lost@1+1s"})
    EXPECT_EQ(error(end), std::string("the fault '") + end +
                              "' has no duration; expected seconds > 0 behind '+'");
  EXPECT_EQ(error("lost@1+1:4"), "the fault 'lost@1+1:4' has a joint; lost is of none");
  EXPECT_EQ(error("torque_sensor_dead@1+1"),
            "the fault 'torque_sensor_dead@1+1' does not say of which joint; expected its number "
            "behind ':', such as 'torque_sensor_dead@1+1:4'");
  for (const char* const joint :
       {"torque_sensor_dead@1+1:", "torque_sensor_dead@1+1:0", "torque_sensor_dead@1+1:a"})
    EXPECT_EQ(error(joint), std::string("the fault '") + joint +
                                "' has no joint's number behind ':'; expected 1 or more");
}

TEST(FaultOrder, AnyTextIsAnOrderOrAnError) {
  std::mt19937 random(31);
  const std::string letters = "lostae_@+:.019-enif x";
  for (int k = 0; k < 100000; ++k) {
    std::string text = k % 2 ? "lost@" : "";
    for (std::size_t n = random() % 12; n > 0; --n) text += letters[random() % letters.size()];
    ErrorOf([&] { FaultOrder::Of(text, kKnown); });
  }
}

}  // namespace
}  // namespace pliant
