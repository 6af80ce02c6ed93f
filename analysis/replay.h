#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/analysis/recording.h"
#include "pliant/systems/diagram.h"

namespace pliant {

/// An element of a signal that was not computed again as it was recorded.
struct SignalDifference {
  std::string path, element, unit;
  double first_time, recorded, replayed;  ///< the first that differs [s], and both numbers there
  double largest;    ///< |replayed − recorded|; ∞ where one is not a number
  std::size_t rows;  ///< that differ
};

/// What came of a replay.
struct ReplayResult {
  std::size_t rows = 0;                            ///< compared
  double from = 0, to = 0;                         ///< [s] first and last of them
  std::vector<std::string> compared;               ///< paths of the recorded signals of the part
  std::vector<std::string> along;                  ///< blocks that were run to feed it
  std::vector<std::string> unknown;                ///< recorded paths that the part does not have
  std::vector<SignalDifference> differences = {};  ///< the first in time first

  bool identical() const { return differences.empty() && unknown.empty(); }

  /// "identical: 42 signals over 6001 rows, 0 s to 6 s", or a table of the differences.
  std::string text() const;
};

/// Runs the block or composite `part` of a diagram on a recorded log in the place of the plant, and
/// compares what it computes with what was recorded, bit for bit:
///
///   const ReplayResult result = Replay(std::move(builder), "control", Recording::Read(file));
///   if (!result.identical()) std::cout << result.text();
///
/// At a tick k the part reads row k of the signals that feed it, as it did when they were recorded:
/// a row of a recorder with a period holds the values of that instant, held outputs new, states
/// before their updates. So an unchanged program gives the same bits. What the log lacks is
/// computed again where the log has what it follows from (`along`); part.h says what can be run.
/// Every recorded signal within the part is compared, at all rows at which its inputs are recorded.
///
/// The log begins no later than the first tick of the part, from whose initial state the replay
/// starts, and has a row at each of its ticks: a replay is exact, or Error.
ReplayResult Replay(DiagramBuilder whole, std::string_view part, const Recording& recording);

}  // namespace pliant
