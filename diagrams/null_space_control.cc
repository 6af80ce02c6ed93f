#include "pliant/diagrams/null_space_control.h"

#include <Eigen/Geometry>
#include <cmath>
#include <type_traits>

#include "pliant/controllers/passivity_monitor.h"
#include "pliant/controllers/velocity_tracking.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/estimators/residual_tare.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/filtered_derivative.h"

namespace pliant {

namespace {

using Eigen::Vector3d;

/// The first frame of an arm's dynamics.
class ToolFrame final : public Block {
 public:
  explicit ToolFrame(const Joints& joints) : dynamics{this, "dynamics", joints} {
    Compute(frame).From(dynamics).As([](const RobotDynamics& d) { return d.frame[0]; });
    Compute(position).From(frame).As(
        [](const FrameDynamics& now) { return Position(now.pose.position); });
    Compute(velocity).From(frame).As(
        [](const FrameDynamics& now) { return LinearVelocity(now.twist.tail<3>()); });
  }
  Input<RobotDynamics> dynamics;
  Output<FrameDynamics> frame{this, "frame"};
  Output<Position> position{this, "position"};
  Output<LinearVelocity> velocity{this, "velocity"};
};

/// A velocity from a time on, and none before.
class Wait final : public Block {
 public:
  explicit Wait(double until_s) : until_{until_s} { Compute(v).From(clock, u).As(&Wait::Pass); }
  Input<LinearVelocity> u{this, "u"};
  Output<LinearVelocity> v{this, "v"};

 private:
  LinearVelocity Pass(double t, const LinearVelocity& wanted) const {
    return t < until_ ? LinearVelocity(Vector3d::Zero()) : wanted;
  }

  const double until_;
};

/// τ = g + τᶜ + τⁿ within the limits of the joints, or that of the fallback, and the acceleration
/// of it and of τ̂_e.
class WholeTorque final : public Block {
 public:
  WholeTorque(const RobotModel& model, double fallback_damping)
      : dynamics{this, "dynamics", model.joints()},
        tool{this, "tool", model.joints()},
        null_space{this, "null_space", model.joints()},
        external{this, "external", model.joints()},
        torque{this, "torque", model.joints()},
        acceleration{this, "acceleration", model.joints()},
        limit_{model.effort_limit()},
        damping_{fallback_damping},
        wanted_{this, "wanted", model.joints()} {
    Compute(fallback).From(dynamics, tool, null_space).As(&WholeTorque::Falls);
    Compute(wanted_).From(dynamics, tool, null_space, fallback).As(&WholeTorque::Sum);
    Compute(torque).From(wanted_).As(&WholeTorque::Cut);
    Compute(saturated).From(wanted_, motors).As(&WholeTorque::WhichAreCut);
    Compute(acceleration)
        .From(dynamics, torque, external)
        .As([](const RobotDynamics& d, const JointTorque& tau, const JointTorque& tau_e) {
          return ForwardDynamics(d, tau, tau_e);
        });
  }
  Input<RobotDynamics> dynamics;
  Input<JointTorque> tool, null_space, external;
  Input<JointBits> motors{this, "motors"};  ///< joints whose motor's torque is cut
  Output<bool> fallback{this, "fallback"};
  Output<JointTorque> torque;
  Output<JointBits> saturated{this, "saturated"};
  Output<JointAcceleration> acceleration;

 private:
  bool Falls(const RobotDynamics& d, const JointTorque& tau_c, const JointTorque& tau_n) const {
    return !(d.gravity.allFinite() && tau_c.allFinite() && tau_n.allFinite());
  }

  JointTorque Sum(const RobotDynamics& d, const JointTorque& tau_c, const JointTorque& tau_n,
                  bool falls) const {
    if (!falls) return JointTorque(d.gravity + tau_c + tau_n);
    const PerJoint tau = d.gravity - damping_ * d.v;
    return JointTorque(tau.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; }));
  }

  JointTorque Cut(const JointTorque& tau) const {
    return JointTorque(tau.cwiseMin(limit_).cwiseMax(-limit_));
  }

  JointBits WhichAreCut(const JointTorque& tau, const JointBits& motors) const {
    JointBits bits = motors;
    for (int i = 0; i < tau.size(); ++i)
      if (std::abs(tau(i)) > limit_(i)) bits |= JointBits{1} << i;
    return bits;
  }

  const PerJoint limit_;
  const double damping_;
  Output<JointTorque> wanted_;
};

/// How a point and its velocity miss what moves in time.
class TimedErrors final : public Block {
 public:
  TimedErrors() {
    Compute(desired).From(target_twist).As([](const Twist& V) {
      return LinearVelocity(V.tail<3>());
    });
    Compute(error)
        .From(desired, velocity)
        .As([](const LinearVelocity& wanted, const LinearVelocity& v) {
          return LinearVelocity(wanted - v);
        });
  }
  Input<Twist> target_twist{this, "target_twist"};
  Input<LinearVelocity> velocity{this, "velocity"};
  Output<LinearVelocity> desired{this, "desired"};
  Output<LinearVelocity> error{this, "error"};
};

/// A motion with its positions in the world.
CircleGenerator::Options InWorld(const Pose& start, CircleGenerator::Options o) {
  o.center += start.position;
  return o;
}
LimitCycleGenerator::Options InWorld(const Pose& start, LimitCycleGenerator::Options o) {
  o.center += start.position;
  return o;
}
GoalGenerator::Options InWorld(const Pose& start, GoalGenerator::Options o) {
  o.goal += start.position;
  return o;
}
PoseCircle::Options InWorld(const Pose& start, PoseCircle::Options o, double start_s) {
  o.start = {start.position + o.start.position, o.start.rotation * start.rotation};
  o.center += start.position;
  o.start_s += start_s;
  return o;
}

/// The same circle without its time, which says how far from it a point is.
LimitCycleGenerator::Options PathOf(const PoseCircle::Options& circle) {
  const Vector3d out = circle.start.position - circle.center, n = circle.normal.normalized();
  LimitCycleGenerator::Options path{.center = circle.center,
                                    .radius = out.norm(),
                                    .angular_velocity = 0,
                                    .radial_gain = 1,
                                    .height_gain = 1};
  path.axes << out.normalized(), n.cross(out.normalized()), n;
  return path;
}

template <class Options>
struct BlockOf;
template <>
struct BlockOf<CircleGenerator::Options> : std::type_identity<CircleGenerator> {};
template <>
struct BlockOf<LimitCycleGenerator::Options> : std::type_identity<LimitCycleGenerator> {};
template <>
struct BlockOf<GoalGenerator::Options> : std::type_identity<GoalGenerator> {};

}  // namespace

NullSpaceControl::NullSpaceControl(const Options& o)
    : measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      true_torque{this, "true_torque", o.model.joints(), JointTorque::Zero(o.model.joints())},
      torque{this, "torque", o.model.joints()},
      current{this, "current", o.model.joints()},
      torque_error{this, "torque_error", o.model.joints()},
      saturated{this, "saturated"},
      fallback{this, "fallback"},
      tool_torque{this, "tool_torque", o.model.joints()},
      null_space_torque{this, "null_space_torque", o.model.joints()},
      external_torque{this, "external_torque", o.model.joints()},
      desired{this, "desired"},
      velocity_error{this, "velocity_error"},
      target{this, "target"},
      path_error{this, "path_error"},
      orientation_error{this, "orientation_error"},
      storage{this, "storage"},
      supply{this, "supply"},
      excess{this, "excess"},
      least_singular{this, "least_singular"} {
  const Joints& joints = o.model.joints();
  RequireInRange("", o);
  Require(o.start_s == 0 || o.start_s >= 2 * seconds(o.period),
          "start_s must be 0 or at least two periods of " + o.period.text() +
              ": the offset of the estimate is taken before",
          o.start_s);
  RequireOneForEach(joints, "position", o.position.size());
  RobotDynamics at_start(o.model, {o.tool});
  ComputeDynamics(o.model, o.position, JointVelocity::Zero(joints), at_start);
  const Pose start = at_start.frame[0].pose;

  auto& dynamics = Add<ModelDynamics>(
      "dynamics", {.model = o.model, .frames = {o.tool}, .rotor_inertia = o.rotor_inertia});
  auto& tool = Add<ToolFrame>("tool", joints);
  auto& projector =
      Add<NullSpaceProjector>("projector", {.joints = joints, .damped_below = o.damped_below});
  auto& whole = Add<WholeTorque>("whole", o.model, o.fallback_damping);
  auto& actuation = Add<TorqueActuation>("actuation", {.joints = joints,
                                                       .rotor_inertia = o.rotor_inertia,
                                                       .motors = o.low_level,
                                                       .loop = o.torque_loop});
  auto& monitor = Add<PassivityMonitor>(
      "monitor",
      {.joints = joints,
       .damping = o.damping,
       .stiffness = o.orientation.stiffness,
       .rate_gain_s =
           std::holds_alternative<ClassicalMotion>(o.motion) ? 0 : o.tracking.rate_gain_s,
       .from_s = o.start_s,
       .period = o.period});

  Connect(measured_position, dynamics.position);
  Connect(measured_velocity, dynamics.velocity);
  Connect(dynamics.dynamics, tool.dynamics);
  Connect(tool.frame, projector.frame);

  const auto impede = [&](ToolImpedance& law) {
    Connect(tool.frame, law.frame);
    Connect(law.torque, whole.tool);
    Connect(law.torque, tool_torque);
    Connect(law.orientation_error, orientation_error);
    Connect(law.orientation_error, monitor.orientation_error);
  };
  const auto follow = [&](MotionGenerator& generator) {
    Connect(tool.position, generator.position);
    Connect(tool.velocity, generator.velocity);
    Connect(generator.nearest, target);
    Connect(generator.path_error, path_error);
  };
  const auto want = [&](const Output<LinearVelocity>& wanted,
                        const Output<LinearVelocity>& error) -> const Output<LinearVelocity>& {
    Connect(wanted, desired);
    Connect(error, velocity_error);
    Connect(error, monitor.velocity_error);
    return wanted;
  };
  const Output<LinearVelocity>& wanted = std::visit(
      [&](const auto& motion) -> const Output<LinearVelocity>& {
        using Motion = std::remove_cvref_t<decltype(motion)>;
        if constexpr (std::is_same_v<Motion, ClassicalMotion>) {
          const PoseCircle::Options circle = InWorld(start, motion.circle, o.start_s);
          auto& reference = Add<PoseCircle>("reference", circle);
          auto& path = Add<LimitCycleGenerator>("path", PathOf(circle));
          auto& errors = Add<TimedErrors>("errors");
          auto& law = Add<ClassicalImpedance>("impedance", {.joints = joints,
                                                            .stiffness = motion.stiffness,
                                                            .damping = o.damping,
                                                            .orientation = o.orientation});
          follow(path);
          impede(law);
          Connect(reference.pose, law.target);
          Connect(reference.twist, law.target_twist);
          Connect(reference.twist, errors.target_twist);
          Connect(tool.velocity, errors.velocity);
          return want(errors.desired, errors.error);
        } else {
          auto& generator =
              Add<typename BlockOf<Motion>::type>("generator", InWorld(start, motion));
          auto& tracking = Add<VelocityTracking>(
              "tracking", {.gain = o.tracking.gain, .rate_gain_s = o.tracking.rate_gain_s});
          auto& rate = Add<FilteredDerivative<LinearVelocity>>(
              "rate", {.cutoff_hz = o.tracking.cutoff_hz, .period = o.period});
          auto& upright = Add<Constant<Pose>>("upright", {.value = start});
          auto& law = Add<VelocityImpedance>(
              "impedance", {.joints = joints, .damping = o.damping, .orientation = o.orientation});
          follow(generator);
          impede(law);
          auto& wait = Add<Wait>("wait", o.start_s);
          Connect(generator.desired, wait.u);
          Connect(wait.v, tracking.desired);
          Connect(tool.velocity, tracking.velocity);
          Connect(tracking.error, rate.u);
          Connect(rate.y, tracking.error_rate);
          Connect(tracking.command, law.command);
          Connect(upright.y, law.target);
          return want(wait.v, tracking.error);
        }
      },
      o.motion);

  // What is estimated, for the choice or for those who look on.
  const auto listen = [&](auto& estimator) {
    Connect(dynamics.dynamics, estimator.dynamics);
    Connect(measured_torque, estimator.torque);
  };
  const auto estimate = [&]() -> const Output<JointTorque>& {
    if (const auto* of = std::get_if<RegressedNullSpaceTorque>(&o.null_space)) {
      auto& regression = Add<InteractionEstimator>("estimate", {.model = o.model,
                                                                .memory_s = of->memory_s,
                                                                .prior = of->prior,
                                                                .at = of->at,
                                                                .rotor_inertia = o.rotor_inertia,
                                                                .period = o.period});
      listen(regression);
      return regression.external_torque;
    }
    auto& observer = Add<MomentumObserver>(
        "estimate", {.joints = joints,
                     .gain = PerJoint::Constant(joints.size(), o.observer_gain),
                     .period = o.period,
                     .rotor_inertia = o.rotor_inertia});
    listen(observer);
    return observer.residual;
  };
  auto& tare = Add<ResidualTare>(
      "tare",
      {.joints = joints, .period = o.period, .from_s = o.start_s / 2, .until_s = o.start_s});
  Connect(estimate(), tare.residual);
  const Output<JointTorque>& estimated = tare.tared;

  // The proof's q̇_d, also where the law of the null space has none.
  const auto* printed = std::get_if<PrintedNullSpaceTorque>(&o.null_space);
  const auto* meant = std::get_if<MeantNullSpaceTorque>(&o.null_space);
  const PrintedNullSpaceTorque gains = meant     ? PrintedNullSpaceTorque(*meant)
                                       : printed ? *printed
                                                 : PrintedNullSpaceTorque{};
  auto& impedance = Add<NullSpaceImpedance>(
      "null_space", {.joints = joints,
                     .law = meant ? NullSpaceLaw::Meant : NullSpaceLaw::Printed,
                     .damping = gains.damping,
                     .friction_gain = gains.friction_gain,
                     .damping_gain = gains.damping_gain,
                     .coulomb = meant ? o.coulomb : PerJoint{}});
  Connect(projector.null_space, impedance.null_space);
  Connect(wanted, impedance.desired);
  Connect(measured_velocity, impedance.velocity);
  const auto act = [&](const Output<JointTorque>& tau) {
    Connect(tau, whole.null_space);
    Connect(tau, null_space_torque);
  };
  if (printed || meant) {
    act(impedance.torque);
  } else if (std::holds_alternative<NoNullSpaceTorque>(o.null_space)) {
    act(Add<Constant<JointTorque>>("nothing", {.space = joints, .value = JointTorque::Zero(joints)})
            .y);
  } else {
    const auto* regressed = std::get_if<RegressedNullSpaceTorque>(&o.null_space);
    const ObservedNullSpaceTorque& of =
        regressed ? *regressed : std::get<ObservedNullSpaceTorque>(o.null_space);
    auto& reaction = Add<NullSpaceReaction>("reaction", {.joints = joints,
                                                         .null_space_gain = of.null_space_gain,
                                                         .tool_gain = of.tool_gain,
                                                         .stiffness = of.stiffness,
                                                         .posture = o.position,
                                                         .damping = of.damping});
    Connect(dynamics.dynamics, reaction.dynamics);
    Connect(tool.frame, reaction.frame);
    Connect(estimated, reaction.external_torque);
    act(reaction.torque);
  }

  Connect(dynamics.dynamics, whole.dynamics);
  Connect(estimated, whole.external);
  Connect(estimated, external_torque);
  Connect(whole.torque, torque);
  Connect(whole.torque, actuation.torque);
  Connect(whole.acceleration, actuation.acceleration);
  Connect(measured_velocity, actuation.measured_velocity);
  Connect(measured_torque, actuation.measured_torque);
  Connect(actuation.current, current);
  Connect(actuation.torque_error, torque_error);
  Connect(actuation.saturated, whole.motors);
  Connect(whole.saturated, saturated);
  Connect(whole.fallback, fallback);
  Connect(dynamics.dynamics, monitor.dynamics);
  Connect(impedance.desired_velocity, monitor.desired_velocity);
  Connect(true_torque, monitor.external_torque);
  Connect(monitor.storage, storage);
  Connect(monitor.supply, supply);
  Connect(monitor.excess, excess);
  Connect(projector.least_singular, least_singular);
}

}  // namespace pliant
