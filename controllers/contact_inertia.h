#pragma once

#include <optional>

#include "pliant/controllers/objective.h"
#include "pliant/plants/robot_dynamics.h"

namespace pliant {

/// The inertia that a point of an arm shows to what touches it: one that is wanted, M_d, or its
/// natural one
///
///   Λ = (J M⁻¹ Jᵀ)⁻¹                                                                     (CF 24)
///
/// J: 3×n, of the point's translation.
class ContactInertia {
 public:
  /// M_d: nothing: Λ; a number m: m I; a column: the diagonal; else the matrix, positive definite.
  explicit ContactInertia(const TaskMatrix& given);

  /// M_d⁻¹ f or, where it is natural, J M⁻¹ Jᵀ f, which needs no inverse of what may be singular.
  /// Not a number where M is not positive definite.
  Eigen::Vector3d Accelerate(const RobotDynamics& d, const FrameDynamics& point,
                             const Eigen::Vector3d& f) const;

 private:
  std::optional<Eigen::Matrix3d> inverse_;  // M_d⁻¹
};

}  // namespace pliant
