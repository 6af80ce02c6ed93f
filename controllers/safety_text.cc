#include "pliant/controllers/safety_text.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

namespace pliant {

namespace {

struct Meaning {
  std::string_view cause;
  std::string_view unit;   // of value and limit
  std::string_view bound;  // before the limit
  std::string_view per;    // behind it
  std::string_view hint;
};

constexpr std::array<Meaning, 17> kMeanings{{
    {"not_connected", "", "", "",
     "see cable and network, and that no other program runs the arm; what it refused stands above"},
    {"arm_fault", "", "", "", "what the arm reports stands above; release its emergency stop"},
    {"joint_fault", "", "", "", "what the joint reports stands above"},
    {"stale_feedback", " ticks", "allowed less than ", " without a new measurement",
     "see the network to the arm, and its sensors: pliant doctor --arm ADDRESS"},
    {"not_finite", "", "", "", "a sensor is wrong: pliant doctor --arm ADDRESS"},
    {"position_limit", " rad", "limit ", "",
     "bring the joint away from its limit with the arm's own control, and begin elsewhere"},
    {"position_jump", " rad", "allowed ", " in a tick",
     "a sensor is wrong: pliant doctor --arm ADDRESS"},
    {"velocity_limit", " rad/s", "allowed ", "",
     "look at the controller's gains and its reference"},
    {"torque_limit", " N·m", "allowed ", "", "see what the arm carries and what it touches"},
    {"torque_jump", " N·m", "allowed ", " in a tick",
     "did it hit something? If not a torque sensor is wrong: pliant doctor --arm ADDRESS"},
    {"tracking", " rad", "allowed ", " from its command",
     "was it held? If not the reference is too fast"},
    {"temperature", " °C", "allowed ", "", "let the motor cool"},
    {"command_not_finite", "", "", "",
     "the controller computed what is no number: see control.… of the log"},
    {"command_jump", "", "allowed ", " in a tick, in N·m or of currents in A",
     "look at the controller: control.… of the log"},
    {"divergence", " N·m", "allowed ", " from outside",
     "did something lean on the arm? If not its model, payload or friction is wrong"},
    {"overruns", " ticks", "allowed ", " missed in a second",
     "this machine is too slow: pliant doctor; --priority, --cpu and --lock-memory"},
    {"mode", " s", "allowed ", " until the arm is in its mode",
     "what the arm refused stands above"},
}};

const Meaning* MeaningOf(SafetyCause cause) {
  const std::string& word = WordOf(cause);
  const auto* const found = std::ranges::find(kMeanings, std::string_view(word), &Meaning::cause);
  return found == kMeanings.end() ? nullptr : found;
}

/// As many digits as somebody reads in a hurry.
std::string Shown(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

}  // namespace

std::string SafetyText(SafetyCause cause, int joint, double value, double limit) {
  std::string text = WordOf(cause);
  if (joint >= 0) text += " at joint " + Text(joint + 1);
  const Meaning* const meaning = MeaningOf(cause);
  if (!meaning || meaning->bound.empty()) return text;
  const std::string unit(meaning->unit);
  return text + ": " + Shown(value) + unit + ", " + std::string(meaning->bound) + Shown(limit) +
         unit + std::string(meaning->per);
}

std::string SafetyHint(SafetyCause cause) {
  const Meaning* const meaning = MeaningOf(cause);
  return meaning ? std::string(meaning->hint) : "";
}

}  // namespace pliant
