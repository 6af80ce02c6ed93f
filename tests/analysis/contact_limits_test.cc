#include "pliant/analysis/contact_limits.h"

#include <gtest/gtest.h>

#include <limits>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// A contact over 2 s, 1 ms apart: 0 N but for `force` from `from_s` to `to_s`, along (0.6, 0,
/// 0.8).
RecordedSignal Touch(double from_s, double to_s, double force) {
  RecordedSignal signal{{"hand_1.contact",
                         "contact force",
                         {".link", ".force[x]", ".force[y]", ".force[z]"},
                         {"", "N", "N", "N"}},
                        Eigen::VectorXd::LinSpaced(2001, 0, 2),
                        Eigen::MatrixXd::Zero(4, 2001)};
  for (Eigen::Index k = 0; k < 2001; ++k)
    if (signal.times(k) >= from_s && signal.times(k) <= to_s)
      signal.numbers.col(k) << 3, 0.6 * force, 0, 0.8 * force;
  return signal;
}

RecordedSignal Both(RecordedSignal one, const RecordedSignal& other) {
  one.numbers += other.numbers;
  return one;
}

KeepsContactLimits Of(BodyArea body, double area = 0) {
  return {.claim = {.id = "id", .source = "s", .paper = "p"},
          .run = "run",
          .contact = "hand_1.contact",
          .body = body,
          .area = area};
}

TEST(ContactLimits, AreThoseOfTheTable) {
  EXPECT_EQ(Words(BodyArea{}).size(), 29u);
  EXPECT_EQ(Words(BodyArea{}).at(static_cast<std::size_t>(BodyArea::CalfMuscle)), "calf_muscle");
  EXPECT_EQ(Words(BodyArea{}).at(static_cast<std::size_t>(BodyArea::BackOfHandNd)),
            "back_of_hand_nd");
  const ContactLimits hand = LimitsOf(BodyArea::BackOfHandNd);
  EXPECT_EQ(hand.region, "hands and fingers");
  EXPECT_EQ(hand.force, 140);
  EXPECT_EQ(hand.pressure, 190e4);
  EXPECT_EQ(hand.transient, 2);
  EXPECT_EQ(LimitsOf(BodyArea::MasticatoryMuscle).force, 65);
  EXPECT_EQ(LimitsOf(BodyArea::MasticatoryMuscle).transient, 0);
  EXPECT_EQ(LimitsOf(BodyArea::NeckMuscle).transient, 2);
}

TEST(ContactSummary, AreTransientForTheirFirstHalfSecond) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(2001, 0, 2);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(2001);
  f.segment(100, 1000).setConstant(20);  // 0.1 s to 1.099 s
  f(150) = 90;
  f(599) = 50;   // 0.499 s after it began
  f(600) = 40;   // 0.5 s after it began
  f(1500) = 30;  // another one
  const ContactSummary of = ContactsOf(t, f, 1);
  EXPECT_EQ(of.count, 2);
  EXPECT_EQ(of.transient, 90);
  EXPECT_EQ(of.quasi_static, 40);
  EXPECT_NEAR(of.longest_s, 0.999, 1e-12);
}

TEST(ContactSummary, GoOnThroughShortPauses) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(2001, 0, 2);
  Eigen::VectorXd f = Eigen::VectorXd::Constant(2001, 10);
  for (const Eigen::Index k : {400, 800, 1200}) f(k) = 0;
  const ContactSummary tapped = ContactsOf(t, f, 1);
  EXPECT_EQ(tapped.count, 1);
  EXPECT_EQ(tapped.quasi_static, 10);
  f.segment(300, 102).setZero();  // from one contact to the next it is 0.103 s
  EXPECT_EQ(ContactsOf(t, f, 1).count, 2);
}

TEST(KeepsContactLimits, DoesNotHoldWhereNothingIsTouched) {
  const Claim of = Of(BodyArea::PalmNd).Judge(Touch(3, 4, 1000));
  EXPECT_FALSE(of.holds);
  EXPECT_EQ(of.measured, "0 contacts of hand_1.contact");
}

TEST(ContactSummary, TakeWhatIsNotANumberForInfinite) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(3);
  f(1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ContactsOf(Eigen::VectorXd::LinSpaced(3, 0, 1), f, 1).transient,
            std::numeric_limits<double>::infinity());
}

TEST(KeepsContactLimits, PermitsTwiceTheForceForHalfASecond) {
  const KeepsContactLimits palm = Of(BodyArea::PalmNd);
  EXPECT_TRUE(palm.Judge(Touch(0.1, 0.5, 280)).holds);
  EXPECT_FALSE(palm.Judge(Touch(0.1, 0.5, 281)).holds);
  EXPECT_TRUE(palm.Judge(Touch(0.1, 1.5, 140)).holds);
  EXPECT_FALSE(palm.Judge(Touch(0.1, 1.5, 141)).holds);
}

TEST(KeepsContactLimits, PermitsNoContactWithTheHead) {
  EXPECT_FALSE(Of(BodyArea::Temple).Judge(Touch(0.1, 0.2, 5)).holds);
}

TEST(KeepsContactLimits, ComparesPressuresWhereTheAreaIsKnown) {
  // 100 N on 0.5 cm² are 200 N/cm²: more than the 190 that a hand's back bears, less than twice
  // that.
  const KeepsContactLimits back = Of(BodyArea::BackOfHandNd, 0.5e-4);
  EXPECT_TRUE(back.Judge(Touch(0.1, 0.5, 100)).holds);
  EXPECT_FALSE(back.Judge(Touch(0.1, 1.5, 100)).holds);
}

TEST(KeepsContactLimits, SaysWhatItMeasured) {
  const Claim of =
      Of(BodyArea::PalmNd, 1e-4).Judge(Both(Touch(0.1, 0.3, 100), Touch(0.5, 1.5, 20)));
  EXPECT_EQ(of.measured,
            "2 contacts of hand_1.contact; transient 100 N of 280 N, 100 N/cm² of 520 N/cm²; "
            "quasi-static 20.0 N of 140 N, 20.0 N/cm² of 260 N/cm²");
  EXPECT_EQ(of.criterion, "within the limits of palm_nd (hands and fingers)");
  EXPECT_EQ(of.basis, "ISO/TS 15066:2016, table A.2; transient: the first half second");
  EXPECT_EQ(Of(BodyArea::Temple).Judge(Touch(0.1, 0.2, 5)).measured,
            "1 contact of hand_1.contact; transient 5.00 N, where none is permitted");
}

TEST(KeepsContactLimits, WantsASignalWithAForce) {
  RecordedSignal speed = Touch(0, 1, 1);
  speed.type = "twist";
  speed.elements = {".a", ".b", ".c", ".d"};
  EXPECT_EQ(ErrorOf([&] { Of(BodyArea::PalmD).RequireSound(Recording({speed}, {})); }),
            "hand_1.contact has no force: expected a contact or a wrench, with elements force[x], "
            "… or fx, …; it is a twist");
}

}  // namespace
}  // namespace pliant
