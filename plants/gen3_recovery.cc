#include "pliant/plants/gen3_recovery.h"

#include <functional>

#include "pliant/plants/gen3_faults.h"
#include "pliant/plants/kortex_exchange.h"
#include "pliant/plants/kortex_services.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

std::string Listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all.empty() ? "none" : all;
}

std::vector<std::string> Faults(const Gen3Address& address) {
  try {
    const Gen3Feedback f = kortex::Exchange(address).Read();
    std::vector<std::string> lines;
    if (f.fault_a != 0) lines.push_back("faults of the base: " + Listed(BaseFaultNames(f.fault_a)));
    for (std::size_t i = 0; i < f.actuator.size(); ++i)
      if (const std::uint32_t bank = f.actuator[i].fault_a; bank != 0)
        lines.push_back("faults of actuator " + Text(i + 1) + ": " +
                        Listed(ActuatorFaultNames(bank)));
    if (lines.empty()) lines.push_back("faults: none");
    return lines;
  } catch (const Error& e) {
    return {std::string("faults: not known; ") + e.what()};
  }
}

/// What a call says that may fail.
std::string Told(const std::function<std::string()>& call) {
  try {
    return call();
  } catch (const Error& e) {
    return std::string("not done: ") + e.what();
  }
}

}  // namespace

std::vector<std::string> Recover(const Gen3Address& address, bool clear_faults) {
  kortex::Services arm(address);
  std::vector<std::string> lines;
  const auto found = [&] {
    return ArmStateName(arm.ArmState()) + ", " + Gen3ServoingName(arm.Servoing());
  };
  lines.push_back("found: " + found());
  for (const std::string& line : Faults(address)) lines.push_back("found: " + line);
  if (clear_faults)
    lines.push_back("clear faults: " + Told([&] { return arm.ClearFaults(), "done"; }));
  // Before the servoing: the modes belong to low-level servoing.
  for (int joint = 0; joint < kGen3Joints; ++joint) {
    lines.push_back("actuator " + Text(joint + 1) + ": " + Told([&] {
                      const Gen3Mode mode = arm.Mode(joint);
                      if (mode == Gen3Mode::Position) return "in " + Gen3ModeName(mode);
                      arm.SetMode(joint, Gen3Mode::Position);
                      return "from " + Gen3ModeName(mode) + " to " +
                             Gen3ModeName(Gen3Mode::Position);
                    }));
  }
  arm.SetServoing(Gen3Servoing::SingleLevel);
  const Gen3Servoing now = arm.Servoing();
  if (now != Gen3Servoing::SingleLevel)
    throw Error(address.text() + " is in " + Gen3ServoingName(now) + ", expected " +
                Gen3ServoingName(Gen3Servoing::SingleLevel) +
                "; does another program run it? If not, use the arm's emergency stop");
  lines.push_back("now: " + found());
  return lines;
}

}  // namespace pliant
