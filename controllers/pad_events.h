#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pliant/controllers/pad_state.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// What can happen to a game controller.
enum class PadHappening : std::uint8_t { Connect, Disconnect, Press, Release };

inline const std::vector<std::string>& Words(PadHappening) {
  static const std::vector<std::string> words{"connect", "disconnect", "press", "release"};
  return words;
}

struct PadEvent {
  double at_s = kToBeGiven;
  PadHappening what = PadHappening::Press;
  std::optional<PadButton> button = {};  ///< of a press or release

  template <class F>
  void Parameters(F&& f) {
    f("at_s", at_s, "s", Between(0, 1e6));
    f("what", what);
    f("button", button);
  }
};

/// What was recorded of a game controller, as a file has it:
///
///   events:
///     - {at_s: 0, what: connect}
///     - {at_s: 1.5, what: press, button: circle}
///     - {at_s: 1.6, what: release, button: circle}
struct PadEvents {
  std::vector<PadEvent> events = {};  ///< in order of time

  template <class F>
  void Parameters(F&& f) {
    f("events", events);
  }

  /// Throws Error "file:line:column: …", or "file: event 2: …", if it is none.
  static PadEvents Read(const std::filesystem::path& file);
  /// Throws Error "event 2: …" if there are buttons where none belong, or times that fall.
  void RequireValid() const;
};

/// What an event makes of a state. Nothing is down of a controller that is not connected.
PadState After(const PadState& state, const PadEvent& event);

/// The events that lead from one state to the next, at its stamp.
std::vector<PadEvent> EventsBetween(const PadState& last, const PadState& next);

/// An event as a line of a file.
std::string LineOf(const PadEvent& event);

}  // namespace pliant
