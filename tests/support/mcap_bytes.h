#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
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

}  // namespace pliant
