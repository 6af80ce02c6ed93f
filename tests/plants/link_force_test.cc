#include "pliant/plants/link_force.h"

#include <gtest/gtest.h>

#include <limits>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/pulse.h"
#include "pliant/systems/sine.h"
#include "pliant/systems/table.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/plants/energy_balance.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

RobotModel Weightless(double mass) { return Gantry(mass).WithGravity({0, 0, 0}); }

TEST(LinkForce, OfAPulseGivesItsImpulse) {
  const RobotModel m = Weightless(2);
  Scene s({.model = m, .position = {0, 0, 0}});
  auto& blow = s.b.Add<Pulse<Force>>("blow", {.high = {10, 0, -4}, .at = 100ms, .width = 300ms});
  auto& force = s.AddContact<LinkForce>("force", {.model = m, .link = "tip"});
  s.b.Connect(blow.y, force.force);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  sim.AdvanceTo(0.1);
  EXPECT_EQ(sim.Get(s.plant.velocity), JointVelocity({0, 0, 0}));
  sim.AdvanceTo(1);
  // v = F Δt/m; polynomials of the time are integrated exactly, up to round-off.
  EXPECT_LT((sim.Get(s.plant.velocity) - JointVelocity({1.5, 0, -0.6})).norm(), 1e-13);
  EXPECT_NEAR(sim.Get(s.plant.energy), 0.5 * 2 * (1.5 * 1.5 + 0.6 * 0.6), 1e-12);
  EXPECT_NEAR(sim.Get(s.balance.total), 0, 1e-12);
  EXPECT_EQ(sim.Get(force.power), 0) << "the pulse is over";
}

TEST(LinkForce, FollowsATable) {
  const RobotModel m = Weightless(2);
  Scene s({.model = m, .position = {0, 0, 0}});
  const TimeTable recorded{
      .columns = {"fx", "fy", "fz"}, .times = {0, 1, 1.5}, .cells = {0, 0, 0, 20, -10, 0, 0, 0, 4}};
  auto& profile = s.b.Add<Table<Force>>("profile", {.table = recorded});
  auto& force = s.AddContact<LinkForce>("force", {.model = m, .link = "tip"});
  s.b.Connect(profile.y, force.force);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  sim.AdvanceTo(0.5);
  EXPECT_LT((sim.Get(force.contact).force - Eigen::Vector3d(10, -5, 0)).norm(), 1e-12);
  sim.AdvanceTo(1.5);
  // The area under the profile over m. A step of h over the kink at 1 s, where the slope of v̇ jumps
  // by 30 m/s³, errs by less than 30 h²/2; h ≤ 0.5 ms.
  EXPECT_LT((sim.Get(s.plant.velocity) - JointVelocity({7.5, -3.75, 0.5})).norm(), 4e-6);
}

TEST(LinkForce, GivesTheArmTheEnergyItSays) {
  const RobotModel m = Gen3();
  Scene s({.model = m, .position = {0.1, 0.4, 0.2, -1.2, 0.3, 0.8, 0.1}});
  auto& shaker =
      s.b.Add<Sine<Force>>("shaker", {.amplitude = {30, -20, 10}, .frequency_hz = 3, .phase = 1});
  auto& force = s.AddContact<LinkForce>(
      "force", {.model = m, .link = "forearm_link", .point = {0.05, 0, -0.1}});
  s.b.Connect(shaker.y, force.force);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  const double before = sim.Get(s.balance.total), stored = sim.Get(s.balance.stored);
  sim.AdvanceTo(1);
  EXPECT_GT(std::abs(sim.Get(s.balance.stored) - stored), 1);
  EXPECT_NEAR(sim.Get(s.balance.total), before, 1e-6);  // 1e-11 of 50 J, 2000 steps
}

TEST(LinkForce, KeepsTheLaws) {
  const RobotModel m = Gen3();
  BlockTester<LinkForce> t({.model = m, .link = "tool_frame"});
  t.Set(t->motion, RobotDynamics(m));
  ExpectBlockLaws(std::move(t));
}

TEST(LinkForce, RefusesWhatIsNoPoint) {
  EXPECT_THAT(ErrorOf([] { LinkForce force({.model = Gen3(), .link = "tol_frame"}); }),
              testing::HasSubstr("tool_frame"));
  EXPECT_EQ(ErrorOf([] {
              LinkForce force({.model = Gen3(),
                               .link = "tool_frame",
                               .point = {0, std::numeric_limits<double>::quiet_NaN(), 0}});
            }),
            "point must be finite, got   0 nan   0");
}

}  // namespace
}  // namespace pliant
