#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/repeated_number.h"

namespace pliant {

/// A run whose signal "a.b", in metres, is one number at 0 and 1 s.
inline RunData RunWith(const std::string& name, double value) {
  RunData run;
  run.name = name;
  run.title = "run " + name;
  RecordedSignal signal{{"a.b", "position", {"[x]"}, {"m"}}, {}, {}};
  signal.times = Eigen::Vector2d(0, 1);
  signal.numbers = Eigen::RowVector2d(value, value);
  run.log = Recording({signal}, {});
  return run;
}

struct Group {
  std::string run;
  std::vector<double> values;
};

/// What a claim wants measured, of runs with these values in their repetitions.
template <class Check>
RepeatedNumber Measured(const Check& check, const std::vector<Group>& groups) {
  RepeatedNumber number = check.Wanted().front();
  for (std::size_t k = 0; k < groups.front().values.size(); ++k) {
    std::vector<RunData> runs;
    for (const Group& group : groups) runs.push_back(RunWith(group.run, group.values[k]));
    std::vector<const RunData*> all;
    for (const RunData& run : runs) all.push_back(&run);
    number.Add(Runs(all));
  }
  return number;
}

}  // namespace pliant
