#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pliant/diagrams/packet_faults.h"
#include "pliant/plants/rdt_frame.h"
#include "pliant/systems/descriptor.h"
#include "pliant/systems/signal.h"
#include "pliant/systems/time.h"

namespace pliant {

/// A Net F/T that is not there: answers RDT requests at a UDP port, and sends a record a tick to
/// who asked last. Requests are those to start, to stop and to take the bias off; other datagrams
/// are no concern of it.
class RdtEmulator {
 public:
  struct Options {
    std::string bind = "127.0.0.1";  ///< address to listen at; "0.0.0.0": all of this machine's
    int port = kRdtPort;             ///< 0: any that is free
    RdtScale scale = {};
    Duration period = 1ms;                ///< of a tick, for the times of faults
    std::vector<FaultOrder> faults = {};  ///< of WristFaultKinds
  };

  /// Throws Error if it cannot listen there.
  explicit RdtEmulator(const Options& o);
  ~RdtEmulator();
  RdtEmulator(const RdtEmulator&) = delete;
  RdtEmulator& operator=(const RdtEmulator&) = delete;

  int port() const;  ///< where it listens

  /// One period passes, in which it measures a wrench; it does not wait.
  void Tick(const Wrench& wrench);

  std::int64_t sent() const { return sent_; }  ///< datagrams

 private:
  struct Peer;

  void Answer(bool hears, const Wrench& wrench);

  const Options options_;
  PacketFaults faults_;
  internal::Descriptor socket_;
  std::unique_ptr<Peer> peer_;  // who asked, and how many records it is to get
  std::int64_t tick_ = 0, sent_ = 0;
  RdtRecord record_;
  Wrench bias_;
};

}  // namespace pliant
