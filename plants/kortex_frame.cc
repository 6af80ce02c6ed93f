#include "pliant/plants/kortex_frame.h"

#include <google/protobuf/io/coded_stream.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "pliant/systems/error.h"

namespace pliant::kortex {

namespace {

using google::protobuf::io::CodedInputStream;
using google::protobuf::io::CodedOutputStream;

constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 20;  // four fixed32, each behind its tag

// Of protobuf: field « 3 | wire type, which is 2 for lengths and 5 for fixed32.
constexpr std::uint32_t kHeaderTag = 1 << 3 | 2, kPayloadTag = 2 << 3 | 2;
constexpr std::uint32_t Fixed32Tag(std::uint32_t field) { return field << 3 | 5; }

constexpr std::array<char, 8> kMark{7, 'x', 'E', 't', 'R', 'o', 'K', 7};
constexpr std::size_t kPrefix = kMark.size() + 4;

std::uint32_t Bits(std::uint32_t word, int from, int count) {
  return word >> from & ((1U << count) - 1);
}

bool Skip(CodedInputStream& in, std::uint32_t tag) {
  std::uint64_t number;
  std::uint32_t length;
  switch (tag & 7) {
    case 0:
      return in.ReadVarint64(&number);
    case 1:
      return in.Skip(8);
    case 2:
      return in.ReadVarint32(&length) && length <= kLargestFrame &&
             in.Skip(static_cast<int>(length));
    case 5:
      return in.Skip(4);
    default:
      return false;
  }
}

/// `end` is where the bytes do: a stream of protobuf takes one that ends early for a whole one.
bool ReadWords(CodedInputStream& in, std::size_t end, std::array<std::uint32_t, 4>& words) {
  std::uint32_t length;
  if (!in.ReadVarint32(&length) || length > end - static_cast<std::size_t>(in.CurrentPosition()))
    return false;
  const auto limit = in.PushLimit(static_cast<int>(length));
  while (const std::uint32_t tag = in.ReadTag()) {
    const std::uint32_t field = tag >> 3;
    if (field >= 1 && field <= 4 && tag == Fixed32Tag(field)) {
      if (!in.ReadLittleEndian32(&words[field - 1])) return false;
    } else if (!Skip(in, tag)) {
      return false;
    }
  }
  if (!in.ConsumedEntireMessage()) return false;
  in.PopLimit(limit);
  return true;
}

}  // namespace

std::size_t WriteFrame(const Header& h, std::span<const std::byte> payload,
                       std::span<std::byte> out) noexcept {
  if (payload.size() > kLargestFrame - kEnvelope || out.size() < payload.size() + kEnvelope)
    return 0;
  const std::array<std::uint32_t, 4> words{kVersion << 28 |
                                               static_cast<std::uint32_t>(h.type) << 24 |
                                               static_cast<std::uint32_t>(h.device) << 16 |
                                               (h.error & 0xFU) << 12 | (h.error_code & 0xFFFU),
                                           static_cast<std::uint32_t>(h.session) << 16 | h.id,
                                           kVersion << 28 | static_cast<std::uint32_t>(h.function),
                                           static_cast<std::uint32_t>(payload.size())};
  auto* const begin = reinterpret_cast<std::uint8_t*>(out.data());
  std::uint8_t* p = CodedOutputStream::WriteTagToArray(kHeaderTag, begin);
  p = CodedOutputStream::WriteVarint32ToArray(kHeaderBytes, p);
  for (std::uint32_t field = 1; field <= words.size(); ++field) {
    p = CodedOutputStream::WriteTagToArray(Fixed32Tag(field), p);
    p = CodedOutputStream::WriteLittleEndian32ToArray(words[field - 1], p);
  }
  if (!payload.empty()) {
    p = CodedOutputStream::WriteTagToArray(kPayloadTag, p);
    p = CodedOutputStream::WriteVarint32ToArray(static_cast<std::uint32_t>(payload.size()), p);
    std::memcpy(p, payload.data(), payload.size());
    p += payload.size();
  }
  return static_cast<std::size_t>(p - begin);
}

std::optional<Frame> ReadFrame(std::span<const std::byte> bytes) noexcept {
  if (bytes.size() > kLargestFrame) return {};
  CodedInputStream in(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                      static_cast<int>(bytes.size()));
  std::array<std::uint32_t, 4> words{};
  std::span<const std::byte> payload;
  while (const std::uint32_t tag = in.ReadTag()) {
    std::uint32_t length = 0;
    if (tag == kHeaderTag) {
      if (!ReadWords(in, bytes.size(), words)) return {};
    } else if (tag == kPayloadTag) {
      if (!in.ReadVarint32(&length)) return {};
      const auto at = static_cast<std::size_t>(in.CurrentPosition());
      if (length > bytes.size() - at || !in.Skip(static_cast<int>(length))) return {};
      payload = bytes.subspan(at, length);
    } else if (!Skip(in, tag)) {
      return {};
    }
  }
  if (!in.ConsumedEntireMessage() || Bits(words[0], 28, 4) != kVersion ||
      Bits(words[3], 0, 24) != payload.size())
    return {};
  return Frame{.header = {.type = static_cast<FrameType>(Bits(words[0], 24, 4)),
                          .device = static_cast<std::uint8_t>(Bits(words[0], 16, 8)),
                          .error = static_cast<std::uint8_t>(Bits(words[0], 12, 4)),
                          .error_code = static_cast<std::uint16_t>(Bits(words[0], 0, 12)),
                          .session = static_cast<std::uint16_t>(words[1] >> 16),
                          .id = static_cast<std::uint16_t>(words[1]),
                          .function = static_cast<Function>(Bits(words[2], 0, 28))},
               .payload = payload};
}

std::span<std::byte> FrameStream::Room() {
  if (begin_ > 0) {
    std::memmove(bytes_.data(), bytes_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (bytes_.size() < end_ + 4096) bytes_.resize(end_ + 4096);
  return std::span(bytes_).subspan(end_);
}

void FrameStream::Filled(std::size_t bytes) { end_ += bytes; }

std::optional<std::span<const std::byte>> FrameStream::Next() {
  const auto there = std::span(bytes_).subspan(begin_, end_ - begin_);
  const std::size_t marked = std::min(there.size(), kMark.size());
  if (!std::ranges::equal(there.first(marked), std::as_bytes(std::span(kMark)).first(marked)))
    throw Error("the stream of frames is out of step: expected 07 \"xEtRoK\" 07 before a frame");
  if (there.size() < kPrefix) return {};
  std::size_t length = 0;
  for (std::size_t i = kMark.size(); i < kPrefix; ++i)
    length = length << 8 | std::to_integer<std::size_t>(there[i]);
  if (length > kLargestFrame)
    throw Error("a frame must be no longer than " + Text(kLargestFrame) + " bytes, got " +
                Text(length));
  if (there.size() < kPrefix + length) return {};
  begin_ += kPrefix + length;
  return there.subspan(kPrefix, length);
}

std::vector<std::byte> InStream(const Header& header, std::span<const std::byte> payload) {
  std::vector<std::byte> out(kPrefix + payload.size() + kEnvelope);
  const std::size_t length = WriteFrame(header, payload, std::span(out).subspan(kPrefix));
  std::memcpy(out.data(), kMark.data(), kMark.size());
  for (std::size_t i = 0; i < 4; ++i)
    out[kMark.size() + i] = static_cast<std::byte>(length >> (24 - 8 * i));
  out.resize(kPrefix + length);
  return out;
}

}  // namespace pliant::kortex
