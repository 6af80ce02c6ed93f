#pragma once

#include <array>
#include <atomic>
#include <chrono>

#include "pliant/plants/gen3_address.h"
#include "pliant/plants/gen3_link.h"
#include "pliant/plants/kortex_cyclic.h"
#include "pliant/plants/kortex_frame.h"
#include "pliant/plants/kortex_request.h"
#include "pliant/plants/socket.h"

namespace pliant::kortex {

/// Commands and feedback by UDP, within a session of its own that lives as long as this. Send and
/// Receive do as Gen3Link says, with the system calls sendto and recv, and ppoll only for patience.
///
/// Requests of all kinds are numbered by one count, so an answer belongs to one request, and the
/// ids of commands have gaps where something else was asked.
class Exchange {
 public:
  explicit Exchange(const Gen3Address& address);
  ~Exchange();  ///< closes the session; takes a fifth of a second at most
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  Gen3Feedback Read();
  int Send(const Gen3Command& command) noexcept;
  bool Receive(Gen3Feedback& feedback, std::chrono::nanoseconds patience) noexcept;

  /// Sends a sign of life if nothing was sent for so long, from any thread.
  void KeepAlive(std::chrono::milliseconds silent) noexcept;

  Gen3Traffic traffic() const noexcept;

 private:
  using Clock = std::chrono::steady_clock;
  using Buffer = std::array<std::byte, kLargestFrame>;

  /// The answer, in `in_`; asks again at intervals. Throws Error if there is none in time.
  Frame Ask(const Request& request, std::chrono::milliseconds limit);
  /// False if the kernel refused it.
  bool Put(const Header& header, std::span<const std::byte> payload) noexcept;
  /// The next datagram that is there; its size, or −1.
  ssize_t Take() noexcept;
  /// Forgets what came, once nobody has listened for a while.
  void Drain() noexcept;
  /// Whether what came is feedback that answers a command.
  bool Understand(std::span<const std::byte> datagram, Gen3Feedback& feedback) noexcept;

  const Gen3Address address_;
  const Socket socket_;
  Cyclic cyclic_;
  std::uint16_t session_ = 0;
  std::atomic<std::uint16_t> next_id_ = 0;
  std::atomic<Clock::rep> last_sent_ = 0;
  std::atomic<bool> unheard_ = false;
  std::array<std::byte, 1024> out_;
  Buffer in_;

  struct Counts {
    std::atomic<std::int64_t> sent = 0, received = 0, unsent = 0, refused = 0, unreadable = 0;
  };
  Counts counts_;
};

}  // namespace pliant::kortex
