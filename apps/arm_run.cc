#include "pliant/apps/arm_run.h"

#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <thread>

#include "pliant/analysis/run_on_arm.h"
#include "pliant/apps/commands.h"
#include "pliant/apps/stop_signals.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

const std::map<std::string, Overrun> kOverruns{
    {"skip", Overrun::Skip}, {"catch-up", Overrun::CatchUp}, {"stop", Overrun::Stop}};

/// Brings Ctrl-C and what is typed to the panel, and tells what the supervisor does.
class Console {
 public:
  explicit Console(std::shared_ptr<OperatorPanel> panel)
      : panel_{std::move(panel)}, thread_{[this](const std::stop_token& s) { Watch(s); }} {}

 private:
  void Watch(const std::stop_token& stop) {
    bool listens = isatty(STDIN_FILENO) != 0;
    SafetyState shown = SafetyState::Engaging;
    while (!stop.stop_requested()) {
      if (StopSignals::requested) panel_->stop = true;
      pollfd in{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
      if (listens && poll(&in, 1, 20) > 0) {
        char typed[64];
        listens = read(STDIN_FILENO, typed, sizeof typed) > 0;
        if (listens) ++panel_->acknowledged;
      } else if (!listens) {
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
    std::string line = Words(state)[static_cast<std::size_t>(state)];
    if (cause != SafetyCause::None) {
      line += ": " + Words(cause)[static_cast<std::size_t>(cause)];
      if (const int joint = panel_->joint; joint >= 0) line += ", joint " + Text(joint + 1);
      if (const double limit = panel_->limit; limit != 0)
        line += ", " + Text(panel_->value.load()) + " (allowed " + Text(limit) + ")";
      if (cause != SafetyCause::UserStop && state != SafetyState::Stopped)
        line += "; Enter acknowledges";
    }
    std::fprintf(stderr, "%s\n", line.c_str());
  }

  const std::shared_ptr<OperatorPanel> panel_;
  std::jthread thread_;
};

/// The run that is named, or the only one.
void Choose(ExperimentFile& file, const std::string& name) {
  if (name.empty()) return;
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

/// In the place of a simulated arm; what is known of its friction stays.
void PutOnArm(Scenario& scenario, const std::string& address) {
  Gen3Station station;
  if (const auto* there = std::get_if<Gen3Station>(&scenario.station)) station = *there;
  if (const auto* simulated = std::get_if<StationOptions>(&scenario.station))
    station.friction = simulated->friction;
  station.address = address;
  scenario.station = station;
}

}  // namespace

void AddArmOptions(CLI::App& app, ArmTold& told) {
  app.add_option("--arm", told.address,
                 "HOST[:TCP[,UDP]] of a Gen3 that is to be run in the place of the simulated arm");
  app.add_option("--run", told.run, "which of the file's runs the arm is to do");
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

bool IsAboutAnArm(const ExperimentFile& file, const ArmTold& told) {
  return !told.address.empty() || std::ranges::any_of(file.scenarios, IsHardware);
}

int RunOnArmAndTell(ExperimentFile file, const ArmTold& told, const std::filesystem::path& out,
                    bool force) {
  Choose(file, told.run);
  if (!told.address.empty())
    for (Scenario& scenario : file.scenarios) PutOnArm(scenario, told.address);
  const StopSignals signals;
  ArmRunOptions options{.out = out, .force = force, .overrun = kOverruns.at(told.overrun)};
  options.permissions.lock_memory = told.lock_memory;
  if (told.priority > 0) options.permissions.priority = told.priority;
  if (told.cpu >= 0) options.permissions.cpu = told.cpu;
  options.say = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  ArmRun run;
  {
    const Console console(options.panel);
    run = RunOnArm(file, options);
  }
  std::printf("%s\nlog: %s\n", run.text().c_str(), run.log.c_str());
  const bool fault =
      run.safety.cause != SafetyCause::None && run.safety.cause != SafetyCause::UserStop;
  return fault || !run.handing_back.empty() || run.safety.state != SafetyState::Stopped ? 3 : 0;
}

}  // namespace pliant
