#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "pliant/apps/commands.h"
#include "pliant/systems/error.h"

namespace {

constexpr char kExitCodes[] =
    "Exit codes: 0 it ran; 1 a claim fails (--strict), a replay differs or doctor finds "
    "something;\n"
    "2 wrong use or input; 3 it could not go on; 130 stopped by Ctrl-C, what was logged is kept.";

volatile std::sig_atomic_t interrupted = 0;

/// The first Ctrl-C ends the runs as they are, a second one the program.
void Interrupt(int signal) {
  interrupted = 1;
  pliant::stop_requested = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

int main(int argc, char** argv) {
  using pliant::Command;
  CLI::App app{"Torque control of robot arms as diagrams of blocks", "pliant"};
  app.set_version_flag("--version", PLIANT_VERSION);
  app.require_subcommand(1);
  app.footer(std::string("Example: pliant run my_arm.yaml --out out\n") + kExitCodes);

  std::vector<Command> commands;
  pliant::AddRunCommands(app, commands);
  pliant::AddLogCommands(app, commands);
  pliant::AddDoctor(app, commands);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, Interrupt);
  for (const Command& command : commands) {
    if (!*command.app) continue;
    try {
      const int rc = command.act();
      return interrupted ? 130 : rc;
    } catch (const pliant::CannotGoOn& e) {
      std::cerr << "pliant: " << e.what() << '\n';
      return 3;
    } catch (const std::exception& e) {
      std::cerr << "pliant: " << e.what() << '\n';
      return 2;
    }
  }
  return 2;
}
