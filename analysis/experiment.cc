#include "pliant/analysis/experiment.h"

#include <algorithm>

#include "pliant/analysis/integrator_study.h"
#include "pliant/analysis/null_space_compliance.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

const std::vector<Experiment>& Experiments() {
  static const std::vector<Experiment> all{
      {"null-space-compliance",
       "a Gen3 holds its tool and is pushed at the elbow and at the tool, with three compliances",
       [](const ExperimentOptions& o, const Progress& progress) {
         return NullSpaceCompliance({.ideal = o.ideal}, progress);
       }},
      {"integrators",
       "what every integrator costs and how precise it is, on a Gen3 that sways; some minutes",
       [](const ExperimentOptions&, const Progress& progress) {
         return IntegratorStudy({}, progress);
       }},
  };
  return all;
}

const Experiment& FindExperiment(std::string_view name) {
  const std::vector<Experiment>& all = Experiments();
  const auto found = std::ranges::find(all, name, &Experiment::name);
  if (found != all.end()) return *found;
  std::vector<std::string> names;
  for (const Experiment& e : all) names.push_back(e.name);
  throw Error("there is no experiment '" + std::string(name) + "'" + DidYouMean(name, names) +
              "\n`pliant experiment list` names them");
}

}  // namespace pliant
