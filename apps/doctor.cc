#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pliant/analysis/diagram_files.h"
#include "pliant/analysis/figure.h"
#include "pliant/apps/arm_check.h"
#include "pliant/apps/arm_options.h"
#include "pliant/apps/commands.h"
#include "pliant/apps/doctor_checks.h"
#include "pliant/apps/machine_facts.h"
#include "pliant/apps/says_something.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

using namespace std::chrono_literals;

struct Told {
  ArmOptions arm;
  std::filesystem::path out = ".";
};

/// The first line of an error.
std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

Finding TryProgram(const std::string& name, const std::string& package, void (*require)()) {
  try {
    require();
    return CheckProgram(name, package, "");
  } catch (const Error& e) {
    return CheckProgram(name, package, FirstLine(e.what()));
  }
}

Finding Shared(const std::string& name, const std::string& file) {
  try {
    return CheckShared({name, SharedFile(file).string(), ""});
  } catch (const Error& e) {
    return CheckShared({name, "", FirstLine(e.what())});
  }
}

int Examine(const Told& told) {
  std::optional<Gen3Address> address;
  if (!told.arm.arm.empty()) {
    address = told.arm.address();
    address->answer_limit = 2s;  // of one that starts or is another machine's port
  }
  std::vector<Finding> findings{TryProgram("gnuplot", "gnuplot-nox", RequireGnuplot),
                                TryProgram("dot", "graphviz", RequireGraphviz),
                                Shared("models", "models/gen3/gen3_7dof.urdf"),
                                Shared("experiments", "experiments"),
                                Shared("page of a report", "web/dist/replay.js"),
                                CheckOutput(OutputAt(told.out))};
  for (Finding& finding : CheckRealTime(RealTimeOfThisMachine(), address.has_value()))
    findings.push_back(std::move(finding));
  for (Finding& finding : CheckArm(address ? std::optional(TryArm(*address)) : std::nullopt))
    findings.push_back(std::move(finding));
  for (const Finding& finding : findings) std::puts(finding.text().c_str());
  return std::ranges::count(findings, Verdict::Missing, &Finding::verdict) > 0 ? 1 : 0;
}

}  // namespace

void AddDoctor(CLI::App& app, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  CLI::App* doctor =
      app.add_subcommand("doctor", "Says what is missing on this machine, and how to mend it");
  doctor->footer(
      "Example: pliant doctor --arm 192.168.1.10\n"
      "A line each: ok, missing (needed) or note. Exits with 1 if something is missing.");
  told->arm.AddTo(*doctor,
                  "ADDRESS[:PORT] of the arm that is to be run; what it needs is then needed");
  doctor->add_option("--out", told->out, "folder where logs and reports are to go")
      ->check(SaysSomething())
      ->capture_default_str();
  commands.push_back({doctor, [told] { return Examine(*told); }});
}

}  // namespace pliant
