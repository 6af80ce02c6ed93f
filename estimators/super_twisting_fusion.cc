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
        residual{this, "residual", o.joints},
        known{this, "known", o.joints},
        external_torque{this, "external_torque", o.joints},
        last_{this, "last", o.joints} {
    const PeriodicEvent tick = Every(o.period);
    tick.Compute(known).From(torque, sensor_torque, last_).As(&SensorTerms::Known);
    tick.Compute(external_torque)
        .From(sensor_torque, residual)
        .As([](const JointTorque& tau_s, const JointTorque& sigma) {
          return JointTorque(tau_s + sigma);
        });
    tick.Update(last_).From(sensor_torque).As([](const JointTorque& tau_s) { return tau_s; });
  }

  Input<JointTorque> torque, sensor_torque, residual;
  Output<JointTorque> known, external_torque;

 private:
  JointTorque Known(const JointTorque& tau, const JointTorque& tau_s,
                    const JointTorque& last) const {
    return tau + 0.5 * (tau_s + last);
  }

  Discrete<JointTorque> last_;  // τ_s,k−1; the observer does not read `known` at its first tick
};

}  // namespace

SuperTwistingFusion::SuperTwistingFusion(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      torque{this, "torque", o.joints},
      sensor_torque{this, "sensor_torque", o.joints},
      residual{this, "residual", o.joints},
      external_torque{this, "external_torque", o.joints} {
  auto& sensor = Add<SensorTerms>("sensor", {.joints = o.joints, .period = o.period});
  auto& observer = Add<SuperTwistingObserver>(
      "observer",
      {.joints = o.joints, .rate = o.rate, .period = o.period, .rotor_inertia = o.rotor_inertia});

  Connect(torque, sensor.torque);
  Connect(sensor_torque, sensor.sensor_torque);
  Connect(dynamics, observer.dynamics);
  Connect(sensor.known, observer.torque);
  Connect(observer.residual, sensor.residual);
  Connect(observer.residual, residual);
  Connect(sensor.external_torque, external_torque);
}

}  // namespace pliant
