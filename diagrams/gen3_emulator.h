#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pliant/diagrams/gen3_base.h"
#include "pliant/diagrams/gen3_body.h"

namespace pliant {

/// A Kinova Gen3 on the network, with a simulated arm: TCP for services, UDP for the cyclic
/// exchange, both by one thread.
///
///   client ◀─ frames ─▶ base ◀─ commands, feedback ─▶ body
///
/// Two clocks. Real time: the arm is stepped each millisecond of the wall clock, and a Refresh is
/// answered by the last step. Lock-step: time stands still but for Refresh and RefreshCommand, each
/// of which steps the arm by 1 ms before it is answered; the same requests have the same answers,
/// bit for bit.
///
/// Answers to services take `service_delay`, without holding up anything else. A client that sends
/// nonsense, does not read, or floods the arm is answered, ignored or hung up on, and holds up
/// nobody else: what is kept for it is bounded. Of more than `most_connections` the one that was
/// silent for longest is hung up on.
///
/// Faults can be ordered, in seconds since low-level servoing first began; in lock-step these are
/// thousands of commands, lost ones as well. Besides those of Gen3Body and FaultyReplies:
///
///   lost_requests     cyclic requests do not arrive; in lock-step each lets a millisecond pass
///   silent            nothing is answered; commands act
///   session_expired   all sessions end, once
///   tcp_reset         connections are reset, new ones too
///   servoing_refused  low-level servoing is ROBOT_NOT_READY
///   slow_services     they take 500 ms
///
/// Before low-level servoing the time of servoing_refused and slow_services stands at 0, and there
/// are no other faults.
class Gen3Emulator {
 public:
  struct Options {
    Gen3Body::Options arm = {};  ///< without faults: those below are meant
    std::string user = "admin", password = "admin";
    std::string bind = "127.0.0.1";  ///< IPv4
    int port = 0, udp_port = 0;      ///< 0: the kernel chooses
    bool lock_step = false;
    std::chrono::microseconds reply_delay{0};        ///< of datagrams; none in lock-step
    std::chrono::microseconds service_delay{25000};  ///< none in lock-step
    std::vector<FaultOrder> faults = {};
    std::uint64_t seed = 1;  ///< of faults; that of the sensors' noise is the station's
    std::size_t most_connections = 512;
  };

  struct Counts {
    std::int64_t commands = 0;     ///< cyclic requests that were answered
    std::int64_t sessions = 0;     ///< opened
    std::int64_t refused = 0;      ///< requests answered by an error
    std::int64_t unreadable = 0;   ///< datagrams and streams that are no frames
    std::int64_t connections = 0;  ///< accepted
    std::int64_t ticks = 0;        ///< of the arm
    std::int64_t lost_ticks = 0;   ///< that the machine was too slow for
    double worst_late_ms = 0;      ///< of a tick
  };

  /// Listens from here on. Throws Error if it cannot.
  explicit Gen3Emulator(const Options& o);
  ~Gen3Emulator();

  int port() const;
  int udp_port() const;
  Counts counts() const;
  /// Why it does not go on; empty: it does.
  std::string failure() const;

  /// All faults that can be ordered.
  static std::vector<FaultOrder::Kind> Kinds();

 private:
  class Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace pliant
