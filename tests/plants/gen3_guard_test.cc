#include "pliant/plants/gen3_guard.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "pliant/plants/gen3_wire.h"
#include "pliant/tests/plants/fake_gen3.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using kortex::Function;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr int kSingleLevel = 2, kLowLevel = 3;

/// A process that takes an arm and runs it under a guard until it is killed; it is forked before
/// there are threads. Its standard error is kept.
class Runner {
 public:
  explicit Runner(std::chrono::milliseconds patience = 60s) {
    EXPECT_EQ(pipe2(address_, O_CLOEXEC), 0);
    EXPECT_EQ(pipe2(error_, O_CLOEXEC), 0);
    process_ = fork();
    if (process_ != 0) {
      close(address_[0]);
      close(error_[1]);
      return;
    }
    close(address_[1]);
    dup2(error_[1], STDERR_FILENO);
    int ports[2];
    if (read(address_[0], ports, sizeof ports) != sizeof ports) _exit(1);
    Gen3Address address;
    address.host = "localhost";
    address.tcp_port = ports[0];
    address.udp_port = ports[1];
    const auto link = ConnectGen3(address);  // with a thread, as in a program
    const Gen3Guard guard(address, patience);
    link->SetServoing(Gen3Servoing::LowLevel);
    for (;;) pause();
  }
  ~Runner() {
    Kill();
    close(address_[1]);
    close(error_[0]);
  }

  void Run(const Gen3Address& address) {
    const int ports[2] = {address.tcp_port, address.udp_port};
    EXPECT_EQ(write(address_[1], ports, sizeof ports), static_cast<ssize_t>(sizeof ports));
  }
  void Kill() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = 0;
  }
  /// All it and its guard wrote; comes when both are gone.
  std::string Said() {
    std::string all;
    char some[256];
    for (ssize_t n; (n = read(error_[0], some, sizeof some)) > 0;)
      all.append(some, static_cast<std::size_t>(n));
    return all;
  }

 private:
  int address_[2], error_[2];
  pid_t process_ = 0;
};

TEST(Gen3Guard, HandsTheArmBackWhenItsProcessIsKilled) {
  Runner runner;
  FakeGen3 arm;
  runner.Run(arm.address());
  ASSERT_TRUE(Eventually([&] { return arm.servoing() == kLowLevel; }));
  runner.Kill();
  EXPECT_TRUE(Eventually([&] { return arm.servoing() == kSingleLevel; }));
  EXPECT_EQ(runner.Said(), "pliant: the process that ran the arm at 127.0.0.1:" +
                               std::to_string(arm.address().tcp_port) +
                               " is gone; the arm was set to single-level servoing\n");
}

TEST(Gen3Guard, TriesAgainWhereTheArmRefusesAtFirst) {
  Runner runner;
  std::atomic<int> refusals = 0;
  FakeGen3 arm([&](const FakeGen3::Asked& asked) -> std::optional<std::vector<FakeGen3::Bytes>> {
    Kinova::Api::Base::ServoingModeInformation mode;
    mode.ParseFromArray(asked.payload.data(), static_cast<int>(asked.payload.size()));
    if (asked.header.function != Function::SetServoingMode ||
        mode.servoing_mode() != kSingleLevel || ++refusals > 2)
      return {};
    return {{FakeGen3::Refusal(asked, Kinova::Api::SESSION_NOT_IN_CONTROL, "")}};
  });
  runner.Run(arm.address());
  ASSERT_TRUE(Eventually([&] { return arm.servoing() == kLowLevel; }));
  runner.Kill();
  EXPECT_TRUE(Eventually([&] { return arm.servoing() == kSingleLevel; }));
  EXPECT_EQ(refusals, 3);
}

TEST(Gen3Guard, SaysThatItCouldNotAndEnds) {
  Runner runner(200ms);
  auto arm = std::make_unique<FakeGen3>();
  runner.Run(arm->address());
  ASSERT_TRUE(Eventually([&] { return arm->servoing() == kLowLevel; }));
  arm.reset();
  runner.Kill();
  const std::string said = runner.Said();
  EXPECT_THAT(said,
              HasSubstr("is gone, and the arm could not be handed back: cannot reach an arm"));
  EXPECT_THAT(said, HasSubstr("; `pliant recover gen3` tries again\n"));
  EXPECT_EQ(std::ranges::count(said, '\n'), 1);
}

TEST(Gen3Guard, LeavesTheArmAloneIfAllIsWellAndIsReaped) {
  FakeGen3 arm;
  pid_t child = 0;
  {
    const Gen3Guard guard(arm.address());
    child = guard.process();
    EXPECT_EQ(kill(child, 0), 0);
  }
  EXPECT_EQ(kill(child, 0), -1);  // neither there nor a zombie
  EXPECT_EQ(errno, ESRCH);
  EXPECT_TRUE(arm.asked().empty());
}

TEST(Gen3Guard, HoldsNothingOfItsParentAndIsBeyondItsTerminal) {
  FakeGen3 arm;
  const auto link = ConnectGen3(arm.address());
  const Gen3Guard guard(arm.address());
  const pid_t child = guard.process();
  const std::filesystem::path proc = "/proc/" + std::to_string(child);
  // Its name comes with the rest.
  const auto name = [&] {
    std::string text;
    std::getline(std::ifstream(proc / "comm"), text);
    return text;
  };
  ASSERT_TRUE(Eventually([&] { return name() == "pliant guard"; }));
  const auto descriptors = [&] {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(proc / "fd"))
      all.push_back(entry.path().filename());
    std::ranges::sort(all);
    return all;
  };
  EXPECT_TRUE(Eventually([&] {
    return descriptors() == std::vector<std::string>{"0", "1", "2", "3"};
  }));
  EXPECT_EQ(getsid(child), child);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) kill(child, signal);
  EXPECT_EQ(kill(child, 0), 0);
}

TEST(Gen3Guard, RefusesAHostThatNobodyKnows) {
  Gen3Address address;
  address.host = "no.such.arm.invalid";
  EXPECT_THAT(ErrorOf([&] { Gen3Guard guard(address); }),
              HasSubstr("cannot reach an arm at no.such.arm.invalid:10000: "));
}

}  // namespace
}  // namespace pliant
