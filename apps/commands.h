#pragma once

#include <functional>
#include <stdexcept>
#include <vector>

namespace CLI {
class App;
}

namespace pliant {

/// A command of the program and what it does; it returns the exit code.
struct Command {
  const CLI::App* app;
  std::function<int()> act;
};

/// Something went wrong that the user's words are not to blame for.
class CannotGoOn : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void AddRunCommands(CLI::App& app, std::vector<Command>& commands);  ///< run, experiment, report
void AddLogCommands(CLI::App& app, std::vector<Command>& commands);  ///< replay, export, log
void AddIdentifyCommands(CLI::App& app, std::vector<Command>& commands);  ///< identify friction
void AddIdentifyDynamics(CLI::App& app, std::vector<Command>& commands);  ///< identify dynamics
void AddDoctor(CLI::App& app, std::vector<Command>& commands);
void AddPad(CLI::App& app, std::vector<Command>& commands);
void AddEmulate(CLI::App& app, std::vector<Command>& commands);
void AddSweepCommands(CLI::App& app, std::vector<Command>& commands);  ///< sweep, merge, rerun
void AddRecover(CLI::App& app, std::vector<Command>& commands);        ///< recover gen3

/// Devices of `emulate`.
void AddEmulateRdt(CLI::App& emulate, std::vector<Command>& commands);
void AddEmulateBota(CLI::App& emulate, std::vector<Command>& commands);
void AddEmulateGen3(CLI::App& emulate, std::vector<Command>& commands);

}  // namespace pliant
