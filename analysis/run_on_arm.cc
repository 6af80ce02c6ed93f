#include "pliant/analysis/run_on_arm.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <thread>

#include "pliant/analysis/mcap_log.h"
#include "pliant/analysis/run_experiment.h"
#include "pliant/analysis/run_log.h"
#include "pliant/analysis/write_file.h"
#include "pliant/controllers/safety_text.h"
#include "pliant/plants/bota_source.h"
#include "pliant/plants/gen3_faults.h"
#include "pliant/plants/gen3_guard.h"
#include "pliant/plants/gen3_recovery.h"
#include "pliant/plants/gen3_wire.h"
#include "pliant/plants/parameter_text.h"
#include "pliant/plants/rdt_source.h"
#include "pliant/systems/simulator.h"
#include "pliant/systems/tick_cost.h"

namespace pliant {

namespace {

constexpr int kTareSamples = 200;
constexpr auto kTareLimit = std::chrono::seconds(3);
constexpr auto kLockStepLimit = std::chrono::seconds(2);  // of an answer of an emulator
constexpr double kGrace_s = 10;  // beside the supervisor's own times, of a run that does not end

std::shared_ptr<WrenchSource> SourceOf(const Gen3Station& station) {
  if (!station.wrist) return {};
  if (const auto* rdt = std::get_if<RdtWrist>(&*station.wrist))
    return std::make_shared<RdtSource>(
        RdtSource::Options{.host = rdt->host,
                           .port = rdt->port,
                           .scale = {.counts_per_newton = rdt->counts_per_newton,
                                     .counts_per_newton_meter = rdt->counts_per_newton_meter}});
  return std::make_shared<BotaSource>(
      BotaSource::Options{.device = std::get<BotaWrist>(*station.wrist).device});
}

/// What hangs on the sensor weighs, at rest, in the sensor's axes.
Wrench WeightOn(const SimulatedArm::Options& arm) {
  RobotDynamics d(arm.model, {arm.wrist->frame});
  ComputeDynamics(arm.model, arm.position, JointVelocity::Zero(arm.model.joints()), d);
  const Inertial& load = arm.model.link(arm.model.link_index(arm.wrist->frame)).inertial;
  const Eigen::Vector3d f =
      load.mass * (d.frame[0].pose.rotation.transpose() * arm.model.gravity());
  Wrench weight;
  weight << load.center.cross(f), f;
  return weight;
}

/// The mean of what a sensor shows while nothing touches it, less what it ought to show.
Wrench Tare(WrenchSource& source, const SimulatedArm::Options& arm) {
  const auto end = std::chrono::steady_clock::now() + kTareLimit;
  Wrench sum;
  int samples = 0;
  WrenchReading reading;
  while (samples < kTareSamples) {
    if (std::chrono::steady_clock::now() > end)
      throw Error("the wrist sensor must measure " + Text(kTareSamples) +
                  " times before the start, for its offset; got " + Text(samples) +
                  " in 3 s\n"
                  "see that it is on, and what station.wrist says");
    if (source.Read(reading) && !reading.faulty && reading.wrench.allFinite()) {
      sum += reading.wrench;
      ++samples;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  return Wrench(sum / kTareSamples - WeightOn(arm));
}

/// Lines that differ in the number of an actuator are one, with all their numbers.
std::string Folded(const std::string& lines) {
  constexpr std::string_view kMark = " of actuator ";
  std::vector<std::pair<std::string, std::string>> folded;  // with "%" in their place, and they
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) {
    std::string number;
    if (const std::size_t at = line.find(kMark); at != line.npos) {
      const std::size_t begin = at + kMark.size();
      const std::size_t end = std::min(line.find_first_not_of("0123456789", begin), line.size());
      number = line.substr(begin, end - begin);
      line.replace(begin, end - begin, "%");
    }
    if (!folded.empty() && !number.empty() && folded.back().first == line)
      folded.back().second += ", " + number;
    else
      folded.emplace_back(line, number);
  }
  std::string out;
  for (auto& [line, numbers] : folded) {
    if (!numbers.empty())
      line.replace(line.find(std::string(kMark) + "%") + kMark.size(), 1, numbers);
    out += (out.empty() ? "" : "\n") + line;
  }
  return out;
}

/// What the file is not to blame for.
template <class Step>
auto Reached(const Step& step) {
  try {
    return step();
  } catch (const Error& e) {
    throw FailedRun(e.what());
  }
}

/// However a run ends, those who look on are told before what they look at is gone.
struct EndOfView {
  ~EndOfView() {
    if (view) view->End(reason);
  }
  LiveView* view;
  std::string reason = "it failed";
};

class ArmExecution {
 public:
  ArmExecution(const ExperimentFile& file, const ArmRunOptions& o) : file_{file}, o_{o} {
    Require(file.scenarios.size() == 1 && file.experiment.repeat == 1,
            "an arm does one run at a time; name one with --run, and --repeat 1");
    scenario_ = file.scenarios.front();
    Require(IsHardware(scenario_), "station must be !Gen3 to run an arm; give --arm ADDRESS");
    Require(!scenario_.log_period || *scenario_.log_period == ControlPeriodOf(scenario_),
            "log_period must be the controller's period on an arm; leave it out");
  }

  ArmRun Run() {
    auto& station = std::get<Gen3Station>(scenario_.station);
    Gen3Address address = Gen3Address::Of(station.address);
    address.user = o_.user;
    address.password = o_.password;
    result_.address = station.address;
    result_.log = o_.out / "logs" / (file_.experiment.runs.front().name + ".mcap");
    if (std::error_code unknown; !o_.force && std::filesystem::exists(result_.log, unknown))
      throw Error(result_.log.string() +
                  " exists; give --force to write over it, or another --out");
    internal::MakeDirectory(o_.out / "logs");

    const auto guard = Reached([&] { return std::make_unique<Gen3Guard>(address); });
    Hardware hardware{.arm = Reached([&] { return Connect(address, station); }),
                      .panel = o_.panel,
                      .faults = o_.faults};
    station.position = hardware.arm->start().position;
    hardware.wrist = Reached([&] { return SourceOf(station); });
    if (hardware.wrist)
      hardware.wrist_bias = Reached([&] { return Tare(*hardware.wrist, StationOf(scenario_)); });
    const auto times = std::make_shared<TickTimes>();
    hardware.times = times;

    McapLog::Options options = RunLogOf({.file = result_.log,
                                         .experiment = file_.text(),
                                         .run = file_.experiment.runs.front(),
                                         .scenario = scenario_,
                                         .force = o_.force});
    options.full = station.lock_step ? McapLog::Full::Wait : McapLog::Full::Drop;
    const auto log = std::make_shared<McapLog>(options);
    LiveView* const view = o_.view;
    ScenarioDiagram scene(
        scenario_, view ? view->Sink(scenario_, log) : std::shared_ptr<RecordSink>(log), hardware);
    const Diagram diagram = scene.builder.Build();
    const TickCost cost = EstimateTickCost(diagram);
    Say(cost.text());
    std::map<std::string, std::string> costs;
    for (const TickCost::Block& block : cost.blocks)
      costs[block.path] = internal::YamlText(block.cost);
    log->AddMetadata("pliant.costs", costs);
    Simulator sim(diagram);
    RealTimeRunner runner(sim, {.paced = !station.lock_step,
                                .overrun = o_.overrun,
                                .permissions = o_.permissions,
                                .times = times,
                                .stop = &o_.panel->stopped,
                                .before_tick = view ? view->BeforeTick() : nullptr});
    EndOfView end_of_view{view};
    if (view)
      view->Begin({.run = file_.experiment.runs.front(),
                   .scenario = scenario_,
                   .scene = &scene,
                   .diagram = &diagram,
                   .panel = o_.panel});
    const auto settings = scenario_.safety.value_or(SafetySupervisor::Settings());
    const double end =
        scenario_.duration_s + settings.engage_s + settings.damped_s + settings.hold_s + kGrace_s;
    const auto begin = std::chrono::steady_clock::now();
    std::exception_ptr failure;
    try {
      runner.Run(end);
    } catch (...) {
      failure = std::current_exception();
    }
    const double wall =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    HandBack(*hardware.arm, address, *guard);
    result_.timing = runner.report();
    result_.safety = sim.Get(scene.safety->report);
    result_.arm = sim.Get(scene.hardware->report);
    result_.whole = !failure && result_.safety.state == SafetyState::Stopped &&
                    result_.safety.cause == SafetyCause::UserStop &&
                    sim.time() >= scenario_.duration_s && !o_.panel->stop;
    end_of_view.reason = result_.text();
    log->AddMetadata("pliant.run", {{"whole", result_.whole ? "1" : "0"},
                                    {"simulated_s", internal::YamlText(sim.time())},
                                    {"wall_s", internal::YamlText(wall)},
                                    {"ticks", std::to_string(result_.timing.ticks)},
                                    {"end", result_.text()}});
    log->Close();
    if (failure) std::rethrow_exception(failure);
    return result_;
  }

 private:
  void Say(const std::string& line) const {
    if (o_.say) o_.say(line);
  }

  std::shared_ptr<Gen3Arm> Connect(const Gen3Address& address, const Gen3Station& station) const {
    const SimulatedArm::Options known = StationOf(scenario_);
    return std::make_shared<Gen3Arm>(Gen3Arm::Options{
        .link = o_.connect ? o_.connect(address) : ConnectGen3(address),
        .model = known.model,
        .current_limit = FiguresOf(known.actuators.joint, &ActuatorParameters::current_limit),
        .torque_per_ampere = known.actuators.torque_per_ampere(),
        .period = ControlPeriodOf(scenario_),
        .clear_faults = station.clear_faults,
        .frozen_after = station.frozen_after,
        .lock_step = station.lock_step ? kLockStepLimit : std::chrono::nanoseconds(0)});
  }

  /// By another way if its own does not do.
  void HandBack(Gen3Arm& arm, const Gen3Address& address, Gen3Guard& guard) {
    result_.services = arm.failures();
    try {
      arm.HandBack();
      return;
    } catch (const Error& e) {
      result_.handing_back = e.what();
    }
    try {
      for (const std::string& line : Recover(address, false)) Say(line);
      result_.handing_back += "\nanother connection brought it back";
    } catch (const Error& e) {
      result_.handing_back += std::string("\n") + e.what();
      guard.NotHandedBack();
    }
  }

  const ExperimentFile& file_;
  const ArmRunOptions& o_;
  Scenario scenario_;
  ArmRun result_;
};

}  // namespace

std::string ArmRun::text() const {
  std::string out = "ended: " + WordOf(safety.state);
  const bool fault = safety.cause != SafetyCause::None && safety.cause != SafetyCause::UserStop;
  if (fault)
    out += ", because of " + SafetyText(safety.cause, safety.joint, safety.value, safety.limit);
  out += "\n" + timing.text();
  out += "\nframes: " + Text(arm.sent) + " sent, " + Text(arm.answered) + " answered, " +
         Text(arm.late) + " late, " + Text(arm.out_of_order) + " out of order, " +
         Text(arm.refused) + " refused, " + Text(arm.unreadable) + " unreadable";
  bool reports = false;
  const auto report = [&](const std::string& who, const std::vector<std::string>& names) {
    for (const std::string& name : names) out += "\n" + who + " reports " + name;
    reports = reports || !names.empty();
  };
  for (std::size_t j = 0; j < arm.fault.size(); ++j)
    report("joint " + Text(j + 1), ActuatorFaultNames(arm.fault[j]));
  report("the base", BaseFaultNames(arm.base_fault));
  if (!services.empty()) out += "\nnot done: " + Folded(services);
  if (!handing_back.empty()) out += "\nnot handed back: " + Folded(handing_back);
  if (const std::string hint = SafetyHint(safety.cause); fault && !hint.empty())
    out += "\nwhat to do: " + hint;
  if (reports)
    out += "\nwhen it is safe to move the arm: pliant recover gen3 --arm " + address +
           " --clear-faults";
  return out;
}

ArmRun RunOnArm(const ExperimentFile& file, const ArmRunOptions& o) {
  return ArmExecution(file, o).Run();
}

}  // namespace pliant
