#include "pliant/systems/diagram.h"
#include "pliant/systems/diagram_picture.h"

namespace pliant {

std::string Diagram::Graphviz() const { return GraphvizText(DiagramStructure::Of(*this)); }

std::string Diagram::Mermaid() const { return MermaidText(DiagramStructure::Of(*this)); }

}  // namespace pliant
