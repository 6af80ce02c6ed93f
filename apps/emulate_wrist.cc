#include <CLI/CLI.hpp>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "pliant/apps/commands.h"
#include "pliant/apps/paced.h"
#include "pliant/apps/says_something.h"
#include "pliant/diagrams/bota_emulator.h"
#include "pliant/diagrams/rdt_emulator.h"
#include "pliant/systems/error.h"
#include "pliant/systems/parameter.h"

namespace pliant {

namespace {

struct Told {
  std::vector<std::string> faults;
  double duration_s = 0;
  std::array<double, 3> force{0, 0, -5};
  double push_s = 2;
  std::string bind = "127.0.0.1";
  int port = kRdtPort;
};

std::vector<FaultOrder> FaultsOf(const Told& told) {
  std::vector<FaultOrder> faults;
  for (const std::string& text : told.faults)
    faults.push_back(FaultOrder::Of(text, WristFaultKinds()));
  return faults;
}

void RequireForce(const Told& told) {
  for (const double newtons : told.force) RequireInRange("", "--force", newtons, "N", kAnyNumber);
}

/// A push that comes and goes: F (1 − cos 2π t/T)/2.
Wrench PushAt(const Told& told, double t) {
  const double part = 0.5 * (1 - std::cos(2 * std::numbers::pi * t / told.push_s));
  return {0, 0, 0, part * told.force[0], part * told.force[1], part * told.force[2]};
}

template <class Emulator>
void Emulate(const Told& told, Duration period, Emulator& emulator) {
  std::fflush(stdout);
  Pace(period, told.duration_s, [&](std::int64_t k) {
    emulator.Tick(PushAt(told, 1e-9 * static_cast<double>(period.Times(k))));
  });
}

int EmulateRdt(const Told& told) {
  constexpr Duration period = 1ms;
  RequireForce(told);
  RdtEmulator emulator(
      {.bind = told.bind, .port = told.port, .period = period, .faults = FaultsOf(told)});
  std::printf("listening at %s:%d\n", told.bind.c_str(), emulator.port());
  Emulate(told, period, emulator);
  std::printf("sent %" PRId64 " records\n", emulator.sent());
  return 0;
}

int EmulateBota(const Told& told) {
  constexpr Duration period = 1250us;
  RequireForce(told);
  BotaEmulator emulator({.period = period, .faults = FaultsOf(told)});
  std::printf("%s\n", emulator.path().c_str());
  Emulate(told, period, emulator);
  std::printf("sent %" PRId64 " frames\n", emulator.sent());
  return 0;
}

CLI::App* AddSensor(CLI::App& emulate, Told& told, const std::string& name, const std::string& what,
                    const std::string& footer) {
  CLI::App* sensor = emulate.add_subcommand(name, what);
  std::string kinds;
  for (const FaultOrder::Kind& kind : WristFaultKinds())
    kinds += (kinds.empty() ? "" : ", ") + kind.name;
  sensor->footer(footer + "\nFaults: " + kinds);
  sensor->add_option("--fault", told.faults, "KIND@START+DURATION in seconds, as often as wanted")
      ->check(SaysSomething());
  sensor->add_option("--duration", told.duration_s, "seconds; else until Ctrl-C")
      ->check(CLI::Range(1e-3, 1e6));
  sensor->add_option("--force", told.force, "X Y Z of the push that comes and goes, in N; 0 0 -5");
  sensor->add_option("--push-period", told.push_s, "from push to push, in s; 2")
      ->check(CLI::Range(1e-3, 1e6));
  return sensor;
}

}  // namespace

void AddEmulateRdt(CLI::App& emulate, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  CLI::App* rdt =
      AddSensor(emulate, *told, "rdt", "A Net F/T: 1000 RDT records a second over UDP to who asks",
                "Example: pliant emulate rdt --port 0 --fault lost@2+0.1\n"
                "The first line is where it listens.");
  rdt->add_option("--port", told->port, "UDP port, 0: any that is free; 49152")
      ->check(CLI::Range(0, 65535));
  rdt->add_option("--bind", told->bind, "IPv4 address to listen at, 0.0.0.0: all; 127.0.0.1")
      ->check(SaysSomething());
  commands.push_back({rdt, [told] { return EmulateRdt(*told); }});
}

void AddEmulateBota(CLI::App& emulate, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  const CLI::App* bota =
      AddSensor(emulate, *told, "bota", "A Bota sensor: 800 frames a second from a pseudo terminal",
                "Example: pliant emulate bota --fault corrupted@2+0.1\n"
                "The first line is the terminal's path.");
  commands.push_back({bota, [told] { return EmulateBota(*told); }});
}

}  // namespace pliant
