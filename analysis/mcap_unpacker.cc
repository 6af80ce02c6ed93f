#include "pliant/analysis/mcap_unpacker.h"

#include <lz4frame.h>
#include <zstd.h>

#include <array>
#include <cstdio>
#include <new>
#include <span>
#include <string>

#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

std::string Hex(std::uint32_t number) {
  std::array<char, 11> text;
  std::snprintf(text.data(), text.size(), "0x%08x", number);
  return text.data();
}

struct Lz4Context {
  LZ4F_dctx* context = nullptr;

  Lz4Context() {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)))
      throw std::bad_alloc();
  }
  ~Lz4Context() { LZ4F_freeDecompressionContext(context); }
  Lz4Context(const Lz4Context&) = delete;
  Lz4Context& operator=(const Lz4Context&) = delete;
};

/// Both return what is wrong; empty if all of `to` has been filled from all of `from`.
std::string UnpackZstd(Bytes from, std::span<std::byte> to) {
  const std::size_t n = ZSTD_decompress(to.data(), to.size(), from.data(), from.size());
  if (ZSTD_isError(n)) return ZSTD_getErrorName(n);
  return n == to.size() ? "" : "it has " + Text(n) + " bytes, not " + Text(to.size());
}

std::string UnpackLz4(Bytes from, std::span<std::byte> to) {
  const Lz4Context lz4;
  while (!from.empty()) {
    std::size_t written = to.size(), read = from.size();
    const std::size_t hint =
        LZ4F_decompress(lz4.context, to.data(), &written, from.data(), &read, nullptr);
    if (LZ4F_isError(hint)) return LZ4F_getErrorName(hint);
    if (written == 0 && read == 0) return "it has more bytes than the chunk says";
    to = to.subspan(written);
    from = from.subspan(read);
    if (from.empty() && hint != 0) return "its end is missing";
  }
  return to.empty() ? "" : "it has " + Text(to.size()) + " bytes less than the chunk says";
}

}  // namespace

Bytes Unpacker::Unpack(McapWindow& window, const ChunkHead& chunk) {
  const McapFile& file = window.file();
  RequireNotTooLarge(file, chunk.at, "the packed records of a chunk", chunk.records_size);
  RequireNotTooLarge(file, chunk.at, "the records of a chunk", chunk.size);
  const Bytes packed = window.At(chunk.records, chunk.records_size);
  Bytes records = packed;
  std::string fault;
  if (chunk.compression.empty()) {
    if (chunk.size != packed.size())
      fault = "it has " + Text(packed.size()) + " bytes, not " + Text(chunk.size);
  } else {
    if (chunk.size > capacity_) {
      buffer_.reset();
      capacity_ = 0;
      buffer_.reset(new (std::nothrow) std::byte[chunk.size]);
      if (!buffer_)
        throw Error(file.At(chunk.at) + "no memory for a chunk of " + Text(chunk.size) + " bytes");
      capacity_ = chunk.size;
    }
    const std::span<std::byte> to(buffer_.get(), chunk.size);
    if (chunk.compression == "zstd") {
      fault = UnpackZstd(packed, to);
    } else if (chunk.compression == "lz4") {
      fault = UnpackLz4(packed, to);
    } else {
      fault =
          "its compression must be zstd, lz4 or empty, got '" + Printable(chunk.compression) + "'";
    }
    records = to;
  }
  if (!fault.empty()) throw Error(file.At(chunk.at) + "the chunk cannot be unpacked: " + fault);
  if (chunk.crc != 0)
    if (const std::uint32_t crc = Crc32(records); crc != chunk.crc)
      throw Error(file.At(chunk.at) + "the chunk is damaged: its CRC is " + Hex(crc) + ", not " +
                  Hex(chunk.crc));
  return records;
}

}  // namespace pliant::internal
