#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/figure.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// One number of a recorded signal.
struct SignalElement {
  std::string signal;   ///< path, such as control.pose_error
  std::string element;  ///< such as x

  template <class F>
  void Parameters(F&& f) {
    f("signal", signal);
    f("element", element);
  }
};

/// Two recorded numbers against each other, such as the path of a frame in a plane: a panel for
/// each pair, a curve for each run. Axes of one unit have one scale.
struct PathFigure {
  static constexpr const char* kTag = "Path";

  struct Plane {
    SignalElement x = {}, y = {};

    template <class F>
    void Parameters(F&& f) {
      f("x", x);
      f("y", y);
    }
  };

  std::string name, caption;
  std::vector<std::string> runs = {};
  std::vector<Plane> planes = {};
  double from_s = 0, to_s = kUnbounded;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("caption", caption);
    f("runs", runs);
    f("planes", planes);
    f("from_s", from_s, "s", kNotNegative);
    f("to_s", to_s, "s", kLimit);
  }
  std::string file() const { return name; }
  /// Throws Error if its name cannot name a file, without a plane, or if no row of a run is shown.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if a signal or an element is not there.
  void RequireSound(const Recording& recorded) const;
  Figure Draw(const Runs& runs) const;

 private:
  Panel PanelOf(const Plane& plane, const Runs& all) const;
};

}  // namespace pliant
