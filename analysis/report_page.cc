#include "pliant/analysis/report_page.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "pliant/analysis/figure_style.h"
#include "pliant/analysis/html_page.h"
#include "pliant/analysis/replay_section.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

using internal::Escaped;

std::string In(std::string_view tag, std::string_view content, std::string_view attributes = {}) {
  std::string element = "<" + std::string(tag);
  if (!attributes.empty()) element += " " + std::string(attributes);
  element += ">";
  element += content;
  return element + "</" + std::string(tag) + ">\n";
}

void Replace(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// Takes out all from `begin` to the next `end`.
void Cut(std::string& text, std::string_view begin, std::string_view end) {
  for (std::size_t at = 0; (at = text.find(begin, at)) != std::string::npos;)
    text.erase(at, text.find(end, at) - at + end.size());
}

/// A colour as gnuplot writes it: of lines "rgb(  0, 114, 178)", of text "rgb(0,114,178)".
std::string AsDrawn(const char* format, const internal::Colour& colour) {
  const unsigned long rgb = std::stoul(std::string(colour.light.substr(1)), nullptr, 16);
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), format, rgb >> 16, rgb >> 8 & 255, rgb & 255);
  return text.data();
}

/// What stands between the marks of a tag; text is none of its concern.
void RestyleTag(std::string& tag, const std::string& figure) {
  Replace(tag, " xmlns=\"http://www.w3.org/2000/svg\"", "");
  Replace(tag, " xmlns:xlink=\"http://www.w3.org/1999/xlink\"", "");
  for (const char* attribute : {"color=\"black\"", "color=\"white\""})
    Replace(tag, std::string(" ") + attribute, "");
  for (const char* attribute : {"fill", "stroke"})
    for (const char quote : {'"', '\''})
      Replace(tag, std::string(attribute) + "=" + quote + "black" + quote,
              std::string(attribute) + "=\"currentColor\"");
  for (const internal::Colour& c : internal::kColours)
    for (const char* format : {"rgb(%3lu, %3lu, %3lu)", "rgb(%lu,%lu,%lu)"})
      Replace(tag, AsDrawn(format, c), "var(--" + std::string(c.name) + ")");
  // Several drawings in one page: ids are the figure's own.
  for (const char* id : {"gpDot", "gpPt", "gnuplot_canvas", "textbox", "greybox"})
    Replace(tag, id, figure + "_" + id);
}

/// A drawing in the colours of the page, on its ground.
std::string Inlined(const Figure& figure, std::string svg) {
  svg.erase(0, std::min(svg.find("<svg"), svg.size()));
  Cut(svg, "<title>", "</title>");
  Cut(svg, "<desc>", "</desc>");
  Cut(svg, "<filter", "</filter>");
  Cut(svg, "<rect x=\"0\" y=\"0\"", "/>");  // the white ground
  std::string restyled;
  for (std::size_t at = 0; at < svg.size();) {
    const std::size_t open = std::min(svg.find('<', at), svg.size());
    const std::size_t close = std::min(svg.find('>', open), svg.size());
    restyled.append(svg, at, open - at);
    std::string tag = svg.substr(open, close - open);
    Replace(tag, "\n", " ");
    RestyleTag(tag, figure.name);
    restyled += tag;
    at = close;
    if (at < svg.size()) restyled += svg[at++];
  }
  const std::string label = figure.caption.empty() ? figure.name : figure.caption;
  Replace(restyled, "<svg ", "<svg role=\"img\" aria-label=\"" + Escaped(label) + "\" ");
  return restyled;
}

// ---- parts of the page -----------------------------------------------------------------------

bool IsNumber(std::string_view cell) {
  if (cell == "–") return true;
  if (cell.starts_with("-") || cell.starts_with("−")) cell.remove_prefix(cell[0] == '-' ? 1 : 3);
  return !cell.empty() && cell[0] >= '0' && cell[0] <= '9';
}

std::string TableOf(const Table& table) {
  std::vector<const char*> looks;
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    looks.push_back(
        std::ranges::all_of(table.rows, [&](const auto& row) { return IsNumber(row[c]); })
            ? "class=\"number\""
            : "");
  const auto row_of = [&](const char* tag, const std::vector<std::string>& cells) {
    std::string row;
    for (std::size_t c = 0; c < cells.size(); ++c) row += In(tag, Escaped(cells[c]), looks[c]);
    return In("tr", row);
  };
  std::string rows;
  for (const auto& row : table.rows) rows += row_of("td", row);
  const std::string caption = table.caption.empty() ? "" : In("caption", Escaped(table.caption));
  return In("h2", Escaped(table.title)) +
         In("div",
            In("table", caption + In("thead", row_of("th", table.columns)) + In("tbody", rows)),
            "class=\"wide\"");
}

std::string SettingsOf(const std::vector<Setting>& settings) {
  if (settings.empty()) return "";
  std::string rows;
  for (const Setting& s : settings)
    rows += In("tr", In("th", Escaped(s.name), "scope=\"row\"") + In("td", Escaped(s.value)));
  return In("h2", "What was run") + In("table", In("tbody", rows), "class=\"pairs\"");
}

std::string ClaimsOf(const std::vector<Claim>& claims) {
  if (claims.empty()) return "";
  std::string head;
  for (const char* column : {"claim", "source", "the paper", "measured", "criterion", "holds"})
    head += In("th", column);
  std::string rows;
  for (const Claim& c : claims)
    rows += In(
        "tr", In("th", Escaped(c.id), "scope=\"row\"") + In("td", Escaped(c.source)) +
                  In("td", Escaped(c.paper)) + In("td", Escaped(c.measured)) +
                  In("td", Escaped(c.criterion) + In("span", Escaped(c.basis), "class=\"basis\"")) +
                  In("td", c.holds ? "✓ yes" : "✗ no",
                     c.holds ? "class=\"verdict yes\"" : "class=\"verdict no\""));
  return In("h2", "Verdict") +
         In("div", In("table", In("thead", In("tr", head)) + In("tbody", rows)), "class=\"wide\"");
}

std::string TallyOf(const std::vector<Claim>& claims) {
  if (claims.empty()) return "";
  const auto holding = static_cast<std::size_t>(
      std::ranges::count_if(claims, [](const Claim& c) { return c.holds; }));
  const std::string text =
      claims.size() == 1
          ? (holding ? "the claim holds" : "the claim does not hold")
          : std::to_string(holding) + " of " + std::to_string(claims.size()) + " claims hold";
  return In("div", text, holding == claims.size() ? "class=\"tally yes\"" : "class=\"tally no\"");
}

std::string FiguresOf(const std::vector<Figure>& figures,
                      const std::vector<std::string>& drawings) {
  if (figures.empty()) return "";
  std::string all = In("h2", "Figures");
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::string caption =
        In("b", "Figure " + std::to_string(i + 1) + ".") + Escaped(figures[i].caption);
    all += In("figure", Inlined(figures[i], drawings[i]) + In("figcaption", caption));
  }
  return all;
}

Table TimingTable(const Timing& t) {
  return {
      "Timing",
      {"simulated", "wall", "real-time factor", "ticks", "integrator steps", "derivative calls"},
      {{WithUnit(t.simulated_s, "s"), WithUnit(t.wall_s, "s"),
        WithUnit(t.simulated_s / t.wall_s, ""), std::to_string(t.ticks),
        std::to_string(t.integrator_steps), std::to_string(t.derivative_calls)}}};
}

/// The scenario as it was run, to unfold.
std::string ScenarioOf(const Runs& runs) {
  if (runs.all().empty()) return "";
  return In("details", In("summary", "The scenario, with everything that was left out filled in") +
                           In("pre", Escaped(runs.all().front()->experiment)));
}

}  // namespace

std::string internal::ReportPage(const Report& report, const std::vector<std::string>& drawings,
                                 const Runs& runs) {
  std::string before = In("h1", Escaped(report.title)) + TallyOf(report.claims) +
                       In("p", Escaped(report.summary)) + SettingsOf(report.settings) +
                       ScenarioOf(runs) + ClaimsOf(report.claims);
  for (const Table& table : report.results) before += TableOf(table);
  std::string behind = FiguresOf(report.figures, drawings);
  for (const Table& table : report.tables) behind += TableOf(table);
  if (report.timing) behind += TableOf(TimingTable(*report.timing));

  constexpr std::size_t kPage = 4'900'000, kScript = 800'000, kLeast = 500'000;
  const std::size_t used = before.size() + behind.size() + kScript;
  const ReplaySection replay =
      ReplaySectionOf(runs.all(), used + kLeast < kPage ? kPage - used : kLeast);
  return HtmlPage(report.title, before + replay.middle + behind + replay.end);
}

}  // namespace pliant
