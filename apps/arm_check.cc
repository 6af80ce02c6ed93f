#include "pliant/apps/arm_check.h"

#include <chrono>
#include <set>
#include <thread>

#include "pliant/plants/gen3_faults.h"
#include "pliant/plants/gen3_wire.h"
#include "pliant/plants/socket.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// What the feedback of a while says of each joint.
std::vector<ArmJoint> Watch(Gen3Link& link, ArmFacts& facts) {
  std::vector<ArmJoint> joints(kGen3Joints);
  std::vector<std::set<float>> torques(kGen3Joints);
  auto next = Clock::now();
  for (int i = 0; i < kFeedbacks; ++i) {
    const Gen3Feedback feedback = link.Read();
    facts.faults = BaseFaultNames(feedback.fault_a);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Gen3Feedback::Actuator& actuator = feedback.actuator[j];
      torques[j].insert(actuator.torque);
      joints[j] = {.torques = static_cast<int>(torques[j].size()),
                   .motor_temperature = actuator.motor_temperature,
                   .core_temperature = actuator.core_temperature,
                   .faults = ActuatorFaultNames(actuator.fault_a)};
    }
    // A sensor has a new value each millisecond; it may be read more often.
    next = std::max(next + 1ms, Clock::now());
    std::this_thread::sleep_until(next);
  }
  return joints;
}

}  // namespace

ArmFacts TryArm(const Gen3Address& address) {
  ArmFacts facts{.address = address.text()};
  const auto begin = Clock::now();
  try {
    ConnectTcp(address.host, address.tcp_port, address.connect_limit);
  } catch (const Error& e) {
    facts.fault = e.what();
    return facts;
  }
  facts.answered_s = std::chrono::duration<double>(Clock::now() - begin).count();
  try {
    const std::unique_ptr<Gen3Link> link = ConnectGen3(address);
    const Gen3Servoing servoing = link->Servoing();
    facts.state = ArmStateName(link->ArmState());
    facts.servoing = Gen3ServoingName(servoing);
    facts.left_low_level = servoing == Gen3Servoing::LowLevel;
    facts.joints = Watch(*link, facts);
  } catch (const Error& e) {
    facts.session_fault = e.what();
  }
  return facts;
}

}  // namespace pliant
