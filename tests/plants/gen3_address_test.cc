#include "pliant/plants/gen3_address.h"

#include <gtest/gtest.h>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(Gen3Address, HasKinovasPortsUnlessTold) {
  EXPECT_EQ(Gen3Address{}.text(), "192.168.1.10:10000");
  const Gen3Address plain = Gen3Address::Of("10.0.0.2");
  EXPECT_EQ(plain.text(), "10.0.0.2:10000");
  EXPECT_EQ(plain.udp_port, 10001);
  EXPECT_EQ(Gen3Address::Of("arm.local:4711").text(), "arm.local:4711");
  EXPECT_EQ(Gen3Address::Of("[fe80::1]:4711").text(), "[fe80::1]:4711");
  EXPECT_EQ(Gen3Address::Of("[fe80::1]").text(), "[fe80::1]:10000");
}

TEST(Gen3Address, HasTheNextPortForUdpUnlessTold) {
  EXPECT_EQ(Gen3Address::Of("arm:4711").udp_port, 4712);
  EXPECT_EQ(Gen3Address::Of("arm:4711,99").udp_port, 99);
  EXPECT_EQ(Gen3Address::Of("[::1]:4711,99").tcp_port, 4711);
}

TEST(Gen3Address, RefusesWhatIsNone) {
  for (const char* text :
       {"", ":", ":10000", "a b", "arm:", "arm:0", "arm:65536", "arm:1x", "a:-1", "fe80::1",
        "[fe80::1", "[]", "[fe80::1]x", "http://arm", "arm:1,", "arm:1,0", "arm:,1", "arm,1"})
    EXPECT_EQ(ErrorOf([&] { Gen3Address::Of(text); }),
              "an arm's address is such as 192.168.1.10 or 192.168.1.10:10000, got '" +
                  std::string(text) + "'");
}

}  // namespace
}  // namespace pliant
