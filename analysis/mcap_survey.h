#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pliant/analysis/mcap_records.h"
#include "pliant/analysis/mcap_repair.h"

namespace pliant::internal {

/// What of a file can be read, however damaged it is. Where chunks have CRCs, messages without one
/// are not believed if anything is damaged.
struct McapSurvey {
  struct Kept : RecordHead {
    bool checked;  ///< a CRC says that it is right
  };

  std::string profile, library;
  std::map<std::uint16_t, std::string> schemas, channels;  ///< the contents of their records
  std::vector<Kept> kept;  ///< chunks, and messages, metadata and attachments outside of them
  LogRepair losses;

  explicit McapSurvey(const McapFile& file);
};

}  // namespace pliant::internal
