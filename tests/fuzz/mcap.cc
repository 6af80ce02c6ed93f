#include "pliant/analysis/mcap_reader.h"

#include <fstream>

#include "pliant/analysis/mcap_repair.h"
#include "pliant/analysis/recording.h"
#include "pliant/tests/fuzz/targets.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant::fuzz {

bool Mcap(const std::string& bytes) {
  static const TemporaryDirectory directory;
  const std::filesystem::path log = directory.path() / "log.mcap";
  const std::filesystem::path mended = directory.path() / "mended.mcap";
  std::ofstream(log, std::ios::binary) << bytes;

  Takes([&] { McapReader(log).ForEach({}, [](const McapMessage&) {}); });
  const bool recording = Takes([&] { Recording::Read(log); });

  LogRepair repair;
  if (!Takes([&] { repair = RepairLog(log, mended, true); })) return false;
  const McapReader whole(mended);
  Check(whole.fault().empty() && whole.indexed(), "what was repaired is whole");
  std::uint64_t messages = 0;
  whole.ForEach({}, [&](const McapMessage&) { ++messages; });
  Check(messages == repair.messages, "a repair has the messages it says it kept");
  return recording;
}

}  // namespace pliant::fuzz
