#include "pliant/diagrams/fault_order.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"
#include "pliant/systems/parameter.h"

namespace pliant {

namespace {

[[noreturn]] void Refuse(const std::string& text, const std::string& why) {
  throw Error("the fault '" + text + "' " + why);
}

template <class Number>
std::optional<Number> Parsed(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return {};
  return number;
}

}  // namespace

FaultOrder FaultOrder::Of(const std::string& text, const std::vector<Kind>& known) {
  constexpr std::size_t none = std::string::npos;
  std::vector<std::string> names;
  std::string list;
  for (const Kind& kind : known) {
    names.push_back(kind.name);
    list += (list.empty() ? "" : ", ") + kind.name;
  }
  const std::size_t at = text.find('@');
  if (at == none)
    Refuse(text, "does not say when; expected KIND@START+DURATION in seconds, such as '" +
                     (known.empty() ? "lost" : known.front().name) + "@1+0.5'");
  FaultOrder order;
  order.kind = text.substr(0, at);
  const auto kind = std::ranges::find(known, order.kind, &Kind::name);
  if (kind == known.end())
    Refuse(text, "is of no kind that is known" + DidYouMean(order.kind, names) +
                     "; expected one of " + list);

  std::string_view when = std::string_view(text).substr(at + 1);
  if (const std::size_t colon = when.find(':'); colon != none) {
    if (!kind->of_joint) Refuse(text, "has a joint; " + order.kind + " is of none");
    order.joint = Parsed<int>(when.substr(colon + 1));
    if (!order.joint || *order.joint < 1)
      Refuse(text, "has no joint's number behind ':'; expected 1 or more");
    when = when.substr(0, colon);
  } else if (kind->of_joint) {
    Refuse(text,
           "does not say of which joint; expected its number behind ':', such as '" + text + ":4'");
  }
  const std::size_t plus = when.find('+');
  order.start_s = Parsed<double>(when.substr(0, plus)).value_or(-1);
  if (plus != none) order.duration_s = Parsed<double>(when.substr(plus + 1)).value_or(0);
  if (!kNotNegative.Contains(order.start_s))
    Refuse(text, "has no start; expected seconds >= 0 behind '@'");
  if (!kPositive.Contains(order.duration_s))
    Refuse(text, "has no duration; expected seconds > 0 behind '+'");
  return order;
}

bool Shows(const std::vector<FaultOrder>& faults, const std::string& kind, double t) {
  return std::ranges::any_of(
      faults, [&](const FaultOrder& fault) { return fault.kind == kind && fault.At(t); });
}

}  // namespace pliant
