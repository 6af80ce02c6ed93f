#include "pliant/analysis/run_sweep.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "pliant/analysis/run_experiment.h"
#include "pliant/analysis/sweep_part.h"
#include "pliant/analysis/write_file.h"

namespace pliant {

namespace {

class SweepRunner {
 public:
  SweepRunner(const Sweep& sweep, const SweepOptions& options)
      : sweep_{sweep}, options_{options}, is_there_(sweep.runs()) {}

  SweepResults Run() {
    Require(options_.jobs >= 1, "jobs must be >= 1", options_.jobs);
    if (!options_.out.empty()) ReadParts();
    for (std::uint64_t run = 0; run < sweep_.runs(); ++run) missing_ += IsMissing(run);
    {
      std::vector<std::jthread> threads;
      const auto count =
          std::min<std::uint64_t>(static_cast<std::uint64_t>(options_.jobs), missing_);
      try {
        for (std::uint64_t i = 1; i < count; ++i) threads.emplace_back([this] { Work(); });
      } catch (const std::system_error&) {
        // Fewer at a time, where the system gives no more threads.
      }
      Work();
    }
    if (failure_) std::rethrow_exception(failure_);
    SweepResults results{.sweep = sweep_};
    AddRows(results, std::move(rows_));
    return results;
  }

 private:
  void ReadParts() {
    internal::MakeDirectory(options_.out);
    const std::filesystem::path file =
        options_.out / ("part-" + std::to_string(options_.shard.number) + "-of-" +
                        std::to_string(options_.shard.of));
    // Of others what they have by now; before anything is written beside them.
    for (const std::filesystem::path& other : SweepPartsIn(options_.out)) {
      if (other == file) continue;
      const SweepPartContent content = SweepPartContent::Read(other);
      if (content.whole == 0) continue;
      RequireSameSweep(sweep_, other, content.text);
      // The end of a part that is being written may lack a piece of a row.
      if (!IsBeingWritten(other))
        for (const std::string& line : content.damaged) Say(other.string() + ": " + line);
      for (const SweepRow& row : content.rows) Add(row, other);
    }
    part_.emplace(file, sweep_);
    for (const std::string& line : part_->damage()) Say(line);
    for (const SweepRow& row : part_->rows()) Add(row, file);
  }

  void Add(const SweepRow& row, const std::filesystem::path& file) {
    sweep_.RequireOwn(row, file.string());
    is_there_[row.run] = true;
    rows_.emplace_back(row, file.string());
  }

  void Say(const std::string& line) const {
    if (options_.say) options_.say(line);
  }
  bool IsMissing(std::uint64_t run) const { return options_.shard.has(run) && !is_there_[run]; }
  bool Stopped() const { return failed_ || (options_.stop && *options_.stop); }

  void Work() {
    while (!Stopped()) {
      const std::uint64_t run = next_++;
      if (run >= sweep_.runs()) return;
      if (!IsMissing(run)) continue;
      try {
        std::optional<SweepRow> row = sweep_.Make(run, options_.stop);
        if (!row) return;
        const std::lock_guard lock(mutex_);
        Keep(*row);
        failures_ += !row->failed.empty();
        rows_.emplace_back(*std::move(row), "this process");
        if (options_.progress)
          options_.progress(
              ++made_, missing_, failures_,
              std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count());
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
        failed_ = true;
      }
    }
  }

  void Keep(const SweepRow& row) try {
    if (part_) part_->Append(row);
  } catch (const Error& e) {
    throw FailedRun(e.what());
  }

  const Sweep& sweep_;
  const SweepOptions& options_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::optional<SweepPart> part_;
  std::vector<bool> is_there_;  // when the runs begin
  std::uint64_t missing_ = 0;
  std::atomic<std::uint64_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::vector<std::pair<SweepRow, std::string>> rows_;
  std::uint64_t made_ = 0, failures_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

SweepResults RunSweep(const Sweep& sweep, const SweepOptions& o) {
  return SweepRunner(sweep, o).Run();
}

}  // namespace pliant
