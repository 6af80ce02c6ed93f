#include <fstream>

#include "pliant/analysis/csv_rows.h"
#include "pliant/analysis/sample_source.h"
#include "pliant/systems/joint_trajectory.h"
#include "pliant/systems/time_table.h"
#include "pliant/tests/fuzz/targets.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant::fuzz {

bool Csv(const std::string& bytes) {
  static const TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "log.csv";
  std::ofstream(file, std::ios::binary) << bytes;

  Takes([&] {
    internal::CsvRows rows(file);
    Check(rows.names().size() == rows.units().size(), "each column has a name and a unit");
    while (rows.Next())
      for (std::size_t column = 0; column < rows.names().size(); ++column) rows.number(column);
  });

  Takes([&] {
    const TimeTable table = ReadTimeTable(file);
    Check(table.cells.size() == table.times.size() * table.columns.size(), "rows are whole");
  });
  Takes([&] { RequireTrajectory(ReadJointTrajectory(file, {"elbow", "shoulder"})); });

  SampleSource measured{.files = {file},
                        .velocity = {{"v"}},
                        .acceleration = {{"a"}},
                        .current = {{"i"}},
                        .torque = {{"m"}},
                        .most = 1000};
  SampleSource derived{.files = {file},
                       .time = {{"1"}},
                       .position = {{"2"}},
                       .need_current = false,
                       .need_torque = false,
                       .half_window = 2,
                       .most = 1000};
  bool taken = false;
  for (const SampleSource& source : {measured, derived})
    taken |= Takes([&] {
      const Samples samples = ReadSamples(source);
      Check(samples.time.size() > 0 && samples.time.allFinite(), "samples have times");
      for (const Eigen::MatrixXd* rows : {&samples.position, &samples.velocity,
                                          &samples.acceleration, &samples.current, &samples.torque})
        Check(rows->size() == 0 || (rows->cols() == samples.time.size() &&
                                    rows->rows() == std::ssize(samples.joints)),
              "there is a number for each joint and time");
      samples.text();
    });
  return taken;
}

}  // namespace pliant::fuzz
