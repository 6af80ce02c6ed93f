#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "pliant/apps/commands.h"
#include "pliant/apps/graph_command.h"
#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"

namespace {

constexpr char kExitCodes[] =
    "Exit codes: 0 it ran; 1 a claim fails (--strict), a replay or a run made again differs, a\n"
    "log is not whole, a contact passes its limits or doctor misses something; 2 wrong use or\n"
    "input; 3 it could not go on, runs of a sweep are missing or all failed, or a fault ended the\n"
    "run of an arm; 130 stopped by Ctrl-C, what was logged is kept. The run of an arm that Ctrl-C\n"
    "stops ends with 0.";

/// What CLI11 would call a missing command; the words before the first option name one.
void RequireKnownCommand(const CLI::App& app, int argc, char** argv) {
  const CLI::App* at = &app;
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    const std::string word = argv[i];
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* command : at->get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(command->get_name());
      if (command->get_name() == word) next = command;
    }
    if (names.empty()) return;
    if (!next)
      throw pliant::Error("there is no command '" + word + "'" + pliant::DidYouMean(word, names) +
                          "\n`pliant --help` names them");
    at = next;
  }
}

int Act(const std::vector<pliant::Command>& commands) {
  for (const pliant::Command& command : commands) {
    if (!*command.app) continue;
    const int code = command.act();
    // A full disk may show only now.
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      throw pliant::CannotGoOn("cannot write to the standard output; is its disk full?");
    return code;
  }
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Torque control of robot arms as diagrams of blocks", "pliant"};
  app.set_version_flag("--version", PLIANT_VERSION);
  app.require_subcommand(1);
  app.footer(std::string("Example: pliant run my_arm.yaml --out out\n") + kExitCodes);

  std::vector<pliant::Command> commands;
  pliant::AddRunCommands(app, commands);
  pliant::AddSweepCommands(app, commands);
  pliant::AddGraph(app, commands);
  pliant::AddLogCommands(app, commands);
  pliant::AddIdentifyCommands(app, commands);
  pliant::AddIdentifyDynamics(app, commands);
  pliant::AddDoctor(app, commands);
  pliant::AddPad(app, commands);
  pliant::AddEmulate(app, commands);
  pliant::AddRecover(app, commands);

  // A file that must not grow is an error of writing, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    RequireKnownCommand(app, argc, argv);
    app.parse(argc, argv);
    return Act(commands);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const pliant::CannotGoOn& e) {
    std::cerr << "pliant: " << e.what() << '\n';
    return 3;
  } catch (const std::bad_alloc&) {
    std::cerr << "pliant: there is not enough memory\n";
    return 3;
  } catch (const std::exception& e) {
    std::cerr << "pliant: " << e.what() << '\n';
    return 2;
  }
}
