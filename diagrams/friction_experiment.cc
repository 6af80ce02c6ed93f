#include "pliant/diagrams/friction_experiment.h"

#include "pliant/plants/model_dynamics.h"

namespace pliant {

namespace {

FrictionExcitation::Options ExcitationOf(const FrictionExperiment::Options& o) {
  return {.model = o.model,
          .start = o.position,
          .torque_per_ampere = o.torque_per_ampere,
          .coulomb = o.coulomb,
          .viscous = o.viscous,
          .test = o.test,
          .period = o.period};
}

}  // namespace

double FrictionExperiment::LengthOf(const Options& o) {
  return FrictionExcitation::LengthOf(ExcitationOf(o));
}

FrictionExperiment::FrictionExperiment(const Options& o)
    : measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      temperature{this, "temperature", o.model.joints(), JointTemperature::Zero(o.model.joints())},
      current{this, "current", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      reference{this, "reference", o.model.joints()},
      break_away_up{this, "break_away_up", o.model.joints()},
      break_away_down{this, "break_away_down", o.model.joints()},
      report{this, "report"} {
  auto& dynamics =
      Add<ModelDynamics>("dynamics", {.model = o.model, .rotor_inertia = o.rotor_inertia});
  auto& excitation = Add<FrictionExcitation>("excitation", ExcitationOf(o));

  Connect(measured_position, dynamics.position);
  Connect(measured_velocity, dynamics.velocity);
  Connect(measured_position, excitation.position);
  Connect(measured_velocity, excitation.velocity);
  Connect(measured_torque, excitation.torque);
  Connect(temperature, excitation.temperature);
  Connect(dynamics.dynamics, excitation.dynamics);
  Connect(excitation.current, current);
  Connect(excitation.motor_torque, torque);
  Connect(excitation.reference, reference);
  Connect(excitation.break_away_up, break_away_up);
  Connect(excitation.break_away_down, break_away_down);
  Connect(excitation.report, report);
}

}  // namespace pliant
