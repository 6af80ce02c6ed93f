#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "pliant/apps/arm_options.h"
#include "pliant/apps/commands.h"
#include "pliant/plants/gen3_recovery.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

struct Told {
  ArmOptions arm;
  bool clear_faults = false;
};

int Act(const Told& told) {
  const Gen3Address address = told.arm.address();
  std::vector<std::string> lines;
  try {
    lines = Recover(address, told.clear_faults);
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
  for (const std::string& line : lines) std::puts(line.c_str());
  return 0;
}

}  // namespace

void AddRecover(CLI::App& app, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  CLI::App* recover = app.add_subcommand("recover", "Brings back an arm that a program has left");
  recover->require_subcommand(1);
  CLI::App* gen3 = recover->add_subcommand(
      "gen3", "A Kinova Gen3: position mode and single-level servoing, where it holds itself");
  gen3->footer(
      "Example: pliant recover gen3 --arm 192.168.1.10 --clear-faults\n"
      "Be at the emergency stop. Ends the control of any program that runs the arm.");
  told->arm.AddTo(*gen3, "ADDRESS[:PORT] of the arm; 192.168.1.10 unless told");
  gen3->add_flag("--clear-faults", told->clear_faults, "clear what faults it has, first");
  commands.push_back({gen3, [told] { return Act(*told); }});
}

}  // namespace pliant
