#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pliant/diagrams/fault_order.h"
#include "pliant/systems/random.h"

namespace pliant {

/// Datagrams on their way back, and what a bad network makes of them:
///
///   lost        they do not arrive
///   late        they leave `late_s` later
///   duplicated  each arrives twice
///   reordered   two by two, the second before the first
///   corrupted   1 to 8 bits are flipped
///   truncated   a part of the end is missing, at least a byte
///
/// What is flipped or missing is decided by the seed and the number of the reply.
class FaultyReplies {
 public:
  struct Options {
    std::vector<FaultOrder> faults = {};  ///< those of Kinds act
    double delay_s = 0;                   ///< of each [s]
    double late_s = 0.005;
    std::uint64_t seed = 1;
    std::size_t most = 4096;  ///< on their way; of more the oldest are lost
  };
  struct Reply {
    std::uint64_t peer = 0;
    std::vector<std::byte> bytes;
  };

  explicit FaultyReplies(const Options& o) : o_{o}, random_{o.seed} {}

  static std::vector<FaultOrder::Kind> Kinds();

  /// `faults_s`: the time of faults, none if there are none yet. Both in seconds.
  void Send(std::uint64_t peer, std::span<const std::byte> bytes, double now_s,
            std::optional<double> faults_s);

  /// The next that is due.
  std::optional<Reply> Next(double now_s);
  std::optional<double> due_s() const;  ///< of the next

 private:
  void Leave(double due_s, Reply reply);

  const Options o_;
  const RandomStream random_;
  std::uint64_t count_ = 0;
  std::optional<Reply> held_;
  std::multimap<double, Reply> under_way_;
};

}  // namespace pliant
