#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "pliant/plants/gen3_link.h"

/// The messages of the exchange, between the bytes of the wire and plain numbers. Neither allocates
/// nor throws once it was used: what it needs is kept.
namespace pliant::kortex {

class Cyclic {
 public:
  Cyclic();
  ~Cyclic();
  Cyclic(const Cyclic&) = delete;
  Cyclic& operator=(const Cyclic&) = delete;

  /// The payload of Refresh under an id, which is also that of each actuator's command; the flags
  /// are 0. The bytes live until the next call.
  std::span<const std::byte> Write(std::uint16_t id, const Gen3Command& command) noexcept;

  /// Reads the payload of an answer; `feedback` is as it was if it is none of seven actuators.
  /// `answers` is not in it. A number may be any, NaN too.
  bool Read(std::span<const std::byte> payload, Gen3Feedback& feedback) noexcept;

 private:
  struct Messages;
  const std::unique_ptr<Messages> messages_;
};

}  // namespace pliant::kortex
