#pragma once

#include <memory>

#include "pliant/plants/gen3_address.h"
#include "pliant/plants/gen3_link.h"

namespace pliant {

/// The way to an arm through Kinova's own C++ SDK, KortexApi 2.x. In the library pliant::gen3_sdk,
/// which is built where CMake finds the SDK. Throws Error as ConnectGen3 does.
///
/// Send asks by Refresh_callback, so that a tick does not wait; the SDK's thread puts what is
/// answered where Receive takes it. The price: the SDK allocates in each exchange, locks a mutex
/// that its own threads use, and its answer passes through one more thread. What it does with the
/// memory of an answer that never comes is not documented. Of traffic, `unreadable` counts feedback
/// of other than seven actuators and feedback that nobody took in time; bytes that are no feedback
/// are the SDK's to drop. It does not tell a lost connection: `connected` stays true, and services
/// throw.
///
/// Verified: it compiles against the messages of `kortex/` and declarations of the SDK's classes
/// written from Kinova's public examples and reference. Not verified: the SDK's headers themselves,
/// linking with its library, and an arm.
std::unique_ptr<Gen3Link> ConnectGen3BySdk(const Gen3Address& address);

}  // namespace pliant
