// What an emulated Gen3 costs: a millisecond of its arm, a Refresh answered by its base, and one
// that goes over the sockets of this machine and back.

#include <BaseCyclic.pb.h>
#include <Session.pb.h>
#include <arpa/inet.h>
#include <benchmark/benchmark.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "pliant/diagrams/gen3_emulator.h"

namespace pliant {
namespace {

using kortex::Function;

std::string Login() {
  Kinova::Api::Session::CreateSessionInfo info;
  info.set_username("admin");
  info.set_password("admin");
  return info.SerializeAsString();
}

std::string Command() {
  Kinova::Api::BaseCyclic::Command command;
  command.set_frame_id(1);
  for (int j = 0; j < kGen3Joints; ++j) {
    auto& a = *command.add_actuators();
    a.set_command_id(1);
    a.set_position(90);
    a.set_current_motor(1);
  }
  return command.SerializeAsString();
}

std::span<const std::byte> BytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

void Millisecond(benchmark::State& state) {
  Gen3Body arm({});
  for (auto _ : state) arm.Step();
}
BENCHMARK(Millisecond)->Unit(benchmark::kMicrosecond);

void Refresh(benchmark::State& state) {
  Gen3Body arm({});
  Gen3Base base(arm, {});
  Gen3Base::Request request;
  request.channel = Gen3Base::Channel::Datagrams;
  const std::string login = Login(), command = Command();
  request.header.function = Function::CreateSession;
  request.payload = BytesOf(login);
  request.header.session = base.Serve(request)->header.session;
  request.header.function = Function::Refresh;
  request.payload = BytesOf(command);
  for (auto _ : state) benchmark::DoNotOptimize(base.Serve(request));
}
BENCHMARK(Refresh)->Unit(benchmark::kMicrosecond);

/// There and back by UDP, in real time or in lock-step.
void RoundTrip(benchmark::State& state, bool lock_step) {
  const Gen3Emulator emulator({.lock_step = lock_step});
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(emulator.udp_port()));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    return state.SkipWithError("cannot connect");
  std::array<std::byte, 4096> bytes;
  std::uint16_t session = 0;
  const auto ask = [&](Function function, const std::string& payload) {
    const std::size_t size =
        kortex::WriteFrame({.session = session, .function = function}, BytesOf(payload), bytes);
    if (::send(fd, bytes.data(), size, 0) < 0) state.SkipWithError("cannot send");
    const ssize_t got = ::recv(fd, bytes.data(), bytes.size(), 0);
    const auto answer = kortex::ReadFrame(
        std::span(bytes).first(static_cast<std::size_t>(std::max(got, ssize_t{0}))));
    if (answer) session = answer->header.session;
  };
  ask(Function::CreateSession, Login());
  const std::string command = Command();
  for (auto _ : state) ask(Function::Refresh, command);
  ::close(fd);
}
BENCHMARK_CAPTURE(RoundTrip, real_time, false)->Unit(benchmark::kMicrosecond)->UseRealTime();
BENCHMARK_CAPTURE(RoundTrip, lock_step, true)->Unit(benchmark::kMicrosecond)->UseRealTime();

}  // namespace
}  // namespace pliant
