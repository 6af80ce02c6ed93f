#include "pliant/analysis/recording.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <new>
#include <numeric>
#include <optional>
#include <utility>

#include "pliant/analysis/cdr.h"
#include "pliant/analysis/mcap_bytes.h"
#include "pliant/analysis/mcap_format.h"
#include "pliant/analysis/mcap_reader.h"
#include "pliant/analysis/recorded_channel.h"
#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

using internal::Cdr;
using internal::HoldsNoRecording;
using internal::NumbersOf;
using internal::RecordedIn;

namespace {

/// The message is in the encoding in which we write.
bool IsCdr(const McapMessage& message) {
  return internal::TextOf(message.data).starts_with(Cdr::kHead);
}

/// "[elbow]" and "elbow" are "elbow"; ".force[x]" and "force[x]" are "force.x".
std::string Plain(std::string_view element) {
  std::string plain;
  for (const char c : element)
    if (c == '[' || c == '.') {
      if (!plain.empty()) plain += '.';
    } else if (c != ']') {
      plain += c;
    }
  return plain;
}

std::string Described(const RecordedValue& value) {
  std::string text = value.type + " of";
  for (std::size_t i = 0; i < value.elements.size(); ++i)
    text += ' ' + value.elements[i] + " (" + value.units[i] + ')';
  return Printable(text);
}

/// The rows of a signal as they come.
struct Rows {
  RecordedValue value;
  std::vector<std::uint64_t> times;  // [ns]
  std::vector<double> numbers;

  void Add(const McapMessage& message) {
    const std::size_t count = value.elements.size();
    numbers.resize(numbers.size() + count);
    NumbersOf(message, count, numbers.data() + numbers.size() - count);
    times.push_back(message.log_time);
  }

  RecordedSignal Sorted() const {
    std::vector<std::size_t> order(times.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (!std::ranges::is_sorted(times))
      std::ranges::stable_sort(order, {}, [&](std::size_t i) { return times[i]; });
    const auto rows = static_cast<Eigen::Index>(order.size());
    const auto count = static_cast<Eigen::Index>(value.elements.size());
    RecordedSignal signal{value, Eigen::VectorXd(rows), Eigen::MatrixXd(count, rows)};
    for (Eigen::Index k = 0; k < rows; ++k) {
      const std::size_t row = order[static_cast<std::size_t>(k)];
      signal.times(k) = static_cast<double>(times[row]) / 1e9;
      signal.numbers.col(k) =
          Eigen::VectorXd::Map(numbers.data() + row * value.elements.size(), count);
    }
    return signal;
  }
};

/// The text of a std_msgs/msg/String; empty if it is none.
std::string StringOf(const McapMessage& message) {
  std::span data = message.data;
  std::uint32_t size = 0;
  const std::size_t head = Cdr::kHead.size() + sizeof size;
  if (data.size() < head || !IsCdr(message)) return {};
  std::memcpy(&size, data.data() + Cdr::kHead.size(), sizeof size);
  data = data.subspan(head);
  if (size == 0 || size > data.size()) return {};
  return {reinterpret_cast<const char*>(data.data()), size - 1};  // without its 0
}

Recording ReadLog(const std::filesystem::path& file) {
  const McapReader log(file);
  if (!log.fault().empty()) throw Error(log.fault());

  std::vector<Rows> signals;
  std::map<std::uint16_t, std::size_t> of_channel;
  for (const McapChannel& channel : log.channels()) {
    std::optional<RecordedValue> value = RecordedIn(channel);
    if (!value) continue;
    const auto is_it = [&](const Rows& rows) { return rows.value.path == value->path; };
    const auto known = std::ranges::find_if(signals, is_it);
    if (known != signals.end() && known->value != *value)
      throw Error(Printable(value->path) + " changes within the log\n  from  " +
                  Described(known->value) + "\n  to    " + Described(*value));
    of_channel[channel.id] = static_cast<std::size_t>(known - signals.begin());
    if (known == signals.end()) signals.push_back({*std::move(value), {}, {}});
  }
  if (signals.empty()) throw Error(HoldsNoRecording(file, log));

  std::string robot_description;
  log.ForEach({}, [&](const McapMessage& message) {
    if (const auto signal = of_channel.find(message.channel.id); signal != of_channel.end()) {
      signals[signal->second].Add(message);
    } else if (message.channel.topic == "/robot_description") {
      robot_description = StringOf(message);
    }
  });

  std::vector<RecordedSignal> sorted;
  for (Rows& rows : signals) {
    sorted.push_back(rows.Sorted());
    rows = {};
  }
  return {std::move(sorted), log.metadata(), std::move(robot_description)};
}

}  // namespace

Eigen::Index RecordedSignal::row(std::string_view element) const {
  auto at = std::ranges::find(elements, element);
  if (at == elements.end())
    at = std::ranges::find(elements, Plain(element), [](const auto& e) { return Plain(e); });
  if (at == elements.end())
    throw Error(path + " has no element '" + std::string(element) + "'" +
                DidYouMean(element, elements));
  return at - elements.begin();
}

Recording::Recording(std::vector<RecordedSignal> signals, Metadata metadata,
                     std::string robot_description)
    : signals_{std::move(signals)},
      metadata_{std::move(metadata)},
      robot_description_{std::move(robot_description)} {}

Recording Recording::Read(const std::filesystem::path& file) {
  try {
    return ReadLog(file);
  } catch (const std::bad_alloc&) {
    throw Error(file.string() + ": the recording does not fit into the memory");
  } catch (const Error& error) {
    // What is wrong with a channel or a message does not know its file.
    const std::string text = error.what();
    throw text.find(file.string()) == std::string::npos ? Error(file.string() + ": " + text)
                                                        : error;
  }
}

bool Recording::has(std::string_view path) const {
  return std::ranges::find(signals_, path, &RecordedSignal::path) != signals_.end();
}

const RecordedSignal& Recording::operator[](std::string_view path) const {
  const auto at = std::ranges::find(signals_, path, &RecordedSignal::path);
  if (at != signals_.end()) return *at;
  std::vector<std::string> paths;
  for (const RecordedSignal& signal : signals_) paths.push_back(signal.path);
  throw Error("the recording has no signal '" + std::string(path) + "'" + DidYouMean(path, paths));
}

}  // namespace pliant
