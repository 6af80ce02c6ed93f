#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/live_view.h"

namespace CLI {
class App;
}

namespace pliant {

/// What `pliant run --arm` is told beside what `pliant run` is.
struct ArmTold {
  std::string address;
  std::string user = "admin", password = "admin";
  int priority = 0, cpu = -1;  ///< 0, −1: not asked for
  bool lock_memory = false;
  std::string overrun = "skip";
  std::string run;  ///< which of the file's runs
};

void AddArmOptions(CLI::App& app, ArmTold& told);

/// The file as `--arm` and `--set` want it. With an address the arm that is there stands in the
/// place of the file's station, what is known of its friction stays, and `set` is about the new
/// station.
ExperimentFile ReadForArm(const std::filesystem::path& file, const Overrides& set,
                          const ArmTold& told);

/// Leaves the run of that name only. Throws Error with the nearest name if there is none.
void ChooseRun(ExperimentFile& file, const std::string& name);

/// Whether the file is about an arm that is there.
bool IsAboutAnArm(const ExperimentFile& file);

/// Runs it; the exit code: 0 it came to its end or was stopped, 3 a fault ended it. Throws
/// CannotGoOn if there is no such arm.
int RunOnArmAndTell(ExperimentFile file, const ArmTold& told, const std::filesystem::path& out,
                    bool force, LiveView* view);

}  // namespace pliant
