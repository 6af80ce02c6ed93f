#pragma once

#include <memory>

#include "pliant/plants/gen3_address.h"
#include "pliant/plants/gen3_link.h"

namespace pliant {

/// The way to an arm by its own protocol, without the vendor's library: services by TCP, the
/// exchange by UDP, a session on each. Throws Error if there is no arm, or it does not let us in.
///
/// A thread asks for a sign of life where nothing was sent for 150 ms by TCP, or 500 ms by UDP.
/// None by TCP within the connection timeout, and the connection is lost: services throw from then
/// on. The end takes three seconds at most, if the arm is silent.
///
/// A number of the feedback may be NaN or infinite: who uses it judges. `Read` takes its answer
/// from the socket of the exchange.
///
/// The protocol's envelope is not documented by its vendor (`kortex_frame.h`), and this was run
/// against servers of ours only, not yet against an arm.
std::unique_ptr<Gen3Link> ConnectGen3(const Gen3Address& address);

}  // namespace pliant
