#include <CLI/CLI.hpp>

#include "pliant/apps/commands.h"

namespace pliant {

void AddEmulate(CLI::App& app, std::vector<Command>& commands) {
  CLI::App* emulate =
      app.add_subcommand("emulate", "Stands in for a device, and shows faults to order");
  emulate->require_subcommand(1);
  AddEmulateRdt(*emulate, commands);
  AddEmulateBota(*emulate, commands);
  AddEmulateGen3(*emulate, commands);
}

}  // namespace pliant
