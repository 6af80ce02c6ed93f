#include "pliant/analysis/diagram_files.h"

#include <nlohmann/json.hpp>

#include "pliant/analysis/program.h"

namespace pliant {

namespace {

using Json = nlohmann::ordered_json;

const internal::Program& Graphviz() {
  static const internal::Program dot{
      .name = "dot", .task = "draws diagrams", .package = "graphviz"};
  return dot;
}

void AddRates(const Rates& rates, Json& to) {
  to["rates"] = rates.texts();
  Json periods = Json::array();
  for (const Duration& period : rates.periods) periods.push_back(seconds(period));
  to["periods_s"] = periods;
}

Json BlockJson(const DiagramStructure& diagram, const DiagramStructure::Block& block,
               const std::map<std::string, double>& costs) {
  Json json{{"path", block.path}, {"type", block.type}};
  json["parent"] = nullptr;
  if (block.parent >= 0)
    json["parent"] = diagram.blocks[static_cast<std::size_t>(block.parent)].path;
  json["composite"] = block.composite;
  AddRates(block.rates, json);
  json["continuous_state"] = block.integrates;
  json["discrete_state"] = block.remembers;
  json["free"] = block.free;
  if (const auto cost = costs.find(block.path); cost != costs.end()) json["cost_s"] = cost->second;
  return json;
}

}  // namespace

std::string DiagramJson(const DiagramStructure& diagram, const PictureOptions& options) {
  Json json{{"title", options.title}};
  for (const char* list : {"blocks", "values", "wires"}) json[list] = Json::array();
  for (const DiagramStructure::Block& block : diagram.blocks)
    json["blocks"].push_back(BlockJson(diagram, block, options.costs));
  for (const ValueInfo& value : diagram.values)
    json["values"].push_back({{"path", value.path},
                              {"kind", value.kind},
                              {"type", value.type},
                              {"unit", value.unit},
                              {"space", value.space}});
  for (const DiagramStructure::Wire& wire : diagram.wires) {
    Json of{{"from", wire.output}, {"to", wire.input}, {"type", wire.type}, {"unit", wire.unit}};
    AddRates(wire.rates, of);
    json["wires"].push_back(of);
  }
  return json.dump(1) + "\n";
}

void DrawDiagram(const std::string& graphviz_text, const std::filesystem::path& svg) {
  Graphviz().Draw({.arguments = {"-Tsvg"}, .input = graphviz_text}, svg, "</svg>");
}

void RequireGraphviz() { Graphviz().RequireThatItRuns({.arguments = {"-V"}}); }

}  // namespace pliant
