#include "pliant/analysis/mcap_log.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "pliant/analysis/log_file.h"
#include "pliant/analysis/mcap_writer.h"
#include "pliant/analysis/ros_log.h"
#include "pliant/analysis/row_ring.h"
#include "pliant/analysis/without_signals.h"
#include "pliant/systems/error.h"
#include "pliant/systems/time.h"

namespace pliant {
namespace {

using internal::LogFile;
using internal::McapWriter;
using internal::RosLog;
using internal::RowRing;
using internal::WithoutSignals;
using WallClock = std::chrono::steady_clock;

constexpr std::size_t kChunkBytes = 1 << 20;  // before compression: some milliseconds of work
constexpr auto kOldestChunk = 500ms;          // wall time: a killed process loses no more than 1 s
constexpr auto kBetweenLooks = 5ms;           // of the thread that writes, into an empty ring
constexpr auto kBetweenTries = 100us;         // of a simulation, to find room in a full ring

}  // namespace

struct McapLog::Writer {
  explicit Writer(const Options& o)
      : full{o.full},
        ring_cells{o.ring_bytes / sizeof(double)},
        ring{ring_cells},
        file{o.file, o.force},
        mcap{[this](std::string_view bytes) { file.Write(bytes); }, "ros2",
             "pliant " PLIANT_VERSION},
        messages{{.robot = o.robot,
                  .robot_description = o.robot_description,
                  .position = o.position,
                  .velocity = o.velocity,
                  .torque = o.torque}} {
    for (const auto& [name, words] : o.metadata) mcap.AddMetadata(name, words);
    mcap.Flush();
    bytes = file.size();
    BeginThread();
    file.Begun();
  }

  /// Signals of the process are for the other threads, and a file that may not grow is an error
  /// here and not the end of the run.
  void BeginThread() {
    const WithoutSignals in_thread;
    try {
      thread = std::jthread([this](const std::stop_token& stop) { Run(stop); });
    } catch (const std::system_error& e) {
      throw Error("cannot write " + file.path().string() +
                  ": the thread that writes cannot begin: " + e.what());
    }
  }

  // Of the thread that records.

  std::span<double> Begin(int stream, std::int64_t time_ns) {
    const std::size_t n = widths[static_cast<std::size_t>(stream)];
    if (n == 0) return {};
    // MCAP has no times before 0.
    while (time_ns >= 0 && !closed && !failed.load(std::memory_order_relaxed)) {
      const std::span<double> row = ring.Begin(stream, time_ns, without_room, n);
      if (!row.empty()) return row;
      if (full == Full::Drop) {
        ++without_room;
        last_without_room_ns = time_ns;
        break;
      }
      std::this_thread::sleep_for(kBetweenTries);
    }
    dropped.fetch_add(1, std::memory_order_relaxed);
    return {};
  }

  // Of the thread that writes.

  void Run(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any stopped;
    for (;;) {
      const bool last = stop.stop_requested();  // what was recorded before is in the ring
      while (const std::optional<RowRing::Row> row = ring.Front()) {
        if (failed) ++dropped;
        Try([&] { Write(*row); });
        ring.Pop();
      }
      if (last) break;
      if (rows_in_chunk > 0 && WallClock::now() - chunk_begun >= kOldestChunk)
        Try([this] { WriteChunk(); });
      std::unique_lock lock(mutex);
      stopped.wait_for(lock, stop, kBetweenLooks, [] { return false; });
    }
    Try([this] { Finish(); });
  }

  void Write(const RowRing::Row& row) {
    if (rows_in_chunk++ == 0) chunk_begun = WallClock::now();
    if (row.dropped > without_room_written) {
      messages.WriteDropped(mcap, row.time_ns, row.dropped);
      without_room_written = row.dropped;
    }
    messages.Write(mcap, row.stream, row.time_ns, row.numbers);
    if (mcap.chunk_bytes() >= kChunkBytes) WriteChunk();
  }

  void WriteChunk() {
    mcap.WriteChunk();
    rows += std::exchange(rows_in_chunk, 0);
    bytes = file.size();
  }

  void Finish() {
    if (without_room > without_room_written)
      messages.WriteDropped(mcap, last_without_room_ns, without_room);
    WriteChunk();
    for (const auto& [name, words] : at_end) mcap.AddMetadata(name, words);
    mcap.AddMetadata("pliant.statistics", {{"dropped", Text(dropped)}, {"rows", Text(rows)}});
    mcap.Finish();
    bytes = file.size();
    file.Close();
  }

  /// Once writing has failed, the file stays as it is.
  template <class Act>
  void Try(const Act& act) {
    if (failed) return;
    try {
      act();
    } catch (const std::exception& e) {
      dropped += std::exchange(rows_in_chunk, 0);
      const std::lock_guard lock(reason_mutex);
      reason = e.what();
      failed = true;
    }
  }

  std::string Reason() const {
    const std::lock_guard lock(reason_mutex);
    return reason;
  }

  const Full full;
  const std::size_t ring_cells;
  RowRing ring;
  LogFile file;
  McapWriter mcap;
  RosLog messages;
  std::atomic<std::int64_t> rows{0}, dropped{0}, bytes{0};
  std::atomic<bool> failed{false};
  mutable std::mutex reason_mutex;
  std::string reason;

  // Of the thread that records; the other reads them once it has ended.
  std::vector<std::size_t> widths;  // of the streams, in numbers
  std::int64_t without_room = 0, last_without_room_ns = 0;
  bool closed = false;
  std::map<std::string, std::map<std::string, std::string>> at_end;

  // Of the thread that writes.
  std::int64_t rows_in_chunk = 0, without_room_written = 0;
  WallClock::time_point chunk_begun;

  std::jthread thread;  // the last: it uses the others
};

McapLog::McapLog(Options o) : writer_{std::make_unique<Writer>(o)} {}

McapLog::~McapLog() {
  try {
    Close();
  } catch (const std::exception&) {
    // Who wants to know calls Close.
  }
}

int McapLog::Open(std::vector<RecordedValue> values) {
  std::size_t n = 0;
  for (const RecordedValue& value : values) n += value.elements.size();
  const std::size_t least = sizeof(double) * RowRing::CellsFor(n);
  Require(least <= sizeof(double) * writer_->ring_cells,
          "ring_bytes must be >= " + Text(least) + ", twice a row of " + Text(n) + " numbers",
          sizeof(double) * writer_->ring_cells);
  const int stream = writer_->messages.Open(std::move(values));
  writer_->widths.push_back(n);
  return stream;
}

std::span<double> McapLog::Begin(int stream, std::int64_t time_ns) noexcept {
  return writer_->Begin(stream, time_ns);
}

void McapLog::Commit() noexcept { writer_->ring.Commit(); }

void McapLog::AddMetadata(const std::string& name,
                          const std::map<std::string, std::string>& words) {
  writer_->at_end[name] = words;
}

void McapLog::Close() {
  writer_->closed = true;
  if (!writer_->thread.joinable()) return;
  writer_->thread.request_stop();
  writer_->thread.join();
  const Statistics s = statistics();
  if (!s.error.empty())
    throw Error(s.error + "\n" + Text(s.dropped) + " of " + Text(s.rows + s.dropped) +
                " rows are missing; those before them can be read");
  if (const std::string missing = writer_->messages.Missing(); !missing.empty())
    throw Error(writer_->file.path().string() + ": " + missing);
}

McapLog::Statistics McapLog::statistics() const {
  return {writer_->rows, writer_->dropped, writer_->bytes, writer_->Reason()};
}

}  // namespace pliant
