// A simulated second of an ideal Gen3 under the same law at 1 kHz: by MuJoCo and by pliant.
//
// `error_rad` is the largest error of a position in the first second against a reference at a
// relative tolerance of 1e-12. MuJoCo at a tenth of the step shows how much of its error is not the
// step's but what the models differ by.

#include <benchmark/benchmark.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <cstring>
#include <memory>
#include <numbers>
#include <sstream>

#include "pliant/diagrams/stations.h"
#include "pliant/diagrams/sway_loop.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

constexpr int kTicks = 1000;  // of a second

const JointPosition kHome{0, 0.2618, std::numbers::pi, -2.2689, 0, 0.9599, std::numbers::pi / 2};

SimulatedArm::Options Gen3(SimbodyPlant::Engine engine) {
  return SimulatedGen3(RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf")),
                       {.position = kHome, .ideal = true, .engine = engine});
}

/// Positions at the end of each tick of the first second: a column for each.
using Trace = Eigen::MatrixXd;

const Trace& Reference() {
  static const Trace reference = [] {
    const SwayLoop loop({.arm = Gen3(SimbodyPlant::Engine::Recursive)});
    Simulator sim(loop.diagram, {.integrator = {.method = Method::kDormandPrince,
                                                .relative_tolerance = 1e-12,
                                                .absolute_tolerance = 1e-14}});
    Trace trace(kHome.size(), kTicks);
    for (int k = 0; k < kTicks; ++k) {
      sim.AdvanceTo(1e-3 * (k + 1));
      trace.col(k) = sim.Get(loop.arm->position);
    }
    return trace;
  }();
  return reference;
}

std::string Mjcf(const RobotModel& model, const PerJoint& rotors, double step_s) {
  std::ostringstream xml;
  xml.precision(17);
  const Eigen::IOFormat row(17, Eigen::DontAlignCols, " ", " ");
  xml << "<mujoco><compiler angle='radian' inertiafromgeom='false'/><option timestep='" << step_s
      << "' integrator='RK4' gravity='" << model.gravity().format(row)
      << "'><flag constraint='disable'/></option><worldbody>";
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {  // a chain: each inside the one before
    const Body& body = model.bodies()[b];
    const Eigen::Quaterniond turn(body.pose.rotation);
    const Eigen::Vector3d c = body.moment / body.mass;
    const Eigen::Matrix3d steiner =
        body.mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
    const Eigen::Matrix3d I = body.inertia - steiner;
    xml << "<body pos='" << body.pose.position.format(row) << "' quat='" << turn.w() << " "
        << turn.vec().format(row) << "'><joint axis='0 0 1' armature='"
        << rotors(static_cast<Eigen::Index>(b)) << "'/><inertial mass='" << body.mass << "' pos='"
        << c.format(row) << "' fullinertia='" << I(0, 0) << " " << I(1, 1) << " " << I(2, 2) << " "
        << I(0, 1) << " " << I(0, 2) << " " << I(1, 2) << "'/>";
  }
  for (std::size_t b = 0; b < model.bodies().size(); ++b) xml << "</body>";
  xml << "</worldbody></mujoco>";
  return xml.str();
}

/// The arm in MuJoCo under the law of SwayLoop.
class MujocoLoop {
 public:
  explicit MujocoLoop(int steps_per_tick)
      : steps_{steps_per_tick},
        arm_{Gen3(SimbodyPlant::Engine::Recursive)},
        rotors_{arm_.actuators.reflected_inertia()},
        dynamics_{arm_.model},
        model_{Load(Mjcf(arm_.model, rotors_, 1e-3 / steps_per_tick)), mj_deleteModel},
        data_{mj_makeData(model_.get()), mj_deleteData} {
    std::copy(kHome.begin(), kHome.end(), data_->qpos);
  }

  void Tick() {
    const JointPosition q = position();
    JointVelocity v;
    v = Eigen::Map<const Eigen::VectorXd>(data_->qvel, kHome.size());
    ComputeDynamics(arm_.model, q, v, dynamics_);
    dynamics_.M.diagonal() += rotors_;
    const JointTorque torque =
        InverseDynamics(dynamics_, SwayAcceleration(1e-3 * tick_++, kHome, dynamics_));
    std::copy(torque.begin(), torque.end(), data_->qfrc_applied);
    for (int k = 0; k < steps_; ++k) mj_step(model_.get(), data_.get());
  }

  JointPosition position() const {
    JointPosition q;
    q = Eigen::Map<const Eigen::VectorXd>(data_->qpos, kHome.size());
    return q;
  }

 private:
  static mjModel* Load(const std::string& xml) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "arm.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[mj_findFileVFS(files.get(), "arm.xml")], xml.data(), xml.size());
    char message[1000] = "";
    mjModel* const model = mj_loadXML("arm.xml", files.get(), message, sizeof message);
    mj_deleteVFS(files.get());
    if (model == nullptr) throw Error(std::string("MuJoCo: ") + message);
    return model;
  }

  const int steps_;
  const SimulatedArm::Options arm_;
  const PerJoint rotors_;
  RobotDynamics dynamics_;
  const std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_;
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data_;
  int tick_ = 0;
};

void Mujoco(benchmark::State& state, int steps_per_tick) {
  MujocoLoop compared(steps_per_tick);
  double error = 0;
  for (int k = 0; k < kTicks; ++k) {
    compared.Tick();
    error = std::max(error, (compared.position() - Reference().col(k)).cwiseAbs().maxCoeff());
  }
  MujocoLoop loop(steps_per_tick);
  for (auto _ : state)
    for (int k = 0; k < kTicks; ++k) loop.Tick();
  state.counters["error_rad"] = error;
  state.counters["rhs_per_tick"] = 4 * steps_per_tick;
}

void Pliant(benchmark::State& state, SimbodyPlant::Engine engine) {
  const SwayLoop loop({.arm = Gen3(engine)});
  Simulator compared(loop.diagram);
  double error = 0;
  for (int k = 0; k < kTicks; ++k) {
    compared.AdvanceTo(1e-3 * (k + 1));
    error = std::max(error,
                     (compared.Get(loop.arm->position) - Reference().col(k)).cwiseAbs().maxCoeff());
  }
  Simulator sim(loop.diagram);
  for (auto _ : state) sim.AdvanceTo(sim.time() + 1);
  state.counters["error_rad"] = error;
  state.counters["rhs_per_tick"] =
      static_cast<double>(sim.statistics().derivative_calls) / (kTicks * sim.time());
}

using Engine = SimbodyPlant::Engine;
BENCHMARK_CAPTURE(Mujoco, rk4_1ms, 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Mujoco, rk4_100us, 10)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Pliant, recursive, Engine::Recursive)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Pliant, simbody, Engine::Simbody)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pliant
