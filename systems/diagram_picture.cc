#include "pliant/systems/diagram_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/systems/time_text.h"

namespace pliant {

namespace {

using Block = DiagramStructure::Block;
using Wire = DiagramStructure::Wire;

/// Told apart by people who see colours in other ways too.
/// Source: Okabe & Ito, Color Universal Design, 2008.
constexpr const char* kContinuousColor = "#0072B2";
constexpr std::array<const char*, 5> kPeriodColors{"#009E73", "#D55E00", "#CC79A7", "#56B4E9",
                                                   "#8C6D1F"};
constexpr const char* kEventColor = "#5A3E9B";
constexpr const char* kConstantColor = "#9A9A9A";
constexpr const char* kBoxColor = "#F2F4F6";    // of composites; inside them white, and so on
constexpr const char* kQuietColor = "#5F5F5F";  // of text that is not a name

constexpr std::size_t kLongestType = 30;   // letters of a type that a block has room for
constexpr std::size_t kMostLabelled = 50;  // edges with labels, in a picture that can be read
constexpr std::size_t kMostLines = 4;      // of a label

std::string Id(int block) { return "b" + std::to_string(block + 1); }

std::string Cut(const std::string& text) {
  return text.size() <= kLongestType ? text : text.substr(0, kLongestType - 1) + "…";
}

std::string Joined(const std::vector<std::string>& texts, std::string_view between) {
  std::string out;
  for (const std::string& text : texts) (out.empty() ? out : out.append(between)) += text;
  return out;
}

std::string RatesText(const Rates& rates) {
  const std::vector<std::string> texts = rates.texts();
  return texts.empty() ? "constant" : Joined(texts, ", ");
}

std::string StatesText(const Block& block) {
  return std::string(block.integrates ? " ∫" : "") + (block.remembers ? " z⁻¹" : "");
}

std::string SignalText(const Wire& wire) {
  return wire.unit.empty() ? wire.type : wire.type + " [" + wire.unit + "]";
}

/// Wires from one shown block to another.
struct Edge {
  int from, to;
  std::vector<const Wire*> wires;
  Rates rates;

  /// What is on the wires, each output once: its quantity or, where it has no unit, its name. As
  /// many as there is room for.
  std::vector<std::string> label() const {
    std::set<std::string> outputs;
    std::vector<std::pair<std::string, int>> signals;  // and how many have that text
    for (const Wire* wire : wires) {
      if (!outputs.insert(wire->output).second) continue;
      const std::string text =
          wire->unit.empty() ? wire->output.substr(wire->output.rfind('.') + 1) : SignalText(*wire);
      const auto same = std::ranges::find(signals, text, &std::pair<std::string, int>::first);
      if (same == signals.end())
        signals.emplace_back(text, 1);
      else
        ++same->second;
    }
    std::vector<std::string> lines;
    for (const auto& [text, count] : signals)
      lines.push_back(text + (count > 1 ? " ×" + std::to_string(count) : ""));
    const std::size_t all = lines.size();
    if (all <= kMostLines) return lines;
    lines.resize(kMostLines - 1);
    lines.push_back("and " + std::to_string(all - lines.size()) + " more");
    return lines;
  }

  bool thick() const { return wires.size() > 1; }

  std::string tooltip() const {
    std::string text;
    for (const Wire* wire : wires)
      text += (text.empty() ? "" : "\n") + wire->output + " → " + wire->input + ": " +
              SignalText(*wire) + ", " + RatesText(wire->rates);
    return text;
  }
};

/// What of a diagram a picture shows, and how.
class View {
 public:
  View(const DiagramStructure& diagram, const PictureOptions& options)
      : diagram_{diagram}, options_{options}, parts_(diagram.blocks.size() + 1) {
    const std::size_t n = diagram.blocks.size();
    std::vector<int> level(n), shown(n);
    std::vector<bool> visible(n);
    cost_.resize(n);
    hidden_.resize(n);
    expanded_.resize(n);
    for (std::size_t i = n; i-- > 0;) {
      const Block& block = diagram.blocks[i];
      if (const auto cost = options.costs.find(block.path); cost != options.costs.end())
        cost_[i] += cost->second;
      if (block.parent >= 0) cost_[static_cast<std::size_t>(block.parent)] += cost_[i];
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Block& block = diagram.blocks[i];
      const auto above = static_cast<std::size_t>(block.parent);
      const bool outermost = block.parent < 0;
      level[i] = outermost ? 1 : level[above] + 1;
      expanded_[i] = block.composite && level[i] < options.depth;
      visible[i] = outermost || (visible[above] && expanded_[above]);
      shown[i] = visible[i] ? static_cast<int>(i) : shown[above];
      hidden_[i] = !options.recorders && block.records;
    }
    FindEdges(shown);
    for (std::size_t i = 0; i < n; ++i)
      if (visible[i] && !hidden_[i] && (options.recorders || !IsIdle(i))) Show(i);
  }

  const DiagramStructure& diagram() const { return diagram_; }
  const PictureOptions& options() const { return options_; }
  const Block& operator[](int block) const {
    return diagram_.blocks[static_cast<std::size_t>(block)];
  }
  /// Shown parts of a composite; −1: the outermost blocks.
  const std::vector<int>& parts(int block) const {
    return parts_[static_cast<std::size_t>(block + 1)];
  }
  bool expanded(int block) const { return expanded_[static_cast<std::size_t>(block)]; }
  const std::vector<Edge>& edges() const { return edges_; }
  bool has_wires(int block) const {
    return std::ranges::any_of(
        edges_, [block](const Edge& edge) { return edge.from == block || edge.to == block; });
  }

  /// Of blocks that a composite is made of, at any depth, without composites.
  int size(int composite) const {
    int size = 0;
    for (std::size_t i = static_cast<std::size_t>(composite) + 1; i < diagram_.blocks.size(); ++i) {
      int above = diagram_.blocks[i].parent;
      while (above > composite) above = (*this)[above].parent;
      size += above == composite && !diagram_.blocks[i].composite;
    }
    return size;
  }

  /// Of all blocks that are shown.
  const Rates& rates() const { return rates_; }
  /// Whether something that is shown never changes.
  bool constant() const { return constant_; }
  bool measured() const { return !options_.costs.empty(); }
  double cost(int block) const { return cost_[static_cast<std::size_t>(block)]; }
  double total_cost() const {
    double total = 0;
    for (const auto& [block, cost] : options_.costs) total += cost;
    return total;
  }
  /// From 0 to 1, the dearest block that is shown.
  double heat(int block) const { return most_ > 0 ? cost(block) / most_ : 0; }

  std::vector<std::string> colors(const Rates& rates) const {
    std::vector<std::string> colors;
    if (rates.continuous) colors.emplace_back(kContinuousColor);
    for (const Duration& period : rates.periods) {
      const auto place = std::ranges::find(rates_.periods, period) - rates_.periods.begin();
      colors.emplace_back(kPeriodColors[static_cast<std::size_t>(place) % kPeriodColors.size()]);
    }
    if (rates.events || rates.steps) colors.emplace_back(kEventColor);
    if (colors.empty()) colors.emplace_back(kConstantColor);
    return colors;
  }

  std::string tooltip(int of) const {
    const Block& block = (*this)[of];
    std::string text = block.path + "\n" + block.type + "\n" + RatesText(block.rates);
    if (measured()) text += "\n" + TimeText(cost(of)) + " a tick";
    for (const std::string& input : block.free) text += "\nnot wired: " + input;
    return text;
  }

 private:
  /// It says what never changes, to recorders at most.
  bool IsIdle(std::size_t block) const {
    return diagram_.blocks[block].rates == Rates{} && !diagram_.blocks[block].composite &&
           !has_wires(static_cast<int>(block)) &&
           std::ranges::any_of(diagram_.blocks, &Block::records);
  }

  void Show(std::size_t place) {
    const Block& block = diagram_.blocks[place];
    parts_[static_cast<std::size_t>(block.parent + 1)].push_back(static_cast<int>(place));
    rates_ |= block.rates;
    if (expanded_[place]) return;
    most_ = std::max(most_, cost_[place]);
    constant_ = constant_ || block.rates == Rates{};
  }

  void FindEdges(const std::vector<int>& shown) {
    std::map<std::pair<int, int>, std::size_t> places;
    for (const Wire& wire : diagram_.wires) {
      if (hidden_[static_cast<std::size_t>(wire.from)] ||
          hidden_[static_cast<std::size_t>(wire.to)])
        continue;
      const int from = shown[static_cast<std::size_t>(wire.from)];
      const int to = shown[static_cast<std::size_t>(wire.to)];
      const bool inside = from == to && (*this)[from].composite && !expanded(from);
      if (inside) continue;
      const auto [place, is_new] = places.try_emplace({from, to}, edges_.size());
      if (is_new) edges_.push_back({from, to, {}, {}});
      edges_[place->second].wires.push_back(&wire);
      edges_[place->second].rates |= wire.rates;
    }
  }

  const DiagramStructure& diagram_;
  const PictureOptions& options_;
  std::vector<std::vector<int>> parts_;
  std::vector<bool> expanded_, hidden_;
  std::vector<double> cost_;
  double most_ = 0;
  bool constant_ = false;
  Rates rates_;
  std::vector<Edge> edges_;
};

// ------------------------------------------------------------------------------------- Graphviz

/// As HTML, which Graphviz' labels are, or as a string in quotes.
std::string Html(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string Quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    c == '\n' ? out += "\\n" : out += c;
  }
  return out + '"';
}

/// From white to a warm yellow.
std::string HeatColor(double heat) {
  const auto mix = [heat](int to) {
    return static_cast<int>(std::lround(255 + heat * (to - 255)));
  };
  std::array<char, 8> text;
  std::snprintf(text.data(), text.size(), "#%02X%02X%02X", mix(0xFF), mix(0xB0), mix(0x3A));
  return text.data();
}

std::string Small(const std::string& html) {
  return std::string("<font point-size=\"8\" color=\"") + kQuietColor + "\">" + html + "</font>";
}

class GraphvizWriter {
 public:
  explicit GraphvizWriter(const View& view) : view_{view} {}

  std::string Write() {
    out_ =
        "digraph diagram {\n"
        "  graph [rankdir=LR, bgcolor=white, pad=0.3, nodesep=0.18, ranksep=0.5,\n"
        "         fontname=\"Helvetica,Arial,sans-serif\", fontsize=10, labelloc=b, labeljust=l];\n"
        "  node [shape=plain, fontname=\"Helvetica,Arial,sans-serif\", fontsize=10];\n"
        "  edge [fontname=\"Helvetica,Arial,sans-serif\", fontsize=8, fontcolor=\"" +
        std::string(kQuietColor) + "\", arrowsize=0.6];\n";
    Parts(-1, "  ");
    for (const Edge& edge : view_.edges()) Write(edge);
    Legend();
    return out_ + "}\n";
  }

 private:
  void Parts(int composite, const std::string& indent) {
    for (const int part : view_.parts(composite)) {
      if (!view_.expanded(part)) {
        Node(part, indent);
        continue;
      }
      out_ += indent + "subgraph cluster_" + Id(part) + " {\n" + indent +
              "  label=" + Quoted(view_[part].name) + "; tooltip=" + Quoted(view_.tooltip(part)) +
              "; labelloc=t; fontsize=12;\n" + indent +
              "  style=\"rounded,filled\"; color=\"#B8B8B8\"; fillcolor=" +
              (indent.size() % 4 == 2 ? "\"" + std::string(kBoxColor) + "\"" : "white") + ";\n";
      if (view_.has_wires(part)) out_ += indent + "  " + Id(part) + " [label=\"its own rules\"];\n";
      Parts(part, indent + "  ");
      out_ += indent + "}\n";
    }
  }

  void Node(int of, const std::string& indent) {
    const Block& block = view_[of];
    std::vector<std::string> rows{"<b>" + Html(block.name) + "</b>"};
    if (block.composite)
      rows.back() += Small("&#160; of " + std::to_string(view_.size(of)) + " blocks");
    rows.push_back(Small(Html(Cut(block.type))));
    std::string when = Html(RatesText(block.rates)) + StatesText(block);
    if (view_.measured()) when += " · <b>" + TimeText(view_.cost(of)) + "</b>";
    rows.push_back(Small(when));
    if (view_.options().inputs)
      for (const std::string& input : block.free)
        rows.push_back(Small("<i>" + input.substr(block.path.size() + 1) + ": not wired</i>"));
    out_ += indent + Id(of) + " [tooltip=" + Quoted(view_.tooltip(of)) +
            ", label=<<table border=\"1\" color=\"#6E6E6E\" cellborder=\"0\" cellspacing=\"0\" "
            "cellpadding=\"2\" bgcolor=\"" +
            (block.composite && !view_.measured() ? kBoxColor : HeatColor(view_.heat(of))) +
            "\"><tr>";
    for (const std::string& color : view_.colors(block.rates))
      out_ += "<td width=\"5\" rowspan=\"" + std::to_string(rows.size()) + "\" bgcolor=\"" + color +
              "\"></td>";
    for (std::size_t r = 0; r < rows.size(); ++r)
      out_ += (r == 0 ? "" : "<tr>") + std::string("<td align=\"left\">") + rows[r] + "</td></tr>";
    out_ += "</table>>];\n";
  }

  void Write(const Edge& edge) {
    out_ += "  " + Id(edge.from) + " -> " + Id(edge.to) + " [color=\"" +
            view_.colors(edge.rates).front() + "\"";
    const std::string tooltip = Quoted(edge.tooltip());
    if (edge.thick()) out_ += ", penwidth=2.4";
    if (view_.edges().size() <= kMostLabelled)
      out_ += ", label=" + Quoted(Joined(edge.label(), "\n")) + ", labeltooltip=" + tooltip;
    out_ += ", tooltip=" + tooltip + "];\n";
  }

  void Legend() {
    const auto entry = [](const std::string& color, const std::string& text) {
      return "<td width=\"14\" bgcolor=\"" + color + "\"></td><td>" + Html(text) + "&nbsp;</td>";
    };
    std::string entries;
    const Rates& rates = view_.rates();
    if (rates.continuous) entries += entry(kContinuousColor, "continuous");
    for (const Duration& period : rates.periods) {
      const Rates one{.periods = {period}};
      entries += entry(view_.colors(one).front(), one.texts().front());
    }
    if (rates.events || rates.steps) entries += entry(kEventColor, "at events");
    if (view_.constant()) entries += entry(kConstantColor, "constant");
    entries += "<td>∫ continuous state&nbsp;</td><td>z⁻¹ discrete state&nbsp;</td>";
    entries += "<td>thick: several signals&nbsp;</td>";
    if (view_.measured())
      entries += entry(HeatColor(1), "cost at a tick, the dearest block; all blocks: " +
                                         TimeText(view_.total_cost()));
    out_ += "  label=<<table border=\"0\" cellborder=\"0\" cellspacing=\"3\" cellpadding=\"2\">";
    if (!view_.options().title.empty())
      out_ += "<tr><td align=\"left\" colspan=\"30\"><font point-size=\"14\">" +
              Html(view_.options().title) + "</font></td></tr>";
    out_ += "<tr>" + entries + "</tr></table>>;\n";
  }

  const View& view_;
  std::string out_;
};

// -------------------------------------------------------------------------------------- Mermaid

/// What would end a label, and what its Markdown would take for its own.
std::string Entities(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("\"#<>&;`\\*_[]{}|").find(c) == std::string_view::npos)
      out += c;
    else
      out += "#" + std::to_string(static_cast<int>(c)) + ";";
  }
  return out;
}

class MermaidWriter {
 public:
  explicit MermaidWriter(const View& view) : view_{view} {}

  std::string Write() {
    out_ = "flowchart LR\n";
    Parts(-1, "  ");
    for (const Edge& edge : view_.edges()) {
      std::vector<std::string> lines = edge.label();
      for (std::string& line : lines) line = Entities(line);
      out_ += "  " + Id(edge.from) + (edge.thick() ? " == \"" : " -- \"") + Joined(lines, "<br/>") +
              (edge.thick() ? "\" ==> " : "\" --> ") + Id(edge.to) + "\n";
    }
    for (const auto& [color, blocks] : of_color_)
      out_ += "  style " + blocks + " stroke:" + color + ",stroke-width:2px\n";
    return out_;
  }

 private:
  void Parts(int composite, const std::string& indent) {
    for (const int part : view_.parts(composite)) {
      const Block& block = view_[part];
      if (!view_.expanded(part)) {
        out_ += indent + Id(part) + "[\"" + Entities(block.name) + "<br/><small>" +
                Entities(Cut(block.type)) + "<br/>" +
                Entities(RatesText(block.rates) + StatesText(block)) +
                (view_.measured() ? " · " + TimeText(view_.cost(part)) : "") + "</small>\"]\n";
        std::string& blocks = of_color_[view_.colors(block.rates).front()];
        blocks += (blocks.empty() ? "" : ",") + Id(part);
        continue;
      }
      out_ += indent + "subgraph " + Id(part) + "[\"" + Entities(block.name) + "\"]\n";
      Parts(part, indent + "  ");
      out_ += indent + "end\n";
    }
  }

  const View& view_;
  std::string out_;
  std::map<std::string, std::string> of_color_;
};

}  // namespace

std::string GraphvizText(const DiagramStructure& diagram, const PictureOptions& options) {
  const View view(diagram, options);
  return GraphvizWriter(view).Write();
}

std::string MermaidText(const DiagramStructure& diagram, const PictureOptions& options) {
  const View view(diagram, options);
  return MermaidWriter(view).Write();
}

}  // namespace pliant
