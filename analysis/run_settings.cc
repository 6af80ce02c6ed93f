#include "pliant/analysis/run_settings.h"

#include <map>
#include <string>
#include <utility>
#include <variant>

#include "pliant/plants/parameter_text.h"

namespace pliant {

namespace {

/// Empty: 0.
template <class Matrix>
std::string MatrixText(const Matrix& m) {
  return m.size() == 0 ? "0" : internal::LineOf(m);
}

std::string LimitsOf(const ComplianceControl::Options& c) {
  const JointDamper::Options& d = c.damper;
  std::string limits =
      d.form == JointDamper::Form::Classical
          ? "torque, and classical dampers with δt = " + d.step.text()
          : "torque, and dampers with λ = " + Text(d.rate) + " 1/s, M = " + Text(d.damping_ratio);
  limits += ", d_s = " + Text(100 * d.safety_distance) + " % of the range, " +
            Text(100 * d.velocity_fraction) + " % of the velocity limits";
  if (c.collisions) limits += "; collisions";
  if (!c.workspace.empty()) limits += "; workspace";
  if (c.speed_limit) limits += "; speed of " + c.speed_limit->frame;
  if (c.force_limit) limits += "; force at the wrist " + Text(c.force_limit->force) + " N";
  return limits;
}

std::string EstimatorOf(const ComplianceControl::Options& c) {
  const std::string gain = "K_I = " + Text(c.observer_gain) + " 1/s";
  const std::string rate = "L = " + Text(c.observer_rate) + " N·m/s";
  switch (c.estimate) {
    case TorqueEstimate::True:
      return "none: external torques are known";
    case TorqueEstimate::Observer:
      return "momentum observer, " + gain;
    case TorqueEstimate::SuperTwisting:
      return "super-twisting observer, " + rate;
    case TorqueEstimate::Fusion:
      return "momentum observer and wrist sensor, complementary, " + gain;
    case TorqueEstimate::SuperTwistingFusion:
      return "wrist sensor and super-twisting observer, " + rate;
    case TorqueEstimate::Sensor:
      return "wrist sensor";
    case TorqueEstimate::Zero:
      break;
  }
  return "none: external torques are taken for 0";
}

std::string ContactsOf(const ContactSettings& c) {
  const auto text = [](const TaskMatrix& given, const std::string& unit) {
    return given.size() == 0 ? std::string("natural")
                             : MatrixText(given) + (unit.empty() ? "" : " " + unit);
  };
  if (const auto* impedance = std::get_if<ContactImpedance::Gains>(&c.behavior))
    return "impedance at contacts: M_d " + text(impedance->inertia, "kg") + ", K_d " +
           text(impedance->damping, "N·s/m") + ", K_p " + text(impedance->stiffness, "N/m");
  const auto& force = std::get<ContactForceControl::Settings>(c.behavior);
  return "force control at contacts: M_d " + text(force.inertia, "kg") + ", K_d " +
         text(force.damping, "N·s/m") + ", K_f " + text(force.force_gain, "") + "; guard " +
         Text(force.speed_limit) + " m/s, " + Text(force.way_limit) + " m";
}

/// What a kind of controller has to say of itself, under the same names for all kinds.
std::vector<Setting> SettingsOf(const ComplianceControl::Options& c) {
  const auto gains = [](const auto& g) {
    const auto text = [](const auto& x) {
      if constexpr (requires { x.size(); })
        return MatrixText(x);
      else
        return Text(x);
    };
    return text(g.stiffness) + " 1/s², " + text(g.damping) + " 1/s, weight " + Text(g.weight);
  };
  return {{"controller",
           "one QP at " + c.period.text() + ": pose of " + c.tool + " " + gains(c.pose) +
               "; posture " + gains(c.posture) +
               (c.contacts ? "; " + ContactsOf(*c.contacts) + ", weight " + Text(c.contact_weight)
                           : "")},
          {"limits", LimitsOf(c)},
          {"estimator", EstimatorOf(c)},
          {"compliance", c.modes ? "as the modes say"
                                 : "Γ = " + MatrixText(c.pose.compliance) + " of the pose, " +
                                       MatrixText(c.posture.compliance) + " of the posture"}};
}

std::vector<Setting> SettingsOf(const FrictionExperiment::Options& c) {
  const FrictionTest& t = c.test;
  return {{"controller", "friction test at " + c.period.text() + ": " + Text(t.break_aways) +
                             " ramps each way, " + Text(t.speeds) + " speeds up to " +
                             Text(100 * t.speed) + " % of the limits, each " + Text(t.settle_s) +
                             " s to settle and " + Text(t.dwell_s) + " s to measure"},
          {"limits", Text(100 * t.velocity_limit) + " % of the velocity limits; " +
                         Text(t.position_tolerance) + " rad off the reference or beyond " +
                         Text(100 * t.range) + " % of the way to a position limit; " +
                         Text(t.temperature_limit) + " °C; " + Text(t.joint_time_limit_s) +
                         " s for a joint"},
          {"estimator", "none"},
          {"compliance", "none"}};
}

std::string MotionOf(const ToolMotionChoice& choice) {
  if (const auto* o = std::get_if<CircleGenerator::Options>(&choice))
    return "round a circle of " + Text(o->radius) + " m at " + Text(o->angular_velocity) +
           " rad/s, k_ρ = " + Text(o->radial_gain) + " 1/s, k_P = " + Text(o->height_gain) +
           " 1/s, k_D = " + Text(o->height_damping);
  if (const auto* o = std::get_if<LimitCycleGenerator::Options>(&choice))
    return "round a curve of " + Text(o->radius) + " m and " + Text(o->harmonics.size()) +
           " harmonics at " + Text(o->angular_velocity) + " rad/s, k_ρ = " + Text(o->radial_gain) +
           " 1/s, k_P = " + Text(o->height_gain) + " 1/s, k_D = " + Text(o->height_damping);
  if (const auto* o = std::get_if<GoalGenerator::Options>(&choice))
    return "to a point with at most " + Text(o->speed) + " m/s, A = " + MatrixText(o->gain) +
           " 1/s";
  const auto& o = std::get<ClassicalMotion>(choice);
  return "by impedance about a point on a circle, " + Text(o.circle.speed) +
         " rad/s, K_c = " + Text(o.stiffness.transpose()) + " N/m";
}

std::string NullSpaceTorqueOf(const NullSpaceChoice& choice) {
  const auto impedance = [](const std::string& name, const PrintedNullSpaceTorque& o) {
    return name + ", d_n = " + Text(o.damping) + ", α_f = " + Text(o.friction_gain) +
           ", α_d = " + Text(o.damping_gain);
  };
  const auto reaction = [](const ObservedNullSpaceTorque& o) {
    return "k_n = " + Text(o.null_space_gain) + ", k_t = " + Text(o.tool_gain) +
           ", K_n = " + Text(o.stiffness) + " N·m/rad, D_n = " + Text(o.damping);
  };
  if (const auto* o = std::get_if<PrintedNullSpaceTorque>(&choice))
    return impedance("impedance as printed", *o);
  if (const auto* o = std::get_if<MeantNullSpaceTorque>(&choice))
    return impedance("impedance as meant", *o);
  if (const auto* o = std::get_if<ObservedNullSpaceTorque>(&choice))
    return "reaction to the momentum observer, " + reaction(*o);
  if (const auto* o = std::get_if<RegressedNullSpaceTorque>(&choice))
    return "reaction to least squares, " + reaction(*o);
  return "no torque";
}

std::vector<Setting> SettingsOf(const NullSpaceControl::Options& c) {
  const auto* regression = std::get_if<RegressedNullSpaceTorque>(&c.null_space);
  return {{"controller",
           c.tool + " at " + c.period.text() + ", from " + Text(c.start_s) + " s " +
               MotionOf(c.motion) + "; D = " + Text(c.damping.transpose()) + " N·s/m, k_p = " +
               Text(c.tracking.gain) + ", k_d = " + Text(c.tracking.rate_gain_s) +
               " s; K_ω = " + Text(c.orientation.stiffness.transpose()) +
               " N·m/rad, D_ω = " + Text(c.orientation.damping.transpose()) + " N·m·s/rad"},
          {"limits", "torques of the model"},
          {"estimator", regression
                            ? "least squares that forget, T = " + Text(regression->memory_s) +
                                  " s, r₀ = " + Text(regression->prior) +
                                  (regression->at ? ", of a force at " + regression->at->link : "")
                            : "momentum observer, K_I = " + Text(c.observer_gain) + " 1/s"},
          {"compliance", "null space: " + NullSpaceTorqueOf(c.null_space)}};
}

std::string DetectionOf(const ContactSettings& c) {
  return "its offset taken from " + Text(c.tare_from_s) + " s to " + Text(c.tare_until_s) +
         " s; contact above " + MatrixText(c.threshold) + " N·m";
}

std::vector<Setting> SettingsOf(const ContactControl::Options& c) {
  return {{"controller", c.period.text() + ", " + ContactsOf(c.contact)},
          {"limits", "torques of the joints"},
          {"estimator",
           "momentum observer, K_I = " + Text(c.observer_gain) + " 1/s, " + DetectionOf(c.contact)},
          {"compliance", "none"}};
}

/// What makes currents of torques.
std::string LoopOf(const ArmController& controller) {
  return std::visit(
      [](const auto& c) -> std::string {
        if constexpr (requires { c.torque_loop; })
          return c.low_level ? ", " + TorqueLoopText(c.torque_loop) : "";
        else
          return "";
      },
      controller);
}

std::string PlantOf(const Scenario& scenario) {
  return std::visit(
      [](const auto& station) -> std::string {
        if constexpr (requires { station.engine; })
          return WordOf(station.engine);
        else
          return "the arm at " + station.address;
      },
      scenario.station);
}

std::vector<Setting> SettingsOfRun(const RunData& run) {
  const Scenario& s = run.scenario;
  const auto rotors = std::visit([](const auto& c) { return c.rotor_inertia; }, run.control);
  std::vector<Setting> settings{
      {"robot", run.arm.model.name() +
                    (IsHardware(s) ? ", on the arm" + LoopOf(run.control)
                     : IsIdeal(s)  ? ", ideal torque actuators and sensors"
                                  : ", elastic gears with friction, sensors with noise and offsets "
                                    "(seed " +
                                        Text(s.seed) + ")" + LoopOf(run.control))},
      {"rotor inertia", Text(rotors.transpose()) + " kg·m², reflected"},
      {"plant", PlantOf(s)}};
  for (Setting& setting : std::visit([](const auto& c) { return SettingsOf(c); }, run.control))
    settings.push_back(std::move(setting));
  for (Setting& setting : std::vector<Setting>{
           {"integrator", std::string(Name(s.integrator.method)) + ", tolerances " +
                              Text(s.integrator.relative_tolerance) + " relative, " +
                              Text(s.integrator.absolute_tolerance) + " absolute"},
           {"duration",
            Text(s.duration_s) + " s, a row of the log each " + run.sample_period().text()},
           {"version", "pliant " + run.version + "; " + run.built_with}})
    settings.push_back(std::move(setting));
  return settings;
}

}  // namespace

std::vector<Setting> RunSettings(const Runs& runs) {
  std::vector<Setting> settings = SettingsOfRun(*runs.all().front());
  for (std::size_t i = 0; i < settings.size(); ++i) {
    std::map<std::string, std::string> titles;  // by value
    for (const RunData* run : runs.all()) {
      std::string& with = titles[SettingsOfRun(*run)[i].value];
      with += (with.empty() ? "" : "; ") + run->title;
    }
    if (titles.size() == 1) continue;
    settings[i].value.clear();
    for (const auto& [value, of] : titles)
      settings[i].value += (settings[i].value.empty() ? "" : " / ") + value + " (" + of + ")";
  }
  return settings;
}

}  // namespace pliant
