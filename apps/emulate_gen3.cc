#include <CLI/CLI.hpp>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "pliant/apps/commands.h"
#include "pliant/apps/says_something.h"
#include "pliant/apps/stop_signals.h"
#include "pliant/diagrams/gen3_emulator.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

struct Told {
  std::vector<std::string> faults;
  std::vector<double> position_deg;
  double payload_kg = 0, duration_s = 0;
  int reply_delay_us = 0, service_delay_ms = 25;
  Gen3Emulator::Options options{.port = 10000, .udp_port = 10001};
};

Gen3Emulator::Options OptionsOf(const Told& told) {
  Gen3Emulator::Options o = told.options;
  for (const std::string& text : told.faults)
    o.faults.push_back(FaultOrder::Of(text, Gen3Emulator::Kinds()));
  o.arm.station.seed = o.seed;
  o.reply_delay = std::chrono::microseconds(told.reply_delay_us);
  o.service_delay = std::chrono::milliseconds(told.service_delay_ms);
  if (!told.position_deg.empty()) {
    o.arm.station.position.resize(std::ssize(told.position_deg));
    for (Eigen::Index j = 0; j < o.arm.station.position.size(); ++j)
      o.arm.station.position(j) =
          std::numbers::pi / 180 * told.position_deg[static_cast<std::size_t>(j)];
  }
  if (told.payload_kg > 0) {
    // A ball of steel would be no wider.
    const double inertia = 0.4 * told.payload_kg * 0.05 * 0.05;
    o.arm.model =
        RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"))
            .WithPayload("tool_frame", {.mass = told.payload_kg,
                                        .inertia = inertia * Eigen::Matrix3d::Identity()});
  }
  return o;
}

std::string TextOf(const Gen3Emulator::Counts& n) {
  char text[400];
  std::snprintf(text, sizeof text,
                "commands %" PRId64 ", sessions %" PRId64 ", connections %" PRId64
                ", refused %" PRId64 ", unreadable %" PRId64 ", ticks %" PRId64
                ", lost ticks %" PRId64 ", worst lateness %.3f ms",
                n.commands, n.sessions, n.connections, n.refused, n.unreadable, n.ticks,
                n.lost_ticks, n.worst_late_ms);
  return text;
}

int Emulate(const Told& told) {
  using namespace std::chrono_literals;
  const StopSignals signals;
  const Gen3Emulator emulator(OptionsOf(told));
  const std::string& bind = told.options.bind;
  std::printf("listening on %s:%d, UDP %d\n", bind.c_str(), emulator.port(), emulator.udp_port());
  if (!bind.starts_with("127."))
    std::printf("warning: %s is no address of this machine alone; who reaches it may command\n",
                bind.c_str());
  std::fflush(stdout);
  const auto began = std::chrono::steady_clock::now();
  while (!StopSignals::requested && emulator.failure().empty() &&
         (told.duration_s == 0 ||
          std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() <
              told.duration_s))
    std::this_thread::sleep_for(10ms);
  const std::string failure = emulator.failure();
  std::puts(TextOf(emulator.counts()).c_str());
  if (!failure.empty()) throw CannotGoOn(failure);
  return 0;
}

/// The kinds of faults, in lines.
std::string Kinds() {
  std::string text, line;
  for (const FaultOrder::Kind& kind : Gen3Emulator::Kinds()) {
    const std::string word = kind.name + (kind.of_joint ? ":J" : "");
    if (line.size() + word.size() > 90) {
      text += line + "\n";
      line.clear();
    }
    line += (line.empty() ? "  " : " ") + word;
  }
  return text + line;
}

}  // namespace

void AddEmulateGen3(CLI::App& emulate, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  Gen3Emulator::Options& o = told->options;
  CLI::App* gen3 = emulate.add_subcommand(
      "gen3", "A Kinova Gen3 on the network: Kinova's protocol, and a simulated arm behind it");
  gen3->footer(
      "Example: pliant emulate gen3 --port 0 --udp-port 0 --fault torque_sensor_dead@1+2:4\n"
      "The first line says where it listens, the last what it counted. Faults, in seconds since\n"
      "low-level servoing began:\n" +
      Kinds());
  gen3->add_option("--port", o.port, "of services, TCP; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  gen3->add_option("--udp-port", o.udp_port, "of the cyclic exchange; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  gen3->add_option("--bind", o.bind, "IPv4 address to listen on, 0.0.0.0: all")
      ->check(SaysSomething())
      ->capture_default_str();
  gen3->add_flag("--lock-step", o.lock_step,
                 "time goes on by 1 ms with each command, and not by itself");
  gen3->add_option("--fault", told->faults, "KIND@START+DURATION[:JOINT], as often as wanted")
      ->check(SaysSomething())
      ->allow_extra_args(false);
  gen3->add_flag("--ideal", o.arm.station.ideal,
                 "without friction, elastic gears, noise and stops");
  gen3->add_option("--position", told->position_deg, "where it starts: 7 angles in degrees");
  gen3->add_option("--payload", told->payload_kg, "at the tool, in kg")->check(CLI::Range(0., 10.));
  gen3->add_option("--seed", o.seed, "of noise and faults")->capture_default_str();
  gen3->add_option("--reply-delay", told->reply_delay_us, "of the cyclic exchange, in µs")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  gen3->add_option("--service-delay", told->service_delay_ms,
                   "of services, in ms; none in lock-step")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  gen3->add_option("--duration", told->duration_s, "seconds; else until Ctrl-C")
      ->check(CLI::Range(1e-3, 1e6));
  gen3->add_option("--user", o.user, "who may open a session")->capture_default_str();
  gen3->add_option("--password", o.password, "of the user")->capture_default_str();
  commands.push_back({gen3, [told] { return Emulate(*told); }});
}

}  // namespace pliant
