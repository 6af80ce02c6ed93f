// What the compliance controller of Celerier et al. 2025 (EC) costs a tick, whole and in parts, and
// how that grows: with joints, tasks, and pairs that are kept apart.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "pliant/controllers/external_acceleration.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/diagrams/compliance_control.h"
#include "pliant/estimators/complementary_fusion.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/estimators/wrist_torque.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/allocations.h"

namespace pliant {
namespace {

constexpr int kTicks = 2000;  // at 1 kHz, two periods of the sway
constexpr int kRuns = 15;     // the rarest slow ticks need many to meet a quiet machine

double Percentile(std::vector<double> values, double part) {
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

/// Runs kTicks kRuns times over: `prepare(k)`, and `run()` against the clock. Counters, of the
/// fastest run of each tick: median_ns, p999_ns; of all runs: median_all_ns, p999_all_ns; heap
/// allocations in all of them together.
void Clock(benchmark::State& state, const std::function<void(int)>& prepare,
           const std::function<void()>& run) {
  using Time = std::chrono::steady_clock;
  const auto once = [](const auto& f) {
    const Time::time_point start = Time::now();
    f();
    return std::chrono::duration<double, std::nano>(Time::now() - start).count();
  };
  std::vector<double> best(kTicks, 1e18), all;
  all.reserve(kTicks * kRuns);
  double clock = 1e18;
  const std::function<void()> nothing = [] {};
  for (int k = 0; k < kTicks; ++k) clock = std::min(clock, once(nothing));
  for (auto _ : state) {
    long allocations = 0;
    for (int i = 0; i <= kRuns; ++i) {
      for (int k = 0; k < kTicks; ++k) {
        prepare(k);
        const long before = Allocations();
        const double ns = once(run) - clock;
        if (i == 0) continue;  // a run to warm up and to settle
        allocations += Allocations() - before;
        best[static_cast<std::size_t>(k)] = std::min(best[static_cast<std::size_t>(k)], ns);
        all.push_back(ns);
      }
    }
    state.counters["allocations"] = static_cast<double>(allocations);
  }
  state.counters["median_ns"] = Percentile(best, 0.5);
  state.counters["p999_ns"] = Percentile(best, 0.999);
  state.counters["median_all_ns"] = Percentile(all, 0.5);
  state.counters["p999_all_ns"] = Percentile(all, 0.999);
}

// --- the arm, and how it sways ---

std::string TextOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

RobotModel Gen3() { return RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/gen3/gen3_7dof.urdf"); }
RobotModel Gen3WithSensor() {
  return RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/gen3/gen3_7dof_bota.urdf");
}

/// Gen3 side by side on one base; their links and joints begin with a_, b_, …
RobotModel Gen3Tree(int arms) {
  std::string text = TextOf(PLIANT_SOURCE_DIR "/models/gen3/gen3_7dof.urdf");
  const std::size_t first = text.find("<link"), last = text.find("</robot>");
  const std::string materials = text.substr(text.find("<material"), first - text.find("<material"));
  const std::string arm = text.substr(first, last - first);
  text = "<robot name=\"gen3_tree\">" + materials + "<link name=\"base\"/>";
  for (int i = 0; i < arms; ++i) {
    const std::string prefix = std::string(1, static_cast<char>('a' + i)) + "_";
    text += std::regex_replace(arm, std::regex("(<(link|joint) name|(parent|child) link)=\""),
                               "$1=\"" + prefix);
    text += "<joint name=\"" + prefix +
            "stand\" type=\"fixed\"><parent link=\"base\"/><child link=\"" + prefix +
            "base_link\"/><origin xyz=\"0 " + std::to_string(i) + " 0\"/></joint>";
  }
  return RobotModel::FromUrdfText(text + "</robot>");
}

JointPosition Posture(const RobotModel& m) {
  const JointPosition home{0, 0.2618, std::numbers::pi, -2.2689, 0, 0.9599, std::numbers::pi / 2};
  JointPosition q = JointPosition::Zero(m.joints());
  for (int i = 0; i < q.size(); ++i) q(i) = home(i % 7);
  return q;
}

/// What sensors say of an arm that sways by 0.1 rad at 1 Hz, pushed now and then.
struct Measured {
  JointPosition q;
  JointVelocity v;
  JointTorque tau;
  Wrench wrench;
};
std::vector<Measured> Sway(const RobotModel& m) {
  std::vector<Measured> all;
  RobotDynamics d(m);
  for (int k = 0; k < kTicks; ++k) {
    Measured now{Posture(m), JointVelocity::Zero(m.joints()), JointTorque::Zero(m.joints()),
                 Wrench()};
    const double t = 1e-3 * k, w = 2 * std::numbers::pi;
    for (int i = 0; i < m.size(); ++i) {
      now.q(i) += 0.1 * std::sin(w * t + i);
      now.v(i) = 0.1 * w * std::cos(w * t + i);
    }
    ComputeDynamics(m, now.q, now.v, d);
    now.tau = d.gravity + d.coriolis;
    now.tau(1) += 3 * std::sin(3 * w * t);
    now.wrench.tail<3>() << 10 * std::sin(2 * w * t), 0, -5;
    all.push_back(now);
  }
  return all;
}

const Measured& At(const std::vector<Measured>& all, int k) {
  return all[static_cast<std::size_t>(k) % all.size()];
}

std::vector<RobotDynamics> SwayDynamics(const RobotModel& m) {
  const std::vector<Measured> sway = Sway(m);
  std::vector<RobotDynamics> all;
  for (int k = 0; k < 100; ++k) {
    const Measured& now = At(sway, 10 * k);
    RobotDynamics d(m);
    ComputeDynamics(m, now.q, now.v, d);
    all.push_back(d);
  }
  return all;
}

// --- limits ---

/// `count` capsules about the forearm, five of them 10 cm away, the others 2 m.
CollisionDamper::Options Capsules(const RobotModel& m, int count) {
  CollisionDamper::Options o{.model = m};
  std::vector<std::string> all, others;
  for (const Link& link : m.links()) {
    all.push_back(link.name);
    if (link.name != "forearm_link") others.push_back(link.name);
  }
  o.pairs.ignore = {{all, all}};
  for (int i = 0; i < count; ++i) {
    const double angle = 0.7 * i, away = i < 5 ? 0.2 : 2;
    const Eigen::Vector3d center{0.25 + away * std::cos(angle), away * std::sin(angle), 0.55};
    o.obstacles.push_back(CapsuleObstacle{.name = "capsule_" + std::to_string(i),
                                          .a = center - Eigen::Vector3d(0, 0, 0.1),
                                          .b = center + Eigen::Vector3d(0, 0, 0.1),
                                          .radius = 0.04,
                                          .except = others});
  }
  return o;
}

/// Ten pairs: six of the arm itself, two boxes and two capsules beside the forearm.
CollisionDamper::Options TenPairs(const RobotModel& m) {
  CollisionDamper::Options o = Capsules(m, 4);
  o.pairs = {.watch = {{{"base_link", "shoulder_link"},
                        {"spherical_wrist_1_link", "spherical_wrist_2_link", "bracelet_link"}}}};
  for (std::size_t i = 0; i < 2; ++i) {
    const CapsuleObstacle capsule = std::get<CapsuleObstacle>(o.obstacles[i]);
    o.obstacles[i] = BoxObstacle{.name = capsule.name,
                                 .center = (capsule.a + capsule.b) / 2,
                                 .size = {0.1, 0.1, 0.3},
                                 .except = capsule.except};
  }
  return o;
}

WorkspacePlanes::Options Planes(const RobotModel& m, const std::string& frame) {
  return {.model = m,
          .frame = frame,
          .planes = {{.normal = {0, 0, 1}, .point = {0, 0, -0.5}},
                     {.normal = {-1, 0, 0}, .point = {1.5, 0, 0}},
                     {.normal = {0, 1, 0}, .point = {0, -1, 0}}}};
}

FrameSpeedLimit::Options Speed(const RobotModel& m, const std::string& frame) {
  return {.model = m, .frame = frame, .linear = 1.5, .angular = 3};
}

// --- whole ticks ---

FrameTask::Options PoseTask(const RobotModel& m, const std::string& frame) {
  RobotDynamics at(m, {frame});
  ComputeDynamics(m, Posture(m), JointVelocity::Zero(m.joints()), at);
  return {.model = m,
          .frame = frame,
          .target = at.frame[0].pose,
          .stiffness = TaskVector::Constant(6, 400),
          .damping = TaskVector::Constant(6, 40),
          .weight = 1e4};
}

PostureTask::Options Rest(const RobotModel& m) {
  return {.model = m,
          .target = Posture(m),
          .stiffness = PerJoint::Zero(m.size()),
          .damping = PerJoint::Constant(m.size(), 5)};
}

/// Poses, a posture, the limits of the joints and torques, and capsules if there are any: no
/// estimate, no compliance.
///
///   q, v ─▶ dynamics ─▶ pose tasks, posture task, damper ─▶ qp ─▶ torque
struct Common {
  Common(const RobotModel& m, const std::vector<std::string>& tools, int pairs = 0)
      : sway{Sway(m)} {
    auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = m});
    auto& posture = b.Add<PostureTask>("posture", Rest(m));
    auto& damper = b.Add<JointDamper>("damper", {.model = m});
    qp = &b.Add<ComplianceQp>("qp", {.model = m, .period = 1ms, .rows = pairs});
    q = &b.Add<Constant<JointPosition>>("q", {.space = m.joints(), .value = Posture(m)});
    v = &b.Add<Constant<JointVelocity>>(
        "v", {.space = m.joints(), .value = JointVelocity::Zero(m.joints())});
    b.Connect(q->y, dynamics.position);
    b.Connect(v->y, dynamics.velocity);
    for (const std::string& tool : tools) {
      auto& pose = b.Add<FrameTask>(tool, PoseTask(m, tool));
      b.Connect(dynamics.dynamics, pose.dynamics);
      b.Connect(pose.objective, qp->objectives);
    }
    b.Connect(dynamics.dynamics, posture.dynamics);
    b.Connect(dynamics.dynamics, damper.dynamics);
    b.Connect(dynamics.dynamics, qp->dynamics);
    b.Connect(posture.objective, qp->objectives);
    b.Connect(damper.bounds, qp->bounds);
    if (pairs > 0) {
      auto& collisions = b.Add<CollisionDamper>("collisions", Capsules(m, pairs));
      b.Connect(dynamics.dynamics, collisions.dynamics);
      b.Connect(collisions.rows, qp->rows);
    }
  }

  void Run(benchmark::State& state) {
    const Diagram diagram = b.Build();
    Simulator sim(diagram);
    const Measured* now = nullptr;
    long solved = 0, ticks = 0;
    Clock(
        state,
        [&](int k) {
          solved +=
              ticks++ > 0 && sim.Get(qp->report).outcome == ComplianceQpReport::Outcome::Solved;
          now = &At(sway, k);
        },
        [&] {
          sim.Set(q->value, now->q);
          sim.Set(v->value, now->v);
          sim.AdvanceThroughTick();
          benchmark::DoNotOptimize(sim.Get(qp->torque).data());
        });
    state.counters["solved"] = static_cast<double>(solved) / static_cast<double>(ticks - 1);
  }

  std::vector<Measured> sway;
  DiagramBuilder b;
  Constant<JointPosition>* q;
  Constant<JointVelocity>* v;
  ComplianceQp* qp;
};

void CommonTick(benchmark::State& state) { Common(Gen3(), {"tool_frame"}).Run(state); }
BENCHMARK(CommonTick)->Name("Tick/Common")->Iterations(1);

void TickOfArms(benchmark::State& state) {
  std::vector<std::string> tools;
  for (int i = 0; i < state.range(0); ++i)
    tools.push_back(std::string(1, static_cast<char>('a' + i)) + "_tool_frame");
  Common(Gen3Tree(static_cast<int>(state.range(0))), tools).Run(state);
}
BENCHMARK(TickOfArms)->Name("Tick/Common")->ArgName("arms")->Arg(1)->Arg(2)->Arg(4)->Iterations(1);

void TickOfTasks(benchmark::State& state) {
  std::vector<std::string> tools{"tool_frame",    "forearm_link",           "half_arm_2_link",
                                 "bracelet_link", "spherical_wrist_1_link", "half_arm_1_link"};
  tools.resize(static_cast<std::size_t>(state.range(0)));
  Common(Gen3(), tools).Run(state);
}
BENCHMARK(TickOfTasks)->Name("Tick/Common")->ArgName("poses")->DenseRange(1, 6)->Iterations(1);

void TickOfPairs(benchmark::State& state) {
  Common(Gen3(), {"tool_frame"}, static_cast<int>(state.range(0))).Run(state);
}
BENCHMARK(TickOfPairs)
    ->Name("Tick/Common")
    ->ArgName("pairs")
    ->Arg(0)
    ->Arg(5)
    ->Arg(10)
    ->Arg(20)
    ->Arg(30)
    ->Arg(60)
    ->Iterations(1);

/// The whole controller of scenarios, with everything it can keep to.
void EcTick(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  const std::string tool = "FT_sensor_wrench";
  const std::vector<Measured> sway = Sway(m);
  DiagramBuilder b;
  auto& q = b.Add<Constant<JointPosition>>("q", {.space = m.joints(), .value = Posture(m)});
  auto& v = b.Add<Constant<JointVelocity>>(
      "v", {.space = m.joints(), .value = JointVelocity::Zero(m.joints())});
  auto& tau = b.Add<Constant<JointTorque>>(
      "tau", {.space = m.joints(), .value = JointTorque::Zero(m.joints())});
  auto& wrench = b.Add<Constant<Wrench>>("wrench", {.value = Wrench()});
  ComplianceControl::Options o;
  o.model = m;
  o.position = Posture(m);
  o.rotor_inertia = PerJoint::Constant(m.size(), 0.3);
  o.wrist = WristTool{.frame = tool};
  o.tool = tool;
  o.estimate = TorqueEstimate::Fusion;
  o.collisions = TenPairs(m);
  o.speed_limit = Speed(m, tool);
  o.workspace = {Planes(m, tool)};
  o.pose.compliance = 0.5 * TaskMatrix::Identity(6, 6);
  o.posture.compliance = JointMatrix::Identity(m.size(), m.size());
  auto& control = b.Add<ComplianceControl>("control", o);
  b.Connect(q.y, control.measured_position);
  b.Connect(v.y, control.measured_velocity);
  b.Connect(tau.y, control.measured_torque);
  b.Connect(wrench.y, control.wrench);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  const Measured* now = nullptr;
  long solved = 0, ticks = 0, iterations = 0;
  Clock(
      state,
      [&](int k) {
        if (ticks++ > 0) {
          const ComplianceQpReport& report = sim.Get(control.report);
          solved += report.outcome == ComplianceQpReport::Outcome::Solved;
          iterations += report.iterations;
        }
        now = &At(sway, k);
      },
      [&] {
        sim.Set(q.value, now->q);
        sim.Set(v.value, now->v);
        sim.Set(tau.value, now->tau);
        sim.Set(wrench.value, now->wrench);
        sim.AdvanceThroughTick();
        benchmark::DoNotOptimize(sim.Get(control.torque).data());
      });
  state.counters["pairs"] = sim.Get(control.distance).size();
  state.counters["solved"] = static_cast<double>(solved) / static_cast<double>(ticks - 1);
  state.counters["iterations"] = static_cast<double>(iterations) / static_cast<double>(ticks - 1);
}
BENCHMARK(EcTick)->Name("Tick/Ec")->Iterations(1);

// --- its parts ---

/// One output of a block behind `dynamics`, which are set outside the time that counts.
template <class B, class S>
void Part(benchmark::State& state, const RobotModel& m, BlockTester<B>& t, const Output<S>& out,
          const std::function<void(int)>& prepare = {}) {
  const std::vector<RobotDynamics> sway = SwayDynamics(m);
  Clock(
      state,
      [&](int k) {
        t.Set(t->dynamics, sway[static_cast<std::size_t>(k) % sway.size()]);
        if (prepare) prepare(k);
      },
      [&] { benchmark::DoNotOptimize(&t.Get(out)); });
}

/// The same of a sampled block: its tick, the kernel's share included.
template <class B>
void SampledPart(benchmark::State& state, const RobotModel& m, BlockTester<B>& t) {
  const std::vector<RobotDynamics> sway = SwayDynamics(m);
  Clock(
      state,
      [&](int k) {
        if constexpr (requires { t->dynamics; })
          t.Set(t->dynamics, sway[static_cast<std::size_t>(k) % sway.size()]);
      },
      [&] { t.Tick(); });
}

void DynamicsPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  const std::vector<Measured> sway = Sway(m);
  BlockTester<ModelDynamics> t({.model = m, .rotor_inertia = PerJoint::Constant(m.size(), 0.3)});
  Clock(
      state,
      [&](int k) {
        t.Set(t->position, At(sway, k).q);
        t.Set(t->velocity, At(sway, k).v);
      },
      [&] { benchmark::DoNotOptimize(&t.Get(t->dynamics)); });
}
BENCHMARK(DynamicsPart)->Name("Part/Dynamics")->Iterations(1);

void ObserverPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  BlockTester<MomentumObserver> t({.joints = m.joints(),
                                   .gain = PerJoint::Constant(m.size(), 50),
                                   .period = 1ms,
                                   .rotor_inertia = PerJoint::Constant(m.size(), 0.3)});
  t.Set(t->torque, JointTorque::Zero(m.joints()));
  SampledPart(state, m, t);
}
BENCHMARK(ObserverPart)->Name("Part/Observer")->Iterations(1);

void ToolPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  BlockTester<ToolCompensation> t({.model = m, .frame = "FT_sensor_wrench"});
  t.Set(t->measured, Wrench());
  Part(state, m, t, t->contact);
}
BENCHMARK(ToolPart)->Name("Part/Tool")->Iterations(1);

void WristPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  BlockTester<WristTorque> t({.model = m, .frame = "FT_sensor_wrench"});
  t.Set(t->contact, Wrench());
  Part(state, m, t, t->torque);
}
BENCHMARK(WristPart)->Name("Part/WristTorque")->Iterations(1);

void FusionPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  BlockTester<ComplementaryFusion> t(
      {.joints = m.joints(), .gain = PerJoint::Constant(m.size(), 50), .period = 1ms});
  t.Set(t->residual, JointTorque::Zero(m.joints()));
  t.Set(t->sensor_torque, JointTorque::Zero(m.joints()));
  SampledPart(state, m, t);
}
BENCHMARK(FusionPart)->Name("Part/Fusion")->Iterations(1);

void ExternalPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  BlockTester<ExternalAcceleration> t({.joints = m.joints()});
  t.Set(t->external_torque, JointTorque(PerJoint::Ones(m.size())));
  Part(state, m, t, t->acceleration);
}
BENCHMARK(ExternalPart)->Name("Part/ExternalAcceleration")->Iterations(1);

void TaskPart(benchmark::State& state, const FrameTask::Options& o) {
  BlockTester<FrameTask> t(o);
  t.Set(t->external_acceleration, JointAcceleration(PerJoint::Ones(o.model.size())));
  Part(state, o.model, t, t->objective);
}
void PosePart(benchmark::State& state) {
  FrameTask::Options o = PoseTask(Gen3WithSensor(), "FT_sensor_wrench");
  o.compliance = 0.5 * TaskMatrix::Identity(6, 6);
  TaskPart(state, o);
}
BENCHMARK(PosePart)->Name("Part/PoseTask")->Iterations(1);
void MobilityPart(benchmark::State& state) {
  FrameTask::Options o = PoseTask(Gen3WithSensor(), "FT_sensor_wrench");
  o.mobility = 0.5 * TaskMatrix::Identity(6, 6);
  TaskPart(state, o);
}
BENCHMARK(MobilityPart)->Name("Part/PoseTaskOfMobility")->Iterations(1);

void PositionPart(benchmark::State& state) {
  FrameTask::Options o = PoseTask(Gen3WithSensor(), "FT_sensor_wrench");
  o.part = FrameTask::Part::Position;
  o.stiffness = TaskVector::Constant(3, 400);
  o.damping = TaskVector::Constant(3, 40);
  TaskPart(state, o);
}
BENCHMARK(PositionPart)->Name("Part/PositionTask")->Iterations(1);

void PosturePart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  PostureTask::Options o = Rest(m);
  o.compliance = JointMatrix::Identity(m.size(), m.size());
  BlockTester<PostureTask> t(o);
  t.Set(t->external_acceleration, JointAcceleration(PerJoint::Ones(m.size())));
  Part(state, m, t, t->objective);
}
BENCHMARK(PosturePart)->Name("Part/PostureTask")->Iterations(1);

void DamperPart(benchmark::State& state) {
  BlockTester<JointDamper> t({.model = Gen3WithSensor()});
  Part(state, Gen3WithSensor(), t, t->bounds);
}
BENCHMARK(DamperPart)->Name("Part/JointDamper")->Iterations(1);

void CollisionPart(benchmark::State& state) {
  const CollisionDamper::Options o = TenPairs(Gen3WithSensor());
  BlockTester<CollisionDamper> t(o);
  Part(state, o.model, t, t->rows);
  state.counters["pairs"] = t->geometry().size();
}
BENCHMARK(CollisionPart)->Name("Part/CollisionDamper")->Iterations(1);

void PlanesPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  BlockTester<WorkspacePlanes> t(Planes(m, "FT_sensor_wrench"));
  Part(state, m, t, t->rows);
}
BENCHMARK(PlanesPart)->Name("Part/WorkspacePlanes")->Iterations(1);

void SpeedPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  BlockTester<FrameSpeedLimit> t(Speed(m, "FT_sensor_wrench"));
  Part(state, m, t, t->rows);
}
BENCHMARK(SpeedPart)->Name("Part/FrameSpeedLimit")->Iterations(1);

/// Its terms and rows are those of one tick.
void QpPart(benchmark::State& state) {
  const RobotModel m = Gen3WithSensor();
  const RobotDynamics d = SwayDynamics(m)[10];
  const auto of = [&]<class B, class S>(BlockTester<B>& t, const Output<S>& out) -> const S& {
    t.Set(t->dynamics, d);
    return t.Get(out);
  };
  BlockTester<FrameTask> pose(PoseTask(m, "FT_sensor_wrench"));
  BlockTester<PostureTask> posture(Rest(m));
  BlockTester<JointDamper> damper({.model = m});
  BlockTester<CollisionDamper> collisions(TenPairs(m));
  BlockTester<WorkspacePlanes> planes(Planes(m, "FT_sensor_wrench"));
  BlockTester<FrameSpeedLimit> speed(Speed(m, "FT_sensor_wrench"));
  BlockTester<ComplianceQp> t({.model = m, .period = 1ms, .rows = 10 + 3 + 6});
  t.Join(t->objectives, of(pose, pose->objective));
  t.Join(t->objectives, of(posture, posture->objective));
  t.Join(t->bounds, of(damper, damper->bounds));
  t.Join(t->rows, of(collisions, collisions->rows));
  t.Join(t->rows, of(planes, planes->rows));
  t.Join(t->rows, of(speed, speed->rows));
  SampledPart(state, m, t);
  state.counters["solved"] = t.Get(t->report).outcome == ComplianceQpReport::Outcome::Solved;
}
BENCHMARK(QpPart)->Name("Part/Qp")->Iterations(1);

}  // namespace
}  // namespace pliant
