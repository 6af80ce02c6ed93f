#include "pliant/diagrams/gen3_emulator.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "pliant/tests/diagrams/kortex_client.h"
#include "pliant/tests/diagrams/kortex_nonsense.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Gen3Emulator::Options LockStep(const std::vector<std::string>& faults = {}) {
  Gen3Emulator::Options o{.lock_step = true};
  for (const std::string& text : faults)
    o.faults.push_back(FaultOrder::Of(text, Gen3Emulator::Kinds()));
  return o;
}

/// An emulator, and a client with a session on each channel.
struct Connected {
  explicit Connected(const Gen3Emulator::Options& o)
      : emulator{o}, tcp{SOCK_STREAM, emulator.port()}, udp{SOCK_DGRAM, emulator.udp_port()} {
    tcp.Open();
    udp.Open();
  }

  api::SubErrorCodes Enter() {
    feedback = udp.Ask(Function::RefreshFeedback).As<api::BaseCyclic::Feedback>();
    return tcp.Ask(Function::SetServoingMode, Servoing(api::Base::LOW_LEVEL_SERVOING)).error();
  }
  void Send() {
    ++id;
    udp.Send(Function::Refresh, Echo(feedback, id).SerializeAsString());
  }
  /// Sends a command, and takes all datagrams that are there once it was served. The answer of a
  /// service that was asked later is later.
  std::vector<std::vector<std::byte>> Exchange() {
    Send();
    EXPECT_EQ(tcp.Ask(Function::KeepAlive).error(), api::SUB_ERROR_NONE);
    return udp.Drain();
  }
  /// The numbers of the commands whose answers arrive after each of n commands; −1: unreadable.
  std::vector<std::vector<int>> Arrivals(int n) {
    std::vector<std::vector<int>> all;
    for (int k = 0; k < n; ++k) all.push_back(NumbersOf(Exchange()));
    return all;
  }
  std::vector<int> NumbersOf(const std::vector<std::vector<std::byte>>& datagrams) {
    std::vector<int> numbers;
    for (const auto& bytes : datagrams) {
      const auto frame = kortex::ReadFrame(bytes);
      api::BaseCyclic::Feedback read;
      const bool whole =
          frame && frame->header.error == 0 &&
          read.ParseFromArray(frame->payload.data(), static_cast<int>(frame->payload.size()));
      if (whole) feedback = read;
      numbers.push_back(whole ? static_cast<int>(read.frame_id()) : -1);
    }
    return numbers;
  }

  Gen3Emulator emulator;
  KortexClient tcp, udp;
  api::BaseCyclic::Feedback feedback;
  unsigned id = 0;
};

/// What is counted is told at the end of a turn, after what it answers.
bool Becomes(const std::function<bool()>& so) {
  const auto until = std::chrono::steady_clock::now() + 10s;
  while (!so() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(1ms);
  return so();
}

/// That an arm is servoed from the first session to the last.
void ServesAsUsual(Connected& c) {
  c.tcp.Ask(Function::ClearFaults);
  EXPECT_EQ(c.Enter(), api::SUB_ERROR_NONE);
  const unsigned before = c.id;
  EXPECT_THAT(c.Arrivals(1), ElementsAre(ElementsAre(before + 1)));
  EXPECT_EQ(c.tcp.Ask(Function::SetControlMode, Mode(api::ActuatorConfig::CURRENT), 2).error(),
            api::SUB_ERROR_NONE);
  for (int k = 0; k < 50; ++k) c.Arrivals(1);
  EXPECT_EQ(c.feedback.base().active_state(), api::Common::ARMSTATE_SERVOING_LOW_LEVEL);
  EXPECT_EQ(c.tcp.Ask(Function::SetControlMode, Mode(api::ActuatorConfig::POSITION), 2).error(),
            api::SUB_ERROR_NONE);
  EXPECT_EQ(
      c.tcp.Ask(Function::SetServoingMode, Servoing(api::Base::SINGLE_LEVEL_SERVOING)).error(),
      api::SUB_ERROR_NONE);
}

TEST(Gen3Emulator, ServesAnArmOverBothChannels) {
  Connected c(LockStep());
  ServesAsUsual(c);
  EXPECT_EQ(c.udp.Ask(Function::CloseSession).error(), api::SUB_ERROR_NONE);
  EXPECT_EQ(c.udp.Ask(Function::RefreshFeedback).error(), api::INVALID_SESSION);
  EXPECT_EQ(c.udp.Ask(Function::GetArmState).error(), api::UNSUPPORTED_SERVICE);
  EXPECT_EQ(c.emulator.failure(), "");
}

TEST(Gen3Emulator, IsTheSameBitForBitInLockStep) {
  const auto run = [] {
    Connected c(LockStep({"corrupted@0.01+0.01", "lost@0.03+0.002"}));
    c.Enter();
    std::vector<std::vector<std::byte>> all;
    for (int k = 0; k < 60; ++k)
      for (auto& bytes : c.Exchange()) {
        c.NumbersOf({bytes});
        all.push_back(std::move(bytes));
      }
    return all;
  };
  const auto once = run();
  EXPECT_EQ(once.size(), 58U);
  EXPECT_EQ(run(), once);
}

TEST(Gen3Emulator, LosesReplies) {
  Connected c(LockStep({"lost@0.002+0.002"}));
  c.Enter();
  EXPECT_THAT(c.Arrivals(5),
              ElementsAre(ElementsAre(1), IsEmpty(), IsEmpty(), ElementsAre(4), ElementsAre(5)));
}

TEST(Gen3Emulator, LosesRequestsAndLetsTimePass) {
  Connected c(LockStep({"lost_requests@0.002+0.002"}));
  c.Enter();
  EXPECT_THAT(c.Arrivals(5),
              ElementsAre(ElementsAre(1), ElementsAre(2), IsEmpty(), IsEmpty(), ElementsAre(5)));
  EXPECT_TRUE(Becomes([&] { return c.emulator.counts().ticks == 5; }));
}

TEST(Gen3Emulator, TripsCyclicDataJitterWhenRequestsAreLost) {
  Connected c(LockStep({"lost_requests@0.005+0.03"}));
  c.Enter();
  c.Arrivals(40);
  EXPECT_EQ(c.feedback.base().fault_bank_a(), api::Base::CYCLIC_DATA_JITTER);
  EXPECT_EQ(c.feedback.base().active_state(), api::Common::ARMSTATE_IN_FAULT);
}

TEST(Gen3Emulator, SendsRepliesLate) {
  Connected c(LockStep({"late@0.002+0.002"}));
  c.Enter();
  EXPECT_THAT(c.Arrivals(9),
              ElementsAre(ElementsAre(1), IsEmpty(), IsEmpty(), ElementsAre(4), ElementsAre(5),
                          ElementsAre(6), ElementsAre(2, 7), ElementsAre(3, 8), ElementsAre(9)));
}

TEST(Gen3Emulator, SendsRepliesTwice) {
  Connected c(LockStep({"duplicated@0.002+0.002"}));
  c.Enter();
  EXPECT_THAT(c.Arrivals(4),
              ElementsAre(ElementsAre(1), ElementsAre(2, 2), ElementsAre(3, 3), ElementsAre(4)));
}

TEST(Gen3Emulator, SendsRepliesTheSecondBeforeTheFirst) {
  Connected c(LockStep({"reordered@0.002+0.003"}));
  c.Enter();
  EXPECT_THAT(c.Arrivals(6), ElementsAre(ElementsAre(1), IsEmpty(), ElementsAre(3, 2), IsEmpty(),
                                         ElementsAre(5, 4), ElementsAre(6)));
}

TEST(Gen3Emulator, FlipsBitsAndCutsReplies) {
  const auto third = [](const std::vector<std::string>& faults) {
    Connected c(LockStep(faults));
    c.Enter();
    c.Arrivals(2);
    const auto datagrams = c.Exchange();
    EXPECT_EQ(datagrams.size(), 1U);
    return datagrams.front();
  };
  const auto whole = third({});
  const auto flipped = third({"corrupted@0.003+0.001"});
  ASSERT_EQ(flipped.size(), whole.size());
  int bits = 0;
  for (std::size_t i = 0; i < whole.size(); ++i)
    bits += std::popcount(std::to_integer<unsigned>(flipped[i] ^ whole[i]));
  EXPECT_GE(bits, 1);
  EXPECT_LE(bits, 8);
  const auto cut = third({"truncated@0.003+0.001"});
  EXPECT_LT(cut.size(), whole.size());
  EXPECT_TRUE(std::equal(cut.begin(), cut.end(), whole.begin()));
}

TEST(Gen3Emulator, FallsSilentAndGoesOnMoving) {
  Connected c(LockStep({"silent@0.002+0.002"}));
  c.Enter();
  c.Arrivals(1);
  c.Send();
  c.Send();
  EXPECT_THAT(c.Arrivals(1), ElementsAre(ElementsAre(4)));
  EXPECT_EQ(c.feedback.actuators(0).command_id(), 4U);
}

TEST(Gen3Emulator, EndsSessionsThatExpire) {
  Connected c(LockStep({"session_expired@0.002+1"}));
  c.Enter();
  c.Arrivals(1);
  c.Send();
  EXPECT_EQ(c.udp.Receive()->error(), api::SUB_ERROR_NONE) << "the answer is on its way";
  c.Send();
  EXPECT_EQ(c.udp.Receive()->error(), api::INVALID_SESSION);
  EXPECT_EQ(c.tcp.Ask(Function::KeepAlive).error(), api::INVALID_SESSION);
  c.tcp.Open();
  EXPECT_EQ(
      c.tcp.Ask(Function::GetServoingMode).As<api::Base::ServoingModeInformation>().servoing_mode(),
      api::Base::SINGLE_LEVEL_SERVOING);
}

TEST(Gen3Emulator, ResetsConnections) {
  Connected c(LockStep({"tcp_reset@0.002+0.002"}));
  c.Enter();
  c.Arrivals(1);
  c.Send();
  EXPECT_FALSE(c.tcp.Receive());
  EXPECT_TRUE(c.tcp.hung_up);
  c.Send();
  c.Send();
  KortexClient again(SOCK_STREAM, c.emulator.port());
  again.Open();
}

TEST(Gen3Emulator, RefusesServoingAndIsSlow) {
  Connected refusing(LockStep({"servoing_refused@0+1"}));
  EXPECT_EQ(refusing.Enter(), api::ROBOT_NOT_READY);
  Connected slow(LockStep({"slow_services@0+1"}));
  const auto began = std::chrono::steady_clock::now();
  slow.tcp.Ask(Function::GetArmState);
  EXPECT_GE(std::chrono::steady_clock::now() - began, 500ms);
}

TEST(Gen3Emulator, ShowsTheFaultsOfTheArm) {
  Connected c(LockStep({"torque_sensor_dead@0.002+1:4", "actuator_fault@0.01+1:2"}));
  c.Enter();
  c.Arrivals(5);
  EXPECT_EQ(c.feedback.actuators(3).torque(), 0);
  c.Arrivals(10);
  EXPECT_EQ(c.feedback.actuators(1).fault_bank_a(), api::ActuatorConfig::MOTOR_DRIVER_FAULT);
}

TEST(Gen3Emulator, GoesOnByTheWallClockInRealTime) {
  Gen3Emulator::Options o;
  o.arm.patience_ticks = 100000;
  o.service_delay = 30ms;
  Connected c(o);
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(c.Enter(), api::SUB_ERROR_NONE);
  EXPECT_GE(std::chrono::steady_clock::now() - began, 30ms);
  const std::int64_t before = c.emulator.counts().ticks;
  for (int k = 0; k < 100; ++k) {
    c.Send();
    const auto answer = c.udp.Receive();
    ASSERT_TRUE(answer);
    c.feedback = answer->As<api::BaseCyclic::Feedback>();
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(c.feedback.base().active_state(), api::Common::ARMSTATE_SERVOING_LOW_LEVEL);
  EXPECT_TRUE(Becomes([&] { return c.emulator.counts().commands == 100; }));
  const auto counts = c.emulator.counts();
  EXPECT_GE(counts.ticks + counts.lost_ticks - before, 99);
}

TEST(Gen3Emulator, TripsCyclicDataJitterByTheWallClock) {
  Connected c({});
  c.Enter();
  c.Send();
  EXPECT_TRUE(c.udp.Receive());
  const auto until = std::chrono::steady_clock::now() + 10s;
  do {
    c.feedback = c.udp.Ask(Function::RefreshFeedback).As<api::BaseCyclic::Feedback>();
  } while (c.feedback.base().fault_bank_a() == 0 && std::chrono::steady_clock::now() < until);
  EXPECT_EQ(c.feedback.base().fault_bank_a(), api::Base::CYCLIC_DATA_JITTER);
}

TEST(Gen3Emulator, EndsASessionThatIsSilent) {
  Gen3Emulator::Options o;
  o.service_delay = 0ms;
  const Gen3Emulator emulator(o);
  KortexClient client(SOCK_STREAM, emulator.port());
  client.session =
      client.Ask(Function::CreateSession, SessionOf("admin", "admin", 200)).header.session;
  std::this_thread::sleep_for(600ms);
  EXPECT_EQ(client.Ask(Function::KeepAlive).error(), api::INVALID_SESSION);
}

TEST(Gen3Emulator, SurvivesNonsenseOnBothChannels) {
  Connected c(LockStep());
  Nonsense nonsense(3);
  for (int round = 0; round < 30; ++round) {
    KortexClient tcp(SOCK_STREAM, c.emulator.port()), udp(SOCK_DGRAM, c.emulator.udp_port());
    tcp.Open();
    for (int k = 0; k < 100; ++k) {
      udp.Put(nonsense.Next(c.udp.session));
      std::vector<std::byte> prefixed = InStreamAsIs(nonsense.Next(tcp.session));
      if (k == 99) prefixed[static_cast<std::size_t>(round) % 12] ^= std::byte{4};
      tcp.Put(prefixed);
    }
  }
  c.udp.Drain();
  KortexClient tcp(SOCK_STREAM, c.emulator.port()), udp(SOCK_DGRAM, c.emulator.udp_port());
  std::swap(c.tcp, tcp);
  std::swap(c.udp, udp);
  c.tcp.Open();
  c.udp.Open();
  ServesAsUsual(c);
  EXPECT_EQ(c.emulator.failure(), "");
}

TEST(Gen3Emulator, ServesOthersBesideAClientThatNeverReads) {
  Connected c(LockStep());
  KortexClient deaf(SOCK_STREAM, c.emulator.port());
  deaf.Open();
  ::fcntl(deaf.descriptor(), F_SETFL, O_NONBLOCK);
  for (int k = 0; k < 200000; ++k) deaf.Send(Function::ReadAllDevices);
  ServesAsUsual(c);
}

TEST(Gen3Emulator, Serves200Connections) {
  Connected c(LockStep());
  std::vector<KortexClient> clients;
  for (int k = 0; k < 200; ++k) clients.emplace_back(SOCK_STREAM, c.emulator.port());
  for (KortexClient& client : clients) client.Open();
  for (KortexClient& client : clients)
    EXPECT_EQ(client.Ask(Function::GetArmState).error(), api::SUB_ERROR_NONE);
  ServesAsUsual(c);
}

TEST(Gen3Emulator, HangsUpOnWhoWasSilentForLongestOfTooMany) {
  Gen3Emulator::Options o = LockStep();
  o.most_connections = 3;
  const Gen3Emulator emulator(o);
  std::vector<KortexClient> clients;
  for (int k = 0; k < 4; ++k) {
    clients.emplace_back(SOCK_STREAM, emulator.port());
    clients.back().Open();
  }
  EXPECT_FALSE(clients[0].Receive());
  EXPECT_TRUE(clients[0].hung_up);
  for (std::size_t k = 1; k < 4; ++k)
    EXPECT_EQ(clients[k].Ask(Function::KeepAlive).error(), api::SUB_ERROR_NONE);
}

TEST(Gen3Emulator, SaysWhyItCannotListen) {
  const Gen3Emulator first(LockStep());
  const auto refused = [](const Gen3Emulator::Options& o) {
    return ErrorOf([&] { const Gen3Emulator emulator(o); });
  };
  EXPECT_THAT(refused({.port = first.port()}),
              HasSubstr("cannot listen on 127.0.0.1, port " + std::to_string(first.port()) +
                        ": Address already in use"));
  EXPECT_THAT(refused({.udp_port = first.udp_port()}), HasSubstr("UDP port"));
  EXPECT_EQ(refused({.bind = "here"}),
            "the address to listen on must be one of IPv4, such as 127.0.0.1, got here");
  EXPECT_EQ(refused({.port = 70000}), "port must be in 0 … 65535, got 70000");
  EXPECT_EQ(refused({.reply_delay = -1us}), "reply_delay must be >= 0 µs, got -1");
  EXPECT_EQ(refused({.service_delay = -1us}), "service_delay must be >= 0 µs, got -1");
  EXPECT_EQ(refused({.arm = {.faults = LockStep({"lost@0+1"}).faults}}),
            "faults are those of the emulator, not of its arm");
  EXPECT_EQ(refused({.most_connections = 0}), "most_connections must be > 0, got 0");
}

TEST(Gen3Emulator, KnowsTheFaultsThatCanBeOrdered) {
  std::vector<std::string> names;
  for (const auto& kind : Gen3Emulator::Kinds()) names.push_back(kind.name);
  EXPECT_THAT(names, ElementsAre("lost", "late", "duplicated", "reordered", "corrupted",
                                 "truncated", "lost_requests", "silent", "session_expired",
                                 "tcp_reset", "servoing_refused", "slow_services", "actuator_fault",
                                 "following_error", "overspeed", "torque_sensor_dead",
                                 "torque_jump", "encoder_jump", "frozen", "nan", "emergency_stop"));
}

}  // namespace
}  // namespace pliant
