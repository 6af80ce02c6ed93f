#pragma once

#include <Eigen/Core>

#include "pliant/plants/robot_model.h"

namespace pliant {

/// What the dynamics of a body are linear in: mass, first moment and inertia about the origin of a
/// frame fixed to the body, in its axes,
///
///   π = (m, m c_x, m c_y, m c_z, I_xx, I_xy, I_xz, I_yy, I_yz, I_zz)
using InertialParameters = Eigen::Matrix<double, 10, 1>;

/// Their names: "m", "mc_x", …, "I_zz".
inline constexpr const char* kInertialNames[] = {"m",    "mc_x", "mc_y", "mc_z", "I_xx",
                                                 "I_xy", "I_xz", "I_yy", "I_yz", "I_zz"};

InertialParameters ParametersOf(const Inertial& inertial);

/// The body of these parameters, m > 0.
Inertial InertialOf(const InertialParameters& pi);

/// Second moments of mass,
///
///   P = ∫ (x; 1) (x; 1)ᵀ dm = [ ½ tr(I) 1 − I   m c ]
///                             [ (m c)ᵀ           m  ]
///
/// A distribution of mass with these parameters exists if and only if P ⪰ 0, and one that fills a
/// volume if and only if P ≻ 0. Linear in π, and one to one.
///
/// Source: Wensing, Kim & Slotine, IEEE Robotics and Automation Letters 3(1), 2018, (14).
using PseudoInertia = Eigen::Matrix4d;

PseudoInertia PseudoInertiaOf(const InertialParameters& pi);
InertialParameters ParametersOf(const PseudoInertia& P);

}  // namespace pliant
