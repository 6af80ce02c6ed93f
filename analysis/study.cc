#include "pliant/analysis/study.h"

#include "pliant/analysis/integrator_study.h"

namespace pliant {

const std::vector<Study>& Studies() {
  static const std::vector<Study> all{
      {"integrators",
       "what every integrator costs and how precise it is, on a Gen3 that sways; some minutes",
       [](const Progress& progress) { return IntegratorStudy({}, progress); }}};
  return all;
}

}  // namespace pliant
