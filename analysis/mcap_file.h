#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pliant/analysis/mcap_bytes.h"
#include "pliant/systems/descriptor.h"

namespace pliant::internal {

/// An MCAP file that is open for reading. All functions throw Error, with the place, if it cannot
/// be read there.
class McapFile {
 public:
  /// Throws Error if it cannot be opened or is not an MCAP file.
  explicit McapFile(std::filesystem::path path);

  const std::string& name() const { return name_; }
  const std::string& place() const { return place_; }  ///< "FILE: "
  std::uint64_t size() const { return size_; }
  /// Fills `to`, or as much of it as can be read if that is `least` bytes; returns how many.
  std::size_t Read(std::uint64_t at, std::span<std::byte> to, std::size_t least) const;
  /// Of the bytes between these places and those before them, whose sum is `before`.
  std::uint32_t Crc(std::uint64_t from, std::uint64_t to, std::uint32_t before = 0) const;
  /// "FILE: at byte N: "
  std::string At(std::uint64_t at) const;

 private:
  const std::string name_, place_;
  Descriptor descriptor_;
  std::uint64_t size_ = 0;
};

/// A piece of a file in memory, which moves along with what is read.
class McapWindow {
 public:
  explicit McapWindow(const McapFile& file) : file_{file} {}
  const McapFile& file() const { return file_; }
  /// n bytes that the file has; valid until the next call. Bytes that cannot be read hinder only
  /// who wants them.
  Bytes At(std::uint64_t at, std::uint64_t n);

 private:
  const McapFile& file_;
  std::vector<std::byte> bytes_;
  std::uint64_t begin_ = 0;
};

}  // namespace pliant::internal
