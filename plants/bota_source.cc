#include "pliant/plants/bota_source.h"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string>
#include <thread>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

constexpr int kMostAtOnce = 16;  // pieces of 4 KiB, of which the kernel keeps one
constexpr std::int32_t kBehind = 1000000, kAhead = 60000000;  // µs of a sensor that began anew

std::string WayOut(int error) {
  if (error == EACCES || error == EPERM)
    return "; serial ports are for the group dialout: `sudo adduser $USER dialout`, then log in "
           "again";
  if (error == EBUSY) return "; another program has it open";
  return "; is the sensor plugged in? `ls /dev/serial/by-id` names what is there";
}

/// Bytes as they are, at 460 800 baud.
void MakeRaw(int port) {
  termios tty{};
  tcgetattr(port, &tty);
  cfmakeraw(&tty);
  tty.c_cflag |= CLOCAL | CREAD;
  tty.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  tty.c_cc[VMIN] = 0;
  tty.c_cc[VTIME] = 0;
  cfsetspeed(&tty, B460800);
  tcsetattr(port, TCSANOW, &tty);
  // An adapter for USB may keep bytes for 16 ms otherwise; what is none knows no such setting.
  serial_struct serial{};
  if (ioctl(port, TIOCGSERIAL, &serial) == 0) {
    serial.flags |= ASYNC_LOW_LATENCY;
    ioctl(port, TIOCSSERIAL, &serial);
  }
  tcflush(port, TCIFLUSH);
}

/// Throws away what was sent before somebody read: it is old, and the kernel hands it on in pieces.
void Forget(int port) {
  std::array<std::uint8_t, 4096> bytes;
  for (int i = 0; i < 50; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ssize_t old = 0, size = 0;
    while ((size = read(port, bytes.data(), bytes.size())) > 0) old += size;
    if (old < 500) return;
  }
}

}  // namespace

BotaSource::BotaSource(const Options& o)
    : period_us_{1e6 * seconds(o.period)},
      silence_{seconds(o.silence)},
      heard_{std::chrono::steady_clock::now()} {
  Require(Duration{} < o.period, "period must be > 0", o.period.text());
  Require(Duration{} < o.silence, "silence must be > 0", o.silence.text());
  const std::string name = o.device.string();
  Require(!name.empty(), "device must be the serial port of a force sensor, such as /dev/ttyUSB0");
  port_ = internal::Descriptor(open(name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (port_.get() < 0)
    throw Error("cannot open the force sensor's port '" + name + "': " + std::strerror(errno) +
                WayOut(errno));
  if (!isatty(port_.get()))
    throw Error("'" + name + "' is no serial port; expected one such as /dev/ttyUSB0");
  MakeRaw(port_.get());
  Forget(port_.get());
}

bool BotaSource::Read(WrenchReading& newest) noexcept {
  bool news = false;
  std::array<std::uint8_t, 4096> bytes;
  for (int i = 0; i < kMostAtOnce; ++i) {
    const ssize_t size = read(port_.get(), bytes.data(), bytes.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;  // nothing there, or unplugged
    const auto now = std::chrono::steady_clock::now();
    may_begin_ |= now - heard_ >= silence_;
    heard_ = now;
    for (ssize_t k = 0; k < size; ++k)
      if (const auto frame = parser_.Next(bytes[static_cast<std::size_t>(k)]))
        news |= Take(*frame, newest);
  }
  link_.corrupted = parser_.corrupted();
  newest.link = link_;
  return news;
}

bool BotaSource::Take(const BotaFrame& frame, WrenchReading& newest) noexcept {
  const auto ahead = static_cast<std::int32_t>(frame.timestamp_us - last_us_);
  const bool anew = begins_ || ahead <= -kBehind || ahead >= kAhead || (ahead < 0 && may_begin_);
  if (!anew) {
    if (ahead == 0) ++link_.duplicated;
    if (ahead < 0) ++link_.out_of_order;
    if (ahead <= 0) return false;
    const double steps = std::round(ahead / period_us_);
    link_.lost += static_cast<std::uint32_t>(std::max(0.0, steps - 1));
  }
  begins_ = may_begin_ = false;
  last_us_ = frame.timestamp_us;
  for (int i = 0; i < 3; ++i) {
    newest.wrench(i) = frame.torque[static_cast<std::size_t>(i)];
    newest.wrench(i + 3) = frame.force[static_cast<std::size_t>(i)];
  }
  newest.sequence = frame.timestamp_us;
  newest.device_status = frame.status;
  newest.faulty = IsBotaFault(frame.status);
  return true;
}

}  // namespace pliant
