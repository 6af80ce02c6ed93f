#include "pliant/plants/inertial_parameters.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// −[c]²: the inertia of a unit mass at c about the origin.
Matrix3d PointInertia(const Vector3d& c) {
  return c.squaredNorm() * Matrix3d::Identity() - c * c.transpose();
}

InertialParameters Stacked(double m, const Vector3d& mc, const Matrix3d& I) {
  InertialParameters pi;
  pi << m, mc, I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2);
  return pi;
}

Matrix3d InertiaOf(const InertialParameters& pi) {
  Matrix3d I;
  I << pi[4], pi[5], pi[6], pi[5], pi[7], pi[8], pi[6], pi[8], pi[9];
  return I;
}

}  // namespace

InertialParameters ParametersOf(const Inertial& inertial) {
  const auto& [m, c, I] = inertial;
  return Stacked(m, m * c, I + m * PointInertia(c));
}

Inertial InertialOf(const InertialParameters& pi) {
  const Vector3d c = pi.segment<3>(1) / pi[0];
  return {pi[0], c, InertiaOf(pi) - pi[0] * PointInertia(c)};
}

PseudoInertia PseudoInertiaOf(const InertialParameters& pi) {
  const Matrix3d I = InertiaOf(pi);
  PseudoInertia P;
  P.topLeftCorner<3, 3>() = 0.5 * I.trace() * Matrix3d::Identity() - I;
  P.topRightCorner<3, 1>() = pi.segment<3>(1);
  P.bottomLeftCorner<1, 3>() = pi.segment<3>(1).transpose();
  P(3, 3) = pi[0];
  return P;
}

InertialParameters ParametersOf(const PseudoInertia& P) {
  const Matrix3d S = P.topLeftCorner<3, 3>();
  return Stacked(P(3, 3), P.topRightCorner<3, 1>(), S.trace() * Matrix3d::Identity() - S);
}

}  // namespace pliant
