#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "pliant/analysis/mcap_reader.h"
#include "pliant/analysis/mcap_records.h"

namespace pliant::internal {

/// The channels of a file and their schemas, as they are met in it; each may be there often.
class McapChannels {
 public:
  const std::map<std::uint16_t, SchemaRecord>& schemas() const { return schemas_; }
  const std::map<std::uint16_t, ChannelRecord>& channels() const { return channels_; }

  /// Both throw Error, with the place of `content`, if it was another one before.
  void AddSchema(const ByteReader& content);
  void AddChannel(const ByteReader& content);

  /// Throws Error, with the place of the message, if the channel has not been met.
  void RequireKnown(std::uint16_t channel, const ByteReader& message) const;
  /// In order of id.
  std::vector<McapChannel> List() const;

 private:
  std::map<std::uint16_t, SchemaRecord> schemas_;
  std::map<std::uint16_t, ChannelRecord> channels_;
};

}  // namespace pliant::internal
