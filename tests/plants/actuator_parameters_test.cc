#include "pliant/plants/actuator_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;

TEST(ArmActuators, AreReadFromTheFilesOfTheArms) {
  const ArmActuators gen3 = ArmActuators::Read(kModels + "gen3/actuators.yaml", Gen3().joints());
  EXPECT_EQ(gen3.transmission, Transmission::Elastic);
  EXPECT_EQ(gen3.friction, FrictionLaw::ElastoPlastic);
  ASSERT_EQ(gen3.joint.size(), 7u);
  EXPECT_LT((gen3.reflected_inertia() - PerJoint({{.4, .4, .4, .4, .22, .22, .22}})).norm(), 1e-15);
  EXPECT_LT((gen3.torque_per_ampere() - PerJoint({{11, 11, 11, 11, 7.6, 7.6, 7.6}})).norm(), 1e-13);
  EXPECT_EQ(gen3.torque_limit(), PerJoint({{105, 105, 105, 105, 52, 52, 52}}));
  EXPECT_EQ(gen3.joint[0].friction.coulomb, 3.0);
  EXPECT_EQ(gen3.joint[6].friction.viscous, 1.1);

  const ArmActuators lwr = ArmActuators::Read(kModels + "lwr/actuators.yaml", Lwr().joints());
  ASSERT_EQ(lwr.joint.size(), 7u);
  EXPECT_NEAR(lwr.joint[0].reflected_inertia(), 0.896, 1e-15);
  EXPECT_NEAR(lwr.joint[4].reflected_inertia(), 0.2, 1e-15);
}

const std::string kFile = R"(transmission: rigid
friction: stribeck
sizes:
  one:
    gear_ratio: 50
    torque_constant: 0.1
    rotor_inertia: 1e-5
    current_limit: .inf
    torque_limit: 40
    stiffness: 1000
    coulomb: 1
    viscous: 2
    stiction: 1.5
joints:
  a: one
  b: one
)";

TEST(ArmActuators, TakeWhatTheFileSaysAndDefaultsElsewhere) {
  const ArmActuators arm = ArmActuators::ReadText(kFile, {"a", "b"});
  EXPECT_EQ(arm.transmission, Transmission::Rigid);
  EXPECT_EQ(arm.friction, FrictionLaw::Stribeck);
  EXPECT_EQ(arm.joint[0], arm.joint[1]);
  EXPECT_EQ(arm.joint[0].current_limit, kUnbounded);
  EXPECT_EQ(arm.joint[0].efficiency, 1);
  EXPECT_EQ(arm.joint[0].friction.stribeck_velocity, 0.1);
}

TEST(ArmActuators, NameThePlaceOfWhatIsWrong) {
  const auto error = [](const std::string& from, const std::string& to) {
    std::string text = kFile;
    text.replace(text.find(from), from.size(), to);
    return ErrorOf([&] { ArmActuators::ReadText(text, {"a", "b"}, "arm.yaml"); });
  };
  EXPECT_EQ(error("gear_ratio: 50", "gear_ratio: 0"),
            "arm.yaml:5:17: gear_ratio must be > 0, got 0");
  EXPECT_EQ(error("torque_constant: 0.1", "torque_constant: -0.1"),
            "arm.yaml:6:22: torque_constant must be > 0 N·m/A, got -0.1");
  EXPECT_EQ(error("rotor_inertia: 1e-5", "rotor_inertia: heavy"),
            "arm.yaml:7:20: expected a number [kg·m²], got 'heavy'");
  EXPECT_THAT(error("viscous: 2", "viscos: 2"),
              HasSubstr("arm.yaml:12:5: there is no 'viscos' here; did you mean 'viscous'?"));
  EXPECT_THAT(error("    viscous: 2\n", ""), HasSubstr("'viscous' is missing"));
  EXPECT_EQ(error("viscous: 2", "coulomb: 2"), "arm.yaml:12:5: 'coulomb' is given twice");
  EXPECT_EQ(error("transmission: rigid", "transmission: stiff"),
            "arm.yaml:1:15: expected one of rigid, elastic, got 'stiff'; did you mean 'rigid'?");
  EXPECT_EQ(error("a: one", "a: two"),
            "arm.yaml:15:6: expected one of one, got 'two'; did you mean 'one'?");
  EXPECT_THAT(error("  b: one\n", ""), HasSubstr("'b' is missing"));
  EXPECT_THAT(error("b: one", "c: one"), HasSubstr("there is no 'c' here"));
  EXPECT_THAT(error("sizes:", "size:"), HasSubstr("did you mean 'sizes'?"));
  EXPECT_EQ(error("joints:\n  a: one\n  b: one\n", "joints: 3\n"),
            "arm.yaml:14:9: expected a map, got '3'");
  EXPECT_THAT(error("friction: stribeck", "friction: [stribeck"), HasSubstr("arm.yaml:"));
  EXPECT_EQ(ErrorOf([] { ArmActuators::Read("no/such.yaml", {"a"}); }),
            "no/such.yaml: cannot be read");
  EXPECT_THAT(ErrorOf([] { ArmActuators::ReadText("", {"a"}); }), HasSubstr("'sizes' is missing"));
}

TEST(ArmActuators, AreTorqueSourcesIfIdeal) {
  const ArmActuators arm = ArmActuators::Ideal({"a", "b"}, PerJoint({{0.3, 0.2}}));
  EXPECT_EQ(arm.torque_per_ampere(), PerJoint::Ones(2));
  EXPECT_EQ(arm.reflected_inertia(), PerJoint({{0.3, 0.2}}));
  EXPECT_EQ(ErrorOf([] { ArmActuators::Ideal({"a"}, PerJoint::Ones(3)); }),
            "reflected_inertia has an element for each of the 1 joints, got 3");
}

}  // namespace
}  // namespace pliant
