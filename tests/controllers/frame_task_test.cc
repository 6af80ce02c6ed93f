#include "pliant/controllers/frame_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/controllers/task_kinds.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using Part = FrameTask::Part;

constexpr double kPi = std::numbers::pi;

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m, {"tool_frame"});
  ComputeDynamics(m, q, v, d);
  return d;
}

FrameTask::Options Options(const RobotModel& m, Part part = Part::Pose) {
  const int rows = part == Part::Pose ? 6 : 3;
  return {.model = m,
          .frame = "tool_frame",
          .part = part,
          .stiffness = TaskVector::LinSpaced(rows, 100, 400),
          .damping = TaskVector::LinSpaced(rows, 20, 40),
          .weight = 3};
}

/// The rotation vector of R as quaternions give it.
Vector3d Log(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond r(R);
  const double s = r.vec().norm();
  return s == 0 ? Vector3d(Vector3d::Zero()) : Vector3d(2 * std::atan2(s, r.w()) / s * r.vec());
}

TEST(FrameTask, WantsWhatTheFormulaSays) {
  const RobotModel m = Gen3();
  RandomStates random(m, 21);
  for (const Part part : {Part::Pose, Part::Orientation, Part::Position}) {
    const int first = part == Part::Position ? 3 : 0;
    const int rows = part == Part::Pose ? 6 : 3;
    const FrameTask::Options o = Options(m, part);
    BlockTester<FrameTask> t(o);
    for (int k = 0; k < 100; ++k) {
      const RobotDynamics d = At(m, random.q(), random.v());
      const FrameDynamics& f = d.frame[0];
      const JointAcceleration pushed = random.a();
      const Vector3d axis = Vector3d(random.Uniform(1).head<3>()).normalized();
      const Pose target{
          random.Uniform(1).head<3>(),
          AngleAxisd(2 * random.Uniform(1)(0), axis).toRotationMatrix() * f.pose.rotation};
      const Twist twist = random.Uniform(1).head<6>(), feedforward = random.Uniform(5).head<6>();
      const Eigen::MatrixXd root =
          Eigen::MatrixXd::NullaryExpr(rows, rows, [&] { return random.Uniform(1)(0); });
      const TaskMatrix gamma = root * root.transpose();
      t.Set(t->dynamics, d);
      t.Set(t->external_acceleration, pushed);
      t.Set(t->target, target);
      t.Set(t->target_twist, twist);
      t.Set(t->target_acceleration, feedforward);
      t.Set(t->compliance, gamma);

      Vector6 error;
      error << Log(f.pose.rotation * target.rotation.transpose()),
          f.pose.position - target.position;
      const Eigen::VectorXd e = error.segment(first, rows);
      const Eigen::VectorXd edot = (f.J * d.v - twist).segment(first, rows);
      const Eigen::MatrixXd J = f.J.middleRows(first, rows);
      const Eigen::VectorXd wanted = -o.damping.cwiseProduct(edot) - o.stiffness.cwiseProduct(e);
      // ‖J q̈ + J̇ q̇ − ẍ° − ë* − Γ J q̈_e‖, EC (4) and (9)
      const Eigen::VectorXd b = feedforward.segment(first, rows) - f.Jdot_v.segment(first, rows) +
                                wanted + gamma * (J * pushed);
      EXPECT_LT(RelativeError(t.Get(t->error), e), 1e-13);
      EXPECT_LT(RelativeError(t.Get(t->error_rate), edot), 1e-13);
      EXPECT_LT(RelativeError(t.Get(t->objective).A, J), 1e-13);
      EXPECT_LT(RelativeError(t.Get(t->objective).b, b), 1e-13);
      EXPECT_EQ(t.Get(t->objective).weight, 3);
    }
  }
}

TEST(FrameTask, PredictsTheAccelerationOfTheErrorAlongAMotion) {
  const RobotModel m = Gen3();
  RandomStates random(m, 22);
  BlockTester<FrameTask> t(Options(m));
  const double h = 1e-4;
  for (int k = 0; k < 50; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointAcceleration a = random.a();
    const Twist feedforward = random.Uniform(3).head<6>();
    const auto rate = [&](double s) {  // ė along q + s q̇ + s²/2 q̈, with V° = s V̇°
      t.Set(t->dynamics, At(m, q + s * v + 0.5 * s * s * a, v + s * a));
      t.Set(t->target_twist, s * feedforward);
      return Eigen::VectorXd(t.Get(t->error_rate));
    };
    const Eigen::VectorXd measured = (rate(h) - rate(-h)) / (2 * h);
    rate(0);
    t.Set(t->target_acceleration, feedforward);
    const Objective& o = t.Get(t->objective);
    // A q̈ − b = ë − ë*, so with e and ė of this instant:
    const Eigen::VectorXd ideal =
        -Options(m).damping.cwiseProduct(Eigen::VectorXd(t.Get(t->error_rate))) -
        Options(m).stiffness.cwiseProduct(Eigen::VectorXd(t.Get(t->error)));
    EXPECT_LT(RelativeError(o.A * a - o.b + ideal, measured), 1e-5);  // second order in h
  }
}

TEST(FrameTask, TurnsTheShortWayBack) {
  const RobotModel m = Gen3();
  RandomStates random(m, 23);
  BlockTester<FrameTask> t(Options(m, Part::Orientation));
  const RobotDynamics d = At(m, random.q(), random.v());
  t.Set(t->dynamics, d);
  for (const double angle : {0.0, 1e-300, 1e-12, 1e-7, 1e-3, 1.0, 3.0, kPi - 1e-6, kPi - 1e-9})
    for (int k = 0; k < 20; ++k) {
      const Vector3d axis = Vector3d(random.Uniform(1).head<3>()).normalized();
      // R = exp(angle axis) R°
      t.Set(t->target, Pose{d.frame[0].pose.position, AngleAxisd(-angle, axis).toRotationMatrix() *
                                                          d.frame[0].pose.rotation});
      const Vector3d e = t.Get(t->error);
      // Round-off of R, and near π of the half angle: a few ε in all.
      EXPECT_LT((e - angle * axis).norm(), 5e-15) << angle;
    }
  // At half a turn both ways are as short.
  t.Set(t->target,
        Pose{d.frame[0].pose.position,
             AngleAxisd(kPi, Vector3d::UnitY()).toRotationMatrix() * d.frame[0].pose.rotation});
  EXPECT_NEAR(std::abs(t.Get(t->error)(1)), kPi, 1e-14);
  t.Set(t->target,
        Pose{d.frame[0].pose.position, AngleAxisd(kPi + 0.1, Vector3d::UnitY()).toRotationMatrix() *
                                           d.frame[0].pose.rotation});
  EXPECT_NEAR(t.Get(t->error)(1), kPi - 0.1, 1e-14);
}

TEST(FrameTask, ErrorTimesRateIsTheRateOfHalfTheSquaredErrorAtAnyError) {
  const RobotModel m = Gen3();
  RandomStates random(m, 24);
  BlockTester<FrameTask> t(Options(m));
  const double h = 1e-5;
  for (int k = 0; k < 100; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const Vector3d axis = Vector3d(random.Uniform(1).head<3>()).normalized();
    const Twist twist = random.Uniform(1).head<6>();
    const Pose target{random.Uniform(1).head<3>(), AngleAxisd(2.5, axis).toRotationMatrix() *
                                                       At(m, q, v).frame[0].pose.rotation};
    const auto energy = [&](double s) {
      const Vector3d turn = s * twist.head<3>();
      t.Set(t->dynamics, At(m, q + s * v, v));
      t.Set(t->target,
            Pose{target.position + s * twist.tail<3>(),
                 AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * target.rotation});
      return 0.5 * Eigen::VectorXd(t.Get(t->error)).squaredNorm();
    };
    const double measured = (energy(h) - energy(-h)) / (2 * h);
    t.Set(t->dynamics, At(m, q, v));
    t.Set(t->target, target);
    t.Set(t->target_twist, twist);
    EXPECT_NEAR(t.Get(t->error).dot(t.Get(t->error_rate)), measured, 1e-7);  // h² and ε/h
  }
}

TEST(FrameTask, GivesWayAlongTheAxesOfItsCompliance) {
  const RobotModel m = Gen3();
  RandomStates random(m, 25);
  FrameTask::Options o = Options(m, Part::Position);
  const Vector3d axis = Vector3d(1, 2, -0.5).normalized();
  o.compliance = 0.7 * axis * axis.transpose();
  BlockTester<FrameTask> t(o);
  for (int k = 0; k < 20; ++k) {
    const RobotDynamics d = At(m, random.q(), random.v());
    t.Set(t->dynamics, d);
    t.Set(t->external_acceleration, JointAcceleration::Zero(m.joints()));
    const Vector3d still = t.Get(t->objective).b;
    const JointAcceleration pushed = random.a();
    t.Set(t->external_acceleration, pushed);
    const Vector3d moved = Vector3d(t.Get(t->objective).b) - still;
    const Vector3d frame = d.frame[0].J.bottomRows<3>() * pushed;
    EXPECT_LT((moved - 0.7 * axis.dot(frame) * axis).norm(), 1e-12);
  }
}

TEST(FrameTask, FindsAnyLink) {
  const RobotModel m = Gen3();
  RandomStates random(m, 26);
  FrameTask::Options o = Options(m);
  o.frame = "forearm_link";
  BlockTester<FrameTask> t(o);
  const RobotDynamics d = At(m, random.q(), random.v());  // which asked for the tool's frame only
  t.Set(t->dynamics, d);
  const int forearm = m.link_index("forearm_link");
  EXPECT_EQ(t.Get(t->frame).pose.position, LinkPose(m, d, forearm).position);
  EXPECT_EQ(t.Get(t->objective).A, PointDynamics(m, d, forearm, {0, 0, 0}).J);
}

TEST(FrameTask, RefusesOptionsThatMakeNoTask) {
  const RobotModel m = Gen3();
  const auto error = [&](auto change) {
    FrameTask::Options o = Options(m, Part::Position);
    change(o);
    return ErrorOf([&] { FrameTask task(o); });
  };
  using O = FrameTask::Options;
  EXPECT_EQ(error([](O& o) { o.stiffness = TaskVector(); }), "stiffness has 3 elements, got 0");
  EXPECT_EQ(error([](O& o) { o.damping(1) = -1; }), "damping[y] must be >= 0 1/s, got -1");
  EXPECT_EQ(error([](O& o) { o.weight = 0; }), "weight must be finite and > 0, got 0");
  EXPECT_THAT(error([](O& o) { o.frame = "tool_fram"; }), testing::HasSubstr("tool_frame"));
  EXPECT_THAT(error([](O& o) { o.target.rotation(0, 0) = 2; }),
              testing::HasSubstr("target rotation must be a rotation"));
  EXPECT_THAT(error([](O& o) { o.target.rotation(0, 0) = -1; }),
              testing::HasSubstr("target rotation must be a rotation"));
  EXPECT_EQ(error([](O& o) { o.compliance = TaskMatrix::Identity(6, 6); }),
            "compliance must be 3 x 3, got 6 x 6");
}

RobotDynamics Dynamics(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, v, d);
  return d;
}

/// A motion of the arm and of a target, of constant accelerations, along which a task is watched.
struct Course {
  Course(const FrameTask::Options& o, RandomStates& random)
      : model{o.model}, q{random.q()}, v{random.v()}, a{random.a()} {
    const auto draw = [&] { return Eigen::VectorXd(random.Uniform(1).head<3>()); };
    target.position = draw();
    const Vector3d axis = draw().normalized();
    target.rotation = AngleAxisd(2 * random.Uniform(1)(0), axis).toRotationMatrix();
    twist << draw(), draw();
    acceleration << 3 * draw(), 3 * draw();
  }
  /// Everything as it is s later.
  void Show(BlockTester<FrameTask>& t, double s) const {
    t.Set(t->dynamics, Dynamics(model, q + s * v + 0.5 * s * s * a, v + s * a));
    const Vector6 way = s * twist + 0.5 * s * s * acceleration;
    const Vector3d turn = way.head<3>();
    Pose X = target;
    X.position += way.tail<3>();
    if (s != 0)
      X.rotation = AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * X.rotation;
    t.Set(t->target, X);
    t.Set(t->target_twist, twist + s * acceleration);
    t.Set(t->target_acceleration, acceleration);
  }
  const RobotModel model;
  const JointPosition q;
  const JointVelocity v;
  const JointAcceleration a;
  Pose target;
  Twist twist, acceleration;
};

TEST(FrameTask, HasRowsThatAreTheRateOfItsErrorRateForAllKinds) {
  const double h = 1e-4;
  for (const TaskKind& kind : Kinds()) {
    RandomStates random(kind.options.model, 27);
    BlockTester<FrameTask> t(kind.options);
    for (int k = 0; k < 20; ++k) {
      const Course course(kind.options, random);
      const auto rate = [&](double s) {
        course.Show(t, s);
        return Eigen::VectorXd(t.Get(t->error_rate));
      };
      const Eigen::VectorXd measured = (rate(h) - rate(-h)) / (2 * h);
      rate(0);
      const Objective& o = t.Get(t->objective);
      // A q̈ − b = ü − ü*
      const Eigen::VectorXd ideal = -kind.options.damping.cwiseProduct(t.Get(t->error_rate)) -
                                    kind.options.stiffness.cwiseProduct(t.Get(t->error));
      ASSERT_LT((o.A * course.a - o.b + ideal - measured).norm(), 2e-5 * (measured.norm() + 1))
          << kind.name;  // second order in h, of motions that turn at some rad/s
    }
  }
}

TEST(FrameTask, HasAnErrorRateThatIsLinearInTheJointVelocityForAllKinds) {
  for (const TaskKind& kind : Kinds()) {
    RandomStates random(kind.options.model, 28);
    BlockTester<FrameTask> t(kind.options);
    for (int k = 0; k < 20; ++k) {
      const Course course(kind.options, random);
      course.Show(t, 0);
      const Eigen::VectorXd with = t.Get(t->error_rate);
      const Eigen::VectorXd moved = t.Get(t->objective).A * course.v;
      t.Set(t->dynamics, Dynamics(course.model, course.q, 0 * course.v));
      const Eigen::VectorXd without = t.Get(t->error_rate);
      ASSERT_LT((with - without - moved).norm(), 1e-13 * (1 + with.norm())) << kind.name;
    }
  }
}

TEST(FrameTask, HasTheRateOfItsErrorForAllPositions) {
  const double h = 1e-5;
  for (const TaskKind& kind : Kinds()) {
    if (kind.options.part != Part::Position) continue;
    RandomStates random(kind.options.model, 29);
    BlockTester<FrameTask> t(kind.options);
    for (int k = 0; k < 20; ++k) {
      const Course course(kind.options, random);
      const auto error = [&](double s) {
        course.Show(t, s);
        return Eigen::VectorXd(t.Get(t->error));
      };
      const Eigen::VectorXd measured = (error(h) - error(-h)) / (2 * h);
      course.Show(t, 0);
      ASSERT_LT((t.Get(t->error_rate) - measured).norm(), 1e-7) << kind.name;  // h² and ε/h
    }
  }
}

TEST(FrameTask, HasTheRateOfHalfTheSquaredErrorForWholeOrientationsAndPointing) {
  const double h = 1e-5;
  int tried = 0;
  for (const TaskKind& kind : Kinds()) {
    const bool own = kind.options.axes == FrameTask::Axes::Frame;
    const std::string what = kind.name.substr(0, kind.name.find(','));
    if (what != "pose" && what != "orientation" &&
        !(own && (what == "pointing" || what == "drill")))
      continue;
    ++tried;
    RandomStates random(kind.options.model, 30);
    BlockTester<FrameTask> t(kind.options);
    for (int k = 0; k < 20; ++k) {
      const Course course(kind.options, random);
      const auto energy = [&](double s) {
        course.Show(t, s);
        return 0.5 * t.Get(t->error).squaredNorm();
      };
      const double measured = (energy(h) - energy(-h)) / (2 * h);
      course.Show(t, 0);
      if (t.Get(t->error).norm() > 3) continue;  // so near to half a turn the way back may change
      ASSERT_NEAR(t.Get(t->error).dot(t.Get(t->error_rate)), measured, 1e-6) << kind.name;
    }
  }
  EXPECT_EQ(tried, 12);
}

TEST(FrameTask, SeesAFrameFromAReferenceThatMoves) {
  const RobotModel m = Tree();
  RandomStates random(m, 31);
  FrameTask::Options o{.model = m,
                       .frame = "left_hand",
                       .relative_to = "right_tool",
                       .stiffness = TaskVector::Constant(6, 1),
                       .damping = TaskVector::Constant(6, 1)};
  BlockTester<FrameTask> t(o);
  const double h = 1e-5;
  for (int k = 0; k < 50; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const auto at = [&](double s) {
      t.Set(t->dynamics, Dynamics(m, q + s * v, v));
      return t.Get(t->frame);
    };
    const FrameDynamics a = at(-h), b = at(h), now = at(0);
    const RobotDynamics d = Dynamics(m, q, v);
    const Pose X = LinkPose(m, d, m.link_index("right_tool")).inverse() *
                   LinkPose(m, d, m.link_index("left_hand"));
    EXPECT_LT((now.pose.position - X.position).norm(), 1e-14);
    EXPECT_LT((now.pose.rotation - X.rotation).norm(), 1e-14);
    EXPECT_LT((now.J * v - now.twist).norm(), 1e-13);
    const Vector3d turn = Log(b.pose.rotation * a.pose.rotation.transpose());
    EXPECT_LT((turn / (2 * h) - now.twist.head<3>()).norm(), 1e-7);  // h² and ε/h
    EXPECT_LT(((b.pose.position - a.pose.position) / (2 * h) - now.twist.tail<3>()).norm(), 1e-7);
    EXPECT_LT(((b.twist - a.twist) / (2 * h) - now.Jdot_v).norm(), 1e-6);
    // What carries both moves neither.
    EXPECT_LT(now.J.col(m.joint_index("waist")).norm(), 1e-14);
  }
}

TEST(FrameTask, PointsHoweverFarTheFrameHasTurnedAboutThatAxis) {
  const RobotModel m = Gen3();
  RandomStates random(m, 32);
  FrameTask::Options o = Options(m, Part::Orientation);
  o.axes = FrameTask::Axes::Frame;
  o.basis = TaskMatrix::Identity(2, 3);  // z is free
  o.stiffness = o.damping = TaskVector::Constant(2, 1);
  BlockTester<FrameTask> t(o);
  for (int k = 0; k < 100; ++k) {
    const RobotDynamics d = At(m, random.q(), random.v());
    const Eigen::Matrix3d R = d.frame[0].pose.rotation;
    const double tilt = 3.1 * std::abs(random.Uniform(1)(0)), roll = 3 * random.Uniform(1)(0);
    const double along = 3 * random.Uniform(1)(0);
    const Vector3d axis = R * Vector3d(std::cos(along), std::sin(along), 0);
    // z of the target, tilted back, and then rolled
    const Eigen::Matrix3d target = AngleAxisd(-tilt, axis).toRotationMatrix() * R *
                                   AngleAxisd(roll, Vector3d::UnitZ()).toRotationMatrix();
    t.Set(t->dynamics, d);
    t.Set(t->target, Pose{Vector3d::Zero(), target});
    const Eigen::Vector2d expected = tilt * Eigen::Vector2d(std::cos(along), std::sin(along));
    // Round-off of the directions, over the sine of an angle not nearer to π than 0.04.
    ASSERT_LT((t.Get(t->error) - expected).norm(), 1e-13);
  }
  // Turned right round, the way back is any.
  const RobotDynamics d = At(m, random.q(), random.v());
  t.Set(t->dynamics, d);
  t.Set(t->target,
        Pose{Vector3d::Zero(), d.frame[0].pose.rotation * Eigen::Vector3d(1, -1, -1).asDiagonal()});
  EXPECT_NEAR(t.Get(t->error).norm(), kPi, 1e-7);
  t.Set(t->target, d.frame[0].pose);
  EXPECT_LT(t.Get(t->error).norm(), 1e-15);
}

TEST(FrameTask, ReadsAComplianceAsANumberADiagonalOrAMatrix) {
  const RobotModel m = Gen3();
  const auto gamma = [&](const TaskMatrix& given, const Eigen::Matrix3d& axes) {
    FrameTask::Options o = Options(m, Part::Position);
    o.compliance = given;
    o.compliance_axes = axes;
    BlockTester<FrameTask> t(o);
    return Eigen::Matrix3d(t.Get(t->compliance));
  };
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  EXPECT_EQ(gamma({}, I), 0 * I);
  EXPECT_EQ(gamma(TaskMatrix::Constant(1, 1, 0.5), I), 0.5 * I);
  const Vector3d diagonal(1, 2, 3);
  EXPECT_EQ(gamma(diagonal, I), Eigen::Matrix3d(diagonal.asDiagonal()));
  EXPECT_EQ(gamma(TaskMatrix(diagonal.asDiagonal()), I), Eigen::Matrix3d(diagonal.asDiagonal()));
  const Eigen::Matrix3d R = AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_LT((gamma(diagonal, R) * R.col(1) - 2 * R.col(1)).norm(), 1e-14);
}

/// Λ of the task's rows.
Eigen::MatrixXd Inertia(const RobotDynamics& d, const Objective& o) {
  const Eigen::MatrixXd A = o.A, M = d.M;
  return (A * M.inverse() * A.transpose()).inverse();
}

TEST(FrameTask, GivesWayByItsMobilityWhateverTheArmsOwnInertia) {
  for (const TaskKind& kind : Kinds()) {
    if (kind.options.relative_to && kind.options.stiffness.size() == 6)
      continue;  // five joints move one hand against the other
    RandomStates random(kind.options.model, 33);
    FrameTask::Options o = kind.options;
    o.inertia_limit = 1e9;
    BlockTester<FrameTask> t(o);
    const auto rows = o.stiffness.size();
    int tried = 0;
    for (int k = 0; k < 20; ++k) {
      const RobotDynamics d = Dynamics(o.model, random.q(), random.v());
      const JointAcceleration pushed = random.a();
      t.Set(t->dynamics, d);
      t.Set(t->external_acceleration, pushed);
      t.Set(t->mobility, TaskMatrix::Zero(rows, rows));
      t.Set(t->compliance, TaskMatrix::Zero(rows, rows));
      const Eigen::VectorXd still = t.Get(t->objective).b;
      t.Set(t->external_acceleration, JointAcceleration::Zero(o.model.joints()));
      ASSERT_EQ(Eigen::VectorXd(t.Get(t->objective).b), still) << "Y = 0 is 0 to the bit";
      t.Set(t->external_acceleration, pushed);
      const Eigen::MatrixXd A = t.Get(t->objective).A;
      const Eigen::MatrixXd Lambda = Inertia(d, t.Get(t->objective));
      const double condition = Lambda.norm() * Lambda.inverse().norm();
      if (!(condition < 1e6)) continue;
      ++tried;
      // Round-off of Λ, three factors of its condition in all of these.
      const double tolerance = 1e-14 * condition * (1 + (A * pushed).norm()) * 10;

      t.Set(t->mobility, TaskMatrix(Lambda.inverse()));  // Γ = I
      ASSERT_LT((t.Get(t->objective).b - still - A * pushed).norm(), tolerance) << kind.name;

      const Eigen::VectorXd y = random.Uniform(1).head(rows > 4 ? 4 : rows);
      TaskVector direction = TaskVector::Constant(rows, 0.3);
      direction.head(y.size()) = y;
      const TaskMatrix Y = direction * direction.transpose();  // of rank 1
      t.Set(t->mobility, Y);
      ASSERT_LT((t.Get(t->objective).b - still - Y * Lambda * A * pushed).norm(),
                tolerance * Y.norm() * Lambda.norm() + tolerance)
          << kind.name;
    }
    EXPECT_GT(tried, 5) << kind.name;
  }
}

TEST(FrameTask, KeepsItsInertiaBelowTheLimitAtASingularity) {
  const RobotModel m = Gen3();
  FrameTask::Options o = Options(m, Part::Position);
  o.inertia_limit = 50;
  o.mobility = TaskMatrix::Identity(3, 3);
  BlockTester<FrameTask> t(o);
  double last = std::numeric_limits<double>::infinity();
  for (const double bend : {1e-1, 1e-2, 1e-3, 1e-6, 0.0}) {
    JointPosition q = JointPosition::Zero(m.joints());  // outstretched upwards
    q(3) = bend;
    const RobotDynamics d = At(m, q, JointVelocity::Zero(m.joints()));
    t.Set(t->dynamics, d);
    t.Set(t->external_acceleration, JointAcceleration::Zero(m.joints()));
    const Vector3d still = t.Get(t->objective).b;
    const Eigen::MatrixXd J = t.Get(t->objective).A;
    const Eigen::MatrixXd M = d.M;
    const Vector3d force(0, 0, 10);
    const JointAcceleration pushed = M.inverse() * J.transpose() * force;
    t.Set(t->external_acceleration, pushed);
    const Vector3d moved = Vector3d(t.Get(t->objective).b) - still;
    ASSERT_TRUE(moved.allFinite());
    ASSERT_LT(moved.norm(), 50 * (J * pushed).norm() + 1e-12);
    ASSERT_LT(moved.norm(), force.norm() * (1 + 1e-9)) << "no more than Y F";
    ASSERT_LE(moved(2), last * (1 + 1e-9)) << "fades towards the singularity";
    last = moved(2);
  }
  EXPECT_LT(last, 1e-12) << "what is lost is not pushed";
}

TEST(FrameTask, RefusesABasisThatIsNone) {
  const RobotModel m = Gen3();
  const auto error = [&](auto change) {
    FrameTask::Options o = Options(m, Part::Position);
    change(o);
    return ErrorOf([&] { FrameTask task(o); });
  };
  using O = FrameTask::Options;
  EXPECT_EQ(error([](O& o) { o.basis = TaskMatrix::Identity(2, 6); }),
            "basis has up to 3 rows of 3 numbers, got 2 x 6");
  EXPECT_EQ(error([](O& o) { o.basis = TaskMatrix::Identity(4, 3); }),
            "basis has up to 3 rows of 3 numbers, got 4 x 3");
  EXPECT_EQ(error([](O& o) { o.basis = 2 * TaskMatrix::Identity(2, 3); }),
            "basis must have orthonormal rows: |S Sᵀ − I| must be 0, got 3");
  EXPECT_EQ(error([](O& o) {
              o.basis = TaskMatrix::Identity(2, 3);
              o.basis(0, 1) = std::numeric_limits<double>::infinity();
            }),
            "basis must be finite");
  EXPECT_EQ(error([](O& o) { o.basis = TaskMatrix::Identity(2, 3); }),
            "stiffness has 2 elements, got 3");
  EXPECT_EQ(error([](O& o) {
              o.basis = Vector3d(0, 0.6, 0.8);  // one row, as a list is read
              o.stiffness = o.damping = TaskVector::Ones(1);
            }),
            "no error");
  EXPECT_THAT(error([](O& o) { o.relative_to = "forarm_link"; }),
              testing::HasSubstr("forearm_link"));
  EXPECT_EQ(error([](O& o) { o.mobility = TaskMatrix::Constant(1, 1, -1); }),
            "mobility must be positive semi-definite: every eigenvalue must be >= 0, got -1");
  EXPECT_EQ(error([](O& o) {
              o.mobility = TaskMatrix::Identity(3, 3);
              o.mobility(0, 1) = 1;
            }),
            "mobility must be symmetric: |Y − Yᵀ| must be 0, got 1");
  EXPECT_THAT(error([](O& o) { o.compliance_axes(0, 0) = 2; }),
              testing::HasSubstr("compliance_axes must be a rotation"));
  EXPECT_EQ(error([](O& o) {
              o.basis = TaskMatrix::Identity(2, 3);
              o.stiffness = o.damping = TaskVector::Ones(2);
              o.compliance_axes = AngleAxisd(1, Vector3d::UnitZ()).toRotationMatrix();
            }),
            "a compliance is turned into other axes if it is 3 x 3 or 6 x 6, got 2 x 2");
  EXPECT_EQ(error([](O& o) { o.inertia_limit = 0; }), "inertia_limit must be > 0 kg, got 0");
}

}  // namespace
}  // namespace pliant
