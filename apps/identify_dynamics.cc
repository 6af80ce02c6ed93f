#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pliant/analysis/dynamics_identification.h"
#include "pliant/analysis/dynamics_report.h"
#include "pliant/analysis/sample_source.h"
#include "pliant/apps/commands.h"
#include "pliant/apps/new_report.h"
#include "pliant/apps/sample_column_options.h"
#include "pliant/apps/says_something.h"
#include "pliant/diagrams/scenario.h"

namespace pliant {

namespace {

namespace fs = std::filesystem;

struct Told {
  SampleSource source;
  std::vector<fs::path> validation;
  std::string robot;
  fs::path urdf, out, report;
  DynamicsOptions options;
  std::vector<std::string> without;  // joint terms
  bool force = false;
};

fs::path ChosenUrdf(const Told& told) {
  Require(told.robot.empty() != told.urdf.empty(),
          "expected the robot of the log: either --robot or --urdf");
  return told.urdf.empty() ? UrdfOf(told.robot) : told.urdf;
}

/// A log with names of joints has those of the robot; where it has none they are numbered.
void RequireJointsOf(const RobotModel& model, const Samples& samples, const std::string& log) {
  for (int j = 0; j < model.size(); ++j) {
    const std::string& found = samples.joints[static_cast<std::size_t>(j)];
    const std::string& expected = model.joint(j).name;
    if (found != expected && found != "joint_" + std::to_string(j + 1))
      throw Error(log + ": expected joint '" + expected + "' of robot \"" + model.name() +
                  "\", found '" + found +
                  "'; give the robot of the log, or with --joints those "
                  "joints of the log that are the robot's, in its order");
  }
}

/// The columns of the log for the joints of the robot, in its order, unless --joints names some.
Samples Read(const Told& told, const std::vector<fs::path>& files, const RobotModel& model) {
  SampleSource source = told.source;
  source.files = files;
  Samples samples = ReadSamples(source);
  if (static_cast<int>(samples.joints.size()) != model.size())
    throw Error(files.front().string() + ": expected " + Text(model.size()) +
                " joints, those of robot \"" + model.name() + "\", found " +
                Text(samples.joints.size()) + "; name them with --joints, in the robot's order");
  if (source.joints.empty()) RequireJointsOf(model, samples, files.front().string());
  return samples;
}

int Identify(Told told) {
  for (const std::string& term : told.without) {
    JointTerms& terms = told.options.terms;
    (term == "coulomb" ? terms.coulomb : term == "viscous" ? terms.viscous : terms.offset) = false;
  }
  if (!told.out.empty()) RequireIdentifiedFile(told.out, !told.options.payload.empty(), told.force);
  RequireNewReport(told.report, told.force);
  const fs::path urdf = ChosenUrdf(told);
  const RobotModel model = RobotModel::FromUrdf(urdf);
  const Samples samples = Read(told, told.source.files, model);
  std::optional<Samples> validation;
  if (!told.validation.empty()) validation = Read(told, told.validation, model);
  const DynamicsResult result =
      IdentifyDynamics(model, samples, told.options, validation ? &*validation : nullptr);
  std::printf("%s\n%s", samples.text().c_str(), TextOf(result).c_str());
  try {
    if (!told.out.empty()) WriteIdentified(result, urdf, told.out);
    if (!told.report.empty()) {
      fs::create_directories(told.report);
      WriteReport(ReportOf(result), told.report);
    }
  } catch (const fs::filesystem_error& e) {
    throw CannotGoOn("cannot make the directory " + told.report.string() + ": " +
                     e.code().message());
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
  return 0;
}

}  // namespace

void AddIdentifyDynamics(CLI::App& app, std::vector<Command>& commands) {
  const std::vector<CLI::App*> there =
      app.get_subcommands([](CLI::App* c) { return c->get_name() == "identify"; });
  CLI::App* identify =
      there.empty() ? app.add_subcommand("identify", "Identifies parameters of an arm from logs")
                    : there.front();
  identify->require_subcommand(1);
  CLI::App* command = identify->add_subcommand(
      "dynamics",
      "Finds masses, centres and inertia of links, or of a payload, from joint torques");
  command->footer(
      "Example: pliant identify dynamics tool.csv --robot gen3 --payload tool_frame --time t "
      "--position 'q{}' --velocity 'v{}' --torque 'tau{}' --out tool.yaml\n"
      "A column is a name, a number from 1, or for all joints a name with {} for the number of\n"
      "the joint. Logs of pliant need no columns.");
  const auto told = std::make_shared<Told>();
  told->source.need_position = true;
  told->source.need_acceleration = told->source.need_current = false;
  command->add_option("logs", told->source.files, "MCAP files of pliant, or CSV files")->required();
  command->add_option("--robot", told->robot, "gen3, gen3_bota or lwr");
  command->add_option("--urdf", told->urdf, "instead: a URDF file");
  command->add_option("--payload", told->options.payload, "link of a body to be found");
  command->add_option("--links", told->options.links, "to be found; none: all that move")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--validate", told->validation, "logs to hold the result against")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--out", told->out, "a .yaml for a payload, or a .urdf")
      ->check(SaysSomething());
  command->add_option("--report", told->report, "folder of a page with tables and a figure")
      ->check(SaysSomething());
  command->add_flag("--force", told->force, "write over files that are there");
  AddColumns(*command, told->source.time, "time", "column of the time", "ms");
  AddColumns(*command, told->source.position, "position", "columns of the joint position", "deg");
  AddColumns(*command, told->source.velocity, "velocity", "columns; none: derived", "deg/s");
  AddColumns(*command, told->source.torque, "torque", "columns of the measured joint torque",
             "mNm");
  command
      ->add_option("--joints", told->source.joints,
                   "names or numbers, in the robot's order; none: all")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--sample-period", told->source.sample_period_s,
                   "seconds from row to row, if there is no time")
      ->check(CLI::PositiveNumber);
  command->add_option("--window", told->options.smoothing.window_s, "of the smoothing [s]")
      ->check(CLI::Range(1e-4, 1e3))
      ->capture_default_str();
  command->add_option("--step", told->options.smoothing.step_s, "between the points fitted [s]")
      ->check(CLI::Range(1e-4, 1e3))
      ->capture_default_str();
  command->add_option("--without", told->without, "joint terms that are left out")
      ->check(CLI::IsMember({"coulomb", "viscous", "offset"}))
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_flag("--rotor", told->options.terms.rotor, "fit the inertia of rotors along");
  command->add_flag("--robust", told->options.robust, "Huber's weights, for logs with contacts");
  command
      ->add_option("--prior-deviation", told->options.prior_deviation,
                   "of the model's figures: 1 is a factor of about e = 2.7")
      ->check(CLI::Range(1e-6, 1e6))
      ->capture_default_str();
  commands.push_back({command, [told] { return Identify(*told); }});
}

}  // namespace pliant
