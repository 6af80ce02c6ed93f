#pragma once

#include "pliant/plants/robot_dynamics.h"

namespace pliant {

/// The wrench at a frame that accelerates the frame as the environment does:
///
///   F̂ = Λ J q̈_e,   Λ = (J M⁻¹ Jᵀ)⁻¹,   q̈_e = M⁻¹ τ̂_e
///
/// F̂ = F if all that touches the arm is F at the frame. World axes, at the frame's origin, angular
/// part first. Where the arm can hardly accelerate the frame Λ stays finite: an eigenvalue k of
/// J M⁻¹ Jᵀ below k₀ = 2/L counts as k₀²/(2k₀ − k), so no eigenvalue of Λ exceeds L.
///
/// Source: Khatib, IEEE J. Robotics and Automation 3(1), 1987.
Vector6 FrameForce(const RobotDynamics& d, const FrameDynamics& frame,
                   const JointAcceleration& qdd_e, double inertia_limit = 200);

}  // namespace pliant
