#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "pliant/diagrams/fault_order.h"

namespace pliant {

/// What an emulated wrist sensor can be told to show. On the way to who listens:
///
///   lost        packets do not arrive
///   late        they arrive 20 ms later, in among those that are not late
///   duplicated  they arrive twice
///   reordered   they arrive in pairs, the second first
///   corrupted   they arrive with something wrong that who listens can notice
///
/// and in the sensor itself:
///
///   frozen      it measures nothing new, and sends what it measured last
///   silent      it has no power, and begins anew when it has
const std::vector<FaultOrder::Kind>& WristFaultKinds();

/// What the first five do to packets.
class PacketFaults {
 public:
  using Packet = std::vector<std::uint8_t>;

  static constexpr double kLateness = 0.02;  ///< [s]

  /// `corrupt` spoils a packet, in another way for another number.
  PacketFaults(std::vector<FaultOrder> faults,
               std::function<void(Packet&, std::uint32_t number)> corrupt);

  /// What arrives at a time at which a packet is sent, or none is. Times do not go back.
  std::vector<Packet> Pass(double t, std::optional<Packet> sent);

 private:
  std::vector<FaultOrder> faults_;
  std::function<void(Packet&, std::uint32_t)> corrupt_;
  std::uint32_t corrupted_ = 0;
  std::deque<std::pair<double, Packet>> late_;  // and when they are due
  std::optional<Packet> waiting_;               // for the second of its pair
};

}  // namespace pliant
