#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "pliant/analysis/base_parameters.h"
#include "pliant/analysis/consistent_inertia.h"
#include "pliant/analysis/smooth_motion.h"
#include "pliant/plants/robot_model.h"

namespace pliant {

/// What of a joint's torque is no inertia: each part is fitted along if it is wanted.
struct JointTerms {
  bool coulomb = true;          ///< c tanh(v/v₀)
  bool viscous = true;          ///< d v
  bool offset = true;           ///< o
  bool rotor = false;           ///< B v̇
  double zero_velocity = 0.01;  ///< v₀ [rad/s]

  int count() const { return coulomb + viscous + offset + rotor; }
};

struct DynamicsOptions {
  /// Links whose figures are sought; empty: of each moving body the link with the greatest mass.
  std::vector<std::string> links = {};
  /// Instead of that: a body fixed to this link is sought, beyond all the model has.
  std::string payload = {};
  JointTerms terms = {};
  SmoothingOptions smoothing = {};
  bool robust = false;         ///< Huber's weights instead of squares, for logs with contacts
  double prior_deviation = 1;  ///< σ₀, see FitConsistentInertia
  /// Of a payload: a ball of 1 kg and 5 cm at the link's origin.
  Inertial payload_prior = {1, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity() * 1e-3};
};

/// A combination of parameters that the log tells, and how well.
struct IdentifiedCombination {
  std::string name;   ///< "link_6.mc_x + link_7.m"
  double prior;       ///< of the model
  double value;       ///< by least squares, not bound to a body that could be
  double half_width;  ///< of its 95 % interval
};

/// Root mean square of what each joint's torque has beyond a model's [N·m].
struct TorqueResiduals {
  std::string log;      ///< "fitted" or "validated"
  PerJoint torque;      ///< of the torque about its mean, to compare with
  PerJoint model;       ///< the model as it is
  PerJoint prior;       ///< the model with joint terms fitted to it
  PerJoint free;        ///< least squares: no other figures do better on what was fitted
  PerJoint identified;  ///< the links that are the result
};

struct IdentifiedLink {
  std::string name;
  Inertial prior;
  ConsistentInertia found;
};

struct JointTermValues {
  double coulomb = 0, viscous = 0, offset = 0, rotor = 0;
};

struct DynamicsResult {
  RobotModel model;      ///< with the figures found
  bool payload = false;  ///< `links` is one body fixed to a link, not the link
  std::vector<IdentifiedLink> links;
  std::vector<JointTermValues> terms;  ///< of each joint
  std::vector<IdentifiedCombination> combinations;
  std::vector<std::string> alone;       ///< parameters told by themselves
  std::vector<std::string> combined;    ///< told in combinations only
  std::vector<std::string> without;     ///< without effect on any torque in this motion
  double condition = 0;                 ///< of the weighted rows, columns scaled to one length
  PerJoint scale;                       ///< σ_j, of the residuals of least squares [N·m]
  PerJoint correlation;                 ///< T_j, points that are worth one independent point
  Eigen::Index points = 0;              ///< that were fitted
  Eigen::Index repeated = 0, gaps = 0;  ///< see SmoothMotion
  TorqueResiduals fitted;
  std::optional<TorqueResiduals> validated;
};

/// Finds the inertial figures of links, or of a payload, with friction and offset of each joint:
///
///   τ_j = Y_j(q, v, v̇) π + τ_rest,j + c_j tanh(v_j/v₀) + d_j v_j + o_j + B_j v̇_j
///
/// 1. Motion and torque are smoothed alike; see Smooth.
/// 2. Least squares, each joint's rows divided by the deviation σ_j of its residuals, iterated,
///    with Huber's weights if `robust` (k = 1.345, σ by his proposal 2). Columns that depend on
///    others are found and named; the intervals are those of the base parameters. Residuals of
///    neighbouring points are alike: only one in T_j counts,
///
///      T_j = 1 + 2 Σ_{k ≤ K} ρ_k,   K the least with K ≥ 5 T_j
///
///    with ρ_k the autocorrelation of the residuals. Residuals of different joints are taken to be
///    independent, and the noise of the motion to be small.
/// 3. Links that could be built and explain the rows as well; see FitConsistentInertia.
///
/// `samples` must have position, velocity and torque of the model's joints, in its order, where the
/// torque is the one the links feel. Throws Error: an unknown link, one that is fixed or without
/// mass, an arm that does not move, fewer than ten points per parameter of a joint's rows.
///
/// Source: Gautier, J. Robotic Systems 8(4), 1991; Huber, Robust Statistics, 1981, sec. 7.8; Sokal,
/// in: Functional Integration, 1997, sec. 3 (T_j).
DynamicsResult IdentifyDynamics(const RobotModel& model, const Samples& samples,
                                const DynamicsOptions& o = {}, const Samples* validation = nullptr);

}  // namespace pliant
