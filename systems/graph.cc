#include "pliant/systems/diagram.h"

namespace pliant {

namespace {

using internal::Access;

/// Short and unambiguous, whatever the blocks are named.
std::string Id(const Block& block) { return "b" + std::to_string(Access::Number(block)); }

/// The ends of a wire, behind the ports of composites.
struct Edge {
  const Block* from;
  std::string output;
  const Block* to;
  std::string input;
};

void FollowTo(const Block& block, int value, std::vector<std::pair<const Block*, int>>& out) {
  const auto& declared = Access::Values(block)[static_cast<std::size_t>(value)];
  if (declared.from.empty()) {
    out.emplace_back(&block, value);
    return;
  }
  for (const auto& wire : declared.from) FollowTo(*wire.block, wire.value, out);
}

std::vector<Edge> Edges(const internal::Plan& plan) {
  std::vector<Edge> edges;
  for (const Block* block : plan.blocks) {
    if (dynamic_cast<const Composite*>(block)) continue;
    const auto& values = Access::Values(*block);
    for (std::size_t v = 0; v < values.size(); ++v) {
      std::vector<std::pair<const Block*, int>> sources;
      if (!values[v].from.empty()) FollowTo(*block, static_cast<int>(v), sources);
      for (const auto& [source, port] : sources)
        if (!dynamic_cast<const Composite*>(source))  // a default, and no wire
          edges.push_back({source, Access::Values(*source)[static_cast<std::size_t>(port)].name,
                           block, values[v].name});
    }
  }
  return edges;
}

void DrawGraphviz(const Composite& composite, const std::string& indent, std::string& out) {
  for (const auto& part : Access::Parts(composite)) {
    const auto* inner = dynamic_cast<const Composite*>(part.get());
    if (!inner) {
      out += indent + Id(*part) + " [label=\"" + part->name() + "\"];\n";
      continue;
    }
    out += indent + "subgraph cluster_" + Id(*inner) + " {\n" + indent + "  label=\"" +
           inner->name() + "\";\n";
    DrawGraphviz(*inner, indent + "  ", out);
    out += indent + "}\n";
  }
}

void DrawMermaid(const Composite& composite, const std::string& indent, std::string& out) {
  for (const auto& part : Access::Parts(composite)) {
    const auto* inner = dynamic_cast<const Composite*>(part.get());
    if (!inner) {
      out += indent + Id(*part) + "[\"" + part->name() + "\"]\n";
      continue;
    }
    out += indent + "subgraph " + Id(*inner) + "[\"" + inner->name() + "\"]\n";
    DrawMermaid(*inner, indent + "  ", out);
    out += indent + "end\n";
  }
}

}  // namespace

std::string Diagram::Graphviz() const {
  std::string out =
      "digraph diagram {\n  rankdir=LR;\n  node [shape=box, style=rounded, "
      "fontname=\"sans-serif\"];\n"
      "  edge [fontname=\"sans-serif\", fontsize=9];\n";
  DrawGraphviz(*plan_->root, "  ", out);
  for (const Edge& e : Edges(*plan_))
    out += "  " + Id(*e.from) + " -> " + Id(*e.to) + " [taillabel=\"" + e.output +
           "\", headlabel=\"" + e.input + "\"];\n";
  return out + "}\n";
}

std::string Diagram::Mermaid() const {
  std::string out = "flowchart LR\n";
  DrawMermaid(*plan_->root, "  ", out);
  for (const Edge& e : Edges(*plan_))
    out +=
        "  " + Id(*e.from) + " -- \"" + e.output + " → " + e.input + "\" --> " + Id(*e.to) + "\n";
  return out;
}

}  // namespace pliant
