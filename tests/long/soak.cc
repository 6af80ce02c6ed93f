// A Gen3 with a wrist sensor, all of its station and its supervisor, through random modes, pushes,
// hands and faults for as many ticks as one has.
//
//   soak [TICKS] [SEED] [RUNS]
//
// Runs that many times and says the hash of all that was recorded, which must be the same. Ends
// with 1 at the first tick that breaks a rule: a number that is none, memory taken in a tick, a
// limit that is crossed, a supervisor that does not give the arm back. An episode is 20 s; the next
// begins anew, with other events.

#include <unistd.h>

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "pliant/diagrams/scenario.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"

namespace pliant {
namespace {

constexpr std::int64_t kEpisode = 20'000;  // ticks
/// Those of a drill, and two of the arm: a motor is hot, a joint follows its own loop alone.
constexpr std::array kFaults{"nan_command", "command_jump", "divergence",
                             "overruns",    "hot",          "blocked"};

/// How far the arm may go beyond what the supervisor watches, from docs/fault-matrix.md: no joint
/// moves further than 2.5° once a fault has begun; a limit is one.
constexpr double kBeyond = 2.5 * std::numbers::pi / 180;
/// From Damped (3 s at most) through Engaging (3 s at most) and the blending (0.5 s); an
/// acknowledgement that is spent while the fault is there is given again after half a second.
constexpr double kRecovers = 3 + 3 + 0.5 + 0.5;
/// What a process keeps of episodes that are over, by fragmentation [MiB].
constexpr double kMostGrowth = 16;

double ResidentMiB() {
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// What a log of every tick would hold.
class Rows final : public RecordSink {
 public:
  int Open(std::vector<RecordedValue> values) override {
    for (const RecordedValue& value : values)
      for (const std::string& element : value.elements) {
        names_.push_back(value.path + element);
        // What a drill spoils is no number on purpose, and the report tells what was found.
        watched_.push_back(!value.path.starts_with("drill.") && value.path != "safety.report");
      }
    row_.resize(names_.size());
    return 0;
  }
  std::span<double> Begin(int, std::int64_t) noexcept override { return row_; }
  void Commit() noexcept override {
    for (std::size_t i = 0; i < row_.size(); ++i) {
      if (watched_[i] && !std::isfinite(row_[i]) && !broken_) broken_ = names_[i].c_str();
      // A NaN has many bits.
      const auto bits = std::isnan(row_[i]) ? 1 : std::bit_cast<std::uint64_t>(row_[i]);
      hash = (hash ^ bits) * 0x100000001b3;
    }
  }
  const char* broken() const { return broken_; }

  std::uint64_t hash = 0xcbf29ce484222325;

 private:
  std::vector<std::string> names_;
  std::vector<bool> watched_;
  std::vector<double> row_;
  const char* broken_ = nullptr;
};

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : random_{seed} {}
  double Between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  int Below(int end) { return static_cast<int>(random_() % static_cast<std::uint64_t>(end)); }

 private:
  std::mt19937_64 random_;
};

struct Numbers {
  std::int64_t ticks = 0, faults = 0, recoveries = 0, stops = 0, acknowledgements = 0;
  std::map<SafetyCause, std::int64_t> causes;
  double beyond = -kUnbounded;  // a joint's limit [rad]
  double speed = 0;             // of a joint, measured, as a share of its limit
  double torque = 0;            // commanded, the same way
};

Scenario ScenarioOf(Chance& chance, std::uint64_t seed) {
  const auto text = [](double x) { return Text(x) + ", "; };
  const std::array links{"forearm_link", "half_arm_2_link", "bracelet_link", "tool_frame"};
  const std::array modes{"stiff", "null_space", "full_body", "dual"};
  const std::array controls{"position", "proposed_torque", "kinova_torque"};
  std::string changes, environment;
  for (double t = chance.Between(0.5, 3); t < 18; t += chance.Between(0.5, 4)) {
    changes += "      - {at_s: " + text(t) + "mode: " + modes[chance.Below(4)];
    if (chance.Below(2)) changes += std::string(", control: ") + controls[chance.Below(3)];
    changes += "}\n";
  }
  for (double t = chance.Between(0.5, 3); t < 18; t += chance.Between(1, 5)) {
    const std::string link = std::string("link: ") + links[chance.Below(4)];
    const double most = 25;  // [N] along each axis
    if (chance.Below(3)) {
      environment += "  - !Push {" + link + ", force: [" + text(chance.Between(-most, most)) +
                     text(chance.Between(-most, most)) + Text(chance.Between(-most, most)) +
                     "], start_s: " + text(t) + "duration_s: " + text(chance.Between(0.1, 1)) +
                     "edge_s: 0.05}\n";
    } else {
      environment +=
          "  - !Hand {" + link + ", stiffness: [500, 500, 500], damping: 30, start_s: " + text(t) +
          "duration_s: 1.5, path: [{after_s: 1, by: [" + text(chance.Between(-.05, .05)) +
          text(chance.Between(-.05, .05)) + Text(chance.Between(-.05, .05)) + "]}]}\n";
    }
  }
  Scenario scenario;
  ParameterFile::ReadText(
      "robot: gen3_bota\n"
      "station: !SimulatedArm {engine: recursive}\n"
      "controller: !Compliance\n"
      "  tool: tool_frame\n"
      "  estimate: fusion\n"
      "  collisions: {}\n"
      "  speed_limit: {frame: tool_frame, linear: 0.5}\n"
      "  modes:\n"
      "    control: position\n"
      "    kinova_loop: {feedforward: 1, gain: 15, damping: 0}\n"
      "    changes:\n" +
          changes + "environment:\n" + environment +
          "safety: {}\n"
          "integrator: {method: dormand_prince}\n"
          "position_scatter: 0.1\n"
          "duration_s: 20\n"
          "seed: " +
          std::to_string(seed) + "\n",
      "soak")
      .Fill(scenario);
  return scenario;
}

std::vector<FaultOrder> FaultsOf(Chance& chance) {
  std::vector<FaultOrder> faults;
  for (double t = chance.Between(1, 8); t < 19; t += chance.Between(kRecovers + 2, 2 * kRecovers)) {
    const std::string kind = kFaults[static_cast<std::size_t>(chance.Below(std::ssize(kFaults)))];
    // A missed tick is forgiven in 50 ms: of a longer one the arm is held until it stops.
    const double most_s = kind == "overruns" ? 0.04 : 0.4;
    faults.push_back({.kind = kind,
                      .start_s = t,
                      .duration_s = chance.Between(0.001, most_s),
                      .joint = chance.Below(7)});
  }
  return faults;
}

class Episode {
 public:
  Episode(std::uint64_t seed, std::uint64_t hash, Numbers& numbers)
      : chance_{seed}, numbers_{numbers} {
    rows_->hash = hash;
  }

  /// What rule is broken; empty: none is.
  std::string Run(std::int64_t ticks, std::uint64_t seed) {
    const Scenario scenario = ScenarioOf(chance_, seed);
    const std::vector<FaultOrder> faults = FaultsOf(chance_);
    ScenarioDiagram built(scenario, rows_, {.panel = panel_, .faults = faults});
    const Diagram diagram = built.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    const RobotModel model = RobotOf(scenario);
    const MotorCurrent current_limit(
        FiguresOf(StationOf(scenario).actuators.joint, &ActuatorParameters::current_limit));
    for (std::int64_t k = 0; k < ticks; ++k) {
      Spoil(sim, built, faults, model.joints());
      const long before = Allocations();
      sim.AdvanceThroughTick();
      const long taken = Allocations() - before;
      ++numbers_.ticks;
      const SafetyReport report = sim.Get(built.safety->report);
      Answer(report, sim.time());
      const auto broken = [&](const std::string& what) {
        return what + " at tick " + std::to_string(k) + " of episode " + std::to_string(seed) +
               ", state " + WordOf(report.state) + ", cause " + WordOf(report.cause);
      };
      if (rows_->broken()) return broken(std::string(rows_->broken()) + " is no number");
      if (taken > 0 && k > 0) return broken(std::to_string(taken) + " allocations");
      const PerJoint torque =
          sim.Get(built.safety->arm_torque).cwiseAbs().cwiseQuotient(model.effort_limit());
      const PerJoint current =
          sim.Get(built.safety->arm_current).cwiseAbs().cwiseQuotient(current_limit);
      numbers_.torque = std::max({numbers_.torque, torque.maxCoeff(), current.maxCoeff()});
      if (numbers_.torque > 1) return broken("a command beyond the limits of a joint");
      const PerJoint v =
          sim.Get(built.arm->measured_velocity).cwiseAbs().cwiseQuotient(model.velocity_limit());
      // As measured: the arm's own filter is late by some ms. Who pushes an arm that is only damped
      // may move it as fast as he likes.
      if (report.state == SafetyState::Running)
        numbers_.speed = std::max(numbers_.speed, v.maxCoeff());
      if (numbers_.speed > 1) return broken("a joint is faster than its limit");
      const PerJoint q = sim.Get(built.arm->position);
      numbers_.beyond = std::max({numbers_.beyond, (q - model.upper_limit()).maxCoeff(),
                                  (model.lower_limit() - q).maxCoeff()});
      if (numbers_.beyond > kBeyond) return broken("a joint is beyond its limit");
      // An arm that was pushed against a limit stays there until somebody leads it away: its run
      // ends.
      if (report.state == SafetyState::Stopped && report.now == SafetyCause::PositionLimit) {
        ++numbers_.stops;
        return "";
      }
      if (report.state == SafetyState::Stopped) return broken("the run has ended");
      if (fault_s_ >= 0 && sim.time() - acknowledged_s_ > kRecovers)
        return broken("the controller has not got the arm back");
    }
    return "";
  }

  std::uint64_t hash() const { return rows_->hash; }

 private:
  /// What no drill does: two inputs that nothing is wired to.
  void Spoil(Simulator& sim, const ScenarioDiagram& built, const std::vector<FaultOrder>& faults,
             const Joints& joints) {
    int hot = -1, blocked = -1;
    for (const FaultOrder& fault : faults)
      if (fault.At(sim.time())) {
        if (fault.kind == "hot") hot = *fault.joint;
        if (fault.kind == "blocked") blocked = *fault.joint;
      }
    if (hot != hot_) {
      JointTemperature T = JointTemperature::Zero(joints);
      if (hot >= 0) T(hot) = 90;
      sim.Set(built.safety->temperature, T);
    }
    if (blocked != blocked_)
      sim.Set(built.arm->joint_modes,
              {.position = blocked >= 0 ? JointBits{1} << blocked : JointBits{0}});
    hot_ = hot;
    blocked_ = blocked;
  }

  /// Whoever watches acknowledges what has gone wrong after a while, and again until that is heard.
  void Answer(const SafetyReport& report, double t) {
    const bool away = report.state == SafetyState::Damped || report.state == SafetyState::Holding;
    if (away && fault_s_ < 0) {
      ++numbers_.faults;
      ++numbers_.causes[report.cause];
      fault_s_ = t;
      acknowledged_s_ = kUnbounded;
      next_s_ = t + chance_.Between(0.1, 2);
    }
    if (away && t >= next_s_) {
      panel_->acknowledged = panel_->acknowledged + 1;
      ++numbers_.acknowledgements;
      acknowledged_s_ = std::min(acknowledged_s_, t);
      next_s_ = t + 0.5;
    }
    if (fault_s_ >= 0 && report.state == SafetyState::Running) {
      ++numbers_.recoveries;
      fault_s_ = -1;
    }
  }

  Chance chance_;
  Numbers& numbers_;
  const std::shared_ptr<Rows> rows_ = std::make_shared<Rows>();
  const std::shared_ptr<OperatorPanel> panel_ = std::make_shared<OperatorPanel>();
  int hot_ = -1, blocked_ = -1;  // joints
  double fault_s_ = -1, acknowledged_s_ = kUnbounded, next_s_ = 0;
};

/// The hash of all that was recorded; none if a rule is broken.
std::optional<std::uint64_t> Soak(std::int64_t ticks, std::uint64_t seed) {
  const auto began = std::chrono::steady_clock::now();
  Numbers numbers;
  std::uint64_t hash = 0xcbf29ce484222325;
  double resident = 0;
  for (std::uint64_t n = 0; numbers.ticks < ticks; ++n) {
    Episode episode(seed + n, hash, numbers);
    const std::string broken = episode.Run(std::min(kEpisode, ticks - numbers.ticks), seed + n);
    if (!broken.empty()) {
      std::printf("broken: %s\n", broken.c_str());
      return {};
    }
    hash = episode.hash();
    if (n == 4) resident = ResidentMiB();
    if (n % 10 == 9) {
      const double s =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      std::printf("%lld ticks, %.0f us each, %lld faults, %.1f MiB\n",
                  static_cast<long long>(numbers.ticks),
                  1e6 * s / static_cast<double>(numbers.ticks),
                  static_cast<long long>(numbers.faults), ResidentMiB());
      std::fflush(stdout);
    }
  }
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  std::printf(
      "%lld ticks in %.0f s, %.0f us each; %lld faults, %lld acknowledgements, %lld times given "
      "back\n",
      static_cast<long long>(numbers.ticks), s, 1e6 * s / static_cast<double>(numbers.ticks),
      static_cast<long long>(numbers.faults), static_cast<long long>(numbers.acknowledgements),
      static_cast<long long>(numbers.recoveries));
  for (const auto& [cause, times] : numbers.causes)
    std::printf("  %s: %lld\n", WordOf(cause).c_str(), static_cast<long long>(times));
  std::printf("%lld episodes ended at a joint's limit\n", static_cast<long long>(numbers.stops));
  std::printf(
      "commands up to %.3f of their limits, speeds up to %.3f, positions up to %.4f rad "
      "from theirs\n",
      numbers.torque, numbers.speed, numbers.beyond);
  if (resident > 0) {
    const double growth = ResidentMiB() - resident;
    std::printf("%.1f MiB more than after five episodes\n", growth);
    if (growth > kMostGrowth) {
      std::printf("broken: the memory grows\n");
      return {};
    }
  }
  if (numbers.faults == 0) {
    std::printf("broken: no fault was met; give it more ticks\n");
    return {};
  }
  std::printf("hash %016llx\n", static_cast<unsigned long long>(hash));
  return hash;
}

}  // namespace
}  // namespace pliant

int main(int argc, char** argv) {
  const std::int64_t ticks = argc > 1 ? std::atoll(argv[1]) : 100'000;
  const std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 1;
  const int runs = argc > 3 ? std::atoi(argv[3]) : 1;
  const auto first = pliant::Soak(ticks, seed);
  for (int run = 1; first && run < runs; ++run)
    if (pliant::Soak(ticks, seed) != first) {
      std::printf("broken: another hash with the same seed\n");
      return 1;
    }
  return first ? 0 : 1;
}
