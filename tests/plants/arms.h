#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"

namespace pliant {

inline const std::string kModels = PLIANT_SOURCE_DIR "/models/";
inline const std::string kGen3File = kModels + "gen3/gen3_7dof.urdf";
inline const std::string kGen3BotaFile = kModels + "gen3/gen3_7dof_bota.urdf";
inline const std::string kLwrFile = kModels + "lwr/lwr4p.urdf";

inline RobotModel Gen3() { return RobotModel::FromUrdf(kGen3File); }
inline RobotModel Lwr() { return RobotModel::FromUrdf(kLwrFile); }

/// Two arms on a turning trunk: skew and unnormalised axes, a prismatic joint in each, masses on
/// fixed side branches, a rotated inertia, joints that the file names in another order than from
/// the root out.
inline const std::string kTree = R"(<?xml version="1.0"?>
<robot name="tree">
  <link name="base"/>
  <link name="left_hand">
    <inertial>
      <origin xyz="0.02 -0.03 0.05" rpy="0.3 -0.4 0.5"/>
      <mass value="0.7"/>
      <inertia ixx="0.004" ixy="0.0003" ixz="-0.0002" iyy="0.005" iyz="0.0004" izz="0.006"/>
    </inertial>
  </link>
  <link name="trunk">
    <inertial>
      <origin xyz="0.01 0.02 0.3"/>
      <mass value="6"/>
      <inertia ixx="0.2" ixy="0.01" ixz="0.02" iyy="0.25" iyz="-0.01" izz="0.1"/>
    </inertial>
  </link>
  <link name="backpack">
    <inertial>
      <origin xyz="-0.1 0 0.05" rpy="0 0 0.7"/>
      <mass value="1.5"/>
      <inertia ixx="0.01" ixy="0" ixz="0.001" iyy="0.012" iyz="0" izz="0.015"/>
    </inertial>
  </link>
  <link name="left_arm">
    <inertial>
      <origin xyz="0 0.15 0.02"/>
      <mass value="2"/>
      <inertia ixx="0.03" ixy="0.001" ixz="0" iyy="0.02" iyz="0.002" izz="0.025"/>
    </inertial>
  </link>
  <link name="left_slide">
    <inertial>
      <origin xyz="0.05 0 0"/>
      <mass value="0.9"/>
      <inertia ixx="0.003" ixy="0" ixz="0.0004" iyy="0.004" iyz="0" izz="0.005"/>
    </inertial>
  </link>
  <link name="right_slide"/>
  <link name="right_arm">
    <inertial>
      <origin xyz="0.1 -0.1 0"/>
      <mass value="1.2"/>
      <inertia ixx="0.01" ixy="-0.001" ixz="0.002" iyy="0.015" iyz="0" izz="0.012"/>
    </inertial>
  </link>
  <link name="right_tool">
    <inertial>
      <origin xyz="0 0 0.08" rpy="1 0 0"/>
      <mass value="0.4"/>
      <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0.0001" izz="0.0005"/>
    </inertial>
  </link>
  <link name="camera"/>
  <joint name="left_wrist" type="continuous">
    <parent link="left_slide"/>
    <child link="left_hand"/>
    <origin xyz="0.2 0.01 -0.02" rpy="0.2 0.4 -0.3"/>
    <axis xyz="0.6 -0.8 0.3"/>
  </joint>
  <joint name="waist" type="revolute">
    <parent link="base"/>
    <child link="trunk"/>
    <origin xyz="0.1 -0.2 0.4" rpy="0.1 0.2 0.3"/>
    <axis xyz="0.1 0.2 2"/>
    <limit lower="-2" upper="2" velocity="1" effort="100"/>
  </joint>
  <joint name="backpack_mount" type="fixed">
    <parent link="trunk"/>
    <child link="backpack"/>
    <origin xyz="-0.1 0.05 0.3" rpy="0.5 -0.2 0.1"/>
  </joint>
  <joint name="left_shoulder" type="revolute">
    <parent link="trunk"/>
    <child link="left_arm"/>
    <origin xyz="0 0.25 0.5" rpy="-0.4 0 0.6"/>
    <axis xyz="0 -1 0"/>
    <limit lower="-2" upper="2" velocity="2" effort="50"/>
  </joint>
  <joint name="left_extension" type="prismatic">
    <parent link="left_arm"/>
    <child link="left_slide"/>
    <origin xyz="0.03 0.3 0" rpy="0 0.7 0"/>
    <axis xyz="1 1 0.2"/>
    <limit lower="-0.3" upper="0.3" velocity="1" effort="200"/>
  </joint>
  <joint name="right_extension" type="prismatic">
    <parent link="trunk"/>
    <child link="right_slide"/>
    <origin xyz="0 -0.25 0.5"/>
    <axis xyz="0 0 -1"/>
    <limit lower="-0.2" upper="0.2" velocity="1" effort="200"/>
  </joint>
  <joint name="right_shoulder" type="revolute">
    <parent link="right_slide"/>
    <child link="right_arm"/>
    <origin xyz="0.02 0 -0.1" rpy="0 0 1.2"/>
    <axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" velocity="2" effort="50"/>
  </joint>
  <joint name="right_tool_mount" type="fixed">
    <parent link="right_arm"/>
    <child link="right_tool"/>
    <origin xyz="0.2 -0.2 0.1" rpy="-0.3 0.8 0"/>
  </joint>
  <joint name="camera_mount" type="fixed">
    <parent link="base"/>
    <child link="camera"/>
    <origin xyz="1 0 1" rpy="0 0.5 3"/>
  </joint>
</robot>
)";
inline RobotModel Tree() { return RobotModel::FromUrdfText(kTree, "tree.urdf"); }

/// States and torques of a model, drawn from a seed.
struct RandomStates {
  explicit RandomStates(const RobotModel& m, unsigned seed = 1) : model{m}, random{seed} {}

  Eigen::VectorXd Uniform(double largest) {
    std::uniform_real_distribution<double> draw(-largest, largest);
    return Eigen::VectorXd::NullaryExpr(model.size(), [&] { return draw(random); });
  }
  /// Angles over a whole turn, lengths within half a metre.
  JointPosition q() {
    JointPosition all = Uniform(3.1);
    for (int i = 0; i < model.size(); ++i)
      if (model.joint(i).type == Joint::Type::Prismatic) all(i) /= 6.2;
    return all;
  }
  JointVelocity v() { return Uniform(2.0); }
  JointAcceleration a() { return Uniform(5.0); }
  JointTorque tau() { return Uniform(20.0); }

  RobotModel model;
  std::mt19937 random;
};

/// ‖a − b‖ relative to the size of what it is computed from.
template <class A, class B>
double RelativeError(const A& a, const B& b) {
  return (a - b).norm() / std::max(b.norm(), 1e-6);
}

}  // namespace pliant
