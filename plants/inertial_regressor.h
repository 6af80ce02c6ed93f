#pragma once

#include <Eigen/Core>
#include <span>

#include "pliant/plants/inertial_parameters.h"
#include "pliant/plants/robot_dynamics.h"

namespace pliant {

/// The dynamics of an arm as they depend on the masses of some of its links,
///
///   τ = M v̇ + C v + g = Y(q, v, v̇) π + τ_rest
///
/// π stacks the ten parameters of each link of `links`, about the link's origin and in its axes;
/// τ_rest is what the other links ask for. `d` holds (q, v), computed by ComputeDynamics; of its
/// figures only the motion of the bodies is read, so the masses of `model` have no part in Y.
///
/// The force and moment that move a link with angular velocity ω, angular acceleration α and proper
/// acceleration a of its origin (without gravity),
///
///   f = m a + α × m c + ω × (ω × m c),   n = I α + ω × I ω + m c × a,
///
/// are linear in its parameters; each joint that carries the link holds its part of them.
///
/// Y has a row for each joint and ten columns for each link. Links fixed to the world have columns
/// of zeros. `Y` must have that size; no heap.
///
/// Source: Atkeson, An & Hollerbach, Int. J. Robotics Research 5(3), 1986, sec. 2.
void ComputeInertialRegressor(const RobotModel& model, const RobotDynamics& d,
                              const JointAcceleration& vdot, std::span<const int> links,
                              Eigen::Ref<Eigen::MatrixXd> Y);

}  // namespace pliant
