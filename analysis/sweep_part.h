#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/analysis/sweep.h"
#include "pliant/systems/descriptor.h"

namespace pliant {

/// What is read of a part: a file of rows of a sweep, one process's.
///
///   "pliant sweep 1\n" | size, crc | text of the sweep
///   "row\n" | size, crc | run, count, numbers (drawn and measured), ended, failed     … appended
///
/// Sizes and checksums (CRC-32 of size and content) are 4 bytes, numbers 8, little-endian; a text
/// has its size before it. Rows whose checksum is wrong are passed over.
struct SweepPartContent {
  std::string text;  ///< of the sweep
  std::vector<SweepRow> rows;
  std::uint64_t whole = 0;  ///< bytes up to the end of the last row; 0: not even its head is whole
  std::vector<std::string> damaged = {};  ///< such as "bytes 100 to 200 are no row"

  /// Of one that is being written, the rows it has by now. Throws Error with the file if it is no
  /// part.
  static SweepPartContent Read(const std::filesystem::path& file);
};

/// Throws Error, with the first line that differs, unless a part is one of this sweep.
void RequireSameSweep(const Sweep& sweep, const std::filesystem::path& file,
                      const std::string& text);

/// The parts in a directory, sorted.
std::vector<std::filesystem::path> SweepPartsIn(const std::filesystem::path& directory);

/// Whether a process writes a part.
bool IsBeingWritten(const std::filesystem::path& file);

/// A part that is written. Each row is in the file when Append returns, so a process that is killed
/// loses none. It is locked as long as this lives.
class SweepPart {
 public:
  /// Goes on with a part that is there; what stands behind its last row is cut. Throws Error if
  /// another process writes it, or if it is of another sweep.
  SweepPart(std::filesystem::path file, const Sweep& sweep);

  const std::vector<SweepRow>& rows() const { return rows_; }  ///< that were there
  /// What was wrong with it, a line each.
  const std::vector<std::string>& damage() const { return damage_; }
  void Append(const SweepRow& row);

 private:
  void Open(const Sweep& sweep);
  void Write(const std::string& bytes);

  const std::filesystem::path file_;
  internal::Descriptor descriptor_;
  std::uint64_t end_ = 0;
  std::vector<SweepRow> rows_;
  std::vector<std::string> damage_;
};

}  // namespace pliant
