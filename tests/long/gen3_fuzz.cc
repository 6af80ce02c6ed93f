// Sends nonsense to an emulated Gen3 for as long as it is told, and then a request that makes
// sense.
//
//   gen3_fuzz [SECONDS] [SEED]
//
// Half of it goes to the base in this process, half through its sockets. Takes as long as one has,
// so no test runs it by itself.

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "pliant/diagrams/gen3_emulator.h"
#include "pliant/tests/diagrams/kortex_nonsense.h"

int main(int argc, char** argv) {
  using namespace pliant;
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60;
  const unsigned seed = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
  const auto began = std::chrono::steady_clock::now();
  const auto goes_on = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() <
           seconds;
  };

  Nonsense nonsense(seed);
  Gen3Body arm({});
  Gen3Base base(arm, {.lock_step = true});
  const Gen3Emulator emulator({.lock_step = true});
  long frames = 0, answers = 0;
  while (goes_on()) {
    KortexClient tcp(SOCK_STREAM, emulator.port()), udp(SOCK_DGRAM, emulator.udp_port());
    udp.Open();
    for (int k = 0; k < 500; ++k, frames += 3) {
      const auto bytes = nonsense.Next(static_cast<std::uint16_t>(1 + k % 300));
      const auto channel = k % 2 == 0 ? Gen3Base::Channel::Stream : Gen3Base::Channel::Datagrams;
      if (const auto frame = kortex::ReadFrame(bytes))
        answers += base.Serve({.channel = channel,
                               .peer = 1,
                               .time_s = 1e-3 * static_cast<double>(frames),
                               .header = frame->header,
                               .payload = frame->payload})
                       .has_value();
      udp.Put(nonsense.Next(udp.session));
      tcp.Put(InStreamAsIs(nonsense.Next(tcp.session)));
    }
  }
  KortexClient tcp(SOCK_STREAM, emulator.port()), udp(SOCK_DGRAM, emulator.udp_port());
  tcp.Open();
  udp.Open();
  const bool well = tcp.Ask(Function::ClearFaults).error() == api::SUB_ERROR_NONE &&
                    udp.Ask(Function::RefreshFeedback).error() == api::SUB_ERROR_NONE &&
                    emulator.failure().empty();
  const auto counts = emulator.counts();
  std::printf("%ld frames, %ld answered in this process, %lld refused and %lld unreadable: %s\n",
              frames, answers, static_cast<long long>(counts.refused),
              static_cast<long long>(counts.unreadable), well ? "it is well" : "it is NOT well");
  return well ? 0 : 1;
}
