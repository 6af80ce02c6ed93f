#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "pliant/controllers/pad_state.h"

namespace pliant {

/// The first game controller of this machine, asked by a thread of its own every 2 ms. One that is
/// missing or unplugged is not connected; one that is plugged in later is found. One at a time.
class PadDevice {
 public:
  /// Throws Error if game controllers cannot be asked at all, or if there is a PadDevice.
  PadDevice();
  ~PadDevice();
  PadDevice(const PadDevice&) = delete;
  PadDevice& operator=(const PadDevice&) = delete;

  /// What it said last, its stamp since this object began. One word is read: no lock, no system
  /// call, so that a tick may ask.
  PadState latest() const noexcept;

 private:
  void Ask();

  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  std::atomic<std::uint64_t> word_{0};  // 16 bits of buttons, 1 of connected, 47 of microseconds
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace pliant
