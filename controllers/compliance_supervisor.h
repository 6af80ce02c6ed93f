#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/controllers/course.h"
#include "pliant/controllers/objective.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// How an arm gives way to what pushes it.
enum class ComplianceMode : std::uint8_t {
  Stiff,      ///< nowhere
  NullSpace,  ///< where that does not move the tool
  FullBody,   ///< everywhere
  Dual,       ///< in the null space; everywhere while the tool is pushed hard
};

inline const std::vector<std::string>& Words(ComplianceMode) {
  static const std::vector<std::string> words{"stiff", "null_space", "full_body", "dual"};
  return words;
}

/// What decides that a tool is pushed hard: the norm of the force [N], or of all six numbers of the
/// wrench, N·m and N mixed, as the software of the papers has it.
enum class WrenchNorm : std::uint8_t { Force, Mixed };

inline const std::vector<std::string>& Words(WrenchNorm) {
  static const std::vector<std::string> words{"force", "mixed"};
  return words;
}

/// Gains of a pose task and of a posture task, each the same in all directions.
struct ComplianceGains {
  double pose_stiffness, pose_damping, pose_compliance;  ///< λ₂ [1/s²], λ₁ [1/s], γ
  double posture_stiffness, posture_damping, posture_compliance;  ///< of the posture

  template <class F>
  void Parameters(F&& f) {
    f("pose_stiffness", pose_stiffness, "1/s²", kNotNegative);
    f("pose_damping", pose_damping, "1/s", kNotNegative);
    f("pose_compliance", pose_compliance, "", kNotNegative);
    f("posture_stiffness", posture_stiffness, "1/s²", kNotNegative);
    f("posture_damping", posture_damping, "1/s", kNotNegative);
    f("posture_compliance", posture_compliance, "", kNotNegative);
  }
};

/// Chooses the gains and the target of a pose task and a posture task by a mode, and changes them
/// without a jump of torque. The arm holds the pose it has (static), or swings to and fro about it
/// (dynamic),
///
///   p° = p_a + A ½ (1 − cos 2π f t) d,   R° = R_a
///
/// with A rising to 1, and falling to 0, with least jerk over T; a change of that waits until the
/// one before it has ended. In the mode Dual the arm yields, with gains of their own, from the tick
/// at which the norm of the contact reaches `enter` to the one at which it falls below `leave`.
///
/// With a change of mode, and when yielding ends, gains go to their new values linearly over T, and
/// the anchor X_a becomes such that the target is the present pose. What the task's stiffness did
/// until then, −λ₂ e, stays as a feedforward that fades out linearly over T. So a change moves the
/// torque of its first tick by h/T of what it changes in all. While the arm brakes, it holds the
/// pose it has, whatever the mode, with gains of their own that damp its posture.
///
/// Sampled every h. The first anchor is the pose at the first tick.
///
/// Source: Celerier et al. 2025 (EC), Muraccioli et al. 2025 (RSS); gains and thresholds of their
/// software.
class ComplianceSupervisor final : public Block {
 public:
  struct Options {
    int joints = 0;
    Duration period = 1ms;  ///< h
    ComplianceGains stiff = {400, 40, 0, 0, 5, 0};
    ComplianceGains null_space = {400, 40, 0, 0, 5, 1};
    ComplianceGains full_body = {30, 11, 1, 0, 4, 1};
    ComplianceGains yielding = {0, 15, 1, 0, 2, 1};
    ComplianceGains braking = {400, 40, 0, 10, 20, 0};
    WrenchNorm norm = WrenchNorm::Force;
    double enter = 9;                                    ///< [N], > leave
    double leave = 5;                                    ///< [N], > 0
    double change_s = 0.5;                               ///< T, > 0
    Eigen::Vector3d swing = Eigen::Vector3d(0, 0.1, 0);  ///< d, world axes [m]
    double swing_hz = 0.25;                              ///< f > 0

    template <class F>
    void Parameters(F&& f) {
      f("stiff", stiff);
      f("null_space", null_space);
      f("full_body", full_body);
      f("yielding", yielding);
      f("braking", braking);
      f("norm", norm);
      f("enter", enter, "N", kPositive);
      f("leave", leave, "N", kPositive);
      f("change_s", change_s, "s", kPositive);
      f("swing", swing, "m");
      f("swing_hz", swing_hz, "Hz", kPositive);
    }
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    ComplianceMode mode = ComplianceMode::NullSpace;
    bool yields = false, brakes = false, started = false;
    Vector6 from = Vector6::Zero(), gains = Vector6::Zero();  // as in ComplianceGains
    double changed = 1;                                       // part of T that has gone
    Pose anchor;
    Vector6 held =
        Vector6::Zero();  // λ₂ e at the last change, and what was left of the ones before
    double swung = 0;     // part of T that A has risen
    bool swings = false;
    double time = 0;  // of the swing [s]

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("mode", mode, "");
      f("yields", yields, "");
      f("brakes", brakes, "");
      f("started", started, "");
      f("from", from, "");
      f("gains", gains, "");
      f("changed", changed, "");
      f("anchor", anchor, "");
      f("held", held, "rad/s², m/s²");
      f("swung", swung, "");
      f("swings", swings, "");
      f("time", time, "s");
    }
  };

  explicit ComplianceSupervisor(const Options& o);

  Input<ComplianceMode> mode;  ///< NullSpace if not connected
  Input<bool> dynamic;         ///< no if not connected
  Input<bool> brakes;          ///< no if not connected
  Input<Wrench> contact;       ///< at the wrist; none if not connected
  Input<FrameDynamics> tool;
  Output<bool> yields;
  Output<Pose> target;
  Output<Twist> target_twist, target_acceleration;
  Output<TaskVector> pose_stiffness, pose_damping;
  Output<TaskMatrix> pose_compliance;
  Output<PerJoint> posture_stiffness, posture_damping;
  Output<JointMatrix> posture_compliance;

 private:
  Memory Next(const Memory& last, const ComplianceMode& mode, const bool& dynamic,
              const bool& brakes, const Wrench& contact, const FrameDynamics& tool) const;
  const ComplianceGains& GainsOf(const Memory& m) const;
  internal::Course Way(const Memory& m) const;
  Pose Target(const Memory& m) const;
  Twist TargetTwist(const Memory& m) const;
  Twist TargetAcceleration(const Memory& m) const;
  PerJoint PostureStiffness(const Memory& m) const;
  PerJoint PostureDamping(const Memory& m) const;
  JointMatrix PostureCompliance(const Memory& m) const;

  const Options o_;
  const double h_;
  Output<Memory> memory_;
};

}  // namespace pliant
