#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/swept_value.h"

namespace pliant {

/// What one run of a sweep left. Rows are equal if they are so bit for bit.
struct SweepRow {
  std::uint64_t run = 0;             ///< from 0
  std::vector<double> random = {};   ///< the values that were drawn, in their order
  std::vector<double> numbers = {};  ///< NaN where they could not be measured
  std::string ended = {};            ///< by which block, when and why; empty: none did
  std::string failed = {};           ///< why it could not be made or measured; empty: it was

  bool operator==(const SweepRow& other) const;
};

/// Many runs of one scenario, in which some of its values vary, and the numbers that each is
/// measured by.
///
/// Lists of values make a grid, all values of one with all of the others; its cell i mod cells()
/// belongs to run i, the last list running fastest. The random values of a run, and its seed unless
/// that is swept, are a function of the seed of the scenario and of i, so that a run is the same
/// whoever makes it, and whatever was made before.
class Sweep {
 public:
  /// Of an experiment's run, which may be left out if there is but one. `runs` 0: one for each
  /// cell. Throws Error for what cannot be swept: paths and values that the scenario refuses, no
  /// number to measure, an arm that is there.
  Sweep(const ExperimentFile& file, const std::string& run, const std::vector<std::string>& over,
        std::uint64_t runs);

  /// From what text() gave; throws Error "<source>: …".
  static Sweep ReadText(const std::string& text, const std::string& source);
  static constexpr std::size_t kMostText = 512 * 1024;  ///< [bytes], what ParameterFile reads
  /// All of it, as YAML: experiment, swept values, how many runs, and what pliant it is for.
  const std::string& text() const { return text_; }

  /// The pliant, compiler and libraries that it is for, and those that are here.
  const std::string& made_with() const { return made_with_; }
  static std::string MadeWithHere();
  std::uint64_t runs() const { return runs_; }
  std::uint64_t cells() const { return cells_; }
  bool sweeps_seed() const { return sweeps_seed_; }
  const std::vector<SweptValue>& over() const { return over_; }
  const std::vector<NamedNumber>& numbers() const { return experiment_.numbers; }
  const std::vector<std::string>& units() const { return units_; }  ///< of the numbers
  const Experiment& experiment() const { return experiment_; }

  /// The index of the value that a run has of each of over(); of what is random, 0.
  std::vector<std::size_t> IndicesOf(std::uint64_t run) const;
  std::vector<double> RandomValuesOf(std::uint64_t run) const;
  std::uint64_t SeedOf(std::uint64_t run) const;
  /// Throws Error if it cannot be.
  Scenario ScenarioOf(std::uint64_t run) const;
  /// A run by itself, with its values in the place of the swept ones.
  ExperimentFile FileOf(std::uint64_t run) const;

  /// Simulates a run and measures it. What cannot be made or measured is a row that says why. There
  /// is none if `stop` became true before its end.
  std::optional<SweepRow> Make(std::uint64_t run, const std::atomic<bool>* stop = nullptr) const;
  /// Throws Error, with where it stands, if a row is none of this sweep.
  void RequireOwn(const SweepRow& row, const std::string& where) const;
  /// What two rows of one run differ in first, in words.
  std::string DifferenceOf(const SweepRow& a, const SweepRow& b) const;
  /// The numbers of a run that was recorded, into a row that has none.
  void Measure(const Recording& recording, SweepRow& row) const;

 private:
  struct Description;
  Sweep(const Description& description, const std::string& source);
  void Add(const SweptValue& swept);
  RandomStream StreamOf(std::uint64_t run) const;

  Experiment experiment_;
  std::string made_with_;
  std::vector<SweptValue> over_;
  std::uint64_t runs_ = 0, cells_ = 1;
  bool sweeps_seed_ = false;
  std::string text_;
  std::vector<std::string> units_;
  ParameterFile scenario_;  // read once; what varies is put into copies
};

}  // namespace pliant
