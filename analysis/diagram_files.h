#pragma once

#include <filesystem>
#include <string>

#include "pliant/systems/diagram_picture.h"

namespace pliant {

/// A diagram as JSON: all its blocks, values and wires; docs/graph.md says what is in it. Of the
/// options only title and costs matter.
std::string DiagramJson(const DiagramStructure& diagram, const PictureOptions& options = {});

/// Draws GraphvizText to an SVG file, by Graphviz' program `dot`. Throws Error if it is not there;
/// an older file is left as it was.
void DrawDiagram(const std::string& graphviz_text, const std::filesystem::path& svg);

/// Throws Error unless DrawDiagram will find Graphviz.
void RequireGraphviz();

}  // namespace pliant
