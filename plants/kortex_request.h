#pragma once

#include <span>
#include <string>
#include <vector>

#include "pliant/plants/gen3_address.h"
#include "pliant/plants/kortex_frame.h"
#include "pliant/systems/error.h"

namespace pliant::kortex {

/// A call of a service. `text` is how messages name it, such as "SetServoingMode
/// LOW_LEVEL_SERVOING".
struct Request {
  Function function;
  std::string text;
  std::uint8_t device = 0;
  std::vector<std::byte> payload = {};
};

/// What opens a session, by TCP or by UDP.
Request SessionRequest(const Gen3Address& address);

/// What to say of an answer that has an error: what was asked, the error's names, the arm's own
/// words, and a way out of the common ones.
Error Refusal(const Gen3Address& address, const Request& request, const Frame& answer);

/// The same of plain numbers: ErrorCodes and SubErrorCodes.
Error Refusal(const Gen3Address& address, const std::string& asked, int code, int sub_code,
              const std::string& words);

/// What to say if none came.
Error Silence(const Gen3Address& address, const Request& request, std::chrono::milliseconds limit);

/// What to say if there is no way to the arm at all, for the reason.
Error Unreachable(const Gen3Address& address, const std::string& reason);

}  // namespace pliant::kortex
