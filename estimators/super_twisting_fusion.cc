#include "pliant/estimators/super_twisting_fusion.h"

#include "pliant/estimators/super_twisting_observer.h"

namespace pliant {

namespace {

/// Adds a sensor's torque to what an observer knows, and to what it finds.
class SensorTerms final : public Block {
 public:
  struct Options {
    Joints joints;
    Duration period;
  };

  explicit SensorTerms(const Options& o)
      : torque{this, "torque", o.joints},
        sensor_torque{this, "sensor_torque", o.joints},
        observed{this, "observed", o.joints},
        sensor_valid{this, "sensor_valid", {}, true},
        known{this, "known", o.joints},
        external_torque{this, "external_torque", o.joints},
        residual{this, "residual", o.joints},
        taken_{this,
               "taken",
               o.joints,
               {JointTorque::Zero(o.joints), JointTorque::Zero(o.joints),
                JointTorque::Zero(o.joints)}},
        last_{this, "last", o.joints} {
    const PeriodicEvent tick = Every(o.period);
    tick.Compute(taken_).From(taken_, sensor_torque, sensor_valid).As(&SensorTerms::Take);
    tick.Compute(known).From(torque, taken_, last_).As(&SensorTerms::Known);
    tick.Compute(external_torque)
        .From(taken_, observed)
        .As([](const Taken& taken, const JointTorque& sigma) {
          return JointTorque(taken.s + sigma);
        });
    tick.Compute(residual)
        .From(taken_, observed)
        .As([](const Taken& taken, const JointTorque& sigma) {
          return JointTorque(sigma + taken.beyond);
        });
    tick.Update(last_).From(taken_).As([](const Taken& taken) { return taken.s; });
  }

  Input<JointTorque> torque, sensor_torque, observed;
  Input<bool> sensor_valid;
  Output<JointTorque> known, external_torque, residual;

 private:
  /// What is taken for the sensor's torque.
  struct Taken {
    using Space = Joints;
    static constexpr Quantity quantity{"sensor torque", "N·m"};

    JointTorque s;
    JointTorque offset;  ///< o
    JointTorque beyond;  ///< s − τ_s, with 0 for the τ_s of a sensor that is not valid
    bool valid = true;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("s", s, "N·m");
      f("offset", offset, "N·m");
      f("beyond", beyond, "N·m");
      f("valid", valid, "");
    }
  };

  Taken Take(const Taken& last, const JointTorque& tau_s, bool valid) const {
    if (!valid) return {last.s, last.offset, last.s, false};
    Taken now = last;
    now.valid = true;
    if (last.valid)
      now.s = tau_s - last.offset;
    else
      now.offset = tau_s - last.s;
    now.beyond = now.s - tau_s;
    return now;
  }

  JointTorque Known(const JointTorque& tau, const Taken& taken, const JointTorque& last) const {
    return tau + 0.5 * (taken.s + last);
  }

  Output<Taken> taken_;
  Discrete<JointTorque> last_;  // s_{k−1}; the observer does not read `known` at its first tick
};

}  // namespace

SuperTwistingFusion::SuperTwistingFusion(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      torque{this, "torque", o.joints},
      sensor_torque{this, "sensor_torque", o.joints},
      sensor_valid{this, "sensor_valid", {}, true},
      residual{this, "residual", o.joints},
      external_torque{this, "external_torque", o.joints} {
  auto& sensor = Add<SensorTerms>("sensor", {.joints = o.joints, .period = o.period});
  auto& observer = Add<SuperTwistingObserver>(
      "observer",
      {.joints = o.joints, .rate = o.rate, .period = o.period, .rotor_inertia = o.rotor_inertia});

  Connect(torque, sensor.torque);
  Connect(sensor_torque, sensor.sensor_torque);
  Connect(sensor_valid, sensor.sensor_valid);
  Connect(dynamics, observer.dynamics);
  Connect(sensor.known, observer.torque);
  Connect(observer.residual, sensor.observed);
  Connect(sensor.residual, residual);
  Connect(sensor.external_torque, external_torque);
}

}  // namespace pliant
