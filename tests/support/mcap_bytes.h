#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "pliant/tests/support/temporary_directory.h"

namespace pliant {

inline std::filesystem::path LogOf(const std::string& name) {
  return std::filesystem::path(PLIANT_SOURCE_DIR) / "tests/analysis/data" / name;
}

/// A record of an MCAP file, as its opcode, place and length say.
struct McapBytes {
  int op;
  std::size_t at;
  std::uint64_t length;

  std::size_t end() const { return at + 9 + length; }
};

/// Those outside of chunks.
inline std::vector<McapBytes> RecordsOf(const std::string& log) {
  std::vector<McapBytes> records;
  for (std::size_t at = 8; at + 9 <= log.size();) {
    McapBytes record{log[at], at, 0};
    std::memcpy(&record.length, log.data() + at + 1, sizeof record.length);
    if (record.length > log.size()) break;
    at = record.end();
    records.push_back(record);
  }
  return records;
}

/// The k-th record of an opcode.
inline McapBytes RecordOf(const std::string& log, int op, int k = 0) {
  for (const McapBytes& record : RecordsOf(log))
    if (record.op == op && k-- == 0) return record;
  throw std::runtime_error("no record of opcode " + std::to_string(op));
}

template <class T>
void Overwrite(std::string& log, std::size_t at, T number) {
  std::memcpy(log.data() + at, &number, sizeof number);
}

/// What a record is made of.
template <class T>
std::string Packed(T number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}
inline std::string Packed(const std::string& word) {
  return Packed(static_cast<std::uint32_t>(word.size())) + word;
}
inline std::string Packed(const std::map<std::string, std::string>& words) {
  std::string text;
  for (const auto& [key, word] : words) text += Packed(key) + Packed(word);
  return Packed(text);
}

inline std::string RecordBytes(int op, const std::string& content) {
  return static_cast<char>(op) + Packed(std::uint64_t{content.size()}) + content;
}

inline std::string ChannelBytes(std::uint16_t id, const std::string& topic,
                                const std::map<std::string, std::string>& metadata,
                                const std::string& encoding = "cdr") {
  return RecordBytes(4, Packed(id) + Packed(std::uint16_t{0}) + Packed(topic) + Packed(encoding) +
                            Packed(metadata));
}

inline std::string MessageBytes(std::uint16_t channel, std::uint64_t ns, const std::string& data) {
  return RecordBytes(5,
                     Packed(channel) + Packed(std::uint32_t{0}) + Packed(ns) + Packed(ns) + data);
}

/// A log of these records, without index and CRCs.
inline std::string LogBytes(const std::string& records) {
  const std::string magic = "\x89MCAP0\r\n";
  const std::string none(8 + 8 + 4, '\0');
  return magic + RecordBytes(1, Packed(std::string()) + Packed(std::string("by hand"))) + records +
         RecordBytes(15, Packed(std::uint32_t{0})) + RecordBytes(2, none) + magic;
}

}  // namespace pliant
