#include "pliant/analysis/recording.h"

#include <algorithm>
#include <utility>

#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

/// Without a dot or brackets around it.
std::string_view Bare(std::string_view element) {
  if (element.starts_with('.')) return element.substr(1);
  if (element.starts_with('[') && element.ends_with(']') && element.find(']') + 1 == element.size())
    return element.substr(1, element.size() - 2);
  return element;
}

}  // namespace

Eigen::VectorXd RecordedSignal::operator[](std::string_view element) const {
  const auto at = std::ranges::find_if(
      elements, [&](const std::string& e) { return Bare(e) == Bare(element); });
  if (at == elements.end())
    throw Error(path + " has no element '" + std::string(element) + "'" +
                DidYouMean(element, elements));
  return numbers.row(at - elements.begin());
}

Recording::Recording(std::vector<RecordedSignal> signals, Metadata metadata)
    : signals_{std::move(signals)}, metadata_{std::move(metadata)} {}

bool Recording::has(std::string_view path) const {
  return std::ranges::find(signals_, path, &RecordedSignal::path) != signals_.end();
}

const RecordedSignal& Recording::operator[](std::string_view path) const {
  const auto at = std::ranges::find(signals_, path, &RecordedSignal::path);
  if (at != signals_.end()) return *at;
  std::vector<std::string> paths;
  for (const RecordedSignal& signal : signals_) paths.push_back(signal.path);
  throw Error("the recording has no '" + std::string(path) + "'" + DidYouMean(path, paths));
}

}  // namespace pliant
