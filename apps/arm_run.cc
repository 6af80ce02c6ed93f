#include "pliant/apps/arm_run.h"

#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <map>
#include <thread>

#include "pliant/analysis/run_experiment.h"
#include "pliant/analysis/run_on_arm.h"
#include "pliant/apps/commands.h"
#include "pliant/apps/says_something.h"
#include "pliant/apps/stop_signals.h"
#include "pliant/controllers/safety_text.h"
#include "pliant/plants/parameter_text.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

const std::map<std::string, Overrun> kOverruns{
    {"skip", Overrun::Skip}, {"catch-up", Overrun::CatchUp}, {"stop", Overrun::Stop}};

/// Brings Ctrl-C and what is typed to the panel, and tells what the supervisor does.
class Console {
 public:
  explicit Console(std::shared_ptr<OperatorPanel> panel)
      : panel_{std::move(panel)},
        stops_{[this](const std::stop_token& s) { PassStopsOn(s); }},
        thread_{[this](const std::stop_token& s) { Watch(s); }} {
    // A process that stands still leaves its arm where the last frame put it.
    for (const int signal : kSuspend) std::signal(signal, SIG_IGN);
  }
  ~Console() {
    for (const int signal : kSuspend) std::signal(signal, SIG_DFL);
  }
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

 private:
  static constexpr std::array kSuspend{SIGTSTP, SIGTTIN, SIGTTOU};

  /// By a thread of its own: telling waits for a terminal that was held by Ctrl-S.
  void PassStopsOn(const std::stop_token& stop) const {
    while (!stop.stop_requested()) {
      if (StopSignals::requested) panel_->stop = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  void Watch(const std::stop_token& stop) {
    SafetyState shown = SafetyState::Engaging;
    while (!stop.stop_requested()) {
      pollfd in{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
      if (listens_ && poll(&in, 1, 20) > 0) {
        char typed[64];
        listens_ = read(STDIN_FILENO, typed, sizeof typed) > 0;
        if (listens_) ++panel_->acknowledged;
      } else if (!listens_) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
      if (const SafetyState now = panel_->state; now != shown) {
        shown = now;
        Tell(now);
      }
    }
  }
  void Tell(SafetyState state) const {
    const SafetyCause cause = panel_->cause;
    std::string line = WordOf(state);
    if (cause != SafetyCause::None) {
      if (cause == SafetyCause::UserStop)
        line += panel_->stop ? ": asked to stop" : ": its time is over";
      else
        line += ": " + SafetyText(cause, panel_->joint, panel_->value, panel_->limit);
      if (listens_ && cause != SafetyCause::UserStop && state != SafetyState::Stopped)
        line += "; Enter acknowledges, once it is over";
    }
    std::fprintf(stderr, "%s\n", line.c_str());
  }

  const std::shared_ptr<OperatorPanel> panel_;
  bool listens_ = isatty(STDIN_FILENO) != 0;  // to what is typed
  std::jthread stops_, thread_;
};

/// What puts the arm in the place of the station of a file.
Overrides StationAt(const std::string& address, const Scenario& scenario) {
  if (IsHardware(scenario)) return {{"station.address", internal::YamlText(address)}};
  const Gen3Station station{.address = address,
                            .friction = std::get<StationOptions>(scenario.station).friction};
  Overrides set{{"station", "!Gen3 {address: " + internal::YamlText(address) + "}"}};
  if (!station.friction.empty())
    set.emplace_back("station.friction", internal::ValueOf(station.friction, "").substr(1));
  return set;
}

}  // namespace

void AddArmOptions(CLI::App& app, ArmTold& told) {
  app.add_option("--arm", told.address,
                 "HOST[:TCP[,UDP]] of a Gen3 that is to be run in the place of the simulated arm")
      ->check(SaysSomething());
  app.add_option("--user", told.user, "who opens a session with the arm")
      ->check(SaysSomething())
      ->capture_default_str();
  app.add_option("--password", told.password,
                 "of that user; as an arm leaves the factory unless told")
      ->check(SaysSomething());
  app.add_option("--run", told.run, "which of the file's runs it is to be, of an arm or of a page");
  app.add_option("--priority", told.priority, "of SCHED_FIFO, for an arm")
      ->check(CLI::Range(1, 99));
  app.add_option("--cpu", told.cpu, "the processor the ticks stay on, for an arm")
      ->check(CLI::Range(0, 4095));
  app.add_flag("--lock-memory", told.lock_memory, "no page is brought in during the run of an arm");
  std::vector<std::string> words;
  for (const auto& [word, policy] : kOverruns) words.push_back(word);
  app.add_option("--overrun", told.overrun, "what to do about a tick of an arm that is late")
      ->check(CLI::IsMember(words))
      ->capture_default_str();
}

ExperimentFile ReadForArm(const std::filesystem::path& file, const Overrides& set,
                          const ArmTold& told) {
  if (told.address.empty()) return ExperimentFile::Read(file, set);
  Gen3Address::Of(told.address);
  Overrides others = set;
  std::erase_if(others, [](const auto& one) { return one.first.starts_with("station."); });
  Overrides all = StationAt(told.address, ExperimentFile::Read(file, others).scenarios.front());
  all.insert(all.end(), set.begin(), set.end());
  return ExperimentFile::Read(file, all);
}

void ChooseRun(ExperimentFile& file, const std::string& name) {
  std::vector<RunOf>& runs = file.experiment.runs;
  const auto found = std::ranges::find(runs, name, &RunOf::name);
  if (found == runs.end()) {
    std::vector<std::string> names;
    for (const RunOf& run : runs) names.push_back(run.name);
    throw Error("there is no run '" + name + "'" + DidYouMean(name, names));
  }
  file.scenarios = {file.scenarios[static_cast<std::size_t>(found - runs.begin())]};
  runs = {*found};
}

bool IsAboutAnArm(const ExperimentFile& file) {
  return std::ranges::any_of(file.scenarios, IsHardware);
}

int RunOnArmAndTell(ExperimentFile file, const ArmTold& told, const std::filesystem::path& out,
                    bool force, LiveView* view) {
  if (!told.run.empty()) ChooseRun(file, told.run);
  const StopSignals signals;
  ArmRunOptions options{.out = out,
                        .force = force,
                        .user = told.user,
                        .password = told.password,
                        .overrun = kOverruns.at(told.overrun),
                        .view = view};
  options.permissions.lock_memory = told.lock_memory;
  if (told.priority > 0) options.permissions.priority = told.priority;
  if (told.cpu >= 0) options.permissions.cpu = told.cpu;
  options.say = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  ArmRun run;
  {
    const Console console(options.panel);
    try {
      run = RunOnArm(file, options);
    } catch (const FailedRun& e) {
      throw CannotGoOn(e.what());
    }
  }
  std::printf("%s\nlog: %s\n", run.text().c_str(), run.log.c_str());
  const bool fault =
      run.safety.cause != SafetyCause::None && run.safety.cause != SafetyCause::UserStop;
  return fault || !run.handing_back.empty() || run.safety.state != SafetyState::Stopped ? 3 : 0;
}

}  // namespace pliant
