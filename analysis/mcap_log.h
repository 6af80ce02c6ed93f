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

/// Writes what recorders record to an MCAP file that Foxglove, PlotJuggler, Rerun and rosbag2 read.
class McapLog final : public RecordSink {
 public:
  /// What to do with a row for which the ring has no room.
  enum class Full { Wait, Drop };

  struct Options {
    std::filesystem::path file;
    bool force = false;  ///< write over a file that is there
    /// Maps of words by the name of the record, such as "pliant": {"version": …, "scenario": …}.
    std::map<std::string, std::map<std::string, std::string>> metadata = {};
    std::optional<RobotModel> robot = {};                   ///< for /tf
    std::string robot_description = {};                     ///< URDF, for /robot_description
    std::string position = {}, velocity = {}, torque = {};  ///< paths, for /joint_states and /tf
    Full full = Full::Wait;  ///< simulation waits for the disk, a robot does not
    std::size_t ring_bytes = 8 << 20;
  };

  struct Statistics {
    std::int64_t rows = 0, dropped = 0, bytes = 0;
    std::string error = {};  ///< why writing ended before its time; empty: it did not
  };

  explicit McapLog(Options o);
  ~McapLog() override;  ///< closes the file

  int Open(std::vector<RecordedValue> values) override;
  std::span<double> Begin(int stream, std::int64_t time_ns) noexcept override;
  void Commit() noexcept override;

  /// Writes what is in the ring, the index and the statistics; the file is complete. Throws Error
  /// if it could not be written.
  void Close();
  Statistics statistics() const;

 private:
  struct Writer;
  std::unique_ptr<Writer> writer_;
};

}  // namespace pliant
