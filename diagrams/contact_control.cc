#include "pliant/diagrams/contact_control.h"

#include "pliant/estimators/momentum_observer.h"
#include "pliant/plants/model_dynamics.h"

namespace pliant {

ContactControl::ContactControl(const Options& o)
    : measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      contacts{this, "contacts"},
      torque{this, "torque", o.model.joints()},
      current{this, "current", o.model.joints()},
      torque_error{this, "torque_error", o.model.joints()},
      saturated{this, "saturated"},
      acceleration{this, "acceleration", o.model.joints()},
      report{this, "report"} {
  const Joints& joints = o.model.joints();
  o.model.link_index(o.tool);  // throws Error if there is none

  auto& dynamics =
      Add<ModelDynamics>("dynamics", {.model = o.model, .rotor_inertia = o.rotor_inertia});
  auto& observer = Add<MomentumObserver>(
      "observer", {.joints = joints,
                   .gain = PerJoint::Constant(o.model.size(), o.observer_gain),
                   .period = o.period,
                   .rotor_inertia = o.rotor_inertia});
  auto& tasks =
      Add<ContactTasks>("tasks", {.model = o.model, .period = o.period, .settings = o.contact});
  auto& law = Add<ContactLaw>(
      "law", {.model = o.model, .period = o.period, .posture = o.position, .settings = o.rest});
  auto& actuation = Add<TorqueActuation>("actuation", {.joints = joints,
                                                       .rotor_inertia = o.rotor_inertia,
                                                       .motors = o.low_level,
                                                       .loop = o.torque_loop});

  Connect(measured_position, dynamics.position);
  Connect(measured_velocity, dynamics.velocity);
  Connect(dynamics.dynamics, observer.dynamics);
  Connect(measured_torque, observer.torque);
  Connect(dynamics.dynamics, tasks.dynamics);
  Connect(observer.residual, tasks.raw_residual);
  Connect(contacts, tasks.forces);
  if (tasks.image) {
    image.emplace(this, "image");
    Connect(*image, *tasks.image);
  }
  Connect(dynamics.dynamics, law.dynamics);
  Connect(tasks.acting, law.contacts);
  for (const Output<Objective>& objective : tasks.objectives) Connect(objective, law.objectives);
  contact_tasks = &tasks;

  Connect(law.report, report);
  Connect(law.acceleration, acceleration);
  Connect(law.torque, torque);
  Connect(law.torque, actuation.torque);
  Connect(law.acceleration, actuation.acceleration);
  Connect(measured_velocity, actuation.measured_velocity);
  Connect(measured_torque, actuation.measured_torque);
  Connect(actuation.current, current);
  Connect(actuation.torque_error, torque_error);
  Connect(actuation.saturated, saturated);
}

}  // namespace pliant
