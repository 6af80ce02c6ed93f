#pragma once

#include <optional>

#include "pliant/analysis/mcap_reader.h"
#include "pliant/systems/record_sink.h"

namespace pliant::internal {

/// What is recorded in a channel of a log that McapLog wrote; empty if it is nothing of ours.
/// Throws Error with the topic if its metadata contradict themselves.
std::optional<RecordedValue> RecordedIn(const McapChannel& channel);

/// The numbers of a message of such a channel, `count` of them, into `to`. Throws Error with the
/// topic and the time if there are not so many.
void NumbersOf(const McapMessage& message, std::size_t count, double* to);

/// What to say of a log in which nothing of ours is recorded: its topics.
std::string HoldsNoRecording(const std::filesystem::path& file, const McapReader& log);

}  // namespace pliant::internal
