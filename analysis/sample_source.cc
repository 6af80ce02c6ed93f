#include "pliant/analysis/sample_source.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>

#include "pliant/analysis/csv_rows.h"
#include "pliant/analysis/mcap_reader.h"
#include "pliant/analysis/printable.h"
#include "pliant/analysis/recorded_channel.h"
#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

using namespace internal;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kMostJoints = 64;
constexpr long kMostAdded = 1000;

// In the order in which a row holds them, after the time.
enum Part { kPosition, kVelocity, kAcceleration, kCurrent, kTorque, kParts };
constexpr SampleKind kKinds[] = {SampleKind::Position, SampleKind::Velocity,
                                 SampleKind::Acceleration, SampleKind::Current, SampleKind::Torque};
constexpr const char* kDefaults[] = {"arm.measured_position", "arm.measured_velocity", "",
                                     "arm.measured_current", "arm.measured_torque"};

/// The columns of one file, whatever its kind.
struct Header {
  std::filesystem::path file;
  std::vector<std::string> names, units;
  bool named = true;
  bool has_time = false;  // beside the columns

  std::optional<std::size_t> Find(const std::string& name) const {
    const auto at = std::ranges::find(names, name);
    if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
    if (name.empty() || !std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; }))
      return std::nullopt;
    const std::size_t index = name.size() > 6 ? 0 : std::stoul(name);
    if (index == 0 || index > names.size()) return std::nullopt;
    return index - 1;
  }

  std::string Columns() const {
    constexpr std::size_t kShown = 40;
    std::string all = named ? "\nits columns: "
                            : "\nit names no columns and has " + Text(names.size()) +
                                  ", called 1 to " + Text(names.size());
    if (!named) return all;
    for (std::size_t i = 0; i < names.size() && i < kShown; ++i)
      all += (i == 0 ? "" : ", ") + Printable(names[i]);
    if (names.size() > kShown) all += " and " + Text(names.size() - kShown) + " more";
    return all;
  }

  [[noreturn]] void FailColumn(SampleKind kind, const std::string& name) const {
    throw Error(file.string() + ": there is no column '" + Printable(name) + "' for the " +
                std::string(NameOf(kind)) + (named ? DidYouMean(name, names) : "") + Columns());
  }
};

/// "v{+7}" of joint 2 is "v9".
std::string OfJoint(const std::string& pattern, int joint) {
  const std::size_t open = pattern.find('{'), close = pattern.find('}', open);
  const std::string inside = pattern.substr(open + 1, close - open - 1);
  int number = joint;
  if (!inside.empty()) {
    char* end = nullptr;
    const long more = std::strtol(inside.c_str(), &end, 10);
    if ((inside[0] != '+' && inside[0] != '-') || *end != '\0' || std::abs(more) > kMostAdded)
      throw Error("'" + pattern + "': expected {}, {+N} or {-N} for the number of the joint, N ≤ " +
                  Text(kMostAdded));
    number += static_cast<int>(more);
  }
  return pattern.substr(0, open) + std::to_string(number) + pattern.substr(close + 1);
}

bool IsPattern(const std::string& name) {
  const std::size_t open = name.find('{');
  return open != std::string::npos && name.find('}', open) != std::string::npos;
}

int NumberOf(const std::string& word) {
  const bool digits = !word.empty() && word.size() < 4 &&
                      std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
  return digits ? std::stoi(word) : 0;
}

struct Column {
  std::string joint;
  std::size_t index;
  bool named = true;  // the log or the caller names the joint
};

/// The columns of all joints that have this kind, or of those asked for.
std::vector<Column> ColumnsOf(const Header& header, SampleKind kind,
                              const std::vector<std::string>& names,
                              const std::vector<std::string>& joints) {
  std::vector<Column> columns;
  const auto pick = [&](const std::vector<Column>& all) {
    if (joints.empty()) return all;
    std::vector<Column> picked;
    std::vector<std::string> known;
    for (const Column& c : all) known.push_back(c.joint);
    for (const std::string& joint : joints) {
      auto at = std::ranges::find(all, joint, &Column::joint);
      const int number = NumberOf(joint);
      if (at == all.end() && number >= 1 && number <= std::ssize(all))
        at = all.begin() + number - 1;
      if (at == all.end())
        throw Error(header.file.string() + ": there is no joint '" + Printable(joint) +
                    "' among the columns of the " + std::string(NameOf(kind)) +
                    DidYouMean(joint, known));
      picked.push_back(*at);
    }
    return picked;
  };
  if (names.size() == 1 && IsPattern(names[0])) {
    std::vector<int> numbers;
    for (const std::string& joint : joints) {
      const int number = NumberOf(joint.starts_with("joint_") ? joint.substr(6) : joint);
      if (number == 0)
        throw Error("'" + joint + "' is no number of a joint; the columns '" + names[0] +
                    "' have numbers");
      numbers.push_back(number);
    }
    for (int j = 1; joints.empty() && j <= kMostJoints; ++j) {
      if (!header.Find(OfJoint(names[0], j))) {
        if (j == 1) header.FailColumn(kind, OfJoint(names[0], 1));
        break;
      }
      numbers.push_back(j);
    }
    for (const int number : numbers) {
      const std::string name = OfJoint(names[0], number);
      const std::optional<std::size_t> at = header.Find(name);
      if (!at) header.FailColumn(kind, name);
      columns.push_back({"joint_" + std::to_string(number), *at, false});
    }
    return columns;
  }
  if (names.size() == 1 && !header.Find(names[0])) {
    for (std::size_t i = 0; i < header.names.size(); ++i) {
      const std::string& name = header.names[i];
      if (name.starts_with(names[0] + "[") && name.ends_with(']'))
        columns.push_back({name.substr(names[0].size() + 1, name.size() - names[0].size() - 2), i});
    }
    if (columns.empty()) header.FailColumn(kind, names[0]);
    return pick(columns);
  }
  const bool named = joints.size() == names.size();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::optional<std::size_t> at = header.Find(names[i]);
    if (!at) header.FailColumn(kind, names[i]);
    const bool number = named && NumberOf(joints[i]) > 0;
    columns.push_back({named && !number ? joints[i] : "joint_" + (number ? joints[i] : Text(i + 1)),
                       *at, named && !number});
  }
  return named ? columns : pick(columns);
}

std::string Listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + Printable(name);
  return all;
}

struct Plan {
  std::vector<std::string> joints;
  std::optional<std::size_t> time;
  double time_factor = 1;
  // Of each part the columns in the order of the joints; empty: not there.
  std::vector<std::size_t> columns[kParts];
  std::vector<double> factors[kParts];
  bool derive_velocity = false, derive_acceleration = false;
};

double FactorOf(const Header& header, SampleKind kind, const SampleColumns& given,
                std::size_t column) {
  const std::string& said = header.units[column];
  if (!given.unit.empty()) return UnitFactor(kind, given.unit);
  try {
    return UnitFactor(kind, said);
  } catch (const Error& e) {
    throw Error(header.file.string() + ": column '" + Printable(header.names[column]) +
                "': " + e.what() + "\nsay which unit it is in");
  }
}

Plan PlanOf(const Header& header, const SampleSource& source) {
  const SampleColumns* given[] = {&source.position, &source.velocity, &source.acceleration,
                                  &source.current, &source.torque};
  const bool need[] = {source.need_position, source.need_velocity, source.need_acceleration,
                       source.need_current, source.need_torque};
  Plan plan;
  std::optional<std::string> by;
  std::string named_by;
  std::vector<std::string> named;
  const auto has = [&](const std::string& signal) {
    return !signal.empty() &&
           (header.Find(signal) || std::ranges::any_of(header.names, [&](const std::string& name) {
              return name.starts_with(signal + "[");
            }));
  };
  for (const int part : {kVelocity, kPosition, kAcceleration, kCurrent, kTorque}) {
    std::vector<std::string> names = given[part]->names;
    // A position that nobody asks for is read only to derive what is not there.
    const bool spare =
        part == kPosition && !need[part] && names.empty() && !plan.columns[kVelocity].empty();
    if (names.empty() && has(kDefaults[part]) && !spare && (need[part] || part == kPosition))
      names = {kDefaults[part]};
    if (names.empty()) continue;
    const std::vector<Column> columns = ColumnsOf(header, kKinds[part], names, source.joints);
    std::vector<std::string> joints;
    for (const Column& column : columns) {
      joints.push_back(column.joint);
      plan.columns[part].push_back(column.index);
      plan.factors[part].push_back(FactorOf(header, kKinds[part], *given[part], column.index));
    }
    if (!by) {
      plan.joints = joints;
      by = NameOf(kKinds[part]);
    } else if (joints.size() != plan.joints.size()) {
      throw Error(header.file.string() + ": there must be as many columns of the " +
                  std::string(NameOf(kKinds[part])) + " as of the " + *by + ", got " +
                  Text(joints.size()) + " and " + Text(plan.joints.size()));
    }
    if (!std::ranges::all_of(columns, &Column::named)) continue;
    if (named.empty()) {
      named = joints;
      named_by = NameOf(kKinds[part]);
    } else if (joints != named) {
      throw Error(header.file.string() + ": the columns of the " +
                  std::string(NameOf(kKinds[part])) +
                  " must be of the same joints in the same order as those of the " + named_by +
                  " (" + Listed(named) + "), got (" + Listed(joints) +
                  "); name them in one order with --joints, or say each column");
    }
  }
  const auto missing = [&](int part) {
    const std::string name(NameOf(kKinds[part]));
    throw Error(header.file.string() + ": which column is the " + name + "? Say it with --" + name +
                header.Columns());
  };
  const bool position = !plan.columns[kPosition].empty(),
             velocity = !plan.columns[kVelocity].empty();
  for (const int part : {kPosition, kCurrent, kTorque})
    if (need[part] && plan.columns[part].empty()) missing(part);
  if (need[kVelocity] && !velocity && !position) missing(kVelocity);
  plan.derive_velocity = need[kVelocity] && !velocity;
  plan.derive_acceleration = need[kAcceleration] && plan.columns[kAcceleration].empty();
  if (plan.derive_acceleration && !velocity && !position) missing(kVelocity);
  if (plan.joints.empty()) missing(kVelocity);

  if (header.has_time) return plan;
  if (!source.time.names.empty()) {
    plan.time = header.Find(source.time.names[0]);
    if (!plan.time) header.FailColumn(SampleKind::Time, source.time.names[0]);
  } else if (source.sample_period_s <= 0) {
    for (const char* name : {"time", "t", "Time", "timestamp"})
      if (!plan.time && header.named) plan.time = header.Find(name);
    if (!plan.time)
      throw Error(header.file.string() +
                  ": which column is the time? Say it with --time, or --sample-period if there is "
                  "none" +
                  header.Columns());
  }
  if (plan.time) plan.time_factor = FactorOf(header, SampleKind::Time, source.time, *plan.time);
  return plan;
}

/// Takes rows [time; position; velocity; acceleration; current; torque] of a file, derives what is
/// missing and keeps an even share of them.
class Keeper {
 public:
  explicit Keeper(const SampleSource& source) : source_{source} {}

  void Begin(const Plan& plan, const std::filesystem::path& file) {
    if (!joints_.empty() && plan.joints != joints_)
      throw Error(file.string() + ": its joints must be those of the first log (" +
                  Listed(joints_) + "), got (" + Listed(plan.joints) + ")");
    joints_ = plan.joints;
    plan_ = plan;
    n_ = static_cast<Eigen::Index>(joints_.size());
    file_ = file;
    begin_.push_back(count_);
    rows_in_file_ = 0;
    window_.clear();
    finite_.assign(static_cast<std::size_t>(kParts * n_), false);
  }

  Eigen::Index size() const { return 1 + kParts * n_; }

  /// `place` says where the row is, for messages.
  template <class Place>
  void Take(const Eigen::VectorXd& row, const Place& place) {
    ++result.read;
    ++rows_in_file_;
    for (Eigen::Index i = 1; i < row.size(); ++i)
      if (std::isfinite(row(i))) finite_[static_cast<std::size_t>(i - 1)] = true;
    bool whole = std::isfinite(row(0));
    for (int part = 0; part < kParts; ++part)
      if (!plan_.columns[part].empty()) whole = whole && row.segment(1 + part * n_, n_).allFinite();
    if (!whole) {
      ++result.skipped;
      if (result.first_skipped.empty()) result.first_skipped = place();
      return;
    }
    if (rows_in_file_ > 1 && row(0) < last_time_ && any_)
      throw Error(place() + ": the time goes back, from " + Text(last_time_) + " s to " +
                  Text(row(0)) + " s; sort the rows, or give each run a file of its own");
    last_time_ = row(0);
    any_ = true;
    if (!plan_.derive_velocity && !plan_.derive_acceleration) {
      Keep(row);
      return;
    }
    window_.push_back(row);
    const std::size_t whole_window = 2 * static_cast<std::size_t>(source_.half_window) + 1;
    if (window_.size() > whole_window) window_.erase(window_.begin());
    if (window_.size() == whole_window) Derive();
  }

  void End(const std::string& what) {
    if (rows_in_file_ == 0) throw Error(file_.string() + what);
    for (int part = 0; part < kParts; ++part)
      for (Eigen::Index j = 0; j < n_; ++j)
        if (!plan_.columns[part].empty() && !finite_[static_cast<std::size_t>(part * n_ + j)])
          throw Error(file_.string() + ": no number of the " + std::string(NameOf(kKinds[part])) +
                      " of " + joints_[static_cast<std::size_t>(j)] +
                      " is finite; leave the joint " + "out with --joints, or say another column");
    if (count_ == begin_.back() && (plan_.derive_velocity || plan_.derive_acceleration) &&
        stride_ == 1)
      throw Error(file_.string() + ": a derivative needs " + Text(2 * source_.half_window + 1) +
                  " samples without a gap, got " + Text(rows_in_file_ - result.skipped) +
                  "; make --window smaller, or say the column of the acceleration");
    if (count_ == 0) throw Error(file_.string() + ": no row has all its numbers");
    any_ = false;
  }

  Samples Finish() {
    const auto rows = static_cast<Eigen::Index>(kept_.size()) / size();
    const Eigen::Map<const Eigen::MatrixXd> all(kept_.data(), size(), rows);
    result.joints = joints_;
    result.time = all.row(0);
    result.stride = stride_;
    Eigen::MatrixXd* to[] = {&result.position, &result.velocity, &result.acceleration,
                             &result.current, &result.torque};
    for (int part = 0; part < kParts; ++part) {
      const bool derived = (part == kVelocity && plan_.derive_velocity) ||
                           (part == kAcceleration && plan_.derive_acceleration);
      if (!plan_.columns[part].empty() || derived) *to[part] = all.middleRows(1 + part * n_, n_);
    }
    // A file of which nothing is left has no first column.
    for (const std::int64_t begin : begin_) {
      const auto at = static_cast<Eigen::Index>((begin + stride_ - 1) / stride_);
      if (at < rows && (result.begin.empty() || result.begin.back() != at))
        result.begin.push_back(at);
    }
    result.derived_velocity = plan_.derive_velocity;
    result.derived_acceleration = plan_.derive_acceleration;
    return std::move(result);
  }

  Samples result;

 private:
  /// A slope needs two times, a parabola three.
  [[noreturn]] void FailStamps(double time, Eigen::Index samples,
                               const std::vector<double>& steps) const {
    throw Error(file_.string() + " at " + Text(time) + " s: of " + Text(samples) +
                " samples in a row the stamps show " +
                (steps.empty() ? "one time"
                               : "two times, " + Text(steps[0]) +
                                     " s apart, which is their "
                                     "resolution") +
                ": too coarse for a derivative, which needs three; make --window greater, or say "
                "--sample-period instead of --time");
  }

  void Derive() {
    if (count_ % stride_ != 0) {  // it would not be kept
      ++count_;
      return;
    }
    const auto size = static_cast<Eigen::Index>(window_.size());
    const Eigen::Index middle = size / 2;
    Eigen::VectorXd row = window_[static_cast<std::size_t>(middle)];
    const bool from_position = plan_.derive_velocity || plan_.columns[kVelocity].empty();
    const Eigen::Index from = 1 + (from_position ? kPosition : kVelocity) * n_;
    Eigen::VectorXd s(size);
    Eigen::MatrixXd values(n_, size);
    for (Eigen::Index k = 0; k < size; ++k) {
      const Eigen::VectorXd& of = window_[static_cast<std::size_t>(k)];
      s(k) = of(0) - row(0);
      values.col(k) = of.segment(from, n_);
    }
    // The usual step is the median of those that are none; a gap is a window more than twice as
    // long as its steps say.
    std::vector<double> steps;
    for (Eigen::Index k = 1; k < size; ++k)
      if (s(k) > s(k - 1)) steps.push_back(s(k) - s(k - 1));
    if (steps.size() < 2) FailStamps(row(0), size, steps);
    const std::size_t middle_step = (steps.size() - 1) / 2;
    std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(middle_step));
    const double usual = steps[middle_step], length = s(size - 1) - s(0);
    if (length > 2 * usual * static_cast<double>(steps.size())) return;
    const Eigen::MatrixX3d x = FitParabola(s, values);
    if (from_position) {
      row.segment(1 + kVelocity * n_, n_) = x.col(1);
      if (plan_.derive_acceleration) row.segment(1 + kAcceleration * n_, n_) = x.col(2);
    } else {
      row.segment(1 + kAcceleration * n_, n_) = x.col(1);
    }
    Keep(row);
  }

  void Keep(const Eigen::VectorXd& row) {
    if (count_++ % stride_ != 0) return;
    kept_.insert(kept_.end(), row.data(), row.data() + row.size());
    const auto rows = static_cast<Eigen::Index>(kept_.size()) / size();
    if (rows <= source_.most) return;
    const auto width = static_cast<std::size_t>(size());
    std::size_t to = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(rows); k += 2, ++to)
      std::copy_n(kept_.begin() + static_cast<std::ptrdiff_t>(k * width), width,
                  kept_.begin() + static_cast<std::ptrdiff_t>(to * width));
    kept_.resize(to * width);
    stride_ *= 2;
  }

  const SampleSource& source_;
  Plan plan_;
  std::vector<std::string> joints_;
  std::filesystem::path file_;
  Eigen::Index n_ = 0;
  std::vector<double> kept_;
  std::vector<Eigen::VectorXd> window_;
  std::vector<bool> finite_;
  std::vector<std::int64_t> begin_;
  std::int64_t count_ = 0, stride_ = 1, rows_in_file_ = 0;
  double last_time_ = 0;
  bool any_ = false;
};

void Fill(const Plan& plan, Eigen::Index n, Eigen::VectorXd& row, const auto& number) {
  for (int part = 0; part < kParts; ++part)
    for (std::size_t j = 0; j < plan.columns[part].size(); ++j)
      row(1 + part * n + static_cast<Eigen::Index>(j)) =
          plan.factors[part][j] * number(plan.columns[part][j]);
}

void ReadCsv(const std::filesystem::path& file, const SampleSource& source, Keeper& keeper,
             const std::function<void(double)>& progress) {
  CsvRows rows(file, source.delimiter);
  const Header header{file, rows.names(), rows.units(), rows.named(), false};
  const Plan plan = PlanOf(header, source);
  keeper.Begin(plan, file);
  const auto n = static_cast<Eigen::Index>(plan.joints.size());
  Eigen::VectorXd row = Eigen::VectorXd::Constant(keeper.size(), kNaN);
  for (std::int64_t k = 0; rows.Next(); ++k) {
    row(0) = plan.time ? plan.time_factor * rows.number(*plan.time)
                       : source.sample_period_s * static_cast<double>(k);
    Fill(plan, n, row, [&](std::size_t column) { return rows.number(column); });
    keeper.Take(row, [&] { return file.string() + ":" + Text(rows.line()); });
    if (k % 4096 == 0) progress(static_cast<double>(rows.bytes()));
  }
  keeper.result.cut += rows.cut();
  keeper.End(": there are names of columns and no row below them");
}

void ReadMcap(const std::filesystem::path& file, const SampleSource& source, Keeper& keeper,
              const std::function<void(double)>& progress) {
  const McapReader log(file);
  if (!log.fault().empty()) throw Error(log.fault());
  struct Signal {
    RecordedValue value;
    std::string topic;
    std::size_t begin;  // of its numbers among those of all signals
    bool used = false;
  };
  Header header{file, {}, {}, true, true};
  std::map<std::uint16_t, Signal> signals;
  for (const McapChannel& channel : log.channels()) {
    std::optional<RecordedValue> value = RecordedIn(channel);
    if (!value) continue;
    const std::size_t begin = header.names.size();
    for (std::size_t i = 0; i < value->elements.size(); ++i) {
      header.names.push_back(value->path + value->elements[i]);
      header.units.push_back(value->units[i]);
    }
    signals.emplace(channel.id, Signal{*std::move(value), channel.topic, begin});
  }
  if (signals.empty()) throw Error(HoldsNoRecording(file, log));
  const Plan plan = PlanOf(header, source);
  keeper.Begin(plan, file);
  const auto n = static_cast<Eigen::Index>(plan.joints.size());

  std::vector<std::string> topics;
  std::size_t used = 0;
  for (auto& [id, signal] : signals)
    for (const auto& columns : plan.columns)
      for (const std::size_t column : columns)
        if (!signal.used && column >= signal.begin &&
            column < signal.begin + signal.value.elements.size()) {
          signal.used = true;
          topics.push_back(signal.topic);
          ++used;
        }

  // Rows that wait for the rest of their numbers; signals of one recorder come together.
  constexpr std::size_t kMostWaiting = 256;
  struct Waiting {
    std::vector<double> numbers;
    std::size_t got = 0;
  };
  std::map<std::uint64_t, Waiting> waiting;
  Eigen::VectorXd row = Eigen::VectorXd::Constant(keeper.size(), kNaN);
  std::uint64_t messages = 0;
  log.ForEach({.topics = topics}, [&](const McapMessage& message) {
    const auto at = signals.find(message.channel.id);
    if (at == signals.end() || !at->second.used) return;
    Waiting& one = waiting[message.log_time];
    if (one.numbers.empty()) one.numbers.assign(header.names.size(), kNaN);
    NumbersOf(message, at->second.value.elements.size(), one.numbers.data() + at->second.begin);
    if (++one.got == used) {
      row(0) = 1e-9 * static_cast<double>(message.log_time);
      Fill(plan, n, row, [&](std::size_t column) { return one.numbers[column]; });
      keeper.Take(row, [&] { return file.string() + " at " + Text(row(0)) + " s"; });
      waiting.erase(message.log_time);
    } else if (waiting.size() > kMostWaiting) {
      waiting.erase(waiting.begin());
      ++keeper.result.cut;
    }
    if (++messages % 4096 == 0 && log.messages() > 0)
      progress(static_cast<double>(log.bytes()) * static_cast<double>(messages) /
               static_cast<double>(log.messages()));
  });
  keeper.result.cut += static_cast<std::int64_t>(waiting.size());
  keeper.End(": there is no instant at which all the signals were recorded");
}

}  // namespace

Eigen::MatrixX3d FitParabola(const Eigen::VectorXd& s, const Eigen::MatrixXd& values) {
  // Scaled, so that the normal equations are well conditioned.
  const double scale = std::max(s.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  const Eigen::VectorXd u = s / scale;
  Eigen::MatrixX3d A(s.size(), 3);
  A << Eigen::VectorXd::Ones(s.size()), u, 0.5 * u.cwiseAbs2();
  const Eigen::Matrix3d N = A.transpose() * A;
  const Eigen::Matrix3Xd b = A.transpose() * values.transpose();
  const Eigen::Matrix3Xd x = N.ldlt().solve(b);
  return (Eigen::Vector3d(1, 1 / scale, 1 / (scale * scale)).asDiagonal() * x).transpose();
}

Samples ReadSamples(const SampleSource& source) {
  Require(!source.files.empty(), "there must be a log to read");
  Require(source.most >= 1000, "the number of rows to keep must be ≥ 1000", source.most);
  Require(source.half_window >= 1, "the half window must be ≥ 1", source.half_window);
  double before = 0, total = 0;
  for (const std::filesystem::path& file : source.files) {
    std::error_code none;
    const auto size = std::filesystem::file_size(file, none);
    if (!none) total += static_cast<double>(size);
  }
  Keeper keeper(source);
  for (const std::filesystem::path& file : source.files) {
    const auto progress = [&](double bytes) {
      if (source.progress) source.progress(before + bytes, total);
    };
    if (file.extension() == ".mcap") {
      ReadMcap(file, source, keeper, progress);
    } else {
      ReadCsv(file, source, keeper, progress);
    }
    std::error_code none;
    before += static_cast<double>(std::filesystem::file_size(file, none));
  }
  if (source.progress) source.progress(total, total);
  return keeper.Finish();
}

std::string Samples::text() const {
  std::string all = Text(read) + " rows";
  if (skipped > 0)
    all +=
        ", " + Text(skipped) + " skipped for a number that is none (first " + first_skipped + ")";
  if (cut > 0) all += ", " + Text(cut) + " not whole";
  if (stride > 1) all += ", one in " + Text(stride) + " kept";
  if (derived_velocity) all += ", velocity derived from position";
  if (derived_acceleration) all += ", acceleration derived";
  return all;
}

}  // namespace pliant
