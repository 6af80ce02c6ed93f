#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "pliant/analysis/contact_limits.h"
#include "pliant/analysis/export.h"
#include "pliant/analysis/mcap_reader.h"
#include "pliant/analysis/mcap_repair.h"
#include "pliant/analysis/printable.h"
#include "pliant/analysis/replay.h"
#include "pliant/analysis/run_data.h"
#include "pliant/apps/commands.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

namespace fs = std::filesystem;

/// What the commands about one log are told.
struct Told {
  fs::path log, to;
  std::string part = "control";
  std::vector<std::string> signals;
  std::string contact, body;
  double area_cm2 = 0, threshold = KeepsContactLimits{}.threshold;
  bool force = false;
};

int ReplayLog(const Told& told) {
  const RunData run = RunData::Read(told.log);
  DiagramBuilder whole = std::move(ScenarioDiagram(run.scenario).builder);
  try {
    const ReplayResult result = Replay(std::move(whole), told.part, run.log);
    std::fputs(result.text().c_str(), stdout);
    return result.identical() ? 0 : 1;
  } catch (const Error& e) {
    throw Error(told.log.string() + ": " + e.what());
  }
}

int Export(const Told& told) {
  const std::string kind = told.to.extension().string();
  if (kind != ".h5" && kind != ".hdf5" && kind != ".csv")
    throw Error(told.to.string() + ": expected a file that ends in .h5, .hdf5 or .csv");
  const Recording recording = Recording::Read(told.log);
  if (kind == ".csv") {
    ExportCsv(recording, told.to, told.signals, told.force);
  } else {
    Require(told.signals.empty(), "--signal picks columns of a .csv; an HDF5 file gets all");
    ExportHdf5(recording, told.to, told.force);
  }
  return 0;
}

/// Reads everything, to hold it against the checksums; empty if nothing is wrong.
std::string FaultOf(const McapReader& log) {
  if (!log.fault().empty()) return log.fault();
  try {
    log.ForEach({}, [](const McapMessage&) {});
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

int Tell(const Told& told) {
  const McapReader log(told.log);
  const std::string fault = FaultOf(log);
  const double from = 1e-9 * static_cast<double>(log.from());
  const double to = 1e-9 * static_cast<double>(log.to());
  std::printf("written by  %s, profile %s\n", Printable(log.library()).c_str(),
              Printable(log.profile()).c_str());
  std::printf("size        %.3f MB, %llu messages from %g s to %g s\n",
              1e-6 * static_cast<double>(log.bytes()),
              static_cast<unsigned long long>(log.messages()), from, to);
  std::printf("whole       %s\n", fault.empty() ? "yes" : ("no: " + fault).c_str());
  for (const auto& [name, words] : log.metadata())
    for (const auto& [key, word] : words)
      if (word.find('\n') == std::string::npos)
        std::printf("%-11s %s: %s\n", Printable(name).c_str(), Printable(key).c_str(),
                    Printable(word).c_str());
  for (const McapChannel& channel : log.channels())
    std::printf("%9llu  %-32s %s\n", static_cast<unsigned long long>(channel.messages),
                Printable(channel.topic).c_str(), Printable(channel.schema_name).c_str());
  return fault.empty() ? 0 : 1;
}

int Repair(const Told& told) {
  const LogRepair repair = RepairLog(told.log, told.to, told.force);
  std::puts(repair.text().c_str());
  return 0;
}

BodyArea BodyAreaOf(const std::string& word) {
  const std::vector<std::string>& words = Words(BodyArea{});
  const auto found = std::ranges::find(words, word);
  if (found != words.end()) return static_cast<BodyArea>(found - words.begin());
  std::string known;
  for (const std::string& other : words) known += (known.empty() ? "" : ", ") + other;
  throw Error("--body: there is no '" + word + "'" + DidYouMean(word, words) +
              "\n  known: " + known);
}

int HoldAgainstLimits(const Told& told) {
  RequireInRange("", "--area-cm2", told.area_cm2, "cm²", kNotNegative);
  RequireInRange("", "--threshold", told.threshold, "N", kPositive);
  const KeepsContactLimits limits{.claim = {},
                                  .run = {},
                                  .contact = told.contact,
                                  .body = BodyAreaOf(told.body),
                                  .area = 1e-4 * told.area_cm2,
                                  .threshold = told.threshold};
  const Recording log = Recording::Read(told.log);
  try {
    const Claim claim = limits.Judge(log[told.contact]);
    std::printf("%s\n%s: %s\nsource: %s\n", claim.measured.c_str(), claim.criterion.c_str(),
                claim.holds ? "yes" : "no", claim.basis.c_str());
    return claim.holds ? 0 : 1;
  } catch (const Error& e) {
    throw Error(told.log.string() + ": " + e.what());
  }
}

}  // namespace

void AddLogCommands(CLI::App& app, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  const auto add = [&](CLI::App& in, const char* name, const char* what, const char* example,
                       int (*act)(const Told&)) {
    CLI::App* command = in.add_subcommand(name, what);
    command->footer(std::string("Example: ") + example);
    command->add_option("log", told->log, "an MCAP file")->required();
    commands.push_back({command, [told, act] { return act(*told); }});
    return command;
  };
  add(app, "replay", "Runs a part of the diagram on a log in the place of the arm, and compares",
      "pliant replay out/logs/stiff.mcap --part control.estimate.observer", ReplayLog)
      ->add_option("--part", told->part, "path of a block")
      ->capture_default_str();

  CLI::App* to = add(app, "export", "Writes the numbers of a log to an HDF5 or CSV file",
                     "pliant export out/logs/stiff.mcap stiff.h5", Export);
  to->add_option("file", told->to, "ends in .h5, .hdf5 or .csv")->required();
  to->add_option("--signal", told->signals, "path of a signal, in a .csv; none: all")
      ->allow_extra_args(false);
  to->add_flag("--force", told->force, "write over a file that is there");

  CLI::App* log = app.add_subcommand("log", "Looks at logs and repairs them");
  log->require_subcommand(1);
  add(*log, "info", "Says what is in a log, and whether it is whole",
      "pliant log info out/logs/stiff.mcap", Tell);
  CLI::App* repair =
      add(*log, "repair", "Makes a whole log of what can be read of a cut or damaged one",
          "pliant log repair cut.mcap whole.mcap", Repair);
  repair->add_option("file", told->to, "the new log")->required();
  repair->add_flag("--force", told->force, "write over a file that is there");
  CLI::App* contacts = add(*log, "contacts", "Holds the forces of a contact against ISO/TS 15066",
                           "pliant log contacts out/logs/stiff.mcap --signal push_1.force --body "
                           "palm_nd --area-cm2 1",
                           HoldAgainstLimits);
  contacts->add_option("--signal", told->contact, "path of a contact or of a wrench")->required();
  contacts->add_option("--body", told->body, "what is touched, such as palm_nd")->required();
  contacts->add_option("--area-cm2", told->area_cm2, "of the contact, for pressures");
  contacts->add_option("--threshold", told->threshold, "below which nothing touches, in N")
      ->capture_default_str();
}

}  // namespace pliant
