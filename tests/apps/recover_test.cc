#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>

#include "pliant/tests/plants/fake_gen3.h"

namespace pliant {
namespace {

using kortex::Function;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

struct Ended {
  int code;
  std::string said;  ///< on both outputs
};

/// The command as a user runs it.
Ended Pliant(const std::string& words) {
  std::FILE* pipe = popen((PLIANT_COMMAND " " + words + " 2>&1").c_str(), "r");
  std::string said;
  char some[256];
  while (std::fgets(some, sizeof some, pipe)) said += some;
  return {WEXITSTATUS(pclose(pipe)), said};
}

/// As the option --arm has it.
std::string At(const FakeGen3& arm) {
  return arm.address().text() + "," + std::to_string(arm.address().udp_port);
}

TEST(Recover, BringsTheArmBackAndSaysWhatItFound) {
  FakeGen3 arm;
  const Ended ended =
      Pliant("recover gen3 --clear-faults --user ann --password x --arm " + At(arm));
  EXPECT_EQ(ended.code, 0) << ended.said;
  EXPECT_THAT(ended.said, StartsWith("found: ARMSTATE_SERVOING_READY, SINGLE_LEVEL_SERVOING\n"));
  EXPECT_THAT(ended.said, HasSubstr("\nactuator 7: from NONE to POSITION\n"));
  EXPECT_THAT(ended.said, EndsWith("now: ARMSTATE_SERVOING_READY, SINGLE_LEVEL_SERVOING\n"));
  EXPECT_THAT(arm.asked(Function::ClearFaults), SizeIs(1));
  EXPECT_THAT(arm.asked(Function::SetControlMode), SizeIs(7));
  EXPECT_EQ(arm.servoing(), Kinova::Api::Base::SINGLE_LEVEL_SERVOING);
  Kinova::Api::Session::CreateSessionInfo info;
  const FakeGen3::Asked session = arm.asked(Function::CreateSession).at(0);
  info.ParseFromArray(session.payload.data(), static_cast<int>(session.payload.size()));
  EXPECT_EQ(info.username(), "ann");
  EXPECT_EQ(info.password(), "x");
}

TEST(Recover, CannotGoOnWithoutAnArm) {
  const std::string address = At(FakeGen3());
  const Ended ended = Pliant("recover gen3 --arm " + address);
  EXPECT_EQ(ended.code, 3);
  EXPECT_THAT(ended.said, StartsWith("pliant: cannot reach an arm at 127.0.0.1:"));
}

TEST(Recover, RefusesWhatIsNoAddress) {
  const Ended ended = Pliant("recover gen3 --arm a:b");
  EXPECT_EQ(ended.code, 2);
  EXPECT_EQ(ended.said,
            "pliant: --arm: an arm's address is such as 192.168.1.10 or 192.168.1.10:10000, got "
            "'a:b'\n");
  EXPECT_EQ(Pliant("recover gen3 --arm ''").code, 2);
  EXPECT_EQ(Pliant("recover").code, 2);
}

}  // namespace
}  // namespace pliant
