#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pliant/plants/robot_model.h"
#include "pliant/systems/record_sink.h"

namespace pliant {

/// Writes what recorders record to an MCAP file that Foxglove, PlotJuggler, Rerun and rosbag2 read:
/// a ROS 2 topic for each value, "/arm/velocity" for arm.velocity, with a named field for each of
/// its numbers.
///
/// One thread records, or several one after the other: two diagrams that run at the same time need
/// a log each, and two contexts of one diagram, which share its log, may not run at the same time.
/// Open, AddMetadata and Close too are for that thread.
///
/// Rows go through a ring to a thread that compresses and writes them, so that a tick neither
/// allocates nor waits for the disk. That thread closes a chunk every half second of wall time: of
/// a killed process a second is lost at most, and what it has written can be read. But for where
/// such a chunk ends, the same rows make the same file. If writing fails, the run goes on; rows
/// that are not in the file count as dropped.
class McapLog final : public RecordSink {
 public:
  /// What to do with a row for which the ring has no room. Dropped ones are counted on the topic
  /// /pliant/dropped and in the record "pliant.statistics".
  enum class Full { Wait, Drop };

  struct Options {
    std::filesystem::path file;
    /// Write over a file that is there. The new file begins as "<file>.part" and is moved over the
    /// old one at once, which stays if the new one cannot begin.
    bool force = false;
    /// Maps of words by the name of the record, such as "pliant": {"version": …, "scenario": …}.
    std::map<std::string, std::map<std::string, std::string>> metadata = {};
    std::optional<RobotModel> robot = {};  ///< for /tf, at most 100 times a second
    std::string robot_description = {};    ///< URDF, for /robot_description
    /// Paths, for /joint_states and /tf; those that are given are recorded by one recorder.
    std::string position = {}, velocity = {}, torque = {};
    Full full = Full::Wait;  ///< simulation waits for the disk, a robot does not
    std::size_t ring_bytes = 8 << 20;
  };

  struct Statistics {
    std::int64_t rows = 0, dropped = 0, bytes = 0;  ///< rows in the file; its size
    std::string error = {};  ///< why writing ended before its time; empty: it did not
  };

  /// Throws Error if the file is there, or cannot be begun.
  explicit McapLog(Options o);
  ~McapLog() override;  ///< closes the file

  int Open(std::vector<RecordedValue> values) override;
  std::span<double> Begin(int stream, std::int64_t time_ns) noexcept override;
  void Commit() noexcept override;

  /// Says more about the run, such as how it ended, when the file is closed.
  void AddMetadata(const std::string& name, const std::map<std::string, std::string>& words);

  /// Writes what is in the ring, the index and the statistics; the file is complete. Throws Error
  /// if it could not be written, or if a path of the options was never recorded.
  void Close();
  Statistics statistics() const;

 private:
  struct Writer;
  std::unique_ptr<Writer> writer_;
};

}  // namespace pliant
