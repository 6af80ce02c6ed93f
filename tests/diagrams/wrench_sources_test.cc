#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <random>
#include <span>
#include <thread>

#include "pliant/diagrams/bota_emulator.h"
#include "pliant/diagrams/rdt_emulator.h"
#include "pliant/plants/bota_source.h"
#include "pliant/plants/rdt_source.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

/// Sources over a real socket and a real pseudo terminal, from emulators that tick when the test
/// says so: nothing hangs on when a thread wakes up.
namespace pliant {
namespace {

using std::chrono::milliseconds;

/// Waits up to five seconds for what the kernel is to hand on.
bool Becomes(const std::function<bool()>& what) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(5);
  while (Clock::now() < end) {
    if (what()) return true;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return false;
}

/// Distinct, and exact in millionths and in floats.
Wrench Numbered(int k) { return {0.5, 0.25, -0.125, 1.0 * k, 2.0, -k / 4.0}; }

/// A source and what it read; a thing is read once it is there.
struct Reader {
  explicit Reader(WrenchSource& s) : source{s} {}

  /// Reads until the count of all that arrived is as it should be.
  bool Arrives(std::uint32_t good, LinkCounts counts) {
    return Becomes([&] {
      Read();
      return news >= static_cast<int>(good) && last.link == counts;
    });
  }
  bool Read() {
    const bool got = source.Read(last);
    news += got;
    return got;
  }

  WrenchSource& source;
  WrenchReading last;
  int news = 0;
};

FaultOrder Fault(const char* kind, double start_s, double duration_s) {
  return {.kind = kind, .start_s = start_s, .duration_s = duration_s};
}

struct Rdt {
  explicit Rdt(std::vector<FaultOrder> faults = {}, milliseconds ask_again = milliseconds(60000))
      : emulator{{.port = 0, .faults = std::move(faults)}},
        source{{.host = "127.0.0.1", .port = emulator.port(), .ask_again = ask_again}} {}
  void Tick(int k) {
    emulator.Tick(Numbered(k));
    reader.Read();
  }

  RdtEmulator emulator;
  RdtSource source;
  Reader reader{source};
};

struct Bota {
  explicit Bota(std::vector<FaultOrder> faults = {}, milliseconds silence = milliseconds(60000))
      : emulator{{.faults = std::move(faults)}},
        source{{.device = emulator.path(), .silence = silence}} {}
  void Tick(int k) {
    emulator.Tick(Numbered(k));
    reader.Read();
  }

  BotaEmulator emulator;
  BotaSource source;
  Reader reader{source};
};

template <class Sensor>
class WrenchSources : public testing::Test {};
using Sensors = testing::Types<Rdt, Bota>;
TYPED_TEST_SUITE(WrenchSources, Sensors);

/// The times of ticks a to b of a sensor: RDT ticks each ms, Bota each 1.25 ms.
template <class Sensor>
FaultOrder At(const char* kind, int a, int b) {
  const double h = std::is_same_v<Sensor, Rdt> ? 1e-3 : 1.25e-3;
  return Fault(kind, (a - 0.5) * h, (b - a) * h);
}

TYPED_TEST(WrenchSources, ReadTheNewest) {
  TypeParam s;
  for (int k = 0; k < 50; ++k) s.Tick(k);
  EXPECT_TRUE(Becomes([&] {
    s.reader.Read();
    return s.reader.last.wrench == Numbered(49);
  }));
  EXPECT_EQ(s.reader.last.link, LinkCounts());
  EXPECT_FALSE(s.reader.last.faulty);
  EXPECT_FALSE(s.reader.Read()) << "there is nothing more";
}

TYPED_TEST(WrenchSources, DrainWhatHasArrived) {
  TypeParam s;
  s.Tick(0);
  for (int k = 1; k < 50; ++k) s.emulator.Tick(Numbered(k));
  EXPECT_TRUE(Becomes([&] {
    s.reader.Read();
    return s.reader.last.wrench == Numbered(49);
  }));
  EXPECT_EQ(s.reader.last.link, LinkCounts());
}

TYPED_TEST(WrenchSources, CountWhatIsLost) {
  TypeParam s({At<TypeParam>("lost", 10, 17)});
  for (int k = 0; k < 30; ++k) s.Tick(k);
  EXPECT_TRUE(s.reader.Arrives(1, {.lost = 7}));
  EXPECT_EQ(s.reader.last.wrench, Numbered(29));
}

TYPED_TEST(WrenchSources, CountWhatIsDuplicated) {
  TypeParam s({At<TypeParam>("duplicated", 10, 17)});
  for (int k = 0; k < 30; ++k) s.Tick(k);
  EXPECT_TRUE(s.reader.Arrives(1, {.duplicated = 7}));
}

// Of each pair the first is passed over, and then too old.
TYPED_TEST(WrenchSources, CountAndLeaveOutWhatIsOutOfOrder) {
  TypeParam s({At<TypeParam>("reordered", 10, 18)});
  for (int k = 0; k < 30; ++k) s.Tick(k);
  EXPECT_TRUE(s.reader.Arrives(1, {.lost = 4, .out_of_order = 4}));
  EXPECT_EQ(s.reader.last.wrench, Numbered(29));
}

// What is corrupted is missing as well.
TYPED_TEST(WrenchSources, LeaveOutWhatIsCorrupted) {
  TypeParam s({At<TypeParam>("corrupted", 10, 17)});
  for (int k = 0; k < 30; ++k) s.Tick(k);
  EXPECT_TRUE(s.reader.Arrives(1, {.lost = 7, .corrupted = 7}));
  EXPECT_EQ(s.reader.last.wrench, Numbered(29));
}

// Those of ticks 10 to 13 come 20 ms late, among newer ones.
TYPED_TEST(WrenchSources, LeaveOutWhatIsLate) {
  TypeParam s({At<TypeParam>("late", 10, 14)});
  for (int k = 0; k < 60; ++k) s.Tick(k);
  EXPECT_TRUE(s.reader.Arrives(1, {.lost = 4, .out_of_order = 4}));
  EXPECT_EQ(s.reader.last.wrench, Numbered(59));
}

TYPED_TEST(WrenchSources, TellMeasurementsThatAreTheSame) {
  TypeParam s({At<TypeParam>("frozen", 10, 1000)});
  for (int k = 0; k < 10; ++k) s.Tick(k);
  ASSERT_TRUE(Becomes([&] {
    s.reader.Read();
    return s.reader.last.wrench == Numbered(9);
  }));
  const std::uint32_t sequence = s.reader.last.sequence;
  for (int k = 10; k < 30; ++k) s.Tick(k);
  std::this_thread::sleep_for(milliseconds(20));
  s.reader.Read();
  EXPECT_EQ(s.reader.last.sequence, sequence);
  EXPECT_EQ(s.reader.last.wrench, Numbered(9));
}

// It has no power for a while, and counts from the beginning when it is back.
TYPED_TEST(WrenchSources, GoOnWithASensorThatBeganAnew) {
  TypeParam s({At<TypeParam>("silent", 300, 310)}, milliseconds(50));
  for (int k = 0; k < 300; ++k) s.Tick(k);
  ASSERT_TRUE(Becomes([&] {
    s.reader.Read();
    return s.reader.last.wrench == Numbered(299);
  }));
  for (int k = 300; k < 310; ++k) s.Tick(k);
  std::this_thread::sleep_for(milliseconds(60));
  s.reader.Read();
  EXPECT_TRUE(Becomes([&] {
    s.Tick(1000);
    return s.reader.last.wrench == Numbered(1000);
  }));
  EXPECT_EQ(s.reader.last.link, LinkCounts());
}

TYPED_TEST(WrenchSources, TakeNothingFromTheHeap) {
  TypeParam s;
  for (int k = 0; k < 10; ++k) s.emulator.Tick(Numbered(k));
  const long before = Allocations();
  for (int k = 0; k < 100; ++k) s.reader.Read();
  EXPECT_EQ(Allocations() - before, 0);
  EXPECT_EQ(s.reader.last.wrench, Numbered(9));
}

/// A socket of its own on this machine.
struct Udp {
  Udp() : descriptor{socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)} {
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    socklen_t size = sizeof address;
    getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
  }
  ~Udp() { close(descriptor); }
  int port() const { return ntohs(address.sin_port); }
  void Send(const std::vector<std::uint8_t>& bytes, const sockaddr_in& to) {
    sendto(descriptor, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
           sizeof to);
  }
  /// The next datagram and who sent it; waits for one.
  std::vector<std::uint8_t> Receive(sockaddr_in& from) {
    std::vector<std::uint8_t> bytes(100);
    socklen_t size = sizeof from;
    ssize_t got = -1;
    Becomes([&] {
      got = recvfrom(descriptor, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from),
                     &size);
      return got >= 0;
    });
    bytes.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
    return bytes;
  }

  int descriptor;
  sockaddr_in address{};
};

std::vector<std::uint8_t> Record(std::uint32_t sequence, std::uint32_t status = 0) {
  const auto bytes = Encode(RdtRecord{sequence, sequence, status, {1000000}});
  return {bytes.begin(), bytes.end()};
}

TEST(RdtSource, AsksToStartAgainWhileItIsSilentAndToStopInTheEnd) {
  Udp sensor;
  sockaddr_in from{};
  {
    RdtSource source({.host = "localhost", .port = sensor.port(), .ask_again = milliseconds(10)});
    const auto start = Encode(RdtRequest{.command = RdtCommand::Start});
    const std::vector<std::uint8_t> request(start.begin(), start.end());
    WrenchReading reading;
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(sensor.Receive(from), request);
      std::this_thread::sleep_for(milliseconds(11));
      EXPECT_FALSE(source.Read(reading));
    }
    EXPECT_EQ(sensor.Receive(from), request);
  }
  const auto stop = Encode(RdtRequest{.command = RdtCommand::Stop});
  EXPECT_EQ(sensor.Receive(from), std::vector<std::uint8_t>(stop.begin(), stop.end()));
}

TEST(RdtSource, SaysThatASensorCallsItselfFaulty) {
  Udp sensor;
  RdtSource source({.host = "127.0.0.1", .port = sensor.port()});
  sockaddr_in from{};
  sensor.Receive(from);
  WrenchReading reading;
  sensor.Send(Record(1, 0x80020000), from);
  EXPECT_TRUE(Becomes([&] { return source.Read(reading); }));
  EXPECT_TRUE(reading.faulty);
  EXPECT_EQ(reading.device_status, 0x80020000U);
  sensor.Send(Record(2), from);
  EXPECT_TRUE(Becomes([&] { return source.Read(reading); }));
  EXPECT_FALSE(reading.faulty);
}

TEST(RdtSource, CountsOnWhereTheNumbersBeginAgain) {
  Udp sensor;
  RdtSource source({.host = "127.0.0.1", .port = sensor.port()});
  sockaddr_in from{};
  sensor.Receive(from);
  WrenchReading reading;
  for (const std::uint32_t sequence : {0xfffffffeU, 0xffffffffU, 0U, 1U}) {
    sensor.Send(Record(sequence), from);
    ASSERT_TRUE(Becomes([&] { return source.Read(reading); })) << sequence;
  }
  EXPECT_EQ(reading.link, LinkCounts());
}

TEST(RdtSource, NoDatagramDoesHarmOrComesFromAnotherAddress) {
  Udp sensor, stranger;
  RdtSource source({.host = "127.0.0.1", .port = sensor.port()});
  sockaddr_in ours{};
  sensor.Receive(ours);
  WrenchReading reading;
  sensor.Send(Record(7), ours);
  ASSERT_TRUE(Becomes([&] { return source.Read(reading); }));
  const Wrench wrench = reading.wrench;

  std::mt19937 random(41);
  std::uint32_t strange = 0;
  for (int k = 0; k < 100000; ++k) {
    // Any length but a record's, of any content, from the sensor; records from elsewhere.
    std::vector<std::uint8_t> bytes(random() % 72);
    if (bytes.size() == kRdtRecordBytes) bytes.pop_back();
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    sensor.Send(bytes, ours);
    ++strange;
    stranger.Send(Record(8 + static_cast<std::uint32_t>(k)), ours);
    if (k % 100 == 0) {
      ASSERT_TRUE(Becomes([&] {
        EXPECT_FALSE(source.Read(reading));
        return reading.link.corrupted == strange;
      })) << k;
    }
  }
  EXPECT_TRUE(Becomes([&] {
    EXPECT_FALSE(source.Read(reading));
    return reading.link.corrupted == strange;
  }));
  EXPECT_EQ(reading.wrench, wrench);
  EXPECT_EQ(reading.link.lost + reading.link.out_of_order + reading.link.duplicated, 0U);

  // Records of any content: numbers are all that they can be.
  for (int k = 0; k < 100000; ++k) {
    std::vector<std::uint8_t> bytes(kRdtRecordBytes);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    sensor.Send(bytes, ours);
    if (k % 100 == 0) {
      source.Read(reading);
      ASSERT_TRUE(reading.wrench.allFinite());
    }
  }
}

TEST(RdtEmulator, NoDatagramDoesHarm) {
  RdtEmulator emulator({.port = 0});
  Udp stranger;
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(static_cast<std::uint16_t>(emulator.port()));
  std::mt19937 random(43);
  for (int k = 0; k < 100000; ++k) {
    std::vector<std::uint8_t> bytes(random() % 20);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    stranger.Send(bytes, to);
    if (k % 100 == 0) emulator.Tick({});
  }
  EXPECT_EQ(emulator.sent(), 0) << "nobody asked it to start";
}

TEST(RdtEmulator, SendsAsManyRecordsAsAreAskedFor) {
  RdtEmulator emulator({.port = 0});
  Udp user;
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(static_cast<std::uint16_t>(emulator.port()));
  const auto start = Encode(RdtRequest{.count = 3});
  user.Send({start.begin(), start.end()}, to);
  ASSERT_TRUE(Becomes([&] {
    emulator.Tick(Numbered(1));
    return emulator.sent() == 3;
  }));
  for (int k = 0; k < 10; ++k) emulator.Tick(Numbered(1));
  EXPECT_EQ(emulator.sent(), 3);

  // The bias is taken off what is measured.
  const auto bias = Encode(RdtRequest{.command = RdtCommand::Bias});
  user.Send({bias.begin(), bias.end()}, to);
  user.Send({start.begin(), start.end()}, to);
  ASSERT_TRUE(Becomes([&] {
    emulator.Tick(Numbered(1));
    return emulator.sent() == 6;
  }));
  sockaddr_in from{};
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(DecodeRdtRecord(user.Receive(from))->counts, RdtScale{}.CountsOf(Numbered(1)));
  EXPECT_EQ(DecodeRdtRecord(user.Receive(from))->counts, (std::array<std::int32_t, 6>{}));
}

TEST(RdtSource, SaysWhatIsWrongWithAnAddress) {
  using testing::HasSubstr;
  const auto error = [](RdtSource::Options o) { return ErrorOf([&] { RdtSource source(o); }); };
  EXPECT_EQ(error({}), "host must be the address of a force sensor, such as 192.168.1.1");
  EXPECT_EQ(error({.host = "127.0.0.1", .port = 0}), "port must be from 1 to 65535, got 0");
  EXPECT_EQ(error({.host = "127.0.0.1", .port = 65536}), "port must be from 1 to 65535, got 65536");
  // No name server is asked for a label of more than 63 letters.
  const std::string nobody(64, 'x');
  EXPECT_THAT(error({.host = nobody}),
              testing::AllOf(HasSubstr("cannot find the force sensor '" + nobody + "': "),
                             HasSubstr("; expected its IPv4 address, such as 192.168.1.1, or a "
                                       "name the network knows")));
  EXPECT_EQ(error({.host = "127.0.0.1", .scale = {.counts_per_newton = 0}}),
            "scale.counts_per_newton must be > 0 1/N, got 0");
  EXPECT_EQ(error({.host = "127.0.0.1", .ask_again = milliseconds(0)}),
            "ask_again must be > 0, got 0 s");
  // Broadcasts are for those that ask for them.
  EXPECT_THAT(error({.host = "255.255.255.255"}),
              testing::AllOf(HasSubstr("cannot reach the force sensor '255.255.255.255': "),
                             HasSubstr("; is this machine in the sensor's network? `ip route` "
                                       "tells")));
}

TEST(RdtEmulator, SaysWhereItCannotListen) {
  const auto error = [](RdtEmulator::Options o) {
    return ErrorOf([&] { RdtEmulator emulator(o); });
  };
  const RdtEmulator first({.port = 0});
  const std::string port = std::to_string(first.port());
  EXPECT_EQ(error({.port = first.port()}),
            "cannot listen at 127.0.0.1:" + port +
                ": Address already in use; port 0 is any that is free");
  EXPECT_EQ(error({.bind = "here"}),
            "cannot listen at 'here': expected an IPv4 address of this machine, such as 127.0.0.1, "
            "or 0.0.0.0 for all it has");
  EXPECT_EQ(error({.port = -1}), "port must be from 0 to 65535, got -1");
}

TEST(BotaSource, SaysWhatIsWrongWithADevice) {
  const auto error = [](BotaSource::Options o) { return ErrorOf([&] { BotaSource source(o); }); };
  const TemporaryDirectory folder;
  const std::string missing = (folder.path() / "ttyUSB9").string();
  EXPECT_EQ(error({}), "device must be the serial port of a force sensor, such as /dev/ttyUSB0");
  EXPECT_EQ(error({.device = missing}),
            "cannot open the force sensor's port '" + missing +
                "': No such file or directory; is the sensor plugged in? `ls /dev/serial/by-id` "
                "names what is there");
  EXPECT_EQ(error({.device = "/dev/null"}),
            "'/dev/null' is no serial port; expected one such as /dev/ttyUSB0");
  EXPECT_EQ(error({.device = "/dev/null", .period = 0ms}), "period must be > 0, got 0 s");
  EXPECT_EQ(error({.device = "/dev/null", .silence = 0ms}), "silence must be > 0, got 0 s");
}

/// The end of a pseudo terminal that a sensor would have.
struct Terminal {
  Terminal() : ours{posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)} {
    EXPECT_TRUE(ours >= 0 && grantpt(ours) == 0 && unlockpt(ours) == 0);
    EXPECT_EQ(ptsname_r(ours, name.data(), name.size()), 0);
  }
  ~Terminal() { Close(); }
  void Send(std::span<const std::uint8_t> bytes) {
    EXPECT_EQ(write(ours, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  void Close() {
    if (ours >= 0) close(ours);
    ours = -1;
  }

  int ours;
  std::array<char, 128> name{};
};

TEST(BotaSource, SaysThatASensorCallsItselfFaulty) {
  Terminal terminal;
  BotaSource source({.device = terminal.name.data()});
  WrenchReading reading;
  terminal.Send(Encode(BotaFrame{.status = kBotaInvalid, .timestamp_us = 1}));
  EXPECT_TRUE(Becomes([&] { return source.Read(reading); }));
  EXPECT_TRUE(reading.faulty);
  EXPECT_EQ(reading.device_status, kBotaInvalid);
  terminal.Send(Encode(BotaFrame{.status = kBotaTooLate, .timestamp_us = 1251}));
  EXPECT_TRUE(Becomes([&] { return source.Read(reading); }));
  EXPECT_FALSE(reading.faulty);
}

TEST(BotaSource, ForgetsWhatWasSentBefore) {
  BotaEmulator emulator({});
  for (int k = 0; k < 2000; ++k) emulator.Tick(Numbered(k));
  EXPECT_LT(emulator.sent(), 2000) << "it does not hold more";
  BotaSource source({.device = emulator.path()});
  WrenchReading reading;
  EXPECT_FALSE(source.Read(reading));
  for (int k = 2000; k < 2010; ++k) emulator.Tick(Numbered(k));
  EXPECT_TRUE(Becomes([&] {
    source.Read(reading);
    return reading.wrench == Numbered(2009);
  }));
  EXPECT_EQ(reading.link.lost, 0U);
}

// What a terminal would make of them otherwise: line ends, interrupts, stops.
TEST(BotaSource, ReadsBytesAsTheyAre) {
  Terminal terminal;
  BotaSource source({.device = terminal.name.data()});
  WrenchReading reading;
  std::mt19937 random(53);
  for (std::uint32_t k = 1; k < 1000; ++k) {
    BotaFrame frame{.timestamp_us = 1250 * k};
    for (float& x : frame.force) x = static_cast<float>(random());
    terminal.Send(Encode(frame));
    ASSERT_TRUE(Becomes([&] { return source.Read(reading); })) << k;
    ASSERT_EQ(reading.wrench(4), static_cast<double>(frame.force[1]));
  }
  EXPECT_EQ(reading.link, LinkCounts());
}

// Bytes of any content from the terminal's other end.
TEST(BotaSource, NoByteDoesHarm) {
  Terminal terminal;
  BotaSource source({.device = terminal.name.data()});
  std::mt19937 random(47);
  WrenchReading reading;
  for (int k = 0; k < 1000; ++k) {
    std::array<std::uint8_t, 100> bytes;
    for (std::uint8_t& byte : bytes)
      byte = random() % 8 == 0 ? kBotaHeader : static_cast<std::uint8_t>(random());
    terminal.Send(bytes);
    // All is read but what may begin a frame, and the first 36 do not count.
    ASSERT_TRUE(Becomes([&] {
      source.Read(reading);
      return reading.link.corrupted + 3 >= static_cast<std::uint32_t>((k + 1) * 100 / 37);
    }));
  }
  EXPECT_NEAR(reading.link.corrupted, 100000 / 37, 3);

  // The other end goes away: it is silent.
  terminal.Close();
  EXPECT_FALSE(source.Read(reading));
}

}  // namespace
}  // namespace pliant
