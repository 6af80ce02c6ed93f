#include "pliant/plants/push.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

Push::Options Options() {
  return {.model = Gen3(),
          .link = "forearm_link",
          .point = {0.01, 0.02, -0.1},
          .force = {3, -4, 12},
          .start_s = 0.1,
          .duration_s = 0.5,
          .edge_s = 0.2,
          .period = 1ms};
}

TEST(Push, RisesAndFallsAlongARaisedCosine) {
  const Push::Options o = Options();
  BlockTester<Push> t(o);
  for (int k = 0; k < 800; ++k) {
    t.Tick();
    const double time = k * 1e-3;
    double share = 0;
    if (time > 0.1 && time < 0.3)
      share = 0.5 * (1 - std::cos(std::numbers::pi * (time - 0.1) / 0.2));
    if (time >= 0.3 && time <= 0.4) share = 1;
    if (time > 0.4 && time < 0.6)
      share = 0.5 * (1 - std::cos(std::numbers::pi * (0.6 - time) / 0.2));
    const ContactForce& F = t.Get(t->force);
    EXPECT_LT((F.force - share * o.force).norm(), 1e-12) << time;
    EXPECT_EQ(F.moment, Vector3d(Vector3d::Zero()));
    EXPECT_EQ(F.point, o.point);
    EXPECT_EQ(F.link, o.model.link_index("forearm_link"));
  }
}

TEST(Push, IsHeldBetweenItsTicks) {
  Push::Options o = Options();
  o.period = 10ms;
  BlockTester<Push> t(o);
  t.AdvanceTo(0.2055);
  const Vector3d held = t.Get(t->force).force;
  EXPECT_LT((held - 0.5 * o.force).norm(), 1e-12) << "half way up at 0.2 s";
  t.AdvanceTo(0.2099);
  EXPECT_EQ(t.Get(t->force).force, held);
}

TEST(Push, RefusesWhatIsNoPush) {
  const auto error = [](auto change) {
    Push::Options o = Options();
    change(o);
    return ErrorOf([&] { Push push(o); });
  };
  using O = Push::Options;
  EXPECT_EQ(error([](O& o) { o.edge_s = 0; }), "edge_s must be > 0 s, got 0");
  EXPECT_EQ(error([](O& o) { o.duration_s = 0.3; }),
            "duration_s must be >= 2 edge_s = 0.4, got 0.3");
  EXPECT_EQ(error([](O& o) { o.force(1) = HUGE_VAL; }), "force must be finite, got   3 inf  12");
  EXPECT_EQ(error([](O& o) { o.start_s = NAN; }),
            "start_s must be from -1000000 to 1000000 s, got nan");
}

TEST(ContactTorque, IsTheSumOfJacobiansTransposedTimesForces) {
  const RobotModel m = Gen3();
  RandomStates random(m, 61);
  BlockTester<ContactTorque> t(ContactTorque::Options{.model = m});
  RobotDynamics d(m);
  const int forearm = m.link_index("forearm_link"), tool = m.link_index("tool_frame");
  ContactForce one{forearm, {0.03, 0.02, -0.1}, {1, 2, 3}, {0.4, 0.5, 0.6}};
  ContactForce two{tool, {0, 0, 0.05}, {-7, 8, 9}, {0, 0, 0}};
  const ContactForce nowhere{-1, {0, 0, 0}, {100, 100, 100}, {0, 0, 0}};
  t.Join(t->contacts, one);
  t.Join(t->contacts, nowhere);
  t.Join(t->contacts, two);
  for (int k = 0; k < 100; ++k) {
    ComputeDynamics(m, random.q(), random.v(), d);
    t.Set(t->dynamics, d);
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(m.size());
    for (const ContactForce& F : {one, two}) {
      Vector6 wrench;
      wrench << F.moment, F.force;
      expected += PointDynamics(m, d, F.link, F.point).J.transpose() * wrench;
    }
    EXPECT_LT(RelativeError(t.Get(t->torque), expected), 1e-13);
  }
}

}  // namespace
}  // namespace pliant
