#include "pliant/analysis/mcap_byte_reader.h"

#include <bit>
#include <utility>

#include "pliant/systems/error.h"

namespace pliant::internal {

static_assert(std::endian::native == std::endian::little, "MCAP's numbers are read as they lie");

std::string ByteReader::TakeText(const char* what) {
  return std::string(TextOf(TakeBytes(Take<std::uint32_t>(what), what)));
}

ByteReader ByteReader::TakeReader(const char* what) {
  const auto size = Take<std::uint32_t>(what);
  const std::uint64_t at = at_;
  return {TakeBytes(size, what), place_, at};
}

std::map<std::string, std::string> ByteReader::TakeMap(const char* what) {
  std::map<std::string, std::string> map;
  for (ByteReader in = TakeReader(what); !in.empty();) {
    std::string key = in.TakeText(what);
    map[std::move(key)] = in.TakeText(what);
  }
  return map;
}

void ByteReader::Fail(const std::string& what) const {
  throw Error(std::string(place_) + "at byte " + Text(at_) + ": " + what);
}

void ByteReader::Short(std::uint64_t n, const char* what) const {
  Fail(std::string(what) + " has " + Text(n) + " bytes, but its record ends after " +
       Text(bytes_.size()));
}

}  // namespace pliant::internal
