#pragma once

#include <Eigen/QR>
#include <string>
#include <vector>

#include "pliant/controllers/frame_task.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {

/// All ways to select, of a tool on the Gen3 and of one hand against the other on the tree.
struct TaskKind {
  std::string name;
  FrameTask::Options options;
};
inline std::vector<TaskKind> Kinds() {
  RandomStates random(Gen3(), 5);
  const auto orthonormal = [&](int rows, int columns) {
    const Eigen::MatrixXd any =
        Eigen::MatrixXd::NullaryExpr(columns, columns, [&] { return random.Uniform(1)(0); });
    const Eigen::MatrixXd Q = any.householderQr().householderQ();
    return TaskMatrix(Q.topRows(rows));
  };
  std::vector<TaskKind> kinds;
  for (const bool relative : {false, true})
    for (const auto axes : {FrameTask::Axes::Reference, FrameTask::Axes::Frame}) {
      const auto add = [&](const std::string& name, FrameTask::Part part, const TaskMatrix& basis) {
        const int rows = basis.size() > 0 ? static_cast<int>(basis.rows())
                                          : (part == FrameTask::Part::Pose ? 6 : 3);
        FrameTask::Options o{.model = relative ? Tree() : Gen3(),
                             .frame = relative ? "left_hand" : "tool_frame",
                             .part = part,
                             .axes = axes,
                             .basis = basis,
                             .stiffness = TaskVector::LinSpaced(rows, 100, 400),
                             .damping = TaskVector::LinSpaced(rows, 20, 40)};
        if (relative) o.relative_to = "right_tool";
        kinds.push_back({name + (relative ? ", relative" : "") +
                             (axes == FrameTask::Axes::Frame ? ", own axes" : ""),
                         o});
      };
      add("pose", FrameTask::Part::Pose, {});
      add("orientation", FrameTask::Part::Orientation, {});
      add("position", FrameTask::Part::Position, {});
      add("axis", FrameTask::Part::Position, orthonormal(1, 3));
      add("plane", FrameTask::Part::Position, orthonormal(2, 3));
      add("turned axes", FrameTask::Part::Position, orthonormal(3, 3));
      add("turn", FrameTask::Part::Orientation, orthonormal(1, 3));
      add("pointing", FrameTask::Part::Orientation, orthonormal(2, 3));
      add("mixed", FrameTask::Part::Pose, orthonormal(4, 6));
      TaskMatrix drill = TaskMatrix::Identity(6, 6);  // the position, and where z points
      drill.row(2) = TaskMatrix(drill.row(5));
      drill.conservativeResize(5, 6);
      drill.row(2) << 0, 0, 0, 0, 0, 1;
      drill.row(3) << 0, 0, 0, 1, 0, 0;
      drill.row(4) << 0, 0, 0, 0, 1, 0;
      add("drill", FrameTask::Part::Pose, drill);
    }
  return kinds;
}

}  // namespace pliant
