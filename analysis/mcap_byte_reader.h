#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>

#include "pliant/analysis/mcap_bytes.h"

namespace pliant::internal {

/// Takes numbers and words from bytes, one after the other. Throws Error with the place if they end
/// too early.
class ByteReader {
 public:
  /// `place` is put in front of messages and `at` is the first byte's number there.
  ByteReader(Bytes bytes, std::string_view place, std::uint64_t at)
      : bytes_{bytes}, place_{place}, at_{at} {}

  bool empty() const { return bytes_.empty(); }
  std::size_t left() const { return bytes_.size(); }
  std::uint64_t at() const { return at_; }

  template <class T>
  T Take(const char* what) {
    T number;
    std::memcpy(&number, TakeBytes(sizeof number, what).data(), sizeof number);
    return number;
  }
  Bytes TakeBytes(std::uint64_t n, const char* what) {
    if (n > bytes_.size()) Short(n, what);
    const Bytes taken = bytes_.first(n);
    bytes_ = bytes_.subspan(n);
    at_ += n;
    return taken;
  }
  std::string TakeText(const char* what);
  std::map<std::string, std::string> TakeMap(const char* what);
  /// The next bytes, as many as a number in front of them says.
  ByteReader TakeReader(const char* what);
  /// All that is left.
  Bytes Rest() { return TakeBytes(bytes_.size(), ""); }
  [[noreturn]] void Fail(const std::string& what) const;

 private:
  [[noreturn]] void Short(std::uint64_t n, const char* what) const;

  Bytes bytes_;
  std::string_view place_;
  std::uint64_t at_;
};

}  // namespace pliant::internal
