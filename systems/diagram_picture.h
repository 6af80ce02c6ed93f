#pragma once

#include <limits>
#include <map>
#include <string>

#include "pliant/systems/diagram_structure.h"

namespace pliant {

/// What a picture of a diagram shows.
struct PictureOptions {
  std::string title = {};
  /// Composites that deep are one box: of the outermost blocks it is 1.
  int depth = std::numeric_limits<int>::max();
  bool inputs = false;     ///< also those that are not wired
  bool recorders = false;  ///< also recorders and loggers, with all their wires
  /// [s] At a tick, by the path of a block; empty: not measured.
  std::map<std::string, double> costs = {};
};

/// The picture as Graphviz reads it: composites as boxes, from left to right. A bar of a block and
/// the colour of a wire say at which rate they change; several wires from one block to another are
/// one thick edge. What there is no room for is in tooltips.
std::string GraphvizText(const DiagramStructure& diagram, const PictureOptions& options = {});

/// The same for Mermaid, as Markdown shows it.
std::string MermaidText(const DiagramStructure& diagram, const PictureOptions& options = {});

}  // namespace pliant
