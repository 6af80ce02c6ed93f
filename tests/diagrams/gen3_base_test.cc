#include "pliant/diagrams/gen3_base.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pliant/tests/diagrams/kortex_client.h"
#include "pliant/tests/diagrams/kortex_nonsense.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Channel = Gen3Base::Channel;

/// A base that is asked without a network.
struct Asked {
  explicit Asked(const Gen3Base::Options& o = {}) : base{arm, o} {}

  Answered Ask(Function function, const std::string& payload = "", std::uint8_t device = 0,
               Channel channel = Channel::Stream, std::uint64_t peer = 1) {
    const auto answer =
        base.Serve({.channel = channel,
                    .peer = peer,
                    .time_s = time_s,
                    .header = {.device = device,
                               .session = channel == Channel::Stream ? stream : datagrams,
                               .id = ++id,
                               .function = function},
                    .payload = BytesOf(payload)});
    EXPECT_TRUE(answer);
    if (!answer) return {};
    EXPECT_EQ(answer->header.id, id);
    EXPECT_EQ(answer->header.function, function);
    EXPECT_EQ(answer->header.type, kortex::FrameType::Response);
    const Answered own = Own({answer->header, answer->payload});
    if (own.header.error != 0) {
      const auto told = own.As<api::Error>();
      EXPECT_EQ(told.error_code(), own.header.error);
      EXPECT_EQ(told.error_sub_code(), own.header.error_code);
      EXPECT_FALSE(told.error_sub_string().empty());
    }
    return own;
  }
  void Open() {
    stream = Ask(Function::CreateSession, SessionOf()).header.session;
    datagrams = Ask(Function::CreateSession, SessionOf(), 0, Channel::Datagrams).header.session;
  }
  api::SubErrorCodes Enter() {
    return Ask(Function::SetServoingMode, Servoing(api::Base::LOW_LEVEL_SERVOING)).error();
  }
  api::BaseCyclic::Feedback Refresh(const api::BaseCyclic::Command& command) {
    return Ask(Function::Refresh, command.SerializeAsString(), 0, Channel::Datagrams)
        .As<api::BaseCyclic::Feedback>();
  }
  api::BaseCyclic::Feedback Read() {
    return Ask(Function::RefreshFeedback, "", 0, Channel::Datagrams)
        .As<api::BaseCyclic::Feedback>();
  }

  Gen3Body arm{{}};
  Gen3Base base;
  std::uint16_t stream = 0, datagrams = 0, id = 0;
  double time_s = 0;
};

TEST(Gen3Base, AnswersServicesToWhoOpenedASession) {
  Asked asked;
  asked.Open();
  EXPECT_EQ(asked.Ask(Function::GetActuatorCount).As<api::Base::ActuatorInformation>().count(), 7U);
  EXPECT_EQ(asked.Ask(Function::GetArmState).As<api::Base::ArmStateInformation>().active_state(),
            api::Common::ARMSTATE_SERVOING_READY);
  const auto devices = asked.Ask(Function::ReadAllDevices).As<api::DeviceManager::DeviceHandles>();
  ASSERT_EQ(devices.device_handle_size(), 8);
  EXPECT_EQ(devices.device_handle(7).device_identifier(), 7U);
  EXPECT_EQ(devices.device_handle(4).device_type(), api::Common::BIG_ACTUATOR);
  EXPECT_EQ(devices.device_handle(5).device_type(), api::Common::SMALL_ACTUATOR);
  EXPECT_EQ(asked.Ask(Function::KeepAlive).error(), api::SUB_ERROR_NONE);
  EXPECT_EQ(asked.Enter(), api::SUB_ERROR_NONE);
  EXPECT_EQ(
      asked.Ask(Function::GetServoingMode).As<api::Base::ServoingModeInformation>().servoing_mode(),
      api::Base::LOW_LEVEL_SERVOING);
  EXPECT_EQ(asked.Ask(Function::SetControlMode, Mode(api::ActuatorConfig::CURRENT), 3).error(),
            api::SUB_ERROR_NONE);
  EXPECT_EQ(asked.Ask(Function::GetControlMode, "", 3)
                .As<api::ActuatorConfig::ControlModeInformation>()
                .control_mode(),
            api::ActuatorConfig::CURRENT);
  EXPECT_EQ(asked.Ask(Function::GetControlMode, "", 4)
                .As<api::ActuatorConfig::ControlModeInformation>()
                .control_mode(),
            api::ActuatorConfig::POSITION);
}

TEST(Gen3Base, RefusesByTheNamesOfTheProtocol) {
  Asked asked;
  EXPECT_EQ(asked.Ask(Function::KeepAlive).error(), api::INVALID_SESSION);
  EXPECT_EQ(asked.Ask(Function::CreateSession, SessionOf("eve")).error(), api::USER_NOT_FOUND);
  EXPECT_EQ(asked.Ask(Function::CreateSession, SessionOf("admin", "guess")).error(),
            api::INVALID_PASSWORD);
  EXPECT_EQ(asked.Ask(Function::CreateSession, "\xff\xff").error(), api::PAYLOAD_DECODING_ERR);
  asked.Open();
  EXPECT_EQ(asked.Ask(static_cast<Function>(0x50001)).error(), api::UNSUPPORTED_SERVICE);
  EXPECT_EQ(asked.Ask(static_cast<Function>(0x20001)).error(), api::UNSUPPORTED_METHOD);
  EXPECT_EQ(asked.Ask(Function::SetControlMode, "", 0).error(), api::INVALID_DEVICE);
  EXPECT_EQ(asked.Ask(Function::SetControlMode, "", 8).error(), api::INVALID_DEVICE);
  EXPECT_EQ(asked.Ask(Function::GetArmState, "", 3).error(), api::INVALID_DEVICE);
  EXPECT_EQ(asked.Ask(Function::SetControlMode, Mode(api::ActuatorConfig::TORQUE), 1).error(),
            api::WRONG_SERVOING_MODE);
  EXPECT_EQ(asked.Ask(Function::SetServoingMode, Servoing(api::Base::BYPASS_SERVOING)).error(),
            api::UNIMPLEMENTED);
  EXPECT_EQ(asked.Ask(Function::SetServoingMode, "").error(), api::INVALID_PARAM);
  asked.Enter();
  EXPECT_EQ(asked.Ask(Function::SetControlMode, Mode(api::ActuatorConfig::VELOCITY), 1).error(),
            api::UNIMPLEMENTED);
  EXPECT_EQ(asked.Ask(Function::SetControlMode, "", 1).error(), api::INVALID_PARAM);
  EXPECT_EQ(asked.Ask(Function::Refresh, "", 0, Channel::Datagrams).error(),
            api::CONTROL_ACTUATOR_COUNT_MISMATCH);
  EXPECT_EQ(asked.base.refused(), 15);
}

TEST(Gen3Base, AnswersOnlySessionAndCyclicDatagrams) {
  Asked asked;
  asked.Open();
  for (const Function f : {Function::GetArmState, Function::SetServoingMode,
                           Function::SetControlMode, Function::ReadAllDevices})
    EXPECT_EQ(asked.Ask(f, "", 0, Channel::Datagrams).error(), api::UNSUPPORTED_SERVICE);
  EXPECT_EQ(asked.Ask(Function::RefreshFeedback, "", 0, Channel::Datagrams).error(),
            api::SUB_ERROR_NONE);
}

TEST(Gen3Base, KeepsTheSessionsOfItsChannelsAndPeersApart) {
  Asked asked;
  asked.stream = asked.Ask(Function::CreateSession, SessionOf()).header.session;
  asked.datagrams = asked.stream;
  EXPECT_EQ(asked.Ask(Function::RefreshFeedback, "", 0, Channel::Datagrams).error(),
            api::INVALID_SESSION);
  EXPECT_EQ(asked.Ask(Function::KeepAlive, "", 0, Channel::Stream, 2).error(),
            api::INVALID_SESSION);
  EXPECT_EQ(asked.Ask(Function::KeepAlive).error(), api::SUB_ERROR_NONE);
  EXPECT_EQ(asked.Ask(Function::CloseSession).error(), api::SUB_ERROR_NONE);
  EXPECT_EQ(asked.Ask(Function::KeepAlive).error(), api::INVALID_SESSION);
}

TEST(Gen3Base, EndsASilentSessionAndLowLevelServoingWithIt) {
  Asked asked;
  asked.stream =
      asked.Ask(Function::CreateSession, SessionOf("admin", "admin", 500)).header.session;
  EXPECT_EQ(asked.Enter(), api::SUB_ERROR_NONE);
  asked.time_s = 0.5;
  asked.base.Expire(asked.time_s);
  EXPECT_EQ(asked.Ask(Function::KeepAlive).error(), api::SUB_ERROR_NONE);
  asked.time_s = 1.01;
  asked.base.Expire(asked.time_s);
  EXPECT_EQ(asked.arm.servoing(), Gen3Servoing::SingleLevel);
  EXPECT_EQ(asked.Ask(Function::KeepAlive).error(), api::INVALID_SESSION);
}

TEST(Gen3Base, EndsTheSessionThatWasSilentForLongestOfTooMany) {
  Asked asked({.most_sessions = 3});
  std::vector<std::uint16_t> sessions;
  for (int k = 0; k < 3; ++k)
    sessions.push_back(asked.Ask(Function::CreateSession, SessionOf()).header.session);
  asked.stream = sessions[0];
  asked.Ask(Function::KeepAlive);
  sessions.push_back(asked.Ask(Function::CreateSession, SessionOf()).header.session);
  EXPECT_EQ(asked.base.sessions(Channel::Stream), 3U);
  asked.stream = sessions[1];
  EXPECT_EQ(asked.Ask(Function::KeepAlive).error(), api::INVALID_SESSION);
  for (const std::size_t k : {0U, 2U, 3U}) {
    asked.stream = sessions[k];
    EXPECT_EQ(asked.Ask(Function::KeepAlive).error(), api::SUB_ERROR_NONE);
  }
}

TEST(Gen3Base, HasRoomForASession) {
  EXPECT_EQ(ErrorOf([] { const Asked asked({.most_sessions = 0}); }),
            "most_sessions must be in 1 … 65534, got 0");
}

TEST(Gen3Base, RefusesServoingInAFaultAndAnEmergencyStop) {
  Asked asked;
  asked.Open();
  asked.Enter();
  EXPECT_EQ(asked.Ask(Function::ApplyEmergencyStop).error(), api::SUB_ERROR_NONE);
  EXPECT_EQ(asked.Enter(), api::ROBOT_IN_EMERGENCY_STOP);
  EXPECT_EQ(asked.Ask(Function::ClearFaults).error(), api::SUB_ERROR_NONE);
  EXPECT_EQ(asked.Enter(), api::SUB_ERROR_NONE);
  auto command = Echo(asked.Read(), 1);
  command.mutable_actuators(3)->set_position(command.actuators(3).position() + 10);
  asked.Refresh(command);
  asked.arm.Step();
  const auto feedback = asked.Read();
  EXPECT_EQ(feedback.base().active_state(), api::Common::ARMSTATE_IN_FAULT);
  EXPECT_EQ(feedback.actuators(3).fault_bank_a(), api::ActuatorConfig::FOLLOWING_ERROR);
  EXPECT_EQ(asked.Enter(), api::ROBOT_IN_FAULT);
  EXPECT_EQ(asked.Ask(Function::SetControlMode, Mode(api::ActuatorConfig::TORQUE), 1).error(),
            api::ROBOT_IN_FAULT);
  EXPECT_EQ(asked.Ask(Function::ClearActuatorFaults, "", 4).error(), api::SUB_ERROR_NONE);
  EXPECT_EQ(asked.Read().actuators(3).fault_bank_a(), 0U);
  EXPECT_EQ(asked.Enter(), api::ROBOT_IN_FAULT) << "the base keeps its own";
  asked.Ask(Function::ClearFaults);
  EXPECT_EQ(asked.Enter(), api::SUB_ERROR_NONE);
  asked.Ask(Function::SetServoingMode, Servoing(api::Base::SINGLE_LEVEL_SERVOING));
  asked.base.refuses_servoing = true;
  EXPECT_EQ(asked.Enter(), api::ROBOT_NOT_READY);
}

TEST(Gen3Base, RepeatsTheIdsOfACommand) {
  Asked asked({.lock_step = true});
  asked.Open();
  asked.Enter();
  for (unsigned id = 100; id < 110; ++id) {
    const auto feedback = asked.Refresh(Echo(asked.Read(), id));
    EXPECT_EQ(feedback.frame_id(), id);
    for (const auto& a : feedback.actuators()) EXPECT_EQ(a.command_id(), id);
  }
  EXPECT_EQ(asked.arm.ticks(), 10);
}

TEST(Gen3Base, IsTheSameBitForBitInLockStep) {
  const auto run = [] {
    Asked asked({.lock_step = true});
    asked.Open();
    asked.Enter();
    std::string all;
    auto feedback = asked.Read();
    for (unsigned id = 1; id <= 300; ++id) {
      if (id == 10) asked.Ask(Function::SetControlMode, Mode(api::ActuatorConfig::CURRENT), 2);
      auto command = Echo(feedback, id);
      command.mutable_actuators(0)->set_position(command.actuators(0).position() + 0.02F);
      feedback = asked.Refresh(command);
      all += feedback.SerializeAsString();
    }
    return all;
  };
  EXPECT_EQ(run(), run());
}

TEST(Gen3Base, AnswersAPingAndNothingThatIsNoRequest) {
  Asked asked;
  const auto serve = [&](kortex::FrameType type) {
    return asked.base.Serve({.header = {.type = type}, .payload = {}});
  };
  EXPECT_EQ(serve(kortex::FrameType::Ping)->header.type, kortex::FrameType::Pong);
  for (const auto type : {kortex::FrameType::Raw, kortex::FrameType::Response,
                          kortex::FrameType::Notification, kortex::FrameType::Pong})
    EXPECT_FALSE(serve(type));
}

TEST(Gen3Base, SurvivesNonsenseAndThenServesAsBefore) {
  Asked asked;
  asked.Open();
  Nonsense nonsense(7);
  for (int k = 0; k < 100000; ++k) {
    const Channel channel = k % 2 == 0 ? Channel::Stream : Channel::Datagrams;
    const auto bytes = nonsense.Next(k % 2 == 0 ? asked.stream : asked.datagrams);
    if (const auto frame = kortex::ReadFrame(bytes)) {
      const auto answer = asked.base.Serve({.channel = channel,
                                            .peer = 1,
                                            .time_s = 1e-5 * k,
                                            .header = frame->header,
                                            .payload = frame->payload});
      if (answer) {
        EXPECT_LT(answer->payload.size(), 2000U);
      }
    }
    if (k % 100 == 0) asked.arm.Step();
    if (k % 1000 == 0) asked.Open();
  }
  asked.Open();
  asked.Ask(Function::ClearFaults);
  EXPECT_EQ(asked.Enter(), api::SUB_ERROR_NONE);
  const auto feedback = asked.Refresh(Echo(asked.Read(), 1));
  EXPECT_EQ(feedback.actuators_size(), 7);
  for (const auto& a : feedback.actuators()) EXPECT_TRUE(std::isfinite(a.position()));
}

}  // namespace
}  // namespace pliant
