#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/repeated_number.h"

namespace pliant {

enum class OrderDirection { Rising, Falling };

inline const std::vector<std::string>& Words(OrderDirection) {
  static const std::vector<std::string> words{"rising", "falling"};
  return words;
}

/// Of which numbers an order is claimed.
enum class OrderOf { EachRepetition, Medians };

inline const std::vector<std::string>& Words(OrderOf) {
  static const std::vector<std::string> words{"each_repetition", "medians"};
  return words;
}

/// A number rises, or falls, from each of some runs to the next. With x of a run and y of the next:
///
///   rising   y − x > max(margin, margin_part · |x|)
///   falling  x − y > max(margin, margin_part · |x|)
///
/// in every repetition, or of the medians over all repetitions.
struct OrderClaim {
  static constexpr const char* kTag = "Order";
  ClaimSource claim;
  std::string basis;  ///< where the order and its margin come from
  std::vector<std::string> runs = {};
  SignalNumber number = {};
  OrderDirection direction = OrderDirection::Rising;
  OrderOf of = OrderOf::EachRepetition;
  double margin = 0;       ///< in the unit of the number
  double margin_part = 0;  ///< of the former of two numbers

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("runs", runs);
    number.Parameters(f);
    f("direction", direction);
    f("of", of);
    f("margin", margin, "", kNotNegative);
    f("margin_part", margin_part, "", kNotNegative);
  }
  /// Throws Error if there are no two different runs to order, and where the number does.
  void RequireFit(const Scenario& scenario) const;
  void RequireSound(const RecordedSignal& recorded) const { number.RequireSound(recorded); }
  std::vector<RepeatedNumber> Wanted() const { return {{number, runs}}; }
  Claim Judge(const RepeatedNumber& measured) const;
};

}  // namespace pliant
