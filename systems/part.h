#pragma once

#include <string>
#include <vector>

#include "pliant/systems/diagram.h"

namespace pliant {

/// A value under the path it goes by in a log.
struct NamedValue {
  std::string path;
  const internal::Value* value;
};

/// A sampled part of a diagram by itself: what feeds it from outside is set by hand.
///
///   from a log ─▶ given ─▶ [ along ─▶ ] part ─▶ computed ─▶ compare with the log
///
/// All values keep their paths: in the place of an output that is given stands a free value of the
/// same path. What feeds the part and is not known is computed again by the block that computed it,
/// from what feeds that block, until all is known. Where that leads to a value that changes between
/// ticks, an integral or what a guard watches, the part cannot be run and Error says what to
/// record. Recorders and loggers within the part record as ever.
struct Part {
  Diagram diagram;
  std::vector<NamedValue> given;     ///< to set before each tick
  std::vector<NamedValue> computed;  ///< known values within the part that follow from its rules
  std::vector<NamedValue> changed;   ///< known inputs within the part that have their default
  std::vector<std::string> along;    ///< blocks outside of the part that run along
  std::vector<std::string> unknown;  ///< known paths within the part that it does not have
};

}  // namespace pliant
