#include "pliant/plants/gen3_faults.h"

#include <ActuatorConfig.pb.h>
#include <Base.pb.h>
#include <Common.pb.h>

namespace pliant {

namespace {

template <class Enum>
std::vector<std::string> Names(std::uint32_t bank, const std::string& (*name)(Enum)) {
  std::vector<std::string> names;
  for (int bit = 0; bit < 32; ++bit) {
    const std::uint32_t mask = 1U << bit;
    if ((bank & mask) == 0) continue;
    const std::string& known = name(static_cast<Enum>(mask));
    names.push_back(known.empty() ? "bit " + std::to_string(bit) : known);
  }
  return names;
}

template <class Enum, class Number>
std::string Name(Number number, const std::string& (*name)(Enum)) {
  const std::string& known = name(static_cast<Enum>(number));
  return known.empty() ? std::to_string(static_cast<std::uint32_t>(number)) : known;
}

}  // namespace

std::vector<std::string> ActuatorFaultNames(std::uint32_t bank_a) {
  return Names(bank_a, &Kinova::Api::ActuatorConfig::SafetyIdentifierBankA_Name<
                           Kinova::Api::ActuatorConfig::SafetyIdentifierBankA>);
}

std::vector<std::string> BaseFaultNames(std::uint32_t bank_a) {
  return Names(bank_a,
               &Kinova::Api::Base::SafetyIdentifier_Name<Kinova::Api::Base::SafetyIdentifier>);
}

std::string ArmStateName(std::uint32_t state) {
  return Name(state, &Kinova::Api::Common::ArmState_Name<Kinova::Api::Common::ArmState>);
}

std::string Gen3ServoingName(Gen3Servoing servoing) {
  return Name(servoing, &Kinova::Api::Base::ServoingMode_Name<Kinova::Api::Base::ServoingMode>);
}

std::string Gen3ModeName(Gen3Mode mode) {
  return Name(
      mode,
      &Kinova::Api::ActuatorConfig::ControlMode_Name<Kinova::Api::ActuatorConfig::ControlMode>);
}

}  // namespace pliant
