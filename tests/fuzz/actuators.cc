#include "pliant/plants/actuator_parameters.h"
#include "pliant/plants/friction_file.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/tests/fuzz/targets.h"

namespace pliant::fuzz {

bool Actuators(const std::string& bytes) {
  static const Joints joints{"joint_1", "joint_2", "joint_3"};
  Takes([&] {
    const ParameterFile file = ParameterFile::ReadText(bytes);
    std::string once, again;
    if (!Takes([&] { once = file.yaml(); })) return;
    Check(Takes([&] { again = ParameterFile::ReadText(once).yaml(); }), "what is printed is read");
    Check(once == again, "what is printed reads back the same");
  });
  const bool actuators = Takes([&] {
    const ArmActuators arm = ArmActuators::ReadText(bytes, joints);
    Check(std::ssize(arm.joint) == joints.size(), "each joint has an actuator");
    Checked(joints, arm.joint);
  });
  FrictionFile friction;
  if (!Takes([&] { friction = ReadFrictionText(bytes, joints); })) return actuators;
  const std::string text = friction.text();
  Check(Takes([&] { friction = ReadFrictionText(text, joints); }), "friction reads back");
  Check(friction.text() == text, "friction reads back the same");
  return true;
}

}  // namespace pliant::fuzz
