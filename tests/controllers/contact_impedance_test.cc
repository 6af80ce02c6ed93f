#include "pliant/controllers/contact_impedance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/controllers/contact_rig.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TaskMatrix Diagonal(double x, double y, double z) {
  TaskMatrix column(3, 1);
  column << x, y, z;
  return column;
}
TaskMatrix Number(double x) { return TaskMatrix::Constant(1, 1, x); }

TEST(ContactImpedance, WantsWhatTheFormulaSays) {
  const RobotModel m = Lwr();
  RandomStates random(m, 91);
  Matrix3d M_d;
  M_d << 5, 1, 0, 1, 4, -1, 0, -1, 8;
  for (const bool natural : {false, true}) {
    BlockTester<ContactImpedance> t(
        ContactImpedance::Options{.model = m,
                                  .gains = {.inertia = natural ? TaskMatrix() : TaskMatrix(M_d),
                                            .damping = Diagonal(80, 70, 60),
                                            .stiffness = Number(500)}});
    for (int k = 0; k < 100; ++k) {
      RobotDynamics d(m);
      ComputeDynamics(m, random.q(), random.v(), d);
      const AnchoredContact c{.link = m.joint(5).child,
                              .point = random.Uniform(0.2).head<3>(),
                              .anchor = random.Uniform(0.5).head<3>(),
                              .force = random.Uniform(30).head<3>(),
                              .touched = true};
      const Vector3d path = random.Uniform(0.1).head<3>(), rate = random.Uniform(0.3).head<3>(),
                     second = random.Uniform(1).head<3>();
      t.Set(t->contact, c);
      t.Set(t->dynamics, d);
      t.Set(t->displacement, path);
      t.Set(t->displacement_velocity, rate);
      t.Set(t->displacement_acceleration, second);

      const FrameDynamics x = PointDynamics(m, d, c.link, c.point);
      const Eigen::MatrixXd J = x.J.bottomRows<3>();
      const Matrix3d inverse =
          natural ? Matrix3d(J * Eigen::MatrixXd(d.M).inverse() * J.transpose()) : M_d.inverse();
      const Vector3d e = c.anchor + path - x.pose.position;
      const Vector3d wanted =
          second +
          inverse * (Vector3d(80, 70, 60).cwiseProduct(rate - J * d.v) + 500 * e + c.force);
      EXPECT_LT(RelativeError(t.Get(t->error), e), 1e-13);
      EXPECT_LT(RelativeError(t.Get(t->objective).A, J), 1e-13);
      EXPECT_LT(RelativeError(t.Get(t->objective).b, wanted - x.Jdot_v.tail<3>()), 1e-10)
          << "round-off of M⁻¹";
      EXPECT_EQ(t.Get(t->objective).weight, 1);
    }
  }
}

TEST(ContactImpedance, WantsNothingWithoutAPoint) {
  const RobotModel m = Lwr();
  BlockTester<ContactImpedance> t(ContactImpedance::Options{
      .model = m, .gains = {.damping = Number(80), .stiffness = Number(500)}});
  RobotDynamics d(m);
  ComputeDynamics(m, JointPosition::Zero(m.joints()), JointVelocity::Zero(m.joints()), d);
  t.Set(t->dynamics, d);
  t.Set(t->contact, AnchoredContact{});
  EXPECT_EQ(t.Get(t->objective).weight, 0);
  EXPECT_EQ(t.Get(t->error).norm(), 0);
}

/// A mass of 7 kg, 1 N pushing it, by Runge–Kutta steps of 1 ms: 4th order, far below the bounds.
struct PushedMass {
  PushedMass(const ContactImpedance::Gains& gains, const Vector3d& push)
      : rig{Mass(7), gains}, F{push} {}

  PerJoint Accelerate(const PerJoint& x, const PerJoint& v) {
    const JointTorque tau = rig.Torque(x, v, TouchedAt(rig.model.link_index("mass"), {0, 0, 0}, F));
    return (tau + F) / 7;
  }
  void Step(double h) {
    const PerJoint k1 = v, l1 = Accelerate(x, v);
    const PerJoint k2 = v + h / 2 * l1, l2 = Accelerate(x + h / 2 * k1, k2);
    const PerJoint k3 = v + h / 2 * l2, l3 = Accelerate(x + h / 2 * k2, k3);
    const PerJoint k4 = v + h * l3, l4 = Accelerate(x + h * k3, k4);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    v += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  }

  ContactRig rig;
  Vector3d F;
  PerJoint x = PerJoint::Zero(3), v = PerJoint::Zero(3);
};

TEST(ContactImpedance, MakesAMassSwingAsTheOneThatIsWantedWould) {
  // CF's second experiment: M_d = diag(20, 3, 10), K_p = 500, K_d = 80.
  const Vector3d m_d(20, 3, 10);
  PushedMass mass({.inertia = Diagonal(20, 3, 10), .damping = Number(80), .stiffness = Number(500)},
                  Vector3d(20, -10, 5));
  const double h = 1e-3;
  for (int k = 1; k <= 3000; ++k) {
    mass.Step(h);
    if (k % 100 != 0) continue;
    for (int i = 0; i < 3; ++i) {
      // The step response of (CF 11) with ω_n and ζ of (CF 13), to where (CF 15) ends.
      const double w = std::sqrt(500 / m_d(i)), zeta = 80 / (2 * std::sqrt(500 * m_d(i)));
      const double t = k * h, s = -zeta * w;
      double rest;
      if (zeta < 1) {
        const double wd = w * std::sqrt(1 - zeta * zeta);
        rest = std::exp(s * t) * (std::cos(wd * t) - s / wd * std::sin(wd * t));
      } else {
        const double r = w * std::sqrt(zeta * zeta - 1);
        rest = std::exp(s * t) * (std::cosh(r * t) - s / r * std::sinh(r * t));
      }
      EXPECT_NEAR(mass.x(i), mass.F(i) / 500 * (1 - rest), 1e-9) << t;
    }
  }
}

TEST(ContactImpedance, OfTheNaturalInertiaIsASpringAndADamperForAMass) {
  // (CF 14): f = k_p (x_d − x) − k_d ẋ, whatever the force.
  ContactRig rig(Mass(7), ContactImpedance::Gains{.damping = Number(80), .stiffness = Number(500)});
  const int link = rig.model.link_index("mass");
  const Contacts touched = TouchedAt(link, {0, 0, 0}, {30, -40, 50});
  rig.Torque(JointPosition::Zero(rig.model.joints()), JointVelocity::Zero(rig.model.joints()),
             touched);
  const JointPosition x{0.1, -0.2, 0.3};
  const JointVelocity v{-0.4, 0.5, 0.6};
  EXPECT_LT((rig.Torque(x, v, touched) + 500 * x + 80 * v).norm(), 1e-11);
}

TEST(ContactImpedance, RefusesGainsThatAreNone) {
  const auto error = [](const ContactImpedance::Gains& gains) {
    return ErrorOf([&] { ContactImpedance impedance({.model = Lwr(), .gains = gains}); });
  };
  EXPECT_EQ(error({.inertia = Diagonal(1, 0, 1)}),
            "the smallest eigenvalue of inertia must be > 0 kg, got 0");
  EXPECT_THAT(error({.damping = Number(-1)}),
              testing::HasSubstr("damping must be positive semi-definite"));
  EXPECT_THAT(error({.stiffness = TaskMatrix::Identity(2, 2)}),
              testing::HasSubstr("stiffness must be 3 x 3"));
}

TEST(ContactImpedance, HoldsTheLaws) {
  BlockTester<ContactImpedance> t(ContactImpedance::Options{
      .model = Lwr(), .gains = {.damping = Number(80), .stiffness = Number(500)}});
  t.Set(t->dynamics, RobotDynamics(Lwr()));
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
