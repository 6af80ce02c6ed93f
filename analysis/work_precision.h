#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pliant/systems/diagram.h"
#include "pliant/systems/simulator.h"

namespace pliant {

/// A diagram and what is looked at while it runs.
struct Observed {
  Diagram diagram;
  /// Values of the diagram that an integrator's errors show in, such as positions.
  std::function<Eigen::VectorXd(Simulator&)> look;
  Eigen::VectorXd scale;  ///< of each number of `look`, > 0: errors are relative to it
};

struct WorkPrecisionOptions {
  std::function<Observed()> make;  ///< a new one for each run
  double duration_s;
  double spacing_s = 0.01;  ///< of the times at which runs are compared
  std::vector<Method> methods;
  std::vector<double> relative_tolerances;
  double absolute_over_relative = 1e-2;  ///< both tolerances are tightened together
  int repetitions = 3;                   ///< of which the median time counts
  IntegratorOptions reference = {
      .method = Method::kDormandPrince, .relative_tolerance = 1e-12, .absolute_tolerance = 1e-14};
};

/// What one method costs at one tolerance, and what that buys.
struct WorkPrecisionPoint {
  Method method;
  double relative_tolerance;
  double error;  ///< largest |look − look of the reference| / scale over all numbers and times
  double cpu_s;  ///< of the processor, so that a shared machine matters less
  Integrator::Statistics work;
  std::string failure = {};  ///< why the run did not reach its end; `error` is not finite then
};

/// Runs the diagram with every method at every tolerance against a reference run: a point for each,
/// method by method in the order given. Everything but `cpu_s` is the same at each call.
std::vector<WorkPrecisionPoint> WorkPrecision(const WorkPrecisionOptions& options);

/// The least work, such as derivative calls, with which a method kept its error below `error`;
/// infinite if it did at none of its points.
double WorkFor(double error, Method method, const std::vector<WorkPrecisionPoint>& points,
               const std::function<double(const WorkPrecisionPoint&)>& work);

}  // namespace pliant
