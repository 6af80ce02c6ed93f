#include "pliant/apps/arm_address.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(ArmAddress, HasKinovasPortUnlessTold) {
  EXPECT_EQ(ArmAddress::Of("192.168.1.10").text(), "192.168.1.10:10000");
  EXPECT_EQ(ArmAddress::Of("arm.local:4711").text(), "arm.local:4711");
  EXPECT_EQ(ArmAddress::Of("[fe80::1]:4711").text(), "[fe80::1]:4711");
  EXPECT_EQ(ArmAddress::Of("[fe80::1]").text(), "[fe80::1]:10000");
}

TEST(ArmAddress, RefusesWhatIsNone) {
  for (const char* text : {"", ":", ":10000", "a b", "arm:", "arm:0", "arm:65536", "arm:1x", "a:-1",
                           "fe80::1", "[fe80::1", "[]", "[fe80::1]x", "http://arm"})
    EXPECT_EQ(ErrorOf([&] { ArmAddress::Of(text); }),
              "--arm wants an address such as 192.168.1.10 or 192.168.1.10:10000, got '" +
                  std::string(text) + "'");
}

/// A port of this machine, with or without somebody who listens there.
class Port {
 public:
  explicit Port(bool listens) : descriptor_{socket(AF_INET, SOCK_STREAM, 0)} {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    bind(descriptor_, reinterpret_cast<sockaddr*>(&at), size);
    if (listens) listen(descriptor_, 1);
    getsockname(descriptor_, reinterpret_cast<sockaddr*>(&at), &size);
    number = ntohs(at.sin_port);
  }
  ~Port() { close(descriptor_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  int number = 0;

 private:
  int descriptor_;
};

TEST(ArmAddress, IsTriedByTcp) {
  const Port open(true), shut(false);
  EXPECT_EQ(TryArm({"127.0.0.1", open.number}).fault, "");
  EXPECT_EQ(TryArm({"127.0.0.1", shut.number}).fault, "Connection refused");
}

TEST(ArmAddress, ThatNobodyKnowsIsAFault) {
  EXPECT_NE(TryArm({"no.such.arm.invalid", 10000}).fault, "");  // its words are the resolver's
}

}  // namespace
}  // namespace pliant
