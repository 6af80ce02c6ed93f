#include "pliant/diagrams/bota_emulator.h"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

/// One bit, another one each time.
void FlipABit(PacketFaults::Packet& packet, std::uint32_t number) {
  const std::size_t bit = number % (8 * packet.size());
  packet[bit / 8] = static_cast<std::uint8_t>(packet[bit / 8] ^ 1U << bit % 8);
}

}  // namespace

BotaEmulator::BotaEmulator(const Options& o)
    : options_{o},
      faults_{o.faults, FlipABit},
      ours_{posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)} {
  std::array<char, 128> name{};
  if (ours_.get() >= 0 && grantpt(ours_.get()) == 0 && unlockpt(ours_.get()) == 0 &&
      ptsname_r(ours_.get(), name.data(), name.size()) == 0)
    theirs_ = internal::Descriptor(open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (theirs_.get() < 0)
    throw Error(std::string("there is no pseudo terminal: ") + std::strerror(errno) +
                "; /dev/pts must be mounted and have one left");
  path_ = name.data();
  termios tty{};
  tcgetattr(theirs_.get(), &tty);
  cfmakeraw(&tty);  // or it would echo
  tcsetattr(theirs_.get(), TCSANOW, &tty);
}

void BotaEmulator::Tick(const Wrench& wrench) {
  const double t = 1e-9 * static_cast<double>(options_.period.Times(tick_));
  const bool on = !Shows(options_.faults, "silent", t);
  if (!on) on_since_ = tick_ + 1;
  if (on && !Shows(options_.faults, "frozen", t)) {
    for (int i = 0; i < 3; ++i) {
      frame_.torque[static_cast<std::size_t>(i)] = static_cast<float>(wrench(i));
      frame_.force[static_cast<std::size_t>(i)] = static_cast<float>(wrench(i + 3));
    }
    frame_.timestamp_us =
        static_cast<std::uint32_t>(options_.period.Times(tick_ - on_since_) / 1000);
    frame_.temperature = 30;
  }
  ++tick_;
  std::optional<PacketFaults::Packet> packet;
  if (on) {
    const auto bytes = Encode(frame_);
    packet.emplace(bytes.begin(), bytes.end());
  }
  for (const PacketFaults::Packet& each : faults_.Pass(t, std::move(packet)))
    sent_ += write(ours_.get(), each.data(), each.size()) == static_cast<ssize_t>(each.size());
}

}  // namespace pliant
