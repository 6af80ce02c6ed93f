#pragma once

#include "pliant/controllers/arm_control.h"
#include "pliant/controllers/compliance_supervisor.h"
#include "pliant/controllers/pad_state.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What a person wants by a game controller, sampled every h. Each press changes something:
///
///   cross     dual compliance, on or off
///   square    compliance of the tool, on or off: with it the whole body gives way
///   triangle  compliance of the null space, on or off
///   circle    position control or torques
///   R1, L1    torques through the proposed loop, through Kinova's
///   d-pad     up or right: the tool swings; down or left: it does not
///
/// Without a game controller, or when it is unplugged, what was wanted stays; a button that is down
/// when it comes back is no press.
/// Source: Muraccioli et al. 2025 (RSS), the software of their demonstration.
class PadModes final : public Block {
 public:
  struct Options {
    ComplianceMode mode = ComplianceMode::NullSpace;  ///< these three at first
    bool dynamic = false;
    ArmControl control = ArmControl::ProposedTorque;
    Duration period = 1ms;  ///< h
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    bool dual = false, tool = false, null_space = true, dynamic = false, position = false;
    ArmControl loop = ArmControl::ProposedTorque;
    bool connected = false;
    PadButtons buttons = 0;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("dual", dual, "");
      f("tool", tool, "");
      f("null_space", null_space, "");
      f("dynamic", dynamic, "");
      f("position", position, "");
      f("loop", loop, "");
      f("connected", connected, "");
      f("buttons", buttons, "");
    }
  };

  explicit PadModes(const Options& o)
      : pad{this, "pad", {}, PadState{}},
        mode{this, "mode"},
        dynamic{this, "dynamic"},
        control{this, "control"},
        memory_{this, "memory", {}, AtFirst(o)} {
    Every(o.period).Compute(memory_).From(memory_, pad).As(&PadModes::Next);
    Compute(mode).From(memory_).As([](const Memory& m) {
      return m.dual         ? ComplianceMode::Dual
             : m.tool       ? ComplianceMode::FullBody
             : m.null_space ? ComplianceMode::NullSpace
                            : ComplianceMode::Stiff;
    });
    Compute(dynamic).From(memory_).As([](const Memory& m) { return m.dynamic; });
    Compute(control).From(memory_).As(
        [](const Memory& m) { return m.position ? ArmControl::Position : m.loop; });
  }

  Input<PadState> pad;  ///< none if not connected
  Output<ComplianceMode> mode;
  Output<bool> dynamic;
  Output<ArmControl> control;

 private:
  static Memory AtFirst(const Options& o) {
    return {.dual = o.mode == ComplianceMode::Dual,
            .tool = o.mode == ComplianceMode::FullBody,
            .null_space = o.mode != ComplianceMode::Stiff,
            .dynamic = o.dynamic,
            .position = o.control == ArmControl::Position,
            .loop = o.control == ArmControl::Position ? ArmControl::ProposedTorque : o.control};
  }

  Memory Next(const Memory& last, const PadState& now) const {
    Memory m = last;
    m.connected = now.connected;
    m.buttons = now.buttons;
    if (!now.connected || !last.connected) return m;
    const auto pressed = [fresh = now.buttons & ~last.buttons](PadButton button) {
      return (fresh & BitOf(button)) != 0;
    };
    using enum PadButton;
    if (pressed(Cross)) m.dual = !m.dual;
    if (pressed(Square)) m.tool = !m.tool;
    if (pressed(Triangle)) m.null_space = !m.null_space;
    if (pressed(Circle)) m.position = !m.position;
    if (pressed(R1)) m.loop = ArmControl::ProposedTorque;
    if (pressed(L1)) m.loop = ArmControl::KinovaTorque;
    if (pressed(Up) || pressed(Right)) m.dynamic = true;
    if (pressed(Down) || pressed(Left)) m.dynamic = false;
    return m;
  }

  Output<Memory> memory_;
};

}  // namespace pliant
