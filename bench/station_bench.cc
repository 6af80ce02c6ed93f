// What a simulated second costs: a Gen3 in a closed loop with a joint-space controller at 1 kHz.

#include <benchmark/benchmark.h>

#include <numbers>

#include "pliant/diagrams/stations.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

const JointPosition kHome{0, 0.2618, std::numbers::pi, -2.2689, 0, 0.9599, std::numbers::pi / 2};

/// Follows a sway of 0.1 rad about home: τ = (M + diag(B)) (q̈_d + 40 ė + 400 e) + C v + g.
class SwayController final : public Block {
 public:
  struct Options {
    Joints joints;
  };

  explicit SwayController(const Options& o)
      : dynamics{this, "dynamics", o.joints},
        torque{this, "torque", o.joints},
        acceleration{this, "acceleration", o.joints} {
    Every(1ms).Compute(acceleration).From(clock, dynamics).As(&SwayController::Want);
    Compute(torque).From(dynamics, acceleration).As(&InverseDynamics);
  }

  Input<RobotDynamics> dynamics;
  Output<JointTorque> torque;
  Output<JointAcceleration> acceleration;

 private:
  JointAcceleration Want(double t, const RobotDynamics& d) const {
    const PerJoint phase = PerJoint::LinSpaced(d.q.size(), 0, 3).array() + 2 * t;
    const PerJoint q = kHome.array() + 0.1 * phase.array().sin();
    const PerJoint v = 0.2 * phase.array().cos();
    const PerJoint a = -0.4 * phase.array().sin();
    return a + 40 * (v - d.v) + 400 * (q - d.q);
  }
};

struct Loop {
  explicit Loop(const SimulatedArm::Options& station) {
    DiagramBuilder b;
    arm = &b.Add<SimulatedArm>("arm", station);
    auto& dynamics = b.Add<ModelDynamics>(
        "dynamics",
        {.model = station.model, .rotor_inertia = station.actuators.reflected_inertia()});
    auto& law = b.Add<SwayController>("law", {.joints = station.model.joints()});
    b.Connect(arm->measured_position, dynamics.position);
    b.Connect(arm->measured_velocity, dynamics.velocity);
    b.Connect(dynamics.dynamics, law.dynamics);
    if (station.actuators.friction == FrictionLaw::None) {
      b.Connect(law.torque, arm->torque_command);
    } else {
      auto& low_level = b.Add<LowLevelTorque>(
          "low_level", LowLevelTorqueOf(station.actuators, station.model, station.period));
      b.Connect(law.torque, low_level.torque);
      b.Connect(law.acceleration, low_level.acceleration);
      b.Connect(arm->measured_velocity, low_level.measured_velocity);
      b.Connect(arm->measured_torque, low_level.measured_torque);
      b.Connect(low_level.current, arm->current_command);
    }
    diagram.emplace(b.Build());
  }

  SimulatedArm* arm;
  std::optional<Diagram> diagram;
};

void Second(benchmark::State& state, bool ideal, SimbodyPlant::Engine engine, Method method) {
  const RobotModel model = RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/gen3/gen3_7dof.urdf");
  SimulatedArm::Options station =
      SimulatedGen3(model, {.position = kHome, .ideal = ideal, .engine = engine});
  if (!ideal) station.firmware.mode = ControlMode::Current;
  const Loop loop(station);
  Simulator sim(*loop.diagram, {.integrator = {.method = method,
                                               .absolute_tolerance =
                                                   getenv("ATOL") ? atof(getenv("ATOL")) : 1e-8}});
  sim.AdvanceTo(0.5);  // the gears have settled
  const std::int64_t before = sim.statistics().derivative_calls;
  const double start = sim.time();
  for (auto _ : state) sim.AdvanceTo(sim.time() + 1);
  const double ticks = 1000 * (sim.time() - start);
  state.counters["rhs_per_tick"] =
      static_cast<double>(sim.statistics().derivative_calls - before) / ticks;
}

using Engine = SimbodyPlant::Engine;
#define PLIANT_SECOND(name, ideal, engine, method)                       \
  BENCHMARK_CAPTURE(Second, name, ideal, Engine::engine, Method::method) \
      ->Unit(benchmark::kMillisecond)
PLIANT_SECOND(ideal / recursive, true, Recursive, kBogackiShampine);
PLIANT_SECOND(ideal / simbody, true, Simbody, kBogackiShampine);
PLIANT_SECOND(full / recursive, false, Recursive, kBogackiShampine);
PLIANT_SECOND(full / simbody, false, Simbody, kBogackiShampine);
PLIANT_SECOND(full / recursive / zonneveld, false, Recursive, kZonneveld);
PLIANT_SECOND(full / recursive / dormand_prince, false, Recursive, kDormandPrince);
PLIANT_SECOND(full / recursive / sdirk, false, Recursive, kSdirk);
PLIANT_SECOND(full / recursive / adams, false, Recursive, kAdams);
PLIANT_SECOND(full / recursive / bdf, false, Recursive, kBdf);

}  // namespace
}  // namespace pliant
