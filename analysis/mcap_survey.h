#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pliant/analysis/mcap_records.h"
#include "pliant/analysis/mcap_repair.h"

namespace pliant::internal {

/// What of a file can be read, however damaged it is.
struct McapSurvey {
  std::string profile, library;
  std::map<std::uint16_t, std::string> schemas, channels;  ///< the contents of their records
  std::vector<RecordHead> kept;  ///< chunks, and messages, metadata and attachments outside of them
  LogRepair losses;

  explicit McapSurvey(const McapFile& file);
};

}  // namespace pliant::internal
