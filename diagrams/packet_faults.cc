#include "pliant/diagrams/packet_faults.h"

namespace pliant {

const std::vector<FaultOrder::Kind>& WristFaultKinds() {
  static const std::vector<FaultOrder::Kind> kinds{
      {"lost"}, {"late"}, {"duplicated"}, {"reordered"}, {"corrupted"}, {"frozen"}, {"silent"}};
  return kinds;
}

PacketFaults::PacketFaults(std::vector<FaultOrder> faults,
                           std::function<void(Packet&, std::uint32_t)> corrupt)
    : faults_{std::move(faults)}, corrupt_{std::move(corrupt)} {}

std::vector<PacketFaults::Packet> PacketFaults::Pass(double t, std::optional<Packet> sent) {
  std::vector<Packet> arrives;
  for (; !late_.empty() && late_.front().first <= t; late_.pop_front())
    arrives.push_back(std::move(late_.front().second));
  if (!sent || Shows(faults_, "lost", t)) return arrives;
  if (Shows(faults_, "corrupted", t)) corrupt_(*sent, corrupted_++);
  if (Shows(faults_, "late", t)) {
    late_.emplace_back(t + kLateness, std::move(*sent));
    return arrives;
  }
  const bool swaps = Shows(faults_, "reordered", t);
  if (swaps && !waiting_) {
    waiting_ = std::move(sent);
    return arrives;
  }
  if (waiting_ && !swaps) arrives.push_back(*std::exchange(waiting_, {}));
  if (Shows(faults_, "duplicated", t)) arrives.push_back(*sent);
  arrives.push_back(std::move(*sent));
  if (waiting_) arrives.push_back(*std::exchange(waiting_, {}));
  return arrives;
}

}  // namespace pliant
