#include "pliant/analysis/mcap_bytes.h"

#include <zlib.h>

namespace pliant::internal {

std::uint32_t Crc32(Bytes bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace pliant::internal
