#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace pliant {

namespace internal {
class McapFile;
}

/// A topic of an MCAP file and what its messages are.
struct McapChannel {
  std::uint16_t id = 0;
  std::string topic;
  std::string message_encoding;                        ///< such as "cdr"
  std::string schema_name, schema_encoding, schema{};  ///< empty if it has none
  std::map<std::string, std::string> metadata;
  std::uint64_t messages = 0;
};

/// Valid during the call it is given to.
struct McapMessage {
  const McapChannel& channel;
  std::uint32_t sequence;
  std::uint64_t log_time, publish_time;  ///< [ns]
  std::span<const std::byte> data;
};

/// Reads MCAP files, also those of others: with or without index and chunks; zstd, lz4 or nothing.
///
///   const McapReader log("run.mcap");
///   log.ForEach({.topics = {"/arm/measured_velocity"}}, [](const McapMessage& m) { … });
///
/// The file is read a chunk at a time. A chunk may have 1 GiB, packed and unpacked.
/// Source: the MCAP file format specification, https://mcap.dev/spec.
class McapReader {
 public:
  using Metadata = std::map<std::string, std::map<std::string, std::string>>;

  struct Filter {
    std::vector<std::string> topics = {};                          ///< empty: all
    std::uint64_t from = 0;                                        ///< log time [ns]
    std::uint64_t to = std::numeric_limits<std::uint64_t>::max();  ///< included
  };

  /// Throws Error if the file cannot be read or is not an MCAP file. One that is cut or damaged is
  /// opened and has a fault; its channels and counts are those of its readable beginning.
  explicit McapReader(const std::filesystem::path& file);
  ~McapReader();
  McapReader(McapReader&&) noexcept;
  McapReader& operator=(McapReader&&) noexcept;

  std::uint64_t bytes() const;
  const std::string& profile() const { return profile_; }                 ///< such as "ros2"
  const std::string& library() const { return library_; }                 ///< that wrote the file
  const std::vector<McapChannel>& channels() const { return channels_; }  ///< in order of id
  const Metadata& metadata() const { return metadata_; }
  std::uint64_t messages() const { return messages_; }
  std::uint64_t from() const { return from_; }  ///< the first log time [ns]; 0 without messages
  std::uint64_t to() const { return to_; }      ///< the last
  bool indexed() const { return indexed_; }     ///< it could be opened without reading it all
  /// What is wrong with the file and the way out; empty if nothing is known to be.
  const std::string& fault() const { return fault_; }

  /// The messages that pass, in the order in which they lie in the file. Without a filter all that
  /// the file says about itself is checked: the CRC of each chunk and of all data, and the number
  /// of messages. Throws Error if there is a fault.
  void ForEach(const Filter& filter, const std::function<void(const McapMessage&)>& act) const;

 private:
  bool ReadIndex(std::uint64_t from, std::uint64_t to);
  void ReadAll();
  std::string WayOut() const;
  std::string Broken(const std::string& fault) const;

  std::unique_ptr<internal::McapFile> file_;
  std::uint64_t begin_ = 0, end_ = 0;  // of the records before the summary
  std::string profile_, library_, fault_;
  std::vector<McapChannel> channels_;
  Metadata metadata_;
  std::uint64_t messages_ = 0, from_ = 0, to_ = 0;
  bool indexed_ = false;
};

}  // namespace pliant
