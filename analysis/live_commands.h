#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/analysis/live_parameters.h"
#include "pliant/analysis/row_ring.h"
#include "pliant/plants/robot_model.h"

namespace pliant::internal {

/// What clients of a run may do to it, between the thread that serves them and the one that ticks:
/// set parameters, push a link, stop, acknowledge.
///
/// Requests are checked and put into a ring; the run takes them out before a tick. Neither side
/// waits for the other.
class LiveCommands {
 public:
  using Json = nlohmann::json;
  using Clock = std::chrono::steady_clock;

  struct Options {
    std::vector<TunableValue> tunables;
    std::optional<RobotModel> pushed = {};  ///< whose links may be pushed; none: nobody may push
    bool control = false;                   ///< parameters may be set and links pushed
    std::function<void()> stop, acknowledge = {};
  };

  explicit LiveCommands(Options o);

  // What follows is for the thread that serves. All that is refused throws Error.

  const LiveParameters& parameters() const { return parameters_; }
  bool control() const { return options_.control; }
  bool pushes() const { return options_.control && options_.pushed.has_value(); }

  void SetParameter(std::size_t i, const Json& value);

  /// What a client says on a topic: /push, /pliant/stop, /pliant/acknowledge. `client` is whoever
  /// says it.
  void Publish(std::string_view topic, const Json& message, const void* client);
  static void RequireTopic(std::string_view topic);

  /// Who pushes and is gone lets go, and so does who says nothing more for a quarter of a second.
  void Leave(const void* client);
  void LetGoOfOld(Clock::time_point now);

  // What follows is for the thread that ticks.

  /// A change: `target` is the number of a parameter, or kPush, whose numbers are those of a
  /// ContactForce.
  struct Change {
    int target;
    std::span<const double> numbers;
  };
  static constexpr int kPush = -1;

  /// The oldest change, until the next call of Next; none if there is none.
  std::optional<Change> Next();

 private:
  void Push(const Json& message, const void* client);
  bool PutPush(const ContactForce& F);
  bool Put(int target, std::span<const double> numbers);

  const Options options_;
  LiveParameters parameters_;
  RowRing changes_;
  bool taken_ = false;  // of `changes_` the oldest

  const void* pusher_ = nullptr;
  Clock::time_point pushed_;
};

}  // namespace pliant::internal
