#include "pliant/estimators/wrist_torque.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "pliant/estimators/tool_compensation.h"
#include "pliant/plants/wrist_sensor.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

const std::string kFrame = "FT_sensor_wrench";

RobotModel Gen3Bota() { return RobotModel::FromUrdf(kGen3BotaFile); }

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, v, d);
  return d;
}

TEST(WristTorque, IsTheTransposedJacobianTimesTheWrench) {
  const RobotModel m = Gen3Bota();
  RandomStates random(m, 61);
  BlockTester<WristTorque> t(WristTorque::Options{.model = m, .frame = kFrame});
  for (int k = 0; k < 100; ++k) {
    const RobotDynamics d = At(m, random.q(), random.v());
    const Wrench F = random.Uniform(20).head<6>();
    const FrameDynamics frame = PointDynamics(m, d, m.link_index(kFrame), {0, 0, 0});
    const Eigen::Matrix3d& R = frame.pose.rotation;
    Vector6 in_world;
    in_world << R * F.head<3>(), R * F.tail<3>();
    t.Set(t->contact, F);
    t.Set(t->dynamics, d);
    // J_Sᵀ F with J in the sensor's axes is J_Wᵀ of F turned into the world's.
    const PerJoint expected = frame.J.transpose() * in_world;
    EXPECT_LT((t.Get(t->torque) - expected).norm(), 1e-13);  // round-off of some 50 N·m
  }
}

/// A sensor without flaws in an arm that moves, the tool's weight taken off, and the torque of
/// what is left.
struct Rig {
  RobotModel model =
      Gen3Bota().WithPayload(kFrame, {0.9, {0.01, 0.02, 0.07}, 1e-3 * Eigen::Matrix3d::Identity()});
  BlockTester<WristSensor> sensor{WristSensor::Options{.model = model, .frame = kFrame}};
  BlockTester<ToolCompensation> compensation{ToolCompensation::Options{
      .model = model,
      .frame = kFrame,
      .tool = {.mass = model.link(model.link_index(kFrame)).inertial.mass,
               .center = model.link(model.link_index(kFrame)).inertial.center,
               .bias = {}}}};
  BlockTester<WristTorque> torque{WristTorque::Options{.model = model, .frame = kFrame}};
  const Input<ContactForce>& push = sensor.Join(sensor->contacts, {});

  JointTorque Of(const RobotDynamics& d, const ContactForce& force) {
    sensor.Set(sensor->motion, d);
    sensor.Set(sensor->acceleration, JointAcceleration::Zero(model.joints()));
    sensor.Set(push, force);
    compensation.Set(compensation->measured, sensor.Get(sensor->true_wrench));
    compensation.Set(compensation->dynamics, d);
    torque.Set(torque->contact, compensation.Get(compensation->contact));
    torque.Set(torque->dynamics, d);
    return torque.Get(torque->torque);
  }
};

TEST(WristTorque, IsTheExternalTorqueOfAForceAtTheToolAndNothingOfOneBeforeTheSensor) {
  Rig rig;
  const RobotModel& m = rig.model;
  RandomStates random(m, 62);
  for (int k = 0; k < 100; ++k) {
    const RobotDynamics d = At(m, random.q(), JointVelocity::Zero(m.joints()));
    ContactForce force{.link = m.link_index(kFrame),
                       .point = random.Uniform(0.2).head<3>(),
                       .force = random.Uniform(20).head<3>(),
                       .moment = random.Uniform(2).head<3>()};
    const PerJoint expected = ExternalTorque(m, d, std::span(&force, 1));
    EXPECT_LT((rig.Of(d, force) - expected).norm(), 1e-12);  // round-off of some 100 N·m
    force.link = m.link_index("forearm_link");
    EXPECT_LT(rig.Of(d, force).norm(), 1e-12);
  }
}

TEST(WristTorque, RefusesAFrameThatIsNone) {
  EXPECT_THAT(ErrorOf([] {
                BlockTester<WristTorque> t(
                    WristTorque::Options{.model = Gen3Bota(), .frame = "FT_sensor_wrenc"});
              }),
              testing::HasSubstr("did you mean \"FT_sensor_wrench\"?"));
}

TEST(WristTorque, HoldsTheLaws) {
  ExpectBlockLaws(
      BlockTester<WristTorque>(WristTorque::Options{.model = Gen3Bota(), .frame = kFrame}));
}

}  // namespace
}  // namespace pliant
