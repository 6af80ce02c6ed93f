#include "pliant/systems/joint_trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"
#include "pliant/systems/time_table.h"

namespace pliant {

namespace {

/// A column's name, and the unit behind it in brackets or parentheses.
struct Heading {
  std::string_view name, unit;
};

std::string_view WithoutBlanksBehind(std::string_view text) {
  while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
  return text;
}

Heading HeadingOf(std::string_view cell) {
  const bool bracket = cell.ends_with(']'), parenthesis = cell.ends_with(')');
  const std::size_t open = cell.rfind(bracket ? '[' : '(');
  if (!(bracket || parenthesis) || open == std::string_view::npos) return {cell, {}};
  return {WithoutBlanksBehind(cell.substr(0, open)), cell.substr(open + 1, cell.size() - open - 2)};
}

/// Finds the columns of the joints and what brings them to rad.
class Columns {
 public:
  Columns(const std::filesystem::path& file, const TimeTable& table, const Joints& joints)
      : file_{file}, line_{table.header_line} {
    if (line_ == 0) {
      Require(table.columns.size() == static_cast<std::size_t>(joints.size()),
              file.string() + ": expected a column for the time and one for each of the joints " +
                  joints.text() + ", " + Text(joints.size() + 1) + " in all",
              table.columns.size() + 1);
      for (int j = 0; j < joints.size(); ++j) at.push_back(static_cast<std::size_t>(j));
      to_rad.assign(at.size(), 1);
      return;
    }
    FindTime(table.time_column);
    FindJoints(table.columns, joints);
  }

  double to_s = 1;
  std::vector<std::size_t> at;  // of each joint, into the columns of the table
  std::vector<double> to_rad;

 private:
  [[noreturn]] void Refuse(std::size_t column, const std::string& why) const {
    throw Error(file_.string() + ":" + Text(line_) + ":" + Text(column) + ": " + why);
  }

  void FindTime(const std::string& cell) {
    const std::string_view unit = HeadingOf(cell).unit;
    if (unit == "ms")
      to_s = 1e-3;
    else if (!unit.empty() && unit != "s")
      Refuse(1, "expected a time in s or ms, got '" + std::string(unit) + "'");
  }

  void FindJoints(const std::vector<std::string>& columns, const Joints& joints) {
    std::vector<std::string> names;
    for (int j = 0; j < joints.size(); ++j) names.push_back(joints[j]);
    constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    at.assign(names.size(), kNone);
    to_rad.assign(names.size(), 1);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Heading heading = HeadingOf(columns[c]);
      const auto found = std::ranges::find(names, heading.name);
      if (found == names.end())
        Refuse(c + 2, "'" + std::string(heading.name) + "' is none of the joints " + joints.text() +
                          DidYouMean(heading.name, names));
      const auto j = static_cast<std::size_t>(found - names.begin());
      if (at[j] != kNone)
        Refuse(c + 2, "joint '" + std::string(heading.name) + "' has two columns");
      at[j] = c;
      if (heading.unit == "deg" || heading.unit == "°")
        to_rad[j] = std::numbers::pi / 180;
      else if (!heading.unit.empty() && heading.unit != "rad")
        Refuse(c + 2, "expected an angle in rad or deg, got '" + std::string(heading.unit) + "'");
    }
    if (const auto none = std::ranges::find(at, kNone); none != at.end())
      Refuse(1, "expected a column for each of the joints " + joints.text() +
                    ", there is none for '" + names[static_cast<std::size_t>(none - at.begin())] +
                    "'");
  }

  const std::filesystem::path file_;
  const int line_;
};

}  // namespace

void RequireTrajectory(const JointTrajectory& t) {
  Require(!t.times.empty(), "a trajectory must have a row");
  Require(t.times.size() == t.positions.size(),
          "a trajectory has a position at each of its " + Text(t.times.size()) + " times",
          t.positions.size());
  for (std::size_t i = 0; i < t.times.size(); ++i) {
    const std::string row = "row " + Text(i + 1) + " of the trajectory: ";
    Require(std::isfinite(t.times[i]), row + "the time must be finite", t.times[i]);
    Require(i == 0 || t.times[i] > t.times[i - 1], row + "times must increase", t.times[i]);
    Require(t.positions[i].size() == t.joints.size(),
            row + "it has a number for each of the joints " + t.joints.text(),
            t.positions[i].size());
    Require(t.positions[i].allFinite(), row + "positions must be finite");
  }
}

JointTrajectory ReadJointTrajectory(const std::filesystem::path& file, const Joints& joints) {
  const TimeTable table = ReadTimeTable(file);
  const Columns columns(file, table, joints);
  JointTrajectory trajectory{.joints = joints, .times = table.times, .positions = {}};
  for (double& t : trajectory.times) t *= columns.to_s;
  JointPosition q = JointPosition::Zero(joints);
  for (std::size_t r = 0; r < table.times.size(); ++r) {
    for (std::size_t j = 0; j < columns.at.size(); ++j)
      q(static_cast<Eigen::Index>(j)) =
          columns.to_rad[j] * table.cells[r * table.columns.size() + columns.at[j]];
    trajectory.positions.push_back(q);
  }
  return trajectory;
}

}  // namespace pliant
