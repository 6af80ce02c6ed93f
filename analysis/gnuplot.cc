#include "pliant/analysis/gnuplot.h"

#include "pliant/analysis/figure.h"
#include "pliant/analysis/program.h"

namespace pliant {

namespace {

const internal::Program& Gnuplot() {
  static const internal::Program gnuplot{
      .name = "gnuplot", .task = "draws the figures of a report", .package = "gnuplot-nox"};
  return gnuplot;
}

}  // namespace

void internal::RunGnuplot(const std::filesystem::path& directory,
                          const std::vector<std::string>& arguments,
                          const std::filesystem::path& drawing, std::string_view end) {
  std::vector<std::string> all{"-d"};  // without anyone's start-up file
  all.insert(all.end(), arguments.begin(), arguments.end());
  Gnuplot().Draw({.directory = directory, .arguments = all}, drawing, end);
}

void RequireGnuplot() { Gnuplot().RequireThatItRuns({.arguments = {"-d", "-e", "exit"}}); }

}  // namespace pliant
