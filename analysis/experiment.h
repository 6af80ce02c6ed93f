#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pliant/analysis/accuracy_claims.h"
#include "pliant/analysis/bar_figure.h"
#include "pliant/analysis/bound_claim.h"
#include "pliant/analysis/compliance_claims.h"
#include "pliant/analysis/contact_limits.h"
#include "pliant/analysis/damper_claim.h"
#include "pliant/analysis/difference_claim.h"
#include "pliant/analysis/equivalence_claim.h"
#include "pliant/analysis/experiment_figures.h"
#include "pliant/analysis/friction_claim.h"
#include "pliant/analysis/friction_figure.h"
#include "pliant/analysis/least_claim.h"
#include "pliant/analysis/motion_claims.h"
#include "pliant/analysis/named_number.h"
#include "pliant/analysis/number_table.h"
#include "pliant/analysis/order_claim.h"
#include "pliant/analysis/path_figure.h"
#include "pliant/analysis/phase_figure.h"
#include "pliant/analysis/swing_claim.h"
#include "pliant/diagrams/scenario.h"
#include "pliant/plants/parameter_file.h"

namespace pliant {

/// A run of an experiment: its scenario with some values changed.
struct RunOf {
  std::string name;
  std::string title;
  Overrides set = {};

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("title", title);
    f("set", set);
  }
};

/// Of a claim that is checked in each repetition, `Check` makes a Claim of its runs; of one about
/// all of them, `Judge` makes it of the numbers `Wanted`. What must be so before a run is made:
/// `RequireFit` of a run's scenario, `RequireSound` of what it will record, `RequireRepetitions`.
using ClaimCheck =
    std::variant<StandsStill, HoldsTool, YieldsAsInertia, KeepsLimits, DamperClaim, MovesAlong,
                 KeepsDoor, FollowsAsWell, ComesAsNear, KeepsContactLimits, BoundClaim, LeastClaim,
                 OrderClaim, DifferenceClaim, EquivalenceClaim, FrictionIdentified, SwingClaim>;
/// `Draw` makes the figure of the first repetition's runs, or of the numbers `Wanted` in each.
using FigureOf = std::variant<VelocityFigure, PredictionFigure, LimitFigure, SignalFigure,
                              NormFigure, PhaseFigure, PathFigure, BarFigure, FrictionFigure>;

/// A file that can be run: a scenario, its runs, the claims to check, the figures to draw,
/// the tables to fill, and the numbers that a sweep measures.
struct Experiment {
  std::string title;
  std::string summary;
  Scenario scenario = {};
  int repeat = 1;  ///< how often each run is made, with the seeds of the scenario, that + 1, …
  std::vector<RunOf> runs = {};  ///< none: one, named "run"
  std::vector<ClaimCheck> claims = {};
  std::vector<FigureOf> figures = {};
  std::vector<NumberTable> tables = {};
  std::vector<NamedNumber> numbers = {};  ///< that a sweep measures in each run

  template <class F>
  void Parameters(F&& f) {
    f("title", title);
    f("summary", summary);
    scenario.Parameters(f);
    f("repeat", repeat, "", Between(1, 100'000));
    f("runs", runs);
    f("claims", claims);
    f("figures", figures);
    f("tables", tables);
    f("numbers", numbers);
  }
};

/// Throws Error if a claim can hold of no results of that many repetitions.
void RequireRepetitions(const Experiment& experiment, int repetitions);

/// An experiment and the scenario of each of its runs.
struct ExperimentFile {
  Experiment experiment;
  std::vector<Scenario> scenarios;  ///< in the order of `experiment.runs`

  /// Reads and checks everything, down to building each run's diagram, so that nothing is refused
  /// later. `set` goes before what runs change. What is wrong is an Error "file:line:column: …".
  static ExperimentFile Read(const std::filesystem::path& file, const Overrides& set = {});
  static ExperimentFile ReadText(const std::string& text, const std::string& source,
                                 const Overrides& set = {});

  std::string text() const;  ///< as YAML that reads back the same
};

/// An experiment that comes with pliant.
struct NamedExperiment {
  std::string name;
  std::string title;
  std::filesystem::path file;
};
std::vector<NamedExperiment> Experiments();

/// Throws Error with the nearest name if there is none of that name.
NamedExperiment FindExperiment(std::string_view name);

/// The JSON Schema of experiment files, for editors.
std::string ExperimentSchema();

}  // namespace pliant
