#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pliant {

/// A value as it is recorded: a number for each element, at each row.
struct RecordedValue {
  std::string path;                   ///< such as "arm.measured_velocity"
  std::string type;                   ///< its quantity, or the C++ type
  std::vector<std::string> elements;  ///< such as "[elbow]" or ".force[x]"; "" for a plain number
  std::vector<std::string> units;     ///< of each element

  bool operator==(const RecordedValue&) const = default;
};

/// Where recorders put their rows: a file, a page, a test.
class RecordSink {
 public:
  virtual ~RecordSink() = default;

  /// Before the first row: the values of the rows to come. Returns the number of the stream.
  virtual int Open(std::vector<RecordedValue> values) = 0;

  /// Room for a row at `time_ns`: the numbers of all values of the stream, one after the other.
  /// Empty if the row is dropped. One thread calls it, in a tick: it does not throw and, if the
  /// sink is made for real time, neither allocates nor waits.
  virtual std::span<double> Begin(int stream, std::int64_t time_ns) noexcept = 0;
  /// After Begin has given room and it was filled.
  virtual void Commit() noexcept = 0;

 protected:
  RecordSink() = default;
  RecordSink(const RecordSink&) = default;
  RecordSink& operator=(const RecordSink&) = default;
};

}  // namespace pliant
