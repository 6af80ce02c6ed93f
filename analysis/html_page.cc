#include "pliant/analysis/html_page.h"

#include "pliant/analysis/figure_style.h"

namespace pliant::internal {

namespace {

constexpr std::string_view kSheet = R"(
body { margin: 0 auto; max-width: 62rem; padding: 2rem 1.5rem 4rem; color: var(--ink);
  background: var(--paper); font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.15rem; margin: 2.5rem 0 .6rem; }
p { margin: .5rem 0; max-width: 48rem; }
.tally { display: inline-block; padding: .1rem .7rem; border-radius: 1rem; font-weight: 600;
  margin: 0 0 .6rem; }
.yes { color: var(--yes); background: var(--yes-paper); }
.no { color: var(--no); background: var(--no-paper); }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; width: 100%; }
th, td { padding: .4rem .7rem; text-align: left; vertical-align: top;
  border-bottom: 1px solid var(--grid); }
th { color: var(--grey); font-weight: 600; }
tbody th { color: var(--ink); white-space: nowrap; }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.pairs { width: auto; }
.basis, figcaption, caption { color: var(--grey); font-size: .85rem; }
caption { caption-side: bottom; text-align: left; padding: .4rem .7rem; }
td .basis { display: block; }
details { margin: .8rem 0; }
summary { cursor: pointer; color: var(--grey); font-size: .9rem; }
pre { overflow: auto; max-height: 28rem; font-size: .8rem; padding: .8rem; border: 1px solid var(--grid); }
td.verdict { font-weight: 600; text-align: center; white-space: nowrap; }
figure { margin: 1.2rem 0 2rem; break-inside: avoid; }
figure svg { display: block; width: 100%; height: auto; }
figcaption { max-width: 48rem; margin-top: .3rem; }
tr { break-inside: avoid; }
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; }
  .wide { overflow: visible; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)";

constexpr std::string_view kLight =
    "--paper: #fff; --yes: #00664b; --yes-paper: #dff3ec; --no: #a33a00; --no-paper: #fde8dc;";
constexpr std::string_view kDark =
    "--paper: #16191d; --yes: #5fe0b8; --yes-paper: #123a2f; --no: #ffb083; --no-paper: #4a2412;";

std::string Variables(bool dark) {
  std::string all{dark ? kDark : kLight};
  for (const Colour& c : kColours)
    all += " --" + std::string(c.name) + ": " + std::string(dark ? c.dark : c.light) + ";";
  return all;
}

std::string Sheet() {
  return ":root { color-scheme: light dark; " + Variables(false) + " }\n" +
         "@media screen and (prefers-color-scheme: dark) { :root { " + Variables(true) + " } }" +
         std::string(kSheet);
}

}  // namespace

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string HtmlPage(std::string_view title, std::string_view body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         Escaped(title) + "</title>\n<style>" + Sheet() + "</style>\n</head>\n<body>" +
         std::string(body) + "</body>\n</html>\n";
}

}  // namespace pliant::internal
