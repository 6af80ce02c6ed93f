#include "pliant/analysis/experiment.h"
#include "pliant/plants/parameter_text.h"
#include "pliant/tests/fuzz/targets.h"

namespace pliant::fuzz {

bool ScenarioFile(const std::string& bytes) {
  Experiment experiment;
  Takes([&] {
    ParameterFile::ReadText(bytes).Fill(experiment);
    const std::string text = ParametersText(experiment);
    Experiment again;
    Check(Takes([&] { ParameterFile::ReadText(text).Fill(again); }), "what is printed is read");
    Check(ParametersText(again) == text, "what is printed reads back the same");
  });
  // Each run is built; many of them take as long as they are many.
  return experiment.runs.size() <= 2 && Takes([&] {
           const ExperimentFile file = ExperimentFile::ReadText(bytes, "fuzz.yaml");
           Check(!file.scenarios.empty(), "an experiment has a run");
         });
}

}  // namespace pliant::fuzz
