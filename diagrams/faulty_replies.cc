#include "pliant/diagrams/faulty_replies.h"

#include <utility>

namespace pliant {

std::vector<FaultOrder::Kind> FaultyReplies::Kinds() {
  return {{"lost"}, {"late"}, {"duplicated"}, {"reordered"}, {"corrupted"}, {"truncated"}};
}

void FaultyReplies::Send(std::uint64_t peer, std::span<const std::byte> bytes, double now_s,
                         std::optional<double> faults_s) {
  const auto shows = [&](const char* kind) {
    return faults_s && Shows(o_.faults, kind, *faults_s);
  };
  const RandomStream random = random_.Part(count_++);
  if (shows("lost")) return;
  Reply reply{peer, {bytes.begin(), bytes.end()}};
  const auto below = [&](std::uint64_t n, std::size_t end) {
    return static_cast<std::size_t>(random.Uniform(n) * static_cast<double>(end));
  };
  if (shows("corrupted") && !reply.bytes.empty()) {
    const std::size_t flips = 1 + below(0, 8);
    for (std::size_t n = 1; n <= flips; ++n) {
      const std::size_t bit = below(n, 8 * reply.bytes.size());
      reply.bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    }
  }
  if (shows("truncated")) reply.bytes.resize(below(9, reply.bytes.size()));
  const double due = now_s + o_.delay_s + (shows("late") ? o_.late_s : 0);
  if (shows("reordered") && !held_) {
    held_ = std::move(reply);
    return;
  }
  if (shows("duplicated")) Leave(due, reply);
  Leave(due, std::move(reply));
  if (held_) Leave(due, *std::exchange(held_, {}));
}

void FaultyReplies::Leave(double due_s, Reply reply) {
  if (under_way_.size() >= o_.most) under_way_.erase(under_way_.begin());
  under_way_.emplace(due_s, std::move(reply));  // behind those of the same time
}

std::optional<FaultyReplies::Reply> FaultyReplies::Next(double now_s) {
  if (under_way_.empty() || under_way_.begin()->first > now_s) return {};
  Reply reply = std::move(under_way_.begin()->second);
  under_way_.erase(under_way_.begin());
  return reply;
}

std::optional<double> FaultyReplies::due_s() const {
  if (under_way_.empty()) return {};
  return under_way_.begin()->first;
}

}  // namespace pliant
