#include "pliant/controllers/pad_events.h"

#include "pliant/plants/parameter_file.h"

namespace pliant {

void PadEvents::RequireValid() const {
  double last = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const PadEvent& event = events[i];
    const std::string name = "event " + Text(i + 1) + ": ";
    const bool of_button = event.what == PadHappening::Press || event.what == PadHappening::Release;
    RequireInRange("event " + Text(i + 1), event);
    Require(of_button || !event.button,
            name + "expected no button, unless it is a press or release");
    Require(!of_button || event.button, name + "expected the button of a press or release");
    Require(event.at_s >= last,
            name + "must not be before the one before it, at " + Text(last) + " s",
            Text(event.at_s) + " s");
    last = event.at_s;
  }
}

PadEvents PadEvents::Read(const std::filesystem::path& file) {
  PadEvents read;
  ParameterFile::Read(file).Fill(read);
  try {
    read.RequireValid();
  } catch (const Error& e) {
    throw Error(file.string() + ": " + e.what());
  }
  return read;
}

PadState After(const PadState& state, const PadEvent& event) {
  PadState next = state;
  next.stamp_s = event.at_s;
  const PadButtons bit = event.button ? BitOf(*event.button) : 0;
  switch (event.what) {
    case PadHappening::Connect:
      next.connected = true;
      break;
    case PadHappening::Disconnect:
      next.connected = false;
      next.buttons = 0;
      break;
    case PadHappening::Press:
      if (next.connected) next.buttons |= bit;
      break;
    case PadHappening::Release:
      next.buttons &= ~bit;
      break;
  }
  return next;
}

std::vector<PadEvent> EventsBetween(const PadState& last, const PadState& next) {
  std::vector<PadEvent> events;
  const auto add = [&](PadHappening what, std::optional<PadButton> button = {}) {
    events.push_back({.at_s = next.stamp_s, .what = what, .button = button});
  };
  if (next.connected && !last.connected) add(PadHappening::Connect);
  if (!next.connected && last.connected) add(PadHappening::Disconnect);
  if (!next.connected) return events;
  for (std::size_t i = 0; i < Words(PadButton{}).size(); ++i) {
    const auto button = static_cast<PadButton>(i);
    const bool was = last.buttons & BitOf(button), is = next.buttons & BitOf(button);
    if (is != was) add(is ? PadHappening::Press : PadHappening::Release, button);
  }
  return events;
}

std::string LineOf(const PadEvent& event) {
  std::string line = "{at_s: " + Text(event.at_s) + ", what: " + WordOf(event.what);
  if (event.button) line += ", button: " + WordOf(*event.button);
  return line + "}";
}

}  // namespace pliant
