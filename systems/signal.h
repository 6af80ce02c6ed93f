#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <type_traits>

#include "pliant/systems/space.h"

namespace pliant {

/// Largest number of joints of a joint vector (CMake: PLIANT_MAX_JOINTS). Vectors are bounded so
/// that they live on the stack and inside the context.
#ifdef PLIANT_MAX_JOINTS
inline constexpr int kMaxJoints = PLIANT_MAX_JOINTS;
#else
inline constexpr int kMaxJoints = 32;
#endif

/// One number per joint: gains and other parameters. As a signal, a number per joint without a
/// unit.
using PerJoint = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;

/// One column per joint, up to 6 rows: a Jacobian.
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJoints>;

/// One row and one column per joint: an inertia.
using JointMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;

/// The name and unit of what a signal carries.
struct Quantity {
  std::string_view name;
  std::string_view unit;
};

/// An Eigen vector with a quantity and a space. `D` derives from it and states its quantity:
///
///   struct JointTorque : Signal<JointTorque, Joints, Eigen::Dynamic, kMaxJoints> {
///     using Signal::Signal;
///     static constexpr Quantity quantity{"joint torque", "N·m"};
///   };
///
/// It is made from any Eigen expression or list of numbers, but not from another signal.
template <class D, class S, int Rows, int MaxRows = Rows>
struct Signal : Eigen::Matrix<double, Rows, 1, Eigen::ColMajor, MaxRows, 1> {
  using Base = Eigen::Matrix<double, Rows, 1, Eigen::ColMajor, MaxRows, 1>;
  using Space = S;

  Signal() { this->setZero(); }
  Signal(const Signal&) = default;
  Signal& operator=(const Signal&) = default;

  template <class E>
  Signal(const Eigen::MatrixBase<E>& e) : Base(e) {}  // NOLINT: a rule returns plain algebra
  template <class E, class S2, int R2, int M2>
  requires(!std::is_same_v<D, E>) Signal(const Signal<E, S2, R2, M2>&)
  = delete;

  Signal(std::initializer_list<double> numbers)  // NOLINT: {1.0, -2.0} is a value
      : Base(Eigen::Map<const Eigen::VectorXd>(numbers.begin(),
                                               static_cast<Eigen::Index>(numbers.size()))) {}

  template <class E>
  Signal& operator=(const Eigen::MatrixBase<E>& e) {
    Base::operator=(e);
    return *this;
  }
  template <class E, class S2, int R2, int M2>
  requires(!std::is_same_v<D, E>) Signal& operator=(const Signal<E, S2, R2, M2>&) = delete;

  /// All zero, of the size the space asks for.
  static D Zero(const Space& space) {
    D zero;
    if constexpr (Rows == Eigen::Dynamic) zero.resize(space.size());
    zero.setZero();
    return zero;
  }
};

/// A vector with an element per joint.
template <class D>
using JointSignal = Signal<D, Joints, Eigen::Dynamic, kMaxJoints>;

struct JointAcceleration : JointSignal<JointAcceleration> {
  using Signal::Signal;
  static constexpr Quantity quantity{"joint acceleration", "rad/s²"};
};
struct JointVelocity : JointSignal<JointVelocity> {
  using Signal::Signal;
  using Rate = JointAcceleration;
  static constexpr Quantity quantity{"joint velocity", "rad/s"};
};
struct JointPosition : JointSignal<JointPosition> {
  using Signal::Signal;
  using Rate = JointVelocity;
  static constexpr Quantity quantity{"joint position", "rad"};
};
struct JointTorqueRate : JointSignal<JointTorqueRate> {
  using Signal::Signal;
  static constexpr Quantity quantity{"joint torque rate", "N·m/s"};
};
struct JointTorque : JointSignal<JointTorque> {
  using Signal::Signal;
  using Rate = JointTorqueRate;
  static constexpr Quantity quantity{"joint torque", "N·m"};
};
struct JointMomentum : JointSignal<JointMomentum> {
  using Signal::Signal;
  using Rate = JointTorque;
  static constexpr Quantity quantity{"joint momentum", "N·m·s"};
};
struct MotorCurrent : JointSignal<MotorCurrent> {
  using Signal::Signal;
  static constexpr Quantity quantity{"motor current", "A"};
};

/// [ω; v] of a frame.
struct Twist : Signal<Twist, Frame, 6> {
  using Signal::Signal;
  static constexpr Quantity quantity{"twist", "rad/s, m/s"};
  static constexpr std::array<std::string_view, 6> elements{"wx", "wy", "wz", "vx", "vy", "vz"};
};

/// [moment; force] of the environment on the robot.
struct Wrench : Signal<Wrench, Frame, 6> {
  using Signal::Signal;
  static constexpr Quantity quantity{"wrench", "N·m, N"};
  static constexpr std::array<std::string_view, 6> elements{"mx", "my", "mz", "fx", "fy", "fz"};
};

struct LinearAcceleration : Signal<LinearAcceleration, Frame, 3> {
  using Signal::Signal;
  static constexpr Quantity quantity{"acceleration", "m/s²"};
};
struct LinearVelocity : Signal<LinearVelocity, Frame, 3> {
  using Signal::Signal;
  using Rate = LinearAcceleration;
  static constexpr Quantity quantity{"velocity", "m/s"};
};
/// Of a point.
struct Position : Signal<Position, Frame, 3> {
  using Signal::Signal;
  using Rate = LinearVelocity;
  static constexpr Quantity quantity{"position", "m"};
};
/// Of the environment on the robot.
struct Force : Signal<Force, Frame, 3> {
  using Signal::Signal;
  static constexpr Quantity quantity{"force", "N"};
};

/// Position and orientation X_AB of a frame B in a frame A.
struct Pose {
  using Space = Frame;
  static constexpr Quantity quantity{"pose", "m, rotation"};

  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< of B's origin, in A
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< R_AB

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("position", position, "m");
    f("rotation", rotation, "");
  }

  Pose operator*(const Pose& X_BC) const;
  Pose inverse() const;
};

/// A force and a moment of the environment on a link, acting at a point; world axes.
struct ContactForce {
  using Space = Nothing;
  static constexpr Quantity quantity{"contact force", "N, N·m"};

  int link = -1;                                     ///< index of the link, −1: none
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< in the link's frame [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< [N·m]

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("link", link, "");
    f("point", point, "m");
    f("force", force, "N");
    f("moment", moment, "N·m");
  }
};

}  // namespace pliant
