#include "pliant/plants/actuators.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/masses.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"large", "small"};

const Eigen::Vector2d kAmperes{2, -9}, kLimits{8, 6};  // [A], the second beyond its limit
const Eigen::Vector2d kPerAmpere{0.9 * 0.11 * 100, 0.9 * 0.076 * 100};  // η K_T G_r [N·m/A]
const Eigen::Vector2d kRotors{0.40, 0.22}, kLinks{1.2, 0.3};            // [kg·m²]
const Eigen::Vector2d kStiffness{25000, 6000};
const Eigen::Vector2d kCoulomb{3, 2}, kViscous{2.4, 1.5};  // of the joints
const Eigen::Vector2d kBearings{5, 8};                     // d of the links [N·m·s/rad]

ArmActuators Motors(Transmission transmission, FrictionLaw law) {
  ArmActuators arm{.transmission = transmission, .friction = law, .joint = {}};
  for (int j = 0; j < 2; ++j)
    arm.joint.push_back({.gear_ratio = 100,
                         .torque_constant = j == 0 ? 0.11 : 0.076,
                         .efficiency = 0.9,
                         .rotor_inertia = kRotors(j) / 1e4,
                         .current_limit = kLimits(j),
                         .torque_limit = 100,
                         .current_time_constant = 1e-3,
                         .stiffness = kStiffness(j),
                         .damping = 30,
                         .friction = {.coulomb = kCoulomb(j),
                                      .viscous = kViscous(j),
                                      .stiction = kCoulomb(j),
                                      .bristle_damping = 10}});
  return arm;
}

/// The viscous friction of the links' bearings, d v.
class Bearings final : public Block {
 public:
  Bearings() : velocity{this, "velocity", kTwo}, torque{this, "torque", kTwo} {
    Compute(torque).From(velocity).As(
        [](const JointVelocity& v) { return JointTorque(kBearings.cwiseProduct(v)); });
  }
  Input<JointVelocity> velocity;
  Output<JointTorque> torque;
};

/// A constant current that turns links in viscous bearings.
///
///   amperes ─▶ actuators ─▶ links ◀─▶ bearings
///                  ▲          │
///                  └──────────┘
struct Turning {
  Actuators& actuators;
  Masses& links;
  Diagram diagram;

  static Turning With(const ArmActuators& parameters) {
    DiagramBuilder b;
    auto& amperes = b.Add<Constant<MotorCurrent>>("amperes", {.space = kTwo, .value = kAmperes});
    auto& actuators = b.Add<Actuators>(
        "actuators",
        {.joints = kTwo, .parameters = parameters, .position = JointPosition::Zero(kTwo)});
    const bool rigid = parameters.transmission == Transmission::Rigid;
    const PerJoint inertia = rigid ? kLinks + kRotors : kLinks;
    auto& links = b.Add<Masses>("links", {.joints = kTwo, .inertia = inertia});
    auto& bearings = b.Add<Bearings>("bearings");
    b.Connect(amperes.y, actuators.command);
    b.Connect(links.position, actuators.position);
    b.Connect(links.velocity, actuators.velocity);
    b.Connect(links.acceleration, actuators.acceleration);
    b.Connect(actuators.torque, links.torque);
    b.Connect(links.velocity, bearings.velocity);
    b.Connect(bearings.torque, links.friction);
    return {actuators, links, b.Build()};
  }
};

const Simulator::Options kAccurate{.integrator = {.method = Method::kDormandPrince,
                                                  .relative_tolerance = 1e-10,
                                                  .absolute_tolerance = 1e-12}};

TEST(Actuators, TurnViscousLinksAtTheSpeedTheirCurrentHolds) {
  const PerJoint i = Eigen::Vector2d(2, -6), tau_m = kPerAmpere.cwiseProduct(i);
  for (const Transmission transmission : {Transmission::Rigid, Transmission::Elastic})
    for (const FrictionLaw law : {FrictionLaw::None, FrictionLaw::ElastoPlastic}) {
      SCOPED_TRACE(Text(static_cast<int>(transmission)) + ' ' + Text(static_cast<int>(law)));
      const Turning run = Turning::With(Motors(transmission, law));
      const bool rubs = law != FrictionLaw::None, springs = transmission == Transmission::Elastic;
      // τ_m = d v + c sgn v + d_f v, all of it steady
      const PerJoint dry = (rubs ? 1.0 : 0.0) * kCoulomb.cwiseProduct(i.cwiseSign());
      const PerJoint viscous = (rubs ? 1.0 : 0.0) * kViscous;
      const PerJoint v = (tau_m - dry).cwiseQuotient(kBearings + viscous);
      const PerJoint tau_f = dry + viscous.cwiseProduct(v);
      const PerJoint tau_J = kBearings.cwiseProduct(v);

      Simulator sim(run.diagram, kAccurate);
      // Slowest is joint 1 without friction: exp(−10 s · 5/1.6 s⁻¹) = 3e-14 is left, and tolerance.
      sim.AdvanceTo(10);
      const auto expect = [&](const auto& port, const PerJoint& value) {
        EXPECT_LT((sim.Get(port) - value).cwiseAbs().maxCoeff(), 1e-7)
            << sim.Get(port).transpose() << " for " << value.transpose();
      };
      expect(run.actuators.current, i);
      expect(run.actuators.motor_torque, tau_m);
      expect(run.actuators.motor_velocity, v);
      expect(run.links.velocity, v);
      expect(run.actuators.friction, tau_f);
      expect(run.actuators.torque, tau_J);
      expect(run.actuators.joint_torque, tau_J);  // rotors that do not accelerate take nothing
      EXPECT_EQ(sim.Get(run.actuators.saturated), 2u);
      EXPECT_NEAR(sim.Get(run.actuators.power), tau_m.dot(v), 1e-6);
      // All that motors put in and bearings do not take; bristles that do not bend on store
      // nothing.
      EXPECT_NEAR(sim.Get(run.actuators.dissipation), tau_f.dot(v), 1e-6);
      const double bristles = rubs ? kCoulomb.squaredNorm() / (2 * 1e4) : 0;  // ½ c²/σ₀
      const double gears = springs ? 0.5 * (kRotors.dot(v.cwiseAbs2()) +
                                            tau_J.cwiseAbs2().cwiseQuotient(kStiffness).sum())
                                   : 0;
      EXPECT_NEAR(sim.Get(run.actuators.energy), bristles + gears, 1e-6);
    }
}

TEST(Actuators, OfARigidGearMeasureBehindTheRotor) {
  const Turning run = Turning::With(Motors(Transmission::Rigid, FrictionLaw::None));
  Simulator sim(run.diagram, kAccurate);
  sim.AdvanceTo(0.1);
  const PerJoint a = sim.Get(run.links.acceleration);
  EXPECT_GT(a.cwiseAbs().minCoeff(), 1);
  const PerJoint on_links =
      kLinks.cwiseProduct(a) + kBearings.cwiseProduct(sim.Get(run.links.velocity));
  EXPECT_LT((sim.Get(run.actuators.joint_torque) - on_links).norm(), 1e-12);  // round-off
}

TEST(Actuators, BeginWithTheLoadTheyCarry) {
  const JointTorque load{15, -6};
  for (const Transmission transmission : {Transmission::Rigid, Transmission::Elastic}) {
    DiagramBuilder b;
    auto& actuators =
        b.Add<Actuators>("actuators", {.joints = kTwo,
                                       .parameters = Motors(transmission, FrictionLaw::None),
                                       .position = {0.3, -0.4},
                                       .load = load});
    auto& links = b.Add<Masses>("links", {.joints = kTwo, .inertia = kLinks, .start = {0.3, -0.4}});
    auto& amperes = b.Add<Constant<MotorCurrent>>(
        "amperes", {.space = kTwo, .value = MotorCurrent(load.cwiseQuotient(kPerAmpere))});
    b.Connect(amperes.y, actuators.command);
    b.Connect(links.position, actuators.position);
    b.Connect(links.velocity, actuators.velocity);
    b.Connect(links.acceleration, actuators.acceleration);
    const Diagram diagram = b.Build();
    Simulator sim(diagram, kAccurate);
    for (const double t : {0.0, 0.1}) {  // the links do not move: nothing pushes them
      sim.AdvanceTo(t);
      // Round-off of the angle, 1e-16, times the stiffness.
      EXPECT_LT((sim.Get(actuators.torque) - load).norm(), 1e-10) << t;
      EXPECT_LT((sim.Get(actuators.motor_torque) - load).norm(), 1e-13) << t;
      EXPECT_LT(sim.Get(actuators.motor_velocity).norm(), 1e-12) << t;
    }
  }
}

TEST(Actuators, NameThePartThatRefuses) {
  const auto error = [](auto change) {
    ArmActuators arm = Motors(Transmission::Elastic, FrictionLaw::ElastoPlastic);
    change(arm.joint[1]);
    return ErrorOf([&] {
      DiagramBuilder b;
      b.Add<Actuators>("actuators",
                       {.joints = kTwo, .parameters = arm, .position = JointPosition::Zero(kTwo)});
    });
  };
  using P = ActuatorParameters;
  EXPECT_EQ(error([](P& p) { p.current_limit = 0; }),
            "actuators.drive: small: current_limit must be > 0 A, got 0");
  EXPECT_EQ(error([](P& p) { p.friction.coulomb = -1; }),
            "actuators.drive: small: coulomb must be >= 0 N·m, got -1");
  EXPECT_EQ(
      error([](P& p) { p.rotor_inertia = 0; }),
      "actuators.transmission: rotor_inertia behind a spring[small] must be > 0 kg·m², got 0");
  EXPECT_EQ(error([](P& p) { p.stiffness = kUnbounded; }),
            "actuators.transmission: stiffness of a spring[small] must be > 0 N·m/rad, got inf");
}

}  // namespace
}  // namespace pliant
