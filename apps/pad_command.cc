#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "pliant/analysis/write_file.h"
#include "pliant/apps/commands.h"
#include "pliant/apps/pad_device.h"
#include "pliant/apps/says_something.h"
#include "pliant/apps/stop_signals.h"
#include "pliant/controllers/pad_events.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

namespace fs = std::filesystem;

struct Told {
  fs::path record;
  double seconds = 0;
  bool force = false;
};

void Write(const fs::path& file, const std::vector<PadEvent>& events) {
  std::string text = events.empty() ? "events: []\n" : "events:\n";
  for (const PadEvent& event : events) text += "  - " + LineOf(event) + '\n';
  try {
    internal::WriteFile(file, text);
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
}

int Watch(const Told& told) {
  using namespace std::chrono;
  if (!told.record.empty()) internal::RequireNewFile(told.record, told.force);
  const StopSignals signals;
  const PadDevice device;
  const auto began = steady_clock::now();
  const auto ends = [&] {
    return StopSignals::requested ||
           (told.seconds > 0 &&
            duration<double>(steady_clock::now() - began).count() > told.seconds);
  };
  std::puts("waiting for a game controller");
  PadState last;
  std::vector<PadEvent> events;
  while (!ends()) {
    const PadState now = device.latest();
    for (const PadEvent& event : EventsBetween(last, now)) {
      events.push_back(event);
      std::puts(LineOf(event).c_str());
    }
    std::fflush(stdout);
    last = now;
    std::this_thread::sleep_for(1ms);
  }
  if (events.empty()) std::puts("there was none");
  if (!told.record.empty()) Write(told.record, events);
  return StopSignals::requested ? 130 : 0;
}

}  // namespace

void AddPad(CLI::App& app, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  CLI::App* pad = app.add_subcommand("pad", "Shows what a game controller says, and records it");
  pad->footer(
      "Example: pliant pad --seconds 1 --record pad.yaml\n"
      "A recording is what controller.modes.pad of a scenario takes.");
  pad->add_option("--record", told->record, "file for what it says")->check(SaysSomething());
  pad->add_option("--seconds", told->seconds, "how long; else until Ctrl-C")
      ->check(CLI::Range(1e-3, 1e6));
  pad->add_flag("--force", told->force, "write over the file");
  commands.push_back({pad, [told] { return Watch(*told); }});
}

}  // namespace pliant
