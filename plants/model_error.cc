#include "pliant/plants/model_error.h"

#include <cmath>

#include "pliant/systems/random.h"

namespace pliant {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// What random numbers are for: other numbers than in sensors, so that all may have one seed.
enum Use : std::uint64_t { kLinks = 300, kFriction };

/// Uniform in (−1, 1).
double Draw(const RandomStream& random, std::uint64_t n) { return 2 * random.Uniform(n) - 1; }

Inertial Perturbed(const Inertial& right, const ModelError& error, const RandomStream& random) {
  const Matrix3d Sigma = 0.5 * right.inertia.trace() * Matrix3d::Identity() - right.inertia;
  const double rho = std::sqrt(Sigma.trace() / right.mass);
  const double s = 1 + error.mass * Draw(random, 0);
  const Vector3d u(Draw(random, 1), Draw(random, 2), Draw(random, 3));
  const Vector3d stretch(Draw(random, 4), Draw(random, 5), Draw(random, 6));
  const double xy = Draw(random, 7), xz = Draw(random, 8), yz = Draw(random, 9);
  Matrix3d E = stretch.asDiagonal();
  E(0, 1) = E(1, 0) = xy;
  E(0, 2) = E(2, 0) = xz;
  E(1, 2) = E(2, 1) = yz;
  const Matrix3d A = Matrix3d::Identity() + 0.5 * error.inertia * E;

  // By its change, so that I' = I to the last bit where δ_I = 0.
  const Matrix3d change = A * Sigma * A.transpose() - Sigma;
  Inertial wrong;
  wrong.mass = s * right.mass;
  wrong.center = right.center + error.center * rho * u;
  wrong.inertia = s * (right.inertia + change.trace() * Matrix3d::Identity() - change);
  return wrong;
}

}  // namespace

RobotModel Perturbed(const RobotModel& model, const ModelError& error) {
  RequireInRange("model error", error);
  const RandomStream random = RandomStream(error.seed).Part(kLinks);
  RobotModel wrong = model;
  for (std::size_t i = 0; i < model.links().size(); ++i) {
    const Link& link = model.links()[i];
    if (link.inertial.mass > 0)
      wrong = wrong.WithInertial(link.name, Perturbed(link.inertial, error, random.Part(i)));
  }
  return error.payload ? wrong.WithPayload(error.payload->link, error.payload->inertial) : wrong;
}

ArmActuators Perturbed(const ArmActuators& actuators, const ModelError& error) {
  RequireInRange("model error", error);
  const RandomStream random = RandomStream(error.seed).Part(kFriction);
  ArmActuators wrong = actuators;
  for (std::size_t j = 0; j < wrong.joint.size(); ++j) {
    FrictionParameters& friction = wrong.joint[j].friction;
    const double dry = 1 + error.friction * Draw(random.Part(j), 0);
    friction.coulomb *= dry;
    friction.stiction *= dry;
    friction.viscous *= 1 + error.friction * Draw(random.Part(j), 1);
  }
  return wrong;
}

}  // namespace pliant
