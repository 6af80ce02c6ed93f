#include "pliant/plants/robot_dynamics.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "pliant/systems/error.h"
#include "pliant/systems/value_type.h"
#include "pliant/tests/plants/arms.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t);
thread_local long allocations = 0;  // those of Eigen and, through malloc, those of operator new
void* malloc(std::size_t n) {
  ++allocations;
  return __libc_malloc(n);
}
}
#endif

namespace pliant {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr int kStates = 200;

RobotDynamics DynamicsAt(const RobotModel& model, const JointPosition& q, const JointVelocity& v,
                         std::vector<std::string> frames = {}) {
  RobotDynamics d(model, frames);
  ComputeDynamics(model, q, v, d);
  return d;
}

/// f'(0) from f(±h), f(±2h): error h⁴ f⁽⁵⁾/30 and rounding 3 ε |f|/h.
template <class F>
auto Slope(F&& f, double h) {
  return ((8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h)).eval();
}

// ---- published figures ------------------------------------------------------------------------

/// Computed by a Newton–Euler regressor and by the library DART, which agree to 2e-8; six decimals.
struct Published {
  const char* name;
  std::string file, tool;
  JointPosition q;
  Vector3d position;
  PerJoint gravity, diagonal;
};
constexpr double kPrinted = 0.5e-6 + 2e-8;

PerJoint Seven(std::initializer_list<double> numbers) { return JointTorque(numbers); }

std::vector<Published> PublishedFigures() {
  const JointPosition zero = PerJoint::Zero(7);
  const JointPosition out{0, kPi / 2, 0, 0, 0, 0, 0};
  const JointPosition home{0, 0.262, 3.14, -2.269, 0, 0.96, 1.57};
  const JointPosition circle{0, 2 * kPi / 9, 0, -kPi / 2, 0, 5 * kPi / 18, 0};
  return {
      {"Gen3Upright",
       kGen3File,
       "tool_frame",
       zero,
       {0, -0.02485, 1.187385},
       Seven({0, 0.001487, 0, 0.000483, 0, 0.000325, 0}),
       Seven({0.007988, 1.410780, 0.003616, 0.226673, 0.001175, 0.009309, 0.000240})},
      {"Gen3Horizontal",
       kGen3File,
       "tool_frame",
       out,
       {0.902575, -0.02485, 0.28481},
       Seven({0, -22.292756, 0.338680, -6.474327, 0.004335, -0.762349, 0.000471}),
       Seven({1.414422, 1.410780, 0.003616, 0.226673, 0.001175, 0.009309, 0.000240})},
      {"Gen3Home",
       kGen3File,
       "tool_frame",
       home,
       {0.456656, 0.001991, 0.433625},
       Seven({0, -8.133850, -0.089623, 4.037201, -0.001767, 0.762349, 0.000331}),
       Seven({0.229753, 0.536146, 0.146013, 0.205844, 0.006981, 0.009300, 0.000240})},
      {"Gen3WithSensorHome",
       kGen3BotaFile,
       "tool_frame",
       home,
       {0.456656, 0.001991, 0.433625},
       Seven({0, -9.869051, -0.102567, 5.388964, -0.003045, 1.479842, -0.001087}),
       Seven({0.317222, 0.631599, 0.215020, 0.282726, 0.017242, 0.024426, 0.000459})},
      {"LwrUpright",
       kLwrFile,
       "end_effector_link",
       zero,
       {0, 0, 1.178},
       Seven({0, -0.012892, 0, 0.035514, 0, 0.005415, 0}),
       Seven({0.028442, 2.794094, 0.016786, 0.445672, 0.006251, 0.003722, 0.000143})},
      {"LwrHorizontal",
       kLwrFile,
       "end_effector_link",
       out,
       {-0.868, 0, 0.31},
       Seven({0, -47.262448, -0.403581, 13.362793, -0.408224, -0.280333, -0.009209}),
       Seven({2.807937, 2.794094, 0.016786, 0.445672, 0.006251, 0.003722, 0.000143})},
      {"LwrCircle",
       kLwrFile,
       "end_effector_link",
       circle,
       {-0.555872, 0, 0.287731},
       Seven({0, -31.773801, -0.259417, 10.000852, -0.312717, -0.005415, 0}),
       Seven({1.312697, 1.675785, 0.447593, 0.438038, 0.007117, 0.003722, 0.000143})},
  };
}

TEST(RobotDynamics, HasThePublishedFiguresOfTheArms) {
  for (const Published& x : PublishedFigures()) {
    SCOPED_TRACE(x.name);
    const RobotModel model = RobotModel::FromUrdf(x.file);
    const RobotDynamics d = DynamicsAt(model, x.q, PerJoint::Zero(7), {x.tool});
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(d.frame[0].pose.position[i], x.position[i], kPrinted);
    for (int i = 0; i < 7; ++i) {
      EXPECT_NEAR(d.gravity(i), x.gravity(i), kPrinted) << "joint " << i + 1;
      EXPECT_NEAR(d.M(i, i), x.diagonal(i), kPrinted) << "joint " << i + 1;
    }
  }
}

TEST(RobotDynamics, LwrToolPointsDownAtTheStartOfTheCircle) {
  const JointPosition q{0, 2 * kPi / 9, 0, -kPi / 2, 0, 5 * kPi / 18, 0};
  const RobotDynamics d = DynamicsAt(Lwr(), q, PerJoint::Zero(7), {"end_effector_link"});
  const Eigen::Matrix3d R = Vector3d(-1, 1, -1).asDiagonal();  // roll-pitch-yaw π, 0, π
  EXPECT_LT((d.frame[0].pose.rotation - R).norm(), 1e-14);
}

// ---- laws -------------------------------------------------------------------------------------

class RobotDynamicsLaws : public ::testing::TestWithParam<RobotModel (*)()> {
 protected:
  RobotModel model = GetParam()();
  RandomStates random{model};
  std::string last = model.links().back().name;
};

TEST_P(RobotDynamicsLaws, InertiaIsSymmetricAndPositiveDefinite) {
  for (int k = 0; k < kStates; ++k) {
    const RobotDynamics d = DynamicsAt(model, random.q(), random.v());
    EXPECT_EQ(d.M, d.M.transpose());
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(d.M).info(), Eigen::Success);
  }
}

TEST_P(RobotDynamicsLaws, MomentumIsInertiaTimesVelocity) {
  for (int k = 0; k < kStates; ++k) {
    const RobotDynamics d = DynamicsAt(model, random.q(), random.v());
    EXPECT_LT((d.p - d.M * d.v).norm(), 1e-14 * d.M.norm() * d.v.norm());
  }
}

TEST_P(RobotDynamicsLaws, InertiaRateIsCoriolisPlusItsTranspose) {
  // Each element of M(q + t v) is made of sinusoids of frequencies up to ω = 2 |v|₁ (and of
  // quadratics, where joints slide), so |f⁽⁵⁾| ≤ ω⁵ max |f| (Bernstein).
  constexpr double h = 1e-4;
  for (int k = 0; k < kStates; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const RobotDynamics d = DynamicsAt(model, q, v);
    const auto momentum = [&](double t) {
      return Eigen::VectorXd(DynamicsAt(model, q + t * v, v).p);
    };
    const double omega = 2 * v.lpNorm<1>();
    const double relative = std::pow(h, 4) * std::pow(omega, 5) / 30 + 30 * kEpsilon / h;
    const double largest = 3 * d.M.norm() * v.norm();
    EXPECT_LT((Slope(momentum, h) - d.coriolis - d.coriolis_transposed).norm(), relative * largest);
  }
}

TEST_P(RobotDynamicsLaws, TransposedCoriolisIsTheSlopeOfKineticEnergy) {
  constexpr double h = 1e-3;
  for (int k = 0; k < kStates / 4; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const RobotDynamics d = DynamicsAt(model, q, v);
    for (int i = 0; i < model.size(); ++i) {
      const auto energy = [&](double t) {
        const JointPosition moved = q + t * PerJoint::Unit(model.size(), i);
        return Eigen::Matrix<double, 1, 1>(KineticEnergy(DynamicsAt(model, moved, v)));
      };
      // Frequencies up to 2: h⁴ 2⁵/30 = 1e-12, rounding 30 ε/h = 7e-12, relative to the largest
      // energy.
      EXPECT_NEAR(d.coriolis_transposed(i), Slope(energy, h)(0),
                  1e-11 * d.M.norm() * v.squaredNorm());
    }
  }
}

TEST_P(RobotDynamicsLaws, GravityTorqueIsTheSlopeOfPotentialEnergy) {
  constexpr double h = 1e-3;
  const double largest = 2 * 9.80665 * model.mass();  // [J], two metres up
  for (int k = 0; k < kStates / 4; ++k) {
    const JointPosition q = random.q();
    const RobotDynamics d = DynamicsAt(model, q, PerJoint::Zero(model.size()));
    for (int i = 0; i < model.size(); ++i) {
      const auto energy = [&](double t) {
        const JointPosition moved = q + t * PerJoint::Unit(model.size(), i);
        const RobotDynamics there = DynamicsAt(model, moved, d.v);
        return Eigen::Matrix<double, 1, 1>(PotentialEnergy(model, there));
      };
      EXPECT_NEAR(d.gravity(i), Slope(energy, h)(0), 1e-11 * largest);
    }
  }
}

TEST_P(RobotDynamicsLaws, CoriolisForcesExchangeNoPowerBeyondTheRateOfInertia) {
  // ½ vᵀ Ṁ v = vᵀ C v = vᵀ Cᵀ v
  for (int k = 0; k < kStates; ++k) {
    const RobotDynamics d = DynamicsAt(model, random.q(), random.v());
    EXPECT_NEAR(d.v.dot(d.coriolis), d.v.dot(d.coriolis_transposed),
                1e-14 * d.M.norm() * std::pow(d.v.norm(), 3));
  }
}

TEST_P(RobotDynamicsLaws, ForwardDynamicsInvertsInverseDynamics) {
  const PerJoint B = PerJoint::Constant(model.size(), 0.3);
  for (int k = 0; k < kStates; ++k) {
    const RobotDynamics d = DynamicsAt(model, random.q(), random.v());
    const JointTorque tau = random.tau(), tau_e = random.tau();
    const JointAcceleration a = ForwardDynamics(d, tau, tau_e);
    EXPECT_LT((InverseDynamics(d, a) - tau - tau_e).norm(), 1e-13 * d.M.norm() * a.norm());
    const JointAcceleration b = ForwardDynamics(d, tau, tau_e, B);
    EXPECT_LT((InverseDynamics(d, b) + B.cwiseProduct(b) - tau - tau_e).norm(),
              1e-13 * (d.M.norm() + 1) * (b.norm() + 1));
  }
}

TEST_P(RobotDynamicsLaws, TwistIsJacobianTimesVelocity) {
  for (int k = 0; k < kStates; ++k) {
    const RobotDynamics d = DynamicsAt(model, random.q(), random.v(), {last});
    EXPECT_LT((d.frame[0].J * d.v - d.frame[0].twist).norm(), 1e-14 * (d.v.norm() + 1));
  }
}

TEST_P(RobotDynamicsLaws, PointOfALinkMovesAsItsDerivativesSay) {
  // Positions are made of frequencies up to ω = |v|₁ along q + t v.
  constexpr double h = 1e-4;
  const Vector3d point(0.1, -0.2, 0.3);
  for (int link = 0; link < static_cast<int>(model.links().size()); ++link) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const FrameDynamics frame = PointDynamics(model, DynamicsAt(model, q, v), link, point);
    const auto place = [&](double t) {
      return PointDynamics(model, DynamicsAt(model, q + t * v, v), link, point).pose.position;
    };
    const auto twist = [&](double t) {
      return Vector6(PointDynamics(model, DynamicsAt(model, q + t * v, v), link, point).twist);
    };
    const double omega = v.lpNorm<1>();
    const double relative = std::pow(h, 4) * std::pow(omega, 5) / 30 + 30 * kEpsilon / h;
    EXPECT_LT((Slope(place, h) - frame.twist.tail<3>()).norm(), 3 * relative);  // within 3 m
    EXPECT_LT((Slope(twist, h) - frame.Jdot_v).norm(), 3 * omega * relative);
    EXPECT_LT((frame.pose.position - (LinkPose(model, DynamicsAt(model, q, v), link) *
                                      Pose{point, Eigen::Matrix3d::Identity()})
                                         .position)
                  .norm(),
              1e-14);
  }
}

TEST_P(RobotDynamicsLaws, ExternalTorqueIsJacobianTransposedTimesWrench) {
  for (int k = 0; k < kStates; ++k) {
    const RobotDynamics d = DynamicsAt(model, random.q(), random.v());
    std::vector<ContactForce> forces(3);
    PerJoint expected = PerJoint::Zero(model.size());
    for (ContactForce& F : forces) {
      F.link = static_cast<int>(random.random() % model.links().size());
      F.point = random.Uniform(0.3).head<3>();
      F.force = random.Uniform(20).head<3>();
      F.moment = random.Uniform(5).head<3>();
      Vector6 wrench;
      wrench << F.moment, F.force;
      expected += PointDynamics(model, d, F.link, F.point).J.transpose() * wrench;
    }
    forces.push_back({.link = -1, .force = {1, 1, 1}});
    EXPECT_LT((ExternalTorque(model, d, forces) - expected).norm(), 1e-13 * 60);  // [N·m]
  }
}

TEST_P(RobotDynamicsLaws, HoldsTheStateItBelongsTo) {
  const JointPosition q = random.q();
  const JointVelocity v = random.v();
  const RobotDynamics d = DynamicsAt(model, q, v);
  EXPECT_EQ(d.q, q);
  EXPECT_EQ(d.v, v);
}

TEST_P(RobotDynamicsLaws, DependsOnNothingItHeldBefore) {
  const JointPosition q = random.q();
  const JointVelocity v = random.v();
  RobotDynamics used = DynamicsAt(model, random.q(), random.v(), {last});
  ComputeDynamics(model, q, v, used);
  std::string a, b;
  internal::Write(used, a);
  internal::Write(DynamicsAt(model, q, v, {last}), b);
  EXPECT_EQ(a, b);
}

TEST_P(RobotDynamicsLaws, IsRestoredFromItsBytes) {
  const RobotDynamics d = DynamicsAt(model, random.q(), random.v(), {last});
  std::string bytes, again;
  internal::Write(d, bytes);
  RobotDynamics other(model, {last});
  ASSERT_EQ(internal::Read(other, bytes.data(), bytes.data() + bytes.size()),
            bytes.data() + bytes.size());
  internal::Write(other, again);
  EXPECT_EQ(bytes, again);
}

TEST_P(RobotDynamicsLaws, IsFiniteFarFromZero) {
  const JointPosition q = 1e3 * random.q();
  const JointVelocity v = 1e3 * random.v();
  const RobotDynamics d = DynamicsAt(model, q, v, {last});
  EXPECT_TRUE(d.M.allFinite() && d.coriolis.allFinite() && d.frame[0].Jdot_v.allFinite());
}

#ifdef COUNTS_ALLOCATIONS
TEST_P(RobotDynamicsLaws, IsComputedWithoutTheHeap) {
  const JointPosition q = random.q();
  const JointVelocity v = random.v();
  const JointTorque tau = random.tau();
  const PerJoint B = PerJoint::Constant(model.size(), 0.3);
  const std::vector<ContactForce> forces{{.link = 2, .force = {1, 2, 3}}};
  RobotDynamics d(model, {last, model.links()[2].name});
  const long before = allocations;
  ComputeDynamics(model, q, v, d);
  const JointTorque tau_e = ExternalTorque(model, d, forces);
  const JointAcceleration a = ForwardDynamics(d, tau, tau_e, B);
  const JointTorque back = InverseDynamics(d, a);
  const FrameDynamics point = PointDynamics(model, d, 2, {0, 0, 1});
  const RobotDynamics copy = d;
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(back.allFinite() && point.J.allFinite() && copy.M.allFinite());
}
#endif

INSTANTIATE_TEST_SUITE_P(Arms, RobotDynamicsLaws, ::testing::Values(&Gen3, &Lwr, &Tree),
                         [](const auto& test) { return test.param().name(); });

TEST(RobotDynamics, RefusesFramesItDoesNotKnow) {
  EXPECT_THROW(RobotDynamics(Gen3(), {"tool"}), Error);
  const std::vector<std::string> many(kMaxFrames + 1, "tool_frame");
  try {
    RobotDynamics(Gen3(), many);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "dynamics of at most 8 frames are computed, got 9");
  }
}

TEST(RobotDynamics, FrameFixedToTheWorldStandsStill) {
  const RobotModel tree = Tree();
  RandomStates random(tree);
  const RobotDynamics d = DynamicsAt(tree, random.q(), random.v(), {"camera"});
  EXPECT_EQ(d.frame[0].pose.position, Vector3d(1, 0, 1));
  EXPECT_EQ(d.frame[0].J, Jacobian(Jacobian::Zero(6, tree.size())));
  EXPECT_EQ(d.frame[0].twist.norm(), 0);
}

}  // namespace
}  // namespace pliant
