// The recursive kernel and Simbody against Orocos KDL, which reads the same URDF by itself.

#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>
#include <Eigen/Geometry>

#include <Eigen/Cholesky>
#include <fstream>
#include <functional>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/tree.hpp>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl/treeidsolver_recursive_newton_euler.hpp>
#include <kdl/treejnttojacsolver.hpp>
#include <sstream>

#include "pliant/plants/inertial_regressor.h"
#include "pliant/plants/simbody_arm.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

constexpr int kStates = 1000;
constexpr double kTolerance = 1e-12;  // some 10³ operations, each rounded to 1e-16

KDL::Vector From(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }
KDL::Frame From(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {KDL::Rotation::Quaternion(r.x, r.y, r.z, r.w), From(pose.position)};
}
Eigen::Vector3d From(const KDL::Vector& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Matrix3d From(const KDL::Rotation& R) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data);
}
/// KDL has the linear part first.
Vector6 From(const KDL::Twist& V) { return (Vector6() << From(V.rot), From(V.vel)).finished(); }

/// Inertia of a link in the axes of its frame, about its centre of mass.
KDL::RigidBodyInertia InertiaOf(const urdf::Link& link) {
  if (!link.inertial) return KDL::RigidBodyInertia(0);
  const urdf::Inertial& i = *link.inertial;
  const KDL::Frame X = From(i.origin);
  Eigen::Matrix3d I;
  I << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
  const Eigen::Matrix3d R = From(X.M);
  I = (R * I * R.transpose()).eval();
  return KDL::RigidBodyInertia(
      i.mass, X.p, KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
}

/// What the model says, by KDL's tree solvers.
class Kdl {
 public:
  Kdl(const RobotModel& model, const std::string& urdf_text) : n_{model.size()} {
    const auto urdf = urdf::parseURDF(urdf_text);
    tree_ = KDL::Tree(urdf->getRoot()->name);
    const std::function<void(const urdf::Link&)> add = [&](const urdf::Link& link) {
      for (const auto& child : link.child_links) {
        const urdf::Joint& j = *child->parent_joint;
        const KDL::Frame X = From(j.parent_to_joint_origin_transform);
        const auto type = j.type == urdf::Joint::FIXED       ? KDL::Joint::None
                          : j.type == urdf::Joint::PRISMATIC ? KDL::Joint::TransAxis
                                                             : KDL::Joint::RotAxis;
        const KDL::Joint joint = type == KDL::Joint::None
                                     ? KDL::Joint(j.name, KDL::Joint::None)
                                     : KDL::Joint(j.name, X.p, X.M * From(j.axis), type);
        tree_.addSegment(KDL::Segment(child->name, joint, X, InertiaOf(*child)), link.name);
        add(*child);
      }
    };
    add(*urdf->getRoot());
    for (int i = 0; i < n_; ++i) {
      const std::string& child = model.link(model.joint(i).child).name;
      place_.push_back(static_cast<int>(tree_.getSegment(child)->second.q_nr));
    }
  }

  KDL::JntArray ToKdl(const Eigen::VectorXd& x) const {
    KDL::JntArray y(static_cast<unsigned>(n_));
    for (int i = 0; i < n_; ++i) y.data[place_[static_cast<std::size_t>(i)]] = x[i];
    return y;
  }
  Eigen::VectorXd FromKdl(const Eigen::VectorXd& y) const {
    Eigen::VectorXd x(n_);
    for (int i = 0; i < n_; ++i) x[i] = y[place_[static_cast<std::size_t>(i)]];
    return x;
  }

  Eigen::VectorXd InverseDynamics(const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                  const Eigen::VectorXd& a, double gravity) const {
    KDL::TreeIdSolver_RNE solver(tree_, KDL::Vector(0, 0, -gravity));
    KDL::JntArray tau(static_cast<unsigned>(n_));
    EXPECT_EQ(solver.CartToJnt(ToKdl(q), ToKdl(v), ToKdl(a), KDL::WrenchMap(), tau), 0);
    return FromKdl(tau.data);
  }
  Eigen::MatrixXd M(const Eigen::VectorXd& q) const {
    Eigen::MatrixXd all(n_, n_);
    for (int i = 0; i < n_; ++i)
      all.col(i) = InverseDynamics(q, Eigen::VectorXd::Zero(n_), Eigen::VectorXd::Unit(n_, i), 0);
    return all;
  }

  FrameDynamics Frame(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const std::string& link) {
    FrameDynamics frame;
    KDL::Frame X;
    KDL::TreeFkSolverPos_recursive(tree_).JntToCart(ToKdl(q), X, link);
    frame.pose = {From(X.p), From(X.M)};
    KDL::Jacobian J(static_cast<unsigned>(n_));
    KDL::TreeJntToJacSolver(tree_).JntToJac(ToKdl(q), J, link);
    frame.J.resize(6, n_);
    for (int i = 0; i < n_; ++i)
      frame.J.col(i) =
          From(J.getColumn(static_cast<unsigned>(place_[static_cast<std::size_t>(i)])));
    frame.twist = frame.J * v;

    KDL::Chain chain;
    tree_.getChain(tree_.getRootSegment()->first, link, chain);
    KDL::JntArrayVel state(chain.getNrOfJoints());
    int k = 0;
    for (const KDL::Segment& segment : chain.segments) {
      if (segment.getJoint().getType() == KDL::Joint::None) continue;
      const auto place = tree_.getSegment(segment.getName())->second.q_nr;
      state.q.data[k] = ToKdl(q).data[place];
      state.qdot.data[k++] = ToKdl(v).data[place];
    }
    KDL::Twist bias;
    KDL::ChainJntToJacDotSolver(chain).JntToJacDot(state, bias);
    frame.Jdot_v = From(bias);
    return frame;
  }

 private:
  int n_;
  KDL::Tree tree_;
  std::vector<int> place_;  // KDL's number of each joint of the model
};

struct Case {
  const char* name;
  std::string file;  // empty: the branching tree
  std::vector<std::string> frames;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class AgainstKdl : public ::testing::TestWithParam<Case> {
 protected:
  AgainstKdl() {
    std::ostringstream text;
    if (!GetParam().file.empty()) text << std::ifstream(GetParam().file).rdbuf();
    const std::string urdf = GetParam().file.empty() ? kTree : text.str();
    model = RobotModel::FromUrdfText(urdf);
    kdl.emplace(*model, urdf);
  }

  /// Every figure of `compute(q, v, d)` at random states.
  template <class F>
  void Compare(F&& compute) {
    RandomStates random(*model);
    RobotDynamics d(*model, GetParam().frames);
    const PerJoint zero = PerJoint::Zero(model->size());
    for (int k = 0; k < kStates; ++k) {
      SCOPED_TRACE("state " + std::to_string(k));
      const JointPosition q = random.q();
      const JointVelocity v = random.v();
      compute(q, v, d);
      ASSERT_LT(RelativeError(d.M, kdl->M(q)), kTolerance);
      ASSERT_LT(RelativeError(d.coriolis, kdl->InverseDynamics(q, v, zero, 0)), kTolerance);
      ASSERT_LT(RelativeError(d.gravity, kdl->InverseDynamics(q, zero, zero, 9.80665)), kTolerance);
      ASSERT_LT(RelativeError(d.p, kdl->M(q) * v), kTolerance);
      const JointAcceleration a = random.a();
      ASSERT_LT(RelativeError(InverseDynamics(d, a), kdl->InverseDynamics(q, v, a, 9.80665)),
                kTolerance);
      for (std::size_t f = 0; f < GetParam().frames.size(); ++f) {
        const FrameDynamics expected = kdl->Frame(q, v, GetParam().frames[f]);
        ASSERT_LT(RelativeError(d.frame[f].pose.position, expected.pose.position), kTolerance);
        ASSERT_LT(RelativeError(d.frame[f].pose.rotation, expected.pose.rotation), kTolerance);
        ASSERT_LT(RelativeError(d.frame[f].J, expected.J), kTolerance);
        ASSERT_LT(RelativeError(d.frame[f].twist, expected.twist), kTolerance);
        ASSERT_LT(RelativeError(d.frame[f].Jdot_v, expected.Jdot_v), kTolerance);
      }
    }
  }

  /// `accelerate(q, v, τ)` solves M v̇ + C v + g = τ: the residual relative to the largest term.
  template <class F>
  void CompareAccelerations(F&& accelerate) {
    RandomStates random(*model);
    for (int k = 0; k < kStates; ++k) {
      const JointPosition q = random.q();
      const JointVelocity v = random.v();
      const JointTorque tau = random.tau();
      const JointAcceleration a = accelerate(q, v, tau);
      const Eigen::VectorXd found = kdl->InverseDynamics(q, v, a, 9.80665);
      const double scale = (kdl->M(q).cwiseAbs() * a.cwiseAbs()).norm() + tau.norm();
      ASSERT_LT((found - tau).norm() / scale, kTolerance) << "state " << k;
    }
  }

  std::optional<RobotModel> model;
  std::optional<Kdl> kdl;
};

TEST_P(AgainstKdl, KernelGivesTheSameDynamics) {
  Compare(
      [&](const auto& q, const auto& v, RobotDynamics& d) { ComputeDynamics(*model, q, v, d); });
}

TEST_P(AgainstKdl, RegressorTimesTheParametersGivesTheSameTorques) {
  std::vector<int> links;
  Eigen::VectorXd pi(10 * static_cast<Eigen::Index>(model->links().size()));
  for (int i = 0; i < static_cast<int>(model->links().size()); ++i) {
    links.push_back(i);
    pi.segment<10>(10 * i) = ParametersOf(model->link(i).inertial);
  }
  RandomStates random(*model);
  RobotDynamics d(*model);
  Eigen::MatrixXd Y(model->size(), pi.size());
  for (int k = 0; k < kStates; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointAcceleration a = random.a();
    ComputeDynamics(*model, q, v, d);
    ComputeInertialRegressor(*model, d, a, links, Y);
    ASSERT_LT(RelativeError(Y * pi, kdl->InverseDynamics(q, v, a, 9.80665)), kTolerance);
  }
}

TEST_P(AgainstKdl, SimbodyGivesTheSameDynamics) {
  const SimbodyArm arm(*model);
  SimbodyArm::Workspace workspace;
  Compare([&](const auto& q, const auto& v, RobotDynamics& d) {
    arm.ComputeDynamics(q, v, d, workspace);
  });
}

TEST_P(AgainstKdl, KernelAccelerationsSolveTheEquationOfMotion) {
  RobotDynamics d(*model);
  const JointTorque none = JointTorque::Zero(model->joints());
  CompareAccelerations([&](const auto& q, const auto& v, const auto& tau) {
    ComputeDynamics(*model, q, v, d);
    return ForwardDynamics(d, tau, none);
  });
}

TEST_P(AgainstKdl, SimbodyAccelerationsSolveTheEquationOfMotion) {
  const SimbodyArm arm(*model);
  SimbodyArm::Workspace workspace;
  CompareAccelerations([&](const auto& q, const auto& v, const auto& tau) {
    return arm.ForwardDynamics(q, v, tau, {}, {}, workspace);
  });
}

INSTANTIATE_TEST_SUITE_P(
    Arms, AgainstKdl,
    ::testing::Values(
        Case{"Gen3", kGen3File, {"tool_frame", "half_arm_2_link"}},
        Case{"Gen3WithSensor", kGen3BotaFile, {"FT_sensor_wrench"}},
        Case{"Lwr", kLwrFile, {"end_effector_link", "link_4"}},
        Case{"BranchingTree", "", {"left_hand", "right_tool", "backpack", "right_slide"}}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace pliant
