#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>

#include "pliant/plants/gen3_address.h"
#include "pliant/plants/gen3_link.h"
#include "pliant/plants/kortex_frame.h"
#include "pliant/plants/kortex_request.h"
#include "pliant/plants/socket.h"

namespace pliant::kortex {

/// The services of an arm by TCP, within a session that lives as long as this. Calls come one after
/// another, from any thread. A call throws Error if the arm refuses it, does not answer, or the
/// connection is lost, which is for good. No thread of its own: somebody keeps it alive.
class Services {
 public:
  explicit Services(const Gen3Address& address);
  ~Services();  ///< closes the session; takes half a second at most
  Services(const Services&) = delete;
  Services& operator=(const Services&) = delete;

  void ClearFaults();
  std::uint32_t ArmState();
  int ActuatorCount();
  Gen3Servoing Servoing();
  void SetServoing(Gen3Servoing servoing);
  Gen3Mode Mode(int joint);
  void SetMode(int joint, Gen3Mode mode);

  /// Asks the arm for a sign of life if nothing was sent for so long. None within the address's
  /// connection timeout, and the connection is lost.
  void KeepAlive(std::chrono::milliseconds silent) noexcept;

  bool connected() const noexcept { return connected_; }
  /// Frames that were no answer to what was asked, such as notifications and late answers.
  std::int64_t skipped() const noexcept { return skipped_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::vector<std::byte> Call(const Request& request);
  std::vector<std::byte> Call(const Request& request, std::chrono::milliseconds limit);
  void Write(std::span<const std::byte> bytes, Clock::time_point until);
  /// False if nothing came in time.
  bool Fill(Clock::time_point until);
  Error Lost(const std::string& reason);

  const Gen3Address address_;
  std::mutex call_;
  Socket socket_;
  FrameStream stream_;
  std::uint16_t session_ = 0, next_id_ = 0;
  Clock::time_point last_sent_;
  std::atomic<bool> connected_ = true;
  std::atomic<std::int64_t> skipped_ = 0;
};

}  // namespace pliant::kortex
