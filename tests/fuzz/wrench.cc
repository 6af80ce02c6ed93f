#include <algorithm>
#include <span>

#include "pliant/plants/bota_frame.h"
#include "pliant/plants/rdt_frame.h"
#include "pliant/tests/fuzz/targets.h"

namespace pliant::fuzz {

bool WrenchFrames(const std::string& text) {
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());

  bool found = false;
  BotaParser parser;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    if (const auto frame = parser.Next(bytes[i])) {
      found = true;
      Check(i + 1 >= kBotaFrameBytes &&
                std::ranges::equal(Encode(*frame),
                                   bytes.subspan(i + 1 - kBotaFrameBytes, kBotaFrameBytes)),
            "a frame is the bytes that end where it is found");
    }

  for (std::size_t n : {kRdtRequestBytes, kRdtRecordBytes, bytes.size()}) {
    const auto part = bytes.first(std::min(n, bytes.size()));
    if (const auto request = DecodeRdtRequest(part)) {
      found = true;
      Check(std::ranges::equal(Encode(*request), part), "a request reads back the same");
    }
    if (const auto record = DecodeRdtRecord(part)) {
      found = true;
      Check(std::ranges::equal(Encode(*record), part), "a record reads back the same");
      const RdtScale scale;
      Check(scale.CountsOf(scale.WrenchOf(record->counts)) == record->counts,
            "a wrench has its counts");
    }
  }
  return found;
}

}  // namespace pliant::fuzz
