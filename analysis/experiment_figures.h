#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/figure.h"
#include "pliant/analysis/run_data.h"
#include "pliant/analysis/signal_number.h"

namespace pliant {

/// Throws Error unless a figure's name can name its files.
void RequireFileName(const std::string& name);

/// While a push lasts or a hand holds.
std::vector<Band> ContactBands(const Scenario& scenario);

/// EC-fig6: norms of the tool's linear and angular velocity and of the joint velocity, and the sum
/// of the norms of the forces of all contacts: pushes, hands, masses and surfaces. A column for
/// each run.
struct VelocityFigure {
  static constexpr const char* kTag = "Velocities";
  std::string name = "velocities";
  std::vector<std::string> runs;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("runs", runs);
  }
  std::string file() const { return name; }
  void RequireFit(const Scenario& scenario) const;
  Figure Draw(const Runs& runs) const;
};

/// How far the tool is off, measured and predicted: behind the observer by its transfer function,
/// and as if the pushes were static.
struct PredictionFigure {
  static constexpr const char* kTag = "Predictions";
  std::string name = "predictions";
  std::vector<std::string> behind_observer;
  std::vector<std::string> as_if_static;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("behind_observer", behind_observer);
    f("as_if_static", as_if_static);
  }
  std::string file() const { return name; }
  void RequireFit(const Scenario& scenario) const;
  Figure Draw(const Runs& runs) const;
};

/// Joint positions, velocities and torques of a run as parts of their limits.
struct LimitFigure {
  static constexpr const char* kTag = "Limits";
  std::string name = "limits";
  std::string run;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("run", run);
  }
  std::string file() const { return name; }
  void RequireFit(const Scenario&) const { RequireFileName(name); }
  Figure Draw(const Runs& runs) const;
};

/// Signals over time: a row for each signal, a column for each run, a curve for each element.
struct SignalFigure {
  static constexpr const char* kTag = "Signals";
  std::string name, caption;
  std::vector<std::string> runs, signals;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("caption", caption);
    f("runs", runs);
    f("signals", signals);
  }
  std::string file() const { return name; }
  void RequireFit(const Scenario&) const { RequireFileName(name); }
  Figure Draw(const Runs& runs) const;
};

/// The norms of signals over time, a curve for each run: one panel for each signal. They may be
/// relative to a time or below a frequency, as SignalNumber has it.
struct NormFigure {
  static constexpr const char* kTag = "Norms";
  std::string name, caption;
  std::vector<std::string> runs, signals;
  bool logarithmic = false;  ///< the norms' axis
  std::optional<double> relative_to_s = {};
  double below_hz = kUnbounded;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("caption", caption);
    f("runs", runs);
    f("signals", signals);
    f("logarithmic", logarithmic);
    f("relative_to_s", relative_to_s, "s", kNotNegative);
    f("below_hz", below_hz, "Hz", kLimit);
  }
  std::string file() const { return name; }
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if the elements of a signal have different units.
  void RequireSound(const Recording& recorded) const;
  Figure Draw(const Runs& runs) const;

 private:
  SignalNumber Of(const std::string& signal) const;
};

}  // namespace pliant
