#include "pliant/controllers/virtual_door.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/plants/parameter_file.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
const Joints kJoints = Joints::Numbered(6);

/// A door with a leaning hinge and a handle off its plane.
VirtualDoor::Options Door() {
  VirtualDoor::Options o;
  o.joints = kJoints;
  o.closed = {{0.5, -0.2, 0.4}, AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).matrix()};
  o.hinge = {0.1, 0.3, 0.2};
  o.axis = {0.2, -0.3, 2};
  o.inertia = 1.7;
  return o;
}

/// A door about the world's y axis, as a trap door hangs: γ along −z, its handle at 0.6 m along −z.
VirtualDoor::Options Hanging() {
  VirtualDoor::Options o;
  o.joints = kJoints;
  o.closed = {{0, 0, -0.6}, Matrix3d::Identity()};
  o.hinge = {0, 0, 0};
  o.axis = {0, 1, 0};
  o.inertia = 0.8;
  return o;
}

Pose At(const VirtualDoor::Options& o, double theta) {
  const AngleAxisd turn(theta, o.axis.normalized());
  return {o.hinge + turn * Vector3d(o.closed.position - o.hinge),
          turn.toRotationMatrix() * o.closed.rotation};
}

/// [n; n × (p − h)]
Vector6 Screw(const VirtualDoor::Options& o, double theta) {
  const Vector3d n = o.axis.normalized();
  Vector6 s;
  s << n, n.cross(Vector3d(At(o, theta).position - o.hinge));
  return s;
}

/// A door held by a body that the environment's force alone moves: J = 1, M as one likes.
struct Held {
  explicit Held(const VirtualDoor::Options& options) : o{options}, block(options) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(
        6, 6, [](Eigen::Index i, Eigen::Index j) { return std::cos(1.0 + 7 * i + 3 * j); });
    dynamics.M = root * root.transpose() + JointMatrix::Identity(6, 6);
    block.Set(block->dynamics, dynamics);
  }

  void Place(const Pose& tool, const Twist& V, const Vector6& F = Vector6::Zero()) {
    FrameDynamics frame;
    frame.link = 0;
    frame.pose = tool;
    frame.twist = V;
    frame.J = Jacobian::Identity(6, 6);
    block.Set(block->frame, frame);
    block.Set(block->external_acceleration, JointAcceleration(PerJoint(dynamics.M.llt().solve(F))));
  }
  DoorMotion At(double theta, double rate, const Vector6& F = Vector6::Zero()) {
    Place(pliant::At(o, theta), Twist(rate * Screw(o, theta)), F);
    return block.Get(block->door);
  }

  VirtualDoor::Options o;
  BlockTester<VirtualDoor> block;
  RobotDynamics dynamics;
};

/// The motion that the door asks for, followed exactly: Runge and Kutta's fourth order.
struct Swinging {
  void Step(Held& door, double h) {
    const auto rate = [&](double angle, double speed) {
      return Eigen::Vector2d(speed, door.At(angle, speed).acceleration);
    };
    const Eigen::Vector2d x(theta, omega);
    const auto at = [&](const Eigen::Vector2d& y) { return rate(y(0), y(1)); };
    const Eigen::Vector2d a = at(x), b = at(x + 0.5 * h * a), c = at(x + 0.5 * h * b),
                          d = at(x + h * c);
    const Eigen::Vector2d next = x + h / 6 * (a + 2 * b + 2 * c + d);
    theta = next(0);
    omega = next(1);
    time += h;
  }
  /// The time of a quarter of a period, from rest at the outermost point to θ = `through`.
  double TimeTo(Held& door, double through, double h) {
    const double side = theta - through;
    double before = side;
    while ((theta - through) * side > 0) {
      before = theta - through;
      Step(door, h);
    }
    // The last step by the speed, which is stationary there.
    const double after = theta - through;
    return time - h * after / (after - before);
  }
  double theta, omega = 0, time = 0;
};

TEST(VirtualDoor, ProjectsTheToolOnTheCircleOfItsHandle) {
  Held door(Door());
  const Vector3d n = door.o.axis.normalized();
  for (double theta = -3.1; theta < 3.2; theta += 0.1) {
    const Pose handle = At(door.o, theta);
    const Vector3d along = Screw(door.o, theta).tail<3>();
    const Vector3d outward = along.cross(n) / along.norm();
    for (const double off : {0.0, 0.05}) {  // away from the hinge, and along it
      const Vector3d error = off * outward - 0.5 * off * n;
      const Pose tool{handle.position + error,
                      AngleAxisd(off, outward).toRotationMatrix() * handle.rotation};
      door.Place(tool, Twist{});
      EXPECT_NEAR(door.block.Get(door.block->door).angle, theta, 1e-14);  // round-off
      const Pose target = door.block.Get(door.block->pose);
      EXPECT_LT((target.position - handle.position).norm(), 1e-14);
      EXPECT_LT((target.rotation - handle.rotation).norm(), 1e-14);
      EXPECT_LT(std::abs((tool.position - target.position).dot(along)), 1e-15);
    }
  }
}

TEST(VirtualDoor, FindsItsRateAlsoOffTheCircle) {
  Held door(Door());
  const double h = 1e-6;
  for (const double theta : {-2.0, 0.3, 1.5}) {
    const Pose handle = At(door.o, theta);
    const Vector3d offset(0.03, -0.02, 0.05), v(0.4, -0.3, 0.2);
    const auto angle = [&](double t) {
      door.Place({handle.position + offset + t * v, handle.rotation},
                 Twist{{0.5, -1, 2, v.x(), v.y(), v.z()}});
      return door.block.Get(door.block->door).angle;
    };
    const double difference = (angle(h) - angle(-h)) / (2 * h);
    angle(0);
    EXPECT_NEAR(door.block.Get(door.block->door).rate, difference, 1e-9);  // ε/h
  }
}

TEST(VirtualDoor, MovesItsHandleAsTwistAndAccelerationSay) {
  VirtualDoor::Options o = Door();
  o.closer = 5;
  o.rest_angle = 0.2;
  o.viscous = 0.7;
  o.mass = 2;
  o.center = {0.3, 0.1, 0.3};
  Held door(o);
  const double h = 1e-5;
  for (const double theta : {-2.0, 0.3, 1.5})
    for (const double rate : {-1.0, 0.0, 2.0}) {
      const DoorMotion now = door.At(theta, rate);
      const Twist V = door.block.Get(door.block->twist);
      const Twist A = door.block.Get(door.block->acceleration);
      const auto at = [&](double t) {
        door.At(theta + t * rate + 0.5 * t * t * now.acceleration, rate + t * now.acceleration);
        return std::pair(door.block.Get(door.block->pose), door.block.Get(door.block->twist));
      };
      const auto [X1, V1] = at(h);
      const auto [X0, V0] = at(-h);
      const AngleAxisd turn(X1.rotation * X0.rotation.transpose());
      Vector6 difference;
      difference << turn.angle() * turn.axis() / (2 * h), (X1.position - X0.position) / (2 * h);
      // h²/6 of the third rates, some hundred, and ε/h of a rotation's small angle
      EXPECT_LT((V - difference).norm(), 3e-9);
      EXPECT_LT((A - (V1 - V0) / (2 * h)).norm(), 3e-9);
    }
}

TEST(VirtualDoor, LendsTheHandleTheMobilityOfItsInertia) {
  Held door(Door());
  for (const double theta : {-2.0, 0.3, 1.5}) {
    Vector6 F;
    F << 1, -2, 0.5, 10, 20, -15;
    const Vector6 s = Screw(door.o, theta);
    const DoorMotion now = door.At(theta, 0, F);
    const TaskMatrix Y = door.block.Get(door.block->mobility);
    EXPECT_LT((Y - s * s.transpose() / door.o.inertia).norm(), 1e-14);
    EXPECT_NEAR(now.external, s.dot(F), 1e-12);  // round-off of M, cond 100
    // V̇° + Y F̂ is what the handle does
    const Vector6 wanted = door.block.Get(door.block->acceleration) + Vector6(Y * F);
    EXPECT_LT((wanted - s * now.acceleration).norm(), 1e-12);
    EXPECT_NEAR(now.acceleration, s.dot(F) / door.o.inertia, 1e-12);
  }
}

TEST(VirtualDoor, SwingsOnItsCloserWithThePeriodOfASpring) {
  VirtualDoor::Options o = Door();
  o.closer = 12;
  o.rest_angle = -0.4;
  Held door(o);
  for (const double amplitude : {0.1, 1.5}) {
    Swinging swing{.theta = o.rest_angle + amplitude};
    const double quarter = 0.5 * kPi * std::sqrt(o.inertia / o.closer);
    // Runge–Kutta's h⁴, ω h = 0.0027; and the last step taken as straight: (ω h)³
    EXPECT_NEAR(swing.TimeTo(door, o.rest_angle, 1e-3), quarter, 1e-8 * quarter);
  }
}

TEST(VirtualDoor, SwingsByItsWeightWithThePeriodOfAPendulum) {
  VirtualDoor::Options o = Hanging();
  o.mass = 1.5;
  o.center = {0, 0, -0.4};
  Held door(o);
  const double moment = 1.5 * 9.80665 * 0.4;
  EXPECT_NEAR(door.At(0.5 * kPi, 0).passive, -moment, 1e-14);
  for (const double amplitude : {0.1, 1.0, 2.5}) {
    Swinging swing{.theta = amplitude};
    // Whittaker & Watson: a quarter of a pendulum's period is K(sin ½A) √(I/(m g l))
    const double quarter =
        std::comp_ellint_1(std::sin(0.5 * amplitude)) * std::sqrt(o.inertia / moment);
    EXPECT_NEAR(swing.TimeTo(door, 0, 1e-3), quarter, 1e-7 * quarter) << amplitude;
  }
}

TEST(VirtualDoor, HangsFromALeaningHingeByTheWeightAcrossItAlone) {
  VirtualDoor::Options o = Hanging();
  o.mass = 1.5;
  o.center = {0, 0.1, -0.4};
  for (const double lean : {0.0, 0.3, 0.5 * kPi}) {  // of the axis, from horizontal to upright
    o.axis = {0, std::cos(lean), std::sin(lean)};
    o.closed.position = {0.6, 0, 0};
    o.center = {0.4, 0, 0};
    EXPECT_NEAR(Held(o).At(0, 0).passive, 1.5 * 9.80665 * 0.4 * std::cos(lean), 1e-14);
  }
}

TEST(VirtualDoor, SlowsDownAsViscousFrictionSays) {
  VirtualDoor::Options o = Door();
  o.viscous = 2;
  Held door(o);
  Swinging swing{.theta = -1, .omega = 1.5};
  while (swing.time < 2) {
    swing.Step(door, 1e-3);
    const double decay = std::exp(-o.viscous / o.inertia * swing.time);
    ASSERT_NEAR(swing.omega, 1.5 * decay, 1e-12);  // Runge–Kutta's (b h/I)⁴
    ASSERT_NEAR(swing.theta, -1 + 1.5 * o.inertia / o.viscous * (1 - decay), 1e-12);
  }
}

// Sliding, ½ I (θ̇² − θ̇_b²) is spent over the way; then θ̇_b = c T/I falls as e^{−t/T}.
TEST(VirtualDoor, ComesToRestByCoulombFriction) {
  VirtualDoor::Options o = Door();
  o.coulomb = 0.6;
  o.stopping_time = 0.02;
  Held door(o);
  Swinging swing{.theta = -1, .omega = 0.9};
  const double c = o.coulomb, T = o.stopping_time, I = o.inertia;
  while (swing.time < 0.9 * I / c + 30 * T) swing.Step(door, 1e-3);
  const double way = I * 0.9 * 0.9 / (2 * c) + c * T * T / (2 * I);
  EXPECT_NEAR(swing.theta, -1 + way, 1e-6);  // the kink falls into a step: c/I h²
  EXPECT_NEAR(swing.omega, 0, 0.9 * std::exp(-30));
}

TEST(VirtualDoor, SticksUnderAllThatIsLessThanCoulombFriction) {
  VirtualDoor::Options o = Door();
  o.closer = 3;
  o.coulomb = 2;
  Held door(o);
  const Vector6 s = Screw(o, 0.5);
  for (double torque = -6; torque <= 6; torque += 0.25) {
    // a push that with the closer makes `torque` about the hinge
    const Vector6 F = s * (torque + 3 * 0.5) / s.squaredNorm();
    const DoorMotion now = door.At(0.5, 0, F);
    const double held = std::clamp(torque, -2.0, 2.0);
    EXPECT_NEAR(now.external + now.passive, torque, 1e-12);
    EXPECT_NEAR(now.friction, held, 1e-12);
    EXPECT_NEAR(now.acceleration, (torque - held) / o.inertia, 1e-12);
    // The task holds, too: what it feeds forward takes off what it lets through.
    const Vector6 wanted = door.block.Get(door.block->acceleration) +
                           Vector6(door.block.Get(door.block->mobility) * F);
    EXPECT_LT((wanted - s * (torque - held) / o.inertia).norm(), 1e-12);
  }
}

TEST(VirtualDoor, IsHeldWhereItStopsAndBreaksAwayAgain) {
  VirtualDoor::Options o = Door();
  o.closer = 4;
  o.coulomb = 2;
  Held door(o);
  Swinging swing{.theta = 1.2};
  while (swing.time < 4) swing.Step(door, 1e-3);
  EXPECT_LT(std::abs(swing.theta), o.coulomb / o.closer) << "where the closer is too weak";
  EXPECT_LT(std::abs(swing.omega), 1e-12);
  const double rest = swing.theta;
  while (swing.time < 8) swing.Step(door, 1e-3);
  EXPECT_NEAR(swing.theta, rest, 1e-12);
  EXPECT_GT(std::abs(door.At(1.2, 0).acceleration), 0);
}

TEST(VirtualDoor, FrictionOpposesMotionBeyondTheBandInWhichItStops) {
  VirtualDoor::Options o = Door();
  o.coulomb = 2;
  o.viscous = 0;
  Held door(o);
  const Vector6 s = Screw(o, 0.5);
  for (const double torque : {-5.0, -1.0, 0.0, 3.0}) {
    const double band = o.stopping_time * (o.coulomb + std::abs(torque)) / o.inertia;
    for (const double rate : {-1.0, -1.001 * band, 1.001 * band, 1.0})
      EXPECT_EQ(door.At(0.5, rate, s * torque / s.squaredNorm()).friction,
                std::copysign(o.coulomb, rate));
  }
}

// Without damping a stop gives back what it takes: it is pressed by θ̇ √(I/k).
TEST(VirtualDoor, TurnsBackAtItsStops) {
  VirtualDoor::Options o = Door();
  o.stops = {.lower = -0.5, .upper = 1.2, .stiffness = 400, .damping = 0};
  Held door(o);
  Swinging swing{.theta = 0, .omega = 0.7};
  double most = 0, least = 0;
  while (swing.time < 6) {
    swing.Step(door, 1e-3);
    most = std::max(most, swing.theta);
    least = std::min(least, swing.theta);
  }
  const double depth = 0.7 * std::sqrt(o.inertia / 400);
  // A step that begins before a stop misses some of its force: (ω h)² of the speed, ω = 15 /s.
  EXPECT_NEAR(most, 1.2 + depth, 1e-3 * depth);
  EXPECT_NEAR(least, -0.5 - depth, 1e-3 * depth);
  EXPECT_NEAR(std::abs(swing.omega), 0.7, 2e-3);

  o.stops->damping = 0.5;
  Held damped(o);
  EXPECT_NEAR(damped.At(1.25, 0.3).passive, -400 * 0.05 * (1 + 0.5 * 0.3), 1e-12);
  EXPECT_NEAR(damped.At(-0.55, 0.3).passive, 400 * 0.05 * (1 - 0.5 * 0.3), 1e-12);
}

TEST(VirtualDoor, IsFiniteOnTheAxisOfItsHinge) {
  Held door(Door());
  door.Place({door.o.hinge, Matrix3d::Identity()}, Twist{{1, 2, 3, 4, 5, 6}});
  EXPECT_EQ(door.block.Get(door.block->door).rate, 0);
  EXPECT_TRUE(door.block.Get(door.block->pose).position.allFinite());
  EXPECT_TRUE(door.block.Get(door.block->acceleration).allFinite());
}

TEST(VirtualDoor, TakesNothingFromTheHeap) {
  VirtualDoor::Options o = Door();
  o.closer = 3;
  o.coulomb = 1;
  Held door(o);
  door.At(0.1, 0.2);
  door.block.Get(door.block->mobility);
  const long before = Allocations();
  for (int k = 0; k < 100; ++k) {
    door.At(0.01 * k, 0.3);
    door.block.Get(door.block->mobility);
    door.block.Get(door.block->acceleration);
  }
  EXPECT_EQ(Allocations() - before, 0);
}

TEST(VirtualDoor, IsNamedInAScenario) {
  VirtualDoor::Options o = Door();
  ParameterFile::ReadText(R"(
hinge: [0.1, 0.2, 30 cm]
axis: [0, 0, 1]
inertia: 2.5
closer: 4
rest_angle: 10 deg
coulomb: 0.5
stops: {lower: -45 deg, upper: 90 deg, stiffness: 200}
)",
                          "door.yaml")
      .Fill(o);
  EXPECT_EQ(o.hinge, Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(o.inertia, 2.5);
  EXPECT_DOUBLE_EQ(o.rest_angle, kPi / 18);
  EXPECT_DOUBLE_EQ(o.stops->upper, kPi / 2);
  EXPECT_EQ(std::string(VirtualDoor::Options::kTag), "VirtualDoor");
}

TEST(VirtualDoor, RefusesWhatIsNoDoor) {
  const auto error = [](auto change) {
    VirtualDoor::Options o = Door();
    change(o);
    return ErrorOf([&] { VirtualDoor door(o); });
  };
  using O = VirtualDoor::Options;
  EXPECT_EQ(error([](O& o) { o.inertia = 0; }), "inertia must be > 0 kg·m², got 0");
  EXPECT_EQ(error([](O& o) { o.inertia = O{}.inertia; }), "inertia must be > 0 kg·m², got nan");
  EXPECT_EQ(error([](O& o) { o.closer = -1; }), "closer must be >= 0 N·m/rad, got -1");
  EXPECT_EQ(error([](O& o) { o.rest_angle = 4; }),
            "rest_angle must be from -3.141592654 to 3.141592654 rad, got 4");
  EXPECT_EQ(error([](O& o) { o.mass = -1; }), "mass must be >= 0 kg, got -1");
  EXPECT_EQ(error([](O& o) { o.viscous = -1; }), "viscous must be >= 0 N·m·s/rad, got -1");
  EXPECT_EQ(error([](O& o) { o.coulomb = -1; }), "coulomb must be >= 0 N·m, got -1");
  EXPECT_EQ(error([](O& o) { o.stopping_time = 0; }), "stopping_time must be > 0 s, got 0");
  EXPECT_EQ(error([](O& o) { o.inertia_limit = 0; }), "inertia_limit must be > 0 kg, got 0");
  EXPECT_EQ(error([](O& o) { o.hinge = O{}.hinge; }), "hinge[x] must be finite m, got nan");
  EXPECT_EQ(error([](O& o) { o.center(1) = NAN; }), "center[y] must be finite m, got nan");
  EXPECT_EQ(error([](O& o) { o.gravity(2) = NAN; }), "gravity[z] must be finite m/s², got nan");
  EXPECT_EQ(error([](O& o) { o.axis.setZero(); }), "axis must be finite and not zero, got 0 0 0");
  EXPECT_THAT(error([](O& o) { o.closed.rotation(0, 0) = 2; }),
              testing::StartsWith("closed must be a pose: finite, R Rᵀ = I, det R = 1, got\n"));
  EXPECT_EQ(
      error([](O& o) { o.closed.position = o.hinge; }),
      "the closed door's handle must be at least 0.001 m from the axis of the hinge, got 0 m");
  EXPECT_EQ(error([](O& o) { o.stops = {.lower = 1, .upper = 1, .stiffness = 10}; }),
            "stops.lower must be below stops.upper = 1 rad, got 1 rad");
  EXPECT_EQ(error([](O& o) { o.stops = {.lower = 0, .upper = 1, .stiffness = 0}; }),
            "stops.stiffness must be > 0 N·m/rad, got 0");
}

}  // namespace
}  // namespace pliant
