#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/analysis/friction_report.h"
#include "pliant/analysis/friction_run.h"
#include "pliant/analysis/sample_source.h"
#include "pliant/apps/commands.h"
#include "pliant/apps/new_report.h"
#include "pliant/apps/sample_column_options.h"
#include "pliant/apps/says_something.h"
#include "pliant/plants/robot_model.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

namespace fs = std::filesystem;

struct Told {
  SampleSource source;
  std::vector<std::string> logs;
  std::string robot, model = "auto", loss = "cauchy", directions = "both", delimiter;
  std::vector<double> torque_per_ampere, reflected_inertia;
  double least_velocity = 0;
  bool pool = false, no_offset = false, force = false;
  fs::path out, report;
};

/// Before a long read.
void RequireDrives(const Told& told) {
  for (const double kappa : told.torque_per_ampere)
    Require(std::isfinite(kappa) && kappa > 0,
            "--torque-per-ampere must be > 0 N·m/A; where the current has the other sign, give "
            "--current-unit=-A",
            kappa);
  for (const double inertia : told.reflected_inertia)
    Require(std::isfinite(inertia) && inertia >= 0, "--reflected-inertia must be ≥ 0 kg·m²",
            inertia);
}

/// Of each joint of the samples.
std::vector<DriveFigures> DrivesOf(const Told& told, const std::vector<std::string>& joints) {
  std::vector<DriveFigures> drives;
  if (!told.robot.empty()) {
    Require(
        told.torque_per_ampere.empty() && told.reflected_inertia.empty(),
        "--robot says what --torque-per-ampere and --reflected-inertia would: give one of them");
    const bool gen3 = told.robot == "gen3";
    const Joints of =
        RobotModel::FromUrdf(ModelFile(gen3 ? "gen3/gen3_7dof.urdf" : "lwr/lwr4p.urdf")).joints();
    const ArmActuators arm = ArmActuators::Read(ModelFile(told.robot + "/actuators.yaml"), of);
    std::vector<std::string> known;
    for (int j = 0; j < of.size(); ++j) known.push_back(of[j]);
    for (const std::string& joint : joints) {
      auto at = std::ranges::find(known, joint);
      for (int j = 0; at == known.end() && j < of.size(); ++j)
        if (joint == "joint_" + std::to_string(j + 1)) at = known.begin() + j;
      if (at == known.end())
        throw Error("the robot '" + told.robot + "' has no joint '" + joint + "'" +
                    DidYouMean(joint, known));
      const ActuatorParameters& p = arm.joint[static_cast<std::size_t>(at - known.begin())];
      drives.push_back({p.torque_per_ampere(), p.reflected_inertia()});
    }
    return drives;
  }
  Require(!told.torque_per_ampere.empty(),
          "what torque does a current make? Give --robot gen3, or --torque-per-ampere and "
          "--reflected-inertia");
  const auto each = [&](const std::vector<double>& all, const char* name, std::size_t j) {
    if (all.empty()) return 0.0;
    if (all.size() == 1) return all[0];
    Require(all.size() == joints.size(),
            std::string(name) + " wants one number, or one for each of the " + Text(joints.size()) +
                " joints",
            all.size());
    return all[j];
  };
  for (std::size_t j = 0; j < joints.size(); ++j)
    drives.push_back({each(told.torque_per_ampere, "--torque-per-ampere", j),
                      each(told.reflected_inertia, "--reflected-inertia", j)});
  return drives;
}

template <class E>
E ValueOf(const std::string& word) {
  const std::vector<std::string>& words = Words(E{});
  return static_cast<E>(std::ranges::find(words, word) - words.begin());
}

FrictionResult Fit(const Told& told, FrictionLog log) {
  std::optional<FrictionModel> model;
  if (told.model != "auto") model = ValueOf<FrictionModel>(told.model);
  return Identified(std::move(log), model,
                    {.loss = ValueOf<FrictionLoss>(told.loss),
                     .separate = told.directions == "separate",
                     .offset = !told.no_offset && told.directions == "both",
                     .least_velocity = told.least_velocity});
}

/// Joints with the same drive as one.
std::vector<FrictionResult> Pool(const Told& told, const std::vector<FrictionResult>& results,
                                 const std::vector<DriveFigures>& drives,
                                 std::vector<std::vector<std::string>>& joints) {
  std::vector<FrictionResult> pooled;
  std::vector<DriveFigures> sizes;
  for (const DriveFigures& drive : drives)
    if (std::ranges::find(sizes, drive) == sizes.end()) sizes.push_back(drive);
  for (const DriveFigures& size : sizes) {
    std::vector<FrictionSamples> samples;
    std::vector<FrictionFit> fits;
    FrictionLog one;
    joints.emplace_back();
    for (std::size_t j = 0; j < results.size(); ++j) {
      if (drives[j] != size) continue;
      samples.push_back(results[j].log.samples);
      fits.push_back(results[j].fit);
      joints.back().push_back(results[j].log.joint);
      one.joint += (one.joint.empty() ? "" : ", ") + results[j].log.joint;
      one.transient += results[j].log.transient;
      one.steps += results[j].log.steps;
      for (const std::string& doubt : results[j].log.doubts)
        one.doubts.push_back(results[j].log.joint + ": " + doubt);
    }
    one.samples = Pooled(samples, fits);
    pooled.push_back(Fit(told, std::move(one)));
  }
  return pooled;
}

/// How much of the logs is read, on a terminal.
class ReadLine {
 public:
  void operator()(double done, double of) {
    if (!isatty(fileno(stderr)) || of <= 0) return;
    const int percent = static_cast<int>(100 * done / of);
    if (percent == shown_) return;
    shown_ = percent;
    std::fprintf(stderr, "\r\033[Kreading: %d %% of %.0f MB%s", percent, 1e-6 * of,
                 done >= of ? "\r\033[K" : "");
    std::fflush(stderr);
  }

 private:
  int shown_ = -1;
};

std::string ModelOf(const FrictionFit& fit) { return WordOf(fit.options.model); }

/// Why a file has nothing of a joint; one reason speaks for itself.
std::string WhyNothing(const FrictionFit& fit) {
  std::string all;
  for (const auto& [name, reason] : fit.unidentified)
    all += (all.empty() ? "" : "; ") + (fit.unidentified.size() == 1 ? "" : name + ": ") + reason;
  for (const FrictionEstimate& e : fit.estimates)
    if (e.value < 0) all += (all.empty() ? "" : "; ") + e.name + ": " + Text(e.value) + " is < 0";
  return all;
}

/// What logs say of joints, for a fit, and a line about the logs.
struct ReadJoints {
  std::vector<TestedDrive> joints;
  std::string text;
};

/// Of logs of !FrictionExperiment, which say themselves which samples are steady; none of others,
/// or if other columns or motors are asked for.
std::optional<ReadJoints> ReadTestedJoints(const Told& told) {
  const SampleSource& source = told.source;
  for (const SampleColumns* columns : {&source.time, &source.position, &source.velocity,
                                       &source.acceleration, &source.current, &source.torque})
    if (!columns->names.empty()) return std::nullopt;
  if (!told.torque_per_ampere.empty() || !told.reflected_inertia.empty()) return std::nullopt;
  ReadJoints read;
  std::int64_t rows = 0;
  for (const std::filesystem::path& file : source.files) {
    const std::optional<RunData> run = FrictionRunOf(file);
    if (!run) return std::nullopt;
    rows += run->times().size();
    for (TestedDrive& joint : TestedDrivesOf(*run)) {
      const std::string& name = joint.log.joint;
      if (!source.joints.empty() && std::ranges::find(source.joints, name) == source.joints.end())
        continue;
      const auto same = [&](const TestedDrive& other) { return other.log.joint == name; };
      Require(std::ranges::none_of(read.joints, same),
              name + " is tested in two of the logs; expected it in one");
      read.joints.push_back(std::move(joint));
    }
  }
  std::vector<std::string> tested;
  for (const TestedDrive& joint : read.joints) tested.push_back(joint.log.joint);
  for (const std::string& name : source.joints)
    if (std::ranges::find(tested, name) == tested.end())
      throw Error("the logs test no joint '" + name + "'" + DidYouMean(name, tested));
  if (read.joints.empty()) throw Error("the logs are of friction tests that tested no joint");
  read.text = Text(rows) + " rows of a friction test, its steady samples and break-aways";
  return read;
}

/// Of any logs.
ReadJoints ReadSampledJoints(Told& told) {
  SampleSource& source = told.source;
  // Without a rotor there is nothing to take an acceleration for.
  source.need_acceleration =
      !told.robot.empty() ||
      std::ranges::any_of(told.reflected_inertia, [](double b) { return b != 0; });
  if (told.robot.empty() && told.torque_per_ampere.empty()) DrivesOf(told, {});
  RequireDrives(told);
  source.progress = ReadLine{};
  const Samples samples = ReadSamples(source);
  const std::vector<DriveFigures> drives = DrivesOf(told, samples.joints);
  ReadJoints read{.joints = {}, .text = samples.text()};
  for (std::size_t j = 0; j < drives.size(); ++j)
    read.joints.push_back(
        {.log = FrictionOf(samples, static_cast<Eigen::Index>(j), drives[j], told.least_velocity),
         .drive = drives[j]});
  return read;
}

int IdentifyFriction(Told told) {
  // Before a long read, not after it.
  if (std::error_code none; !told.force && fs::exists(told.out, none))
    throw Error(told.out.string() + " exists; give --force to write over it, or another --out");
  RequireNewReport(told.report, told.force);
  SampleSource& source = told.source;
  source.files.assign(told.logs.begin(), told.logs.end());
  if (!told.delimiter.empty()) {
    Require(told.delimiter.size() == 1 || told.delimiter == "tab" || told.delimiter == "space",
            "--delimiter wants one letter, tab or space", told.delimiter);
    source.delimiter = told.delimiter == "tab"     ? '\t'
                       : told.delimiter == "space" ? ' '
                                                   : told.delimiter[0];
  }
  const std::optional<ReadJoints> tested = ReadTestedJoints(told);
  const ReadJoints read = tested ? *tested : ReadSampledJoints(told);
  std::printf("read: %s\n", read.text.c_str());

  std::vector<FrictionResult> results;
  std::vector<DriveFigures> drives;
  std::vector<std::vector<std::string>> joints;
  for (const TestedDrive& joint : read.joints) {
    for (const std::string& doubt : joint.log.doubts)
      std::fprintf(stderr, "pliant: %s: %s\n", joint.log.joint.c_str(), doubt.c_str());
    joints.push_back({joint.log.joint});
    results.push_back(Fit(told, joint.log));
    drives.push_back(joint.drive);
  }
  if (told.pool) {
    joints.clear();
    results = Pool(told, results, drives, joints);
  }

  std::string logs;
  for (const std::string& log : told.logs) logs += (logs.empty() ? "" : ", ") + log;
  FrictionFile file{
      .sources = told.logs, .model = {}, .loss = told.loss, .directions = told.directions};
  std::string lacking, models;
  bool one_model = true;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const FrictionFit& fit = results[i].fit;
    std::fputs(FrictionText(results[i]).c_str(), stdout);
    for (const std::string& joint : joints[i]) {
      const IdentifiedFriction of = fit.Identified(joint);
      if (!of.coulomb && !of.viscous && !of.stiction && !of.stribeck_velocity) {
        lacking += (lacking.empty() ? "" : "\n") + joint + ": " + WhyNothing(fit);
        continue;
      }
      file.joints.push_back(of);
      if (models.empty()) file.model = ModelOf(fit);
      one_model = one_model && file.model == ModelOf(fit);
      models += (models.empty() ? "" : ", ") + joint + ": " + ModelOf(fit);
    }
  }
  if (!one_model) file.model = models;
  if (file.joints.empty())
    throw Error(lacking + "\nnothing was identified, so nothing was written");
  if (!lacking.empty())
    std::fprintf(stderr, "pliant: not written, for nothing was identified:\n%s\n", lacking.c_str());
  WriteFriction(file, told.out, told.force);
  std::printf("friction: %s\n", fs::absolute(told.out).lexically_normal().c_str());
  if (told.report.empty()) return 0;
  std::error_code error;
  fs::create_directories(told.report, error);
  if (error)
    throw Error("cannot make the directory " + told.report.string() + ": " + error.message());
  try {
    WriteReport(FrictionReportOf(results, logs, read.text), told.report);
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
  std::printf("report: %s\n",
              (fs::absolute(told.report) / "report.html").lexically_normal().c_str());
  return 0;
}

}  // namespace

void AddIdentifyCommands(CLI::App& app, std::vector<Command>& commands) {
  CLI::App* identify = app.add_subcommand("identify", "Identifies parameters of an arm from logs");
  identify->require_subcommand(1);

  const auto told = std::make_shared<Told>();
  CLI::App* friction = identify->add_subcommand(
      "friction", "Fits the friction of joints to motor current, joint torque and velocity");
  friction->footer(
      "Example: pliant identify friction sweep.csv --time t --velocity 'v{}' --current 'i{}' "
      "--torque 'tau{}' --robot gen3 --out friction.yaml\n"
      "A column is a name, a number from 1, or for all joints a name with {} for the number of\n"
      "the joint. Logs of pliant need no columns.");
  friction->add_option("logs", told->logs, ".mcap of pliant, or CSV")->required();
  friction->add_option("--robot", told->robot, "whose motors: gen3 or lwr")
      ->check(CLI::IsMember({"gen3", "lwr"}));
  friction
      ->add_option("--torque-per-ampere", told->torque_per_ampere,
                   "joint torque of a current [N·m/A], of all joints or of each")
      ->delimiter(',')
      ->allow_extra_args(false);
  friction
      ->add_option("--reflected-inertia", told->reflected_inertia,
                   "of the rotors, behind the gear [kg·m²]")
      ->delimiter(',')
      ->allow_extra_args(false);
  friction->add_option("--joints", told->source.joints, "names or numbers; none: all")
      ->delimiter(',')
      ->allow_extra_args(false);
  friction->add_option("--model", told->model, "auto takes the one of least BIC")
      ->check(CLI::IsMember({"auto", "coulomb_viscous", "stribeck", "lugre_static"}))
      ->capture_default_str();
  friction->add_option("--loss", told->loss, "what outliers count")
      ->check(CLI::IsMember({"none", "huber", "cauchy"}))
      ->capture_default_str();
  friction->add_option("--directions", told->directions, "one law for both, or one for each")
      ->check(CLI::IsMember({"both", "separate"}))
      ->capture_default_str();
  friction->add_flag("--pool", told->pool, "joints with the same motor as one");
  friction->add_flag("--no-offset", told->no_offset, "the torque sensor has no offset");
  friction
      ->add_option("--least-velocity", told->least_velocity,
                   "slower samples do not slide [rad/s]; none: 4 σ of the velocity's noise")
      ->check(CLI::PositiveNumber);
  AddColumns(*friction, told->source.time, "time", "column of the time", "ms");
  AddColumns(*friction, told->source.position, "position", "columns, if there is no velocity",
             "deg");
  AddColumns(*friction, told->source.velocity, "velocity", "columns of the joint velocity",
             "deg/s");
  AddColumns(*friction, told->source.acceleration, "acceleration", "columns; none: derived",
             "deg/s²");
  AddColumns(*friction, told->source.current, "current", "columns of the motor current", "mA");
  AddColumns(*friction, told->source.torque, "torque", "columns of the measured joint torque",
             "mNm");
  friction
      ->add_option("--sample-period", told->source.sample_period_s,
                   "seconds from row to row, if there is no time")
      ->check(CLI::PositiveNumber);
  friction->add_option("--delimiter", told->delimiter, "of a CSV file; none: found");
  friction
      ->add_option("--window", told->source.half_window,
                   "samples on either side of one whose derivative is taken")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  friction->add_option("--most", told->source.most, "rows to keep of long logs")
      ->check(CLI::Range(1000, 10'000'000))
      ->capture_default_str();
  friction->add_option("--out", told->out, "the file to write, YAML")
      ->required()
      ->check(SaysSomething());
  friction->add_option("--report", told->report, "folder of a report with figures")
      ->check(SaysSomething());
  friction->add_flag("--force", told->force, "write over files that are there");
  commands.push_back({friction, [told] { return IdentifyFriction(*told); }});
}

}  // namespace pliant
