#include "pliant/analysis/replay.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "pliant/systems/part.h"
#include "pliant/systems/simulator.h"

namespace pliant {

namespace {

using internal::Access;

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

double Seconds(std::int64_t ns) { return static_cast<double>(ns) / 1e9; }

std::string AtTime(std::int64_t ns) { return "t = " + Text(Seconds(ns)) + " s"; }

/// A recorded signal, its value in the part, and how far it has been read.
struct Track {
  const RecordedSignal* signal;
  const internal::Value* value;
  Eigen::Index row = 0;

  Eigen::Index rows() const { return signal->times.size(); }
  std::int64_t time(Eigen::Index k) const { return std::llround(signal->times[k] * 1e9); }  // [ns]

  /// Goes on to time t; whether there is a row.
  bool Reach(std::int64_t t) {
    while (row < rows() && time(row) < t) ++row;
    return row < rows() && time(row) == t;
  }
  std::span<const double> numbers() const {
    return {signal->numbers.col(row).data(), signal->elements.size()};
  }
};

/// Such as "joint velocity [elbow] (rad/s), [wrist] (rad/s)".
std::string Described(const std::string& type, const std::vector<std::string>& elements,
                      const std::vector<std::string>& units) {
  std::string text = type;
  for (std::size_t i = 0; i < elements.size(); ++i)
    text += (i ? ", " : " ") + elements[i] + (units[i].empty() ? "" : " (" + units[i] + ")");
  return text;
}

/// The log is about the same elements as the diagram.
void CheckElements(const RecordedSignal& signal, const internal::Value& value) {
  const auto& declared = Access::Of(value);
  std::vector<std::string> elements, units;
  if (declared.type->write) {
    std::vector<internal::Column> columns;
    declared.type->columns(declared.initial.get(), declared.space, columns);
    for (const internal::Column& column : columns) {
      elements.push_back(column.name);
      units.push_back(column.unit);
    }
  }
  if (elements == signal.elements && units == signal.units) return;
  throw Error("the log and the diagram differ on " + signal.path + "\n  log      " +
              Described(signal.type, signal.elements, signal.units) + "\n  diagram  " +
              Described(declared.type->name, elements, units) +
              "\nreplay with the robot and the settings that were recorded");
}

void CheckTimes(const Track& track) {
  const std::string& path = track.signal->path;
  if (track.rows() == 0) throw Error("the log has no row of " + path);
  if (track.time(0) < 0)
    throw Error("the log begins at " + AtTime(track.time(0)) +
                ", before the start of a run: " + path);
  for (Eigen::Index k = 1; k < track.rows(); ++k)
    if (track.time(k) <= track.time(k - 1))
      throw Error("the rows of " + path + " are not in the order of time: " +
                  AtTime(track.time(k)) + " follows " + AtTime(track.time(k - 1)));
}

std::vector<Track> Tracks(const std::vector<NamedValue>& values, const Recording& recording) {
  std::vector<Track> tracks;
  for (const NamedValue& v : values) {
    const RecordedSignal& signal = recording[v.path];
    CheckElements(signal, *v.value);
    Require(signal.numbers.rows() == static_cast<Eigen::Index>(signal.elements.size()) &&
                signal.numbers.cols() == signal.times.size(),
            "a recorded signal has a number for each element and time: " + signal.path);
    tracks.push_back({&signal, v.value});
    CheckTimes(tracks.back());
  }
  return tracks;
}

/// The ticks of a diagram, one after the other.
class Ticks {
 public:
  explicit Ticks(const Diagram& diagram) : rates_{diagram.plan().rates}, next_(rates_.size(), 0) {}

  /// [ns]
  std::int64_t next() const {
    std::int64_t first = kNever;
    for (std::size_t r = 0; r < rates_.size(); ++r) first = std::min(first, At(r));
    return first;
  }
  void Pass(std::int64_t t) {
    for (std::size_t r = 0; r < rates_.size(); ++r)
      while (At(r) <= t) ++next_[r];
  }

 private:
  std::int64_t At(std::size_t r) const {
    return rates_[r].offset.Times(1) + rates_[r].period.Times(next_[r]);
  }
  const std::vector<internal::Rate>& rates_;
  std::vector<std::int64_t> next_;
};

/// Counts where one element differs.
void Compare(double recorded, double replayed, std::int64_t t, const RecordedSignal& signal,
             std::size_t element, std::optional<SignalDifference>& difference) {
  if (std::bit_cast<std::uint64_t>(recorded) == std::bit_cast<std::uint64_t>(replayed)) return;
  if (!difference)
    difference = SignalDifference{.path = signal.path,
                                  .element = signal.elements[element],
                                  .unit = signal.units[element],
                                  .first_time = Seconds(t),
                                  .recorded = recorded,
                                  .replayed = replayed,
                                  .largest = 0,
                                  .rows = 0};
  const double size = std::abs(replayed - recorded);
  difference->largest = std::isnan(size) ? std::numeric_limits<double>::infinity()
                                         : std::max(difference->largest, size);
  ++difference->rows;
}

class Replayer {
 public:
  Replayer(DiagramBuilder whole, std::string_view name, const Recording& recording)
      : name_{name},
        part_{whole.BuildPart(name, Paths(recording),
                              [this](double t, const AnyValues& values) { See(t, values); })},
        given_{Tracks(part_.given, recording)},
        computed_{Tracks(part_.computed, recording)},
        changed_{Tracks(part_.changed, recording)},
        sim_{part_.diagram},
        ticks_{part_.diagram} {
    if (computed_.empty())
      throw Error("the log has no signal that " + name_ +
                  " computes, so there is nothing to compare\nrecord one of its outputs");
    for (const Track& track : computed_) {
      begins_.push_back(replayed_.size());
      replayed_.resize(replayed_.size() + track.signal->elements.size());
    }
    differences_.resize(replayed_.size());
  }

  ReplayResult Run() {
    const std::vector<std::int64_t> instants = Instants();
    ReplayResult result;
    CheckBegin(instants.front());
    for (const std::int64_t t : instants) {
      CheckMissed(t);
      sim_.AdvanceTo(Seconds(t));
      const Track* missing = SetGiven(t);
      if (missing && ticks_.next() == t) ThrowMissing(*missing, t);
      // Between ticks the numbers are read here; at a tick the watch writes over them, since after
      // it states are new.
      for (std::size_t i = 0; i < computed_.size(); ++i)
        sim_.GetNumbers(*computed_[i].value, Replayed(i));
      sim_.AdvanceTo(Seconds(t + 1));
      ticks_.Pass(t);
      if (missing || !CompareAll(t)) continue;
      if (result.rows++ == 0) result.from = Seconds(t);
      result.to = Seconds(t);
    }
    if (result.rows == 0)
      throw Error("the log has no instant at which both what feeds " + name_ +
                  " and what it computes were recorded\nrecord both with the same period");
    for (const Track& track : computed_) result.compared.push_back(track.signal->path);
    result.along = part_.along;
    result.unknown = part_.unknown;
    for (const auto& difference : differences_)
      if (difference) result.differences.push_back(*difference);
    std::ranges::stable_sort(result.differences, {}, &SignalDifference::first_time);
    return result;
  }

 private:
  static std::vector<std::string> Paths(const Recording& recording) {
    std::vector<std::string> paths;
    for (const RecordedSignal& signal : recording.signals()) paths.push_back(signal.path);
    return paths;
  }

  /// At a tick, before the updates.
  void See(double, const AnyValues& values) {
    for (int i = 0; i < values.size(); ++i) {
      const std::span<double> to = Replayed(static_cast<std::size_t>(i));
      if (!values.type(i).store(values[i], to.data(), to.size()))
        std::ranges::fill(to, std::numeric_limits<double>::quiet_NaN());
    }
  }

  std::span<double> Replayed(std::size_t i) {
    return std::span(replayed_).subspan(begins_[i], computed_[i].signal->elements.size());
  }

  /// All times of rows until one of the inputs ends.
  std::vector<std::int64_t> Instants() const {
    std::int64_t end = kNever;
    for (const Track& track : given_) end = std::min(end, track.time(track.rows() - 1));
    std::vector<std::int64_t> all, more, both;
    for (const auto* tracks : {&given_, &computed_})
      for (const Track& track : *tracks) {
        more.clear();
        for (Eigen::Index k = 0; k < track.rows() && track.time(k) <= end; ++k)
          more.push_back(track.time(k));
        if (more == all) continue;
        both.clear();
        std::ranges::set_union(all, more, std::back_inserter(both));
        all.swap(both);
      }
    return all;
  }

  void CheckBegin(std::int64_t first) const {
    if (ticks_.next() < first)
      throw Error("the log begins at " + AtTime(first) + ", but " + name_ + " ticks from " +
                  AtTime(ticks_.next()) +
                  " on, from its initial state\nreplay a log from the beginning of the run");
  }

  /// No tick lies between two rows.
  void CheckMissed(std::int64_t t) const {
    if (ticks_.next() >= t) return;
    if (!given_.empty()) ThrowMissing(given_.front(), ticks_.next());
  }

  [[noreturn]] void ThrowMissing(const Track& track, std::int64_t t) const {
    throw Error("the log has no row of " + track.signal->path + " at " + AtTime(t) + ", when " +
                name_ + " ticks\nrecord a row at each of its ticks, and drop none");
  }

  /// The first input that has no row at t, or null.
  const Track* SetGiven(std::int64_t t) {
    for (Track& track : changed_)
      for (; track.row < track.rows() && track.time(track.row) <= t; ++track.row)
        sim_.SetNumbers(*track.value, track.numbers());
    const Track* missing = nullptr;
    for (Track& track : given_) {
      if (track.Reach(t))
        sim_.SetNumbers(*track.value, track.numbers());
      else if (!missing)
        missing = &track;
    }
    return missing;
  }

  /// Whether anything was recorded at t.
  bool CompareAll(std::int64_t t) {
    bool any = false;
    for (std::size_t i = 0; i < computed_.size(); ++i) {
      Track& track = computed_[i];
      if (!track.Reach(t)) continue;
      any = true;
      for (std::size_t e = 0; e < track.numbers().size(); ++e)
        Compare(track.numbers()[e], Replayed(i)[e], t, *track.signal, e,
                differences_[begins_[i] + e]);
    }
    return any;
  }

  const std::string name_;
  const Part part_;
  std::vector<Track> given_, computed_, changed_;
  Simulator sim_;
  Ticks ticks_;
  std::vector<double> replayed_;     // what was computed, at the present instant
  std::vector<std::size_t> begins_;  // of each signal in it
  std::vector<std::optional<SignalDifference>> differences_;  // of each number in it
};

/// So that a difference in the last bit is seen.
std::string Exact(double x) {
  std::array<char, 32> text;
  return std::string(text.data(), std::to_chars(text.data(), text.data() + text.size(), x).ptr);
}

/// Characters as one sees them: bytes of UTF-8 that begin one.
std::size_t Width(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string Count(std::size_t n, const std::string& what) {
  return Text(n) + " " + what + (n == 1 ? "" : "s");
}

}  // namespace

std::string ReplayResult::text() const {
  const std::string over =
      " over " + Count(rows, "row") + ", " + Text(from) + " s to " + Text(to) + " s";
  std::string out;
  if (differences.empty()) {
    out = std::string(unknown.empty() ? "identical: " : "identical, but not complete: ") +
          Count(compared.size(), "signal") + over + "\n";
  } else {
    std::vector<std::string> paths;
    for (const SignalDifference& d : differences) paths.push_back(d.path);
    std::ranges::sort(paths);
    const auto differing = std::ranges::unique(paths).begin() - paths.begin();
    out = "different: " + Text(differing) + " of " + Count(compared.size(), "signal") + over + "\n";
    std::vector<std::array<std::string, 6>> table{
        {"signal", "first at (s)", "recorded", "replayed", "largest difference", "rows"}};
    for (const SignalDifference& d : differences)
      table.push_back({d.path + d.element + (d.unit.empty() ? "" : " (" + d.unit + ")"),
                       Text(d.first_time), Exact(d.recorded), Exact(d.replayed), Text(d.largest),
                       Text(d.rows)});
    std::array<std::size_t, 6> widths{};
    for (const auto& row : table)
      for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], Width(row[c]));
    for (const auto& row : table) {
      out += " ";
      for (std::size_t c = 0; c < row.size(); ++c) {
        out += " " + row[c];
        if (c + 1 < row.size()) out += std::string(widths[c] - Width(row[c]) + 1, ' ');
      }
      out += "\n";
    }
  }
  for (const std::string& path : unknown) out += "recorded, but not in the part: " + path + "\n";
  for (const std::string& path : along) out += "not in the log, so computed again: " + path + "\n";
  return out;
}

ReplayResult Replay(DiagramBuilder whole, std::string_view part, const Recording& recording) {
  return Replayer(std::move(whole), part, recording).Run();
}

}  // namespace pliant
