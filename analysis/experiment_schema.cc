#include "pliant/analysis/experiment.h"
#include "pliant/analysis/parameter_schema.h"

namespace pliant {

std::string ExperimentSchema() {
  internal::Json schema = internal::SchemaOfStruct<Experiment>();
  internal::Json all{{"$schema", "http://json-schema.org/draft-07/schema#"},
                     {"title", "An experiment of pliant"}};
  all.update(schema);
  return all.dump(2) + "\n";
}

}  // namespace pliant
