#include "pliant/plants/gen3_wire.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "pliant/tests/plants/fake_gen3.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using kortex::Function;
using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using Asked = FakeGen3::Asked;
using Frames = std::vector<FakeGen3::Bytes>;

/// Answers one function in a way of its own.
FakeGen3::Answer To(Function function, std::function<Frames(const Asked&)> answer) {
  return [=](const Asked& asked) -> std::optional<Frames> {
    if (asked.header.function != function) return {};
    return answer(asked);
  };
}

/// As long as anybody waits for an answer that comes.
constexpr auto kLong = 60s;

TEST(Gen3Wire, OpensASessionOnBothWaysAndEchoesTheirNumbers) {
  FakeGen3 arm;
  {
    const auto link = ConnectGen3(arm.address());
    EXPECT_EQ(link->ActuatorCount(), 7);
    link->Send({});
    EXPECT_TRUE(link->connected());
  }
  const std::vector<Asked> sessions = arm.asked(Function::CreateSession);
  ASSERT_EQ(sessions.size(), 2U);
  EXPECT_FALSE(sessions[0].udp);
  EXPECT_TRUE(sessions[1].udp);
  for (const Asked& asked : sessions) {
    EXPECT_EQ(asked.header.session, 0);
    EXPECT_EQ(asked.header.type, kortex::FrameType::Request);
    Kinova::Api::Session::CreateSessionInfo info;
    ASSERT_TRUE(info.ParseFromArray(asked.payload.data(), static_cast<int>(asked.payload.size())));
    EXPECT_EQ(info.username(), "admin");
    EXPECT_EQ(info.password(), "admin");
    EXPECT_EQ(info.session_inactivity_timeout(), 60000U);
    EXPECT_EQ(info.connection_inactivity_timeout(), 2000U);
  }
  EXPECT_EQ(arm.asked(Function::GetActuatorCount).at(0).header.session, FakeGen3::kTcpSession);
  EXPECT_EQ(arm.asked(Function::Refresh).at(0).header.session, FakeGen3::kUdpSession);
  const std::vector<Asked> closed = arm.asked(Function::CloseSession);
  ASSERT_EQ(closed.size(), 2U);
  EXPECT_NE(closed[0].udp, closed[1].udp);
}

TEST(Gen3Wire, CallsTheServicesOfTheProtocol) {
  FakeGen3 arm;
  const auto link = ConnectGen3(arm.address());
  link->ClearFaults();
  EXPECT_EQ(arm.asked(Function::ClearFaults).size(), 1U);
  EXPECT_EQ(link->ArmState(), 7U);  // ARMSTATE_SERVOING_READY
  EXPECT_EQ(link->Servoing(), Gen3Servoing::SingleLevel);
  link->SetServoing(Gen3Servoing::LowLevel);
  EXPECT_EQ(link->Servoing(), Gen3Servoing::LowLevel);
  for (int joint = 0; joint < kGen3Joints; ++joint) {
    link->SetMode(joint, Gen3Mode::Current);
    EXPECT_EQ(link->Mode(joint), Gen3Mode::Current);
    EXPECT_EQ(arm.asked(Function::SetControlMode).back().header.device, joint + 1);
  }
  EXPECT_EQ(ErrorOf([&] { link->SetMode(7, Gen3Mode::Torque); }),
            "a joint of a Gen3 must be 0 ... 6, got 7");
  EXPECT_EQ(ErrorOf([&] { link->Mode(-1); }), "a joint of a Gen3 must be 0 ... 6, got -1");
}

TEST(Gen3Wire, NamesAWrongPasswordAndTheWayOut) {
  FakeGen3 arm(To(Function::CreateSession, [](const Asked& asked) {
    return Frames{FakeGen3::Refusal(asked, Kinova::Api::INVALID_PASSWORD, "no such luck")};
  }));
  Gen3Address address = arm.address();
  address.user = "ann";
  EXPECT_EQ(ErrorOf([&] { ConnectGen3(address); }),
            address.text() +
                " refused CreateSession for user 'ann': ERROR_DEVICE, INVALID_PASSWORD, \"no such "
                "luck\"; user and password are those of the arm's web page: --user and --password");
}

TEST(Gen3Wire, SaysWhatTheArmAnsweredAndGoesOn) {
  FakeGen3 arm(To(Function::SetControlMode, [](const Asked& asked) {
    return Frames{asked.header.device == 3
                      ? FakeGen3::Refusal(asked, Kinova::Api::WRONG_SERVOING_MODE, "")
                      : FakeGen3::Refusal(asked, Kinova::Api::SubErrorCodes(999), "new")};
  }));
  const auto link = ConnectGen3(arm.address());
  const std::string place = arm.address().text();
  EXPECT_EQ(ErrorOf([&] { link->SetMode(2, Gen3Mode::Torque); }),
            place +
                " refused SetControlMode TORQUE of actuator 3: ERROR_DEVICE, WRONG_SERVOING_MODE; "
                "set the servoing mode first; `pliant recover gen3` brings back an arm that was "
                "left in another");
  EXPECT_EQ(
      ErrorOf([&] { link->SetMode(3, Gen3Mode::Torque); }),
      place + " refused SetControlMode TORQUE of actuator 4: ERROR_DEVICE, code 999, \"new\"");
  EXPECT_EQ(link->ActuatorCount(), 7);
}

TEST(Gen3Wire, HasAWayOutOfTheCommonRefusals) {
  using namespace Kinova::Api;
  const std::vector<std::pair<SubErrorCodes, std::string>> ways{
      {USER_NOT_FOUND, "user and password are those of the arm's web page: --user and --password"},
      {ROBOT_IN_FAULT, "then clear them: `pliant recover gen3 --clear-faults`"},
      {ROBOT_IN_EMERGENCY_STOP, "release the emergency stop"},
      {SESSION_NOT_IN_CONTROL, "another session is in control"},
      {INVALID_SESSION, "connect anew"},
      {INVALID_DEVICE, "has the arm seven actuators?"},
      {ROBOT_NOT_READY, "wait until the arm has started"}};
  std::atomic<std::size_t> now = 0;
  FakeGen3 arm(To(Function::ClearFaults, [&](const Asked& asked) {
    return Frames{FakeGen3::Refusal(asked, ways[now].first, "")};
  }));
  const auto link = ConnectGen3(arm.address());
  for (; now < ways.size(); ++now)
    EXPECT_THAT(ErrorOf([&] { link->ClearFaults(); }), HasSubstr(ways[now].second));
}

TEST(Gen3Wire, TakesTheAnswerWithTheIdOfItsRequestOnly) {
  FakeGen3 arm(To(Function::GetActuatorCount, [](const Asked& asked) {
    Kinova::Api::Base::ActuatorInformation wrong, right;
    wrong.set_count(6);
    right.set_count(7);
    Asked other = asked;
    ++other.header.id;
    Asked notification = asked;
    kortex::Header note = asked.header;
    note.type = kortex::FrameType::Notification;
    return Frames{FakeGen3::Response(other, FakeGen3::Of(wrong)),
                  FakeGen3::Framed(note, FakeGen3::Of(wrong)), FakeGen3::Bytes(5, std::byte(0xFF)),
                  FakeGen3::Response(asked, FakeGen3::Of(right)),
                  FakeGen3::Response(asked, FakeGen3::Of(right))};
  }));
  const auto link = ConnectGen3(arm.address());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(link->ActuatorCount(), 7);
  EXPECT_EQ(link->ArmState(), 7U);
}

TEST(Gen3Wire, RefusesAnAnswerThatIsAnotherMessage) {
  FakeGen3 arm(To(Function::GetArmState, [](const Asked& asked) {
    return Frames{FakeGen3::Response(asked, FakeGen3::Bytes(3, std::byte(0xFF)))};
  }));
  const auto link = ConnectGen3(arm.address());
  EXPECT_EQ(
      ErrorOf([&] { link->ArmState(); }),
      "cannot read the answer of " + arm.address().text() +
          " to GetArmState: its 3 bytes are another message; is its firmware of a version 2?");
}

TEST(Gen3Wire, SaysThatTheArmIsSilent) {
  FakeGen3 arm(To(Function::CreateSession, [](const Asked&) { return Frames{}; }));
  Gen3Address address = arm.address();
  address.answer_limit = 50ms;
  EXPECT_EQ(ErrorOf([&] { ConnectGen3(address); }),
            address.text() +
                " did not answer CreateSession for user 'admin' within 0.05 s; is it a Kinova "
                "Gen3, and has it started?");
}

TEST(Gen3Wire, SaysThatUdpIsSilent) {
  FakeGen3 arm([](const Asked& asked) -> std::optional<Frames> {
    if (asked.udp) return Frames{};
    return {};
  });
  Gen3Address address = arm.address();
  address.connect_limit = 300ms;
  EXPECT_THAT(ErrorOf([&] { ConnectGen3(address); }),
              HasSubstr("CreateSession for user 'admin' by UDP, at port " +
                        std::to_string(address.udp_port) + " within 0.3 s"));
  // What is lost is asked for again.
  EXPECT_GT(std::ranges::count(arm.asked(Function::CreateSession), true, &Asked::udp), 1);
}

TEST(Gen3Wire, SaysWhyNobodyIsReached) {
  Gen3Address address = FakeGen3().address();  // gone
  EXPECT_EQ(ErrorOf([&] { ConnectGen3(address); }),
            "cannot reach an arm at " + address.text() +
                ": Connection refused; is it switched on and wired, and this machine in its "
                "network (a Gen3's is 192.168.1.0/24)?");
}

TEST(Gen3Wire, ThrowsOnceTheConnectionIsCut) {
  FakeGen3 arm;
  const auto link = ConnectGen3(arm.address());
  arm.Cut();
  EXPECT_TRUE(Eventually([&] { return !link->connected(); }));  // the keeper notices
  EXPECT_EQ(ErrorOf([&] { link->ClearFaults(); }),
            "the connection to " + arm.address().text() +
                " is lost: ClearFaults was not sent; connect anew");
  Gen3Feedback feedback;
  ASSERT_NE(link->Send({}), -1);
  EXPECT_TRUE(link->Receive(feedback, kLong));  // UDP is a way of its own
}

TEST(Gen3Wire, ThrowsOnceTheStreamIsOutOfStep) {
  FakeGen3 arm(To(Function::ClearFaults, [](const Asked&) {
    return Frames{FakeGen3::Bytes(70000, std::byte(7))};  // longer than a frame may be
  }));
  const auto link = ConnectGen3(arm.address());
  EXPECT_THAT(ErrorOf([&] { link->ClearFaults(); }),
              AllOf(HasSubstr("is lost: a frame must be no longer than 65507 bytes, got 70000"),
                    EndsWith("; connect anew")));
  EXPECT_FALSE(link->connected());
}

TEST(Gen3Wire, KeepsBothSessionsAliveAndLosesAnArmThatIsSilent) {
  std::atomic<bool> silent = false;
  FakeGen3 arm(To(Function::KeepAlive, [&](const Asked& asked) {
    return silent ? Frames{} : Frames{FakeGen3::Response(asked)};
  }));
  Gen3Address address = arm.address();
  address.connection_timeout = 100ms;
  const auto link = ConnectGen3(address);
  for (const bool udp : {false, true})
    EXPECT_TRUE(Eventually(
        [&] { return std::ranges::count(arm.asked(Function::KeepAlive), udp, &Asked::udp) >= 2; }));
  EXPECT_TRUE(link->connected());
  silent = true;
  EXPECT_TRUE(Eventually([&] { return !link->connected(); }));
}

TEST(Gen3Wire, ReadsWhatTheSensorsSayWithoutACommand) {
  FakeGen3 arm;
  const auto link = ConnectGen3(arm.address());
  const Gen3Feedback feedback = link->Read();
  EXPECT_EQ(feedback.frame_id, 77U);
  EXPECT_EQ(feedback.arm_state, 7U);
  EXPECT_EQ(feedback.actuator[2].position, 21);
  EXPECT_EQ(feedback.actuator[2].torque, -1);
  EXPECT_EQ(feedback.actuator[6].velocity, -6);
  EXPECT_EQ(feedback.actuator[6].core_temperature, 35);
  EXPECT_TRUE(arm.asked(Function::Refresh).empty());
}

TEST(Gen3Wire, AsksForFeedbackAgainIfItIsLost) {
  std::atomic<int> times = 0;
  FakeGen3 arm(To(Function::RefreshFeedback, [&](const Asked& asked) {
    if (++times < 3) return Frames{};
    return Frames{FakeGen3::Response(asked, FakeGen3::Of(FakeGen3::Healthy()))};
  }));
  Gen3Address address = arm.address();
  address.connect_limit = kLong;
  EXPECT_EQ(ConnectGen3(address)->Read().frame_id, 77U);
  EXPECT_GE(times, 3);
}

TEST(Gen3Wire, RefusesToReadAnArmOfSixJoints) {
  FakeGen3 arm(To(Function::RefreshFeedback, [](const Asked& asked) {
    return Frames{FakeGen3::Response(asked, FakeGen3::Of(FakeGen3::Healthy(6)))};
  }));
  EXPECT_THAT(ErrorOf([&] { ConnectGen3(arm.address())->Read(); }),
              AllOf(HasSubstr("cannot read the feedback of " + arm.address().text()),
                    HasSubstr("expected that of 7 actuators"),
                    EndsWith("is it a Gen3 of 7 degrees of freedom?")));
}

TEST(Gen3Wire, WritesACommandUnderOneIdWithoutFlags) {
  FakeGen3 arm;
  const auto link = ConnectGen3(arm.address());
  Gen3Command command;
  for (int i = 0; i < kGen3Joints; ++i) {
    const auto x = static_cast<float>(i);
    command.actuator[static_cast<std::size_t>(i)] = {
        .position = 300 + x, .velocity = -x, .torque = 2 * x, .current = 0.25F * x};
  }
  const int id = link->Send(command);
  ASSERT_GE(id, 0);
  Gen3Feedback feedback;
  ASSERT_TRUE(link->Receive(feedback, kLong));
  EXPECT_EQ(feedback.answers, id);
  const Asked asked = arm.asked(Function::Refresh).at(0);
  EXPECT_EQ(asked.header.id, id);
  EXPECT_EQ(asked.header.device, 0);
  Kinova::Api::BaseCyclic::Command wire;
  ASSERT_TRUE(wire.ParseFromArray(asked.payload.data(), static_cast<int>(asked.payload.size())));
  EXPECT_EQ(wire.frame_id(), static_cast<std::uint32_t>(id));
  ASSERT_EQ(wire.actuators_size(), kGen3Joints);
  for (int i = 0; i < kGen3Joints; ++i) {
    const auto x = static_cast<float>(i);
    EXPECT_EQ(wire.actuators(i).command_id(), static_cast<std::uint32_t>(id));
    EXPECT_EQ(wire.actuators(i).flags(), 0U);
    EXPECT_EQ(wire.actuators(i).position(), 300 + x);
    EXPECT_EQ(wire.actuators(i).velocity(), -x);
    EXPECT_EQ(wire.actuators(i).torque_joint(), 2 * x);
    EXPECT_EQ(wire.actuators(i).current_motor(), 0.25F * x);
  }
}

TEST(Gen3Wire, RunsItsIdsAroundWithoutSendingOneTwice) {
  FakeGen3 arm(To(Function::Refresh, [](const Asked&) { return Frames{}; }));
  const auto link = ConnectGen3(arm.address());
  int last = link->Send({});
  bool around = false;
  for (int i = 0; i < 70000; ++i) {
    const int id = link->Send({});
    if (id < 0) continue;  // the kernel's buffer may be full
    ASSERT_NE(id, last);
    around = around || id < last;
    last = id;
  }
  EXPECT_TRUE(around);
  EXPECT_GT(link->traffic().sent, 0);
}

TEST(Gen3Wire, ExchangesWithoutTheHeap) {
  FakeGen3 arm(To(Function::Refresh, [](const Asked& asked) {
    // Also a field that the messages here do not have, as of the arm's interconnect.
    FakeGen3::Bytes payload = FakeGen3::Of(FakeGen3::Healthy());
    payload.push_back(std::byte(4 << 3 | 2));
    payload.push_back(std::byte(100));
    payload.resize(payload.size() + 100);
    return Frames{FakeGen3::Response(asked, payload)};
  }));
  const auto link = ConnectGen3(arm.address());
  Gen3Feedback feedback;
  long before = 0;
  constexpr int kExchanges = 10'000;
  for (int i = 0; i < kExchanges; ++i) {
    if (i == 1) before = Allocations();
    ASSERT_NE(link->Send({}), -1);
    ASSERT_TRUE(link->Receive(feedback, kLong));
  }
  EXPECT_EQ(Allocations() - before, 0);
  EXPECT_FALSE(link->Receive(feedback, 0ns));
  const Gen3Traffic traffic = link->traffic();
  EXPECT_EQ(traffic.sent, kExchanges);
  EXPECT_EQ(traffic.received, kExchanges);
  EXPECT_EQ(traffic.unsent + traffic.refused + traffic.unreadable, 0);
}

TEST(Gen3Wire, DeliversFeedbackInTheOrderOfItsArrival) {
  std::vector<Asked> held;
  FakeGen3 arm(To(Function::Refresh, [&](const Asked& asked) {
    held.push_back(asked);
    if (held.size() < 3) return Frames{};
    Frames all;
    for (const int i : {2, 0, 1, 1})
      all.push_back(
          FakeGen3::Response(held[static_cast<std::size_t>(i)], FakeGen3::Of(FakeGen3::Healthy())));
    return all;
  }));
  const auto link = ConnectGen3(arm.address());
  std::array<int, 3> id{};
  for (int& i : id) i = link->Send({});
  Gen3Feedback feedback;
  for (const std::size_t i : {2, 0, 1, 1}) {
    ASSERT_TRUE(link->Receive(feedback, kLong));
    EXPECT_EQ(feedback.answers, id[i]);
  }
  EXPECT_FALSE(link->Receive(feedback, 0ns));
  EXPECT_EQ(link->traffic().received, 4);
}

TEST(Gen3Wire, CountsWhatIsNoFeedbackAndNeverDeliversIt) {
  using Bytes = FakeGen3::Bytes;
  FakeGen3 arm(To(Function::Refresh, [](const Asked& asked) {
    const Bytes good = FakeGen3::Of(FakeGen3::Healthy());
    const Bytes whole = FakeGen3::Response(asked, good);
    kortex::Header header{.type = kortex::FrameType::Response,
                          .session = FakeGen3::kUdpSession,
                          .id = asked.header.id,
                          .function = Function::Refresh};
    Frames all;
    all.push_back(FakeGen3::Refusal(asked, Kinova::Api::INVALID_SESSION, ""));
    all.push_back({});                                                              // 1: empty
    all.push_back(Bytes(whole.begin(), whole.end() - 1));                           // 2: cut
    all.push_back(FakeGen3::Response(asked, Bytes(good.begin(), good.end() - 1)));  // 3: cut inside
    all.push_back(FakeGen3::Response(asked));                                      // 4: no feedback
    all.push_back(FakeGen3::Response(asked, FakeGen3::Of(FakeGen3::Healthy(6))));  // 5
    all.push_back(FakeGen3::Response(asked, FakeGen3::Of(FakeGen3::Healthy(8))));  // 6
    kortex::Header wrong = header;
    wrong.session = FakeGen3::kUdpSession + 1;
    all.push_back(FakeGen3::Framed(wrong, good));  // 7
    wrong = header;
    ++wrong.id;                                    // not asked yet
    all.push_back(FakeGen3::Framed(wrong, good));  // 8
    wrong = header;
    wrong.type = kortex::FrameType::Notification;
    all.push_back(FakeGen3::Framed(wrong, good));  // 9
    wrong = header;
    wrong.function = Function::RefreshCommand;
    all.push_back(FakeGen3::Framed(wrong, good));  // 10
    Bytes corrupt = whole;
    corrupt[2] ^= std::byte(0xFF);  // the tag of the first word
    all.push_back(corrupt);         // 11
    all.push_back(whole);
    return all;
  }));
  const auto link = ConnectGen3(arm.address());
  ASSERT_NE(link->Send({}), -1);
  Gen3Feedback feedback;
  ASSERT_TRUE(link->Receive(feedback, kLong));
  EXPECT_EQ(feedback.frame_id, 77U);
  EXPECT_FALSE(link->Receive(feedback, 0ns));
  const Gen3Traffic traffic = link->traffic();
  EXPECT_EQ(traffic.received, 1);
  EXPECT_EQ(traffic.refused, 1);
  EXPECT_EQ(traffic.unreadable, 11);
}

TEST(Gen3Wire, DeliversNumbersThatAreNotFinite) {
  FakeGen3 arm(To(Function::Refresh, [](const Asked& asked) {
    auto feedback = FakeGen3::Healthy();
    feedback.mutable_actuators(4)->set_torque(std::numeric_limits<float>::quiet_NaN());
    feedback.mutable_actuators(5)->set_position(std::numeric_limits<float>::infinity());
    return Frames{FakeGen3::Response(asked, FakeGen3::Of(feedback))};
  }));
  const auto link = ConnectGen3(arm.address());
  link->Send({});
  Gen3Feedback feedback;
  ASSERT_TRUE(link->Receive(feedback, kLong));
  EXPECT_TRUE(std::isnan(feedback.actuator[4].torque));
  EXPECT_TRUE(std::isinf(feedback.actuator[5].position));
}

TEST(Gen3Wire, ReceivesNothingFromASilentArm) {
  FakeGen3 arm(To(Function::Refresh, [](const Asked&) { return Frames{}; }));
  const auto link = ConnectGen3(arm.address());
  link->Send({});
  Gen3Feedback feedback{.answers = 4711};
  for (const std::chrono::nanoseconds patience : {-1ns, 0ns, 1ns, 1000000ns})
    EXPECT_FALSE(link->Receive(feedback, patience));
  EXPECT_EQ(feedback.answers, 4711);  // as it was
}

}  // namespace
}  // namespace pliant
