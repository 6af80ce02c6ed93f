#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/systems/signal.h"

namespace pliant {

/// The buttons of a game controller, by the names of a DualShock 4.
enum class PadButton : std::uint8_t {
  Cross,
  Circle,
  Square,
  Triangle,
  L1,
  R1,
  Up,
  Down,
  Left,
  Right
};

inline const std::vector<std::string>& Words(PadButton) {
  static const std::vector<std::string> words{"cross", "circle", "square", "triangle", "l1",
                                              "r1",    "up",     "down",   "left",     "right"};
  return words;
}

/// A bit for each button: 1, 2, 4, … in the order of PadButton.
using PadButtons = std::uint32_t;

constexpr PadButtons BitOf(PadButton button) {
  return PadButtons{1} << static_cast<unsigned>(button);
}

/// What a game controller says. One that is missing is not connected, and no button is down.
struct PadState {
  using Space = Nothing;
  static constexpr Quantity quantity{"game controller", ""};

  bool connected = false;
  PadButtons buttons = 0;  ///< that are down
  double stamp_s = 0;      ///< of the last change, on the clock of who saw it [s]

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("connected", connected, "");
    f("buttons", buttons, "");
    f("stamp_s", stamp_s, "s");
  }
};

}  // namespace pliant
