#pragma once

#include <zlib.h>
#include <zstd.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// What a walk from the front to the back of an MCAP file finds, written from the specification
/// alone. Throws std::runtime_error at anything that is not as it says, half records included.
struct McapScan {
  struct Message {
    std::uint64_t time_ns;
    std::string data;
  };
  struct Channel {
    std::string topic, schema, text;
    std::map<std::string, std::string> metadata;
    std::vector<Message> messages;
  };

  std::map<std::string, Channel> topics;
  std::map<std::string, std::map<std::string, std::string>> metadata;
  std::size_t chunks = 0;
  bool whole = false;  ///< it has an end

  explicit McapScan(std::string_view file) {
    constexpr std::string_view kMagic = "\x89MCAP0\r\n";
    Check(file.starts_with(kMagic), "it begins with the magic");
    std::string_view rest = file.substr(kMagic.size());
    while (!rest.empty() && rest != kMagic) Record(rest);
    whole = rest == kMagic;
  }

  /// The numbers of a message of doubles.
  static std::vector<double> Numbers(const Message& m) {
    Check(m.data.size() % 8 == 4 && m.data.starts_with(std::string_view("\0\1\0\0", 4)), "CDR");
    std::vector<double> x(m.data.size() / 8);
    std::memcpy(x.data(), m.data.data() + 4, 8 * x.size());
    return x;
  }

 private:
  static void Check(bool holds, const std::string& what) {
    if (!holds) throw std::runtime_error("not an MCAP file: expected that " + what);
  }
  static std::string_view Take(std::string_view& rest, std::size_t n) {
    Check(n <= rest.size(), "a record is whole");
    const std::string_view bytes = rest.substr(0, n);
    rest.remove_prefix(n);
    return bytes;
  }
  template <class T>
  static T Number(std::string_view& rest) {
    T x;
    std::memcpy(&x, Take(rest, sizeof x).data(), sizeof x);
    return x;
  }
  static std::string Text(std::string_view& rest) {
    return std::string(Take(rest, Number<std::uint32_t>(rest)));
  }
  static std::map<std::string, std::string> Words(std::string_view& rest) {
    std::map<std::string, std::string> words;
    std::string_view all = Take(rest, Number<std::uint32_t>(rest));
    while (!all.empty()) {
      const std::string key = Text(all);
      words[key] = Text(all);
    }
    return words;
  }

  void Record(std::string_view& rest) {
    const auto op = Number<std::uint8_t>(rest);
    std::string_view r = Take(rest, Number<std::uint64_t>(rest));
    if (op == 3) {
      const auto id = Number<std::uint16_t>(r);
      const std::string name = Text(r);
      Check(Text(r) == "ros2msg", "schemas are of ROS 2");
      schemas_[id] = {name, Text(r)};
    } else if (op == 4) {
      const auto id = Number<std::uint16_t>(r);
      const auto& [name, text] = schemas_.at(Number<std::uint16_t>(r));
      Channel channel{
          .topic = Text(r), .schema = name, .text = text, .metadata = {}, .messages = {}};
      Check(Text(r) == "cdr", "messages are CDR");
      channel.metadata = Words(r);
      channels_[id] = channel.topic;
      topics.emplace(channel.topic, channel);
    } else if (op == 5) {
      Channel& channel = topics.at(channels_.at(Number<std::uint16_t>(r)));
      Number<std::uint32_t>(r);
      const auto time = Number<std::uint64_t>(r);
      Check(Number<std::uint64_t>(r) == time, "messages are published when they are logged");
      channel.messages.push_back({time, std::string(r)});
    } else if (op == 6) {
      ++chunks;
      Take(r, 16);
      std::string records(Number<std::uint64_t>(r), '\0');
      const auto crc = Number<std::uint32_t>(r);
      Check(Text(r) == "zstd", "chunks are zstd");
      const std::string_view packed = Take(r, Number<std::uint64_t>(r));
      Check(ZSTD_decompress(records.data(), records.size(), packed.data(), packed.size()) ==
                records.size(),
            "a chunk decompresses");
      Check(crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size()) == crc,
            "a chunk's sum is right");
      std::string_view inner = records;
      while (!inner.empty()) Record(inner);
    } else if (op == 12) {
      const std::string name = Text(r);
      metadata[name] = Words(r);
    }
  }

  std::map<std::uint16_t, std::pair<std::string, std::string>> schemas_;
  std::map<std::uint16_t, std::string> channels_;
};

}  // namespace pliant
