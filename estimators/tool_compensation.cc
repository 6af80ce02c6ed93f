#include "pliant/estimators/tool_compensation.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kMostCondition = 100;

Matrix3d Cross(const Vector3d& a) {
  return (Matrix3d() << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0).finished();
}

ToolParameters Checked(const ToolParameters& tool) {
  RequireInRange("", "mass", tool.mass, "kg", kNotNegative);
  RequireEachInRange("center", tool.center, "m", kAnyNumber);
  RequireEachInRange("bias", tool.bias, Wrench::quantity.unit, kAnyNumber);
  return tool;
}

void Check(std::span<const ToolSample> samples, const Vector3d& gravity, const Wrench& noise) {
  RequireEachInRange("gravity", gravity, "m/s²", kAnyNumber);
  RequireInRange("", "the norm of gravity", gravity.norm(), "m/s²", kPositive);
  RequireEachInRange("noise", noise, Wrench::quantity.unit, kPositive);
  Require(samples.size() >= 3, "a tool needs samples of at least 3 orientations", samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Matrix3d& R = samples[i].rotation;
    const std::string sample = "sample " + Text(i);
    // A rotation that was written down with nine digits passes.
    Require((R * R.transpose()).isIdentity(1e-8) && R.determinant() > 0,
            sample + ": R_WS must be a rotation: R Rᵀ = I, det R = 1, got\n" + Text(R));
    RequireEachInRange(sample + ": wrench", samples[i].wrench, Wrench::quantity.unit, kAnyNumber);
  }
}

/// The x that makes ‖A x − y‖ smallest.
struct Solution {
  VectorXd x;
  MatrixXd covariance;
  double condition;
};

Solution LeastSquares(const MatrixXd& A, const VectorXd& y) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& s = svd.singularValues();
  const double condition = s(0) / s(s.size() - 1);
  Require(
      condition <= kMostCondition,
      "the orientations do not tell mass, centre and bias apart; add samples with gravity along "
      "other axes of the sensor's frame: the condition must be <= " +
          Text(kMostCondition),
      condition);
  const VectorXd x = svd.solve(y);
  const auto freedom = static_cast<double>(A.rows() - A.cols());
  const MatrixXd root = svd.matrixV() * s.cwiseInverse().asDiagonal();
  return {x, (A * x - y).squaredNorm() / freedom * root * root.transpose(), condition};
}

}  // namespace

Wrench RestingWrench(const ToolParameters& tool, const Matrix3d& R_WS, const Vector3d& gravity) {
  const Vector3d weight = tool.mass * (R_WS.transpose() * gravity);
  Wrench W = tool.bias;
  W.head<3>() += tool.center.cross(weight);
  W.tail<3>() += weight;
  return W;
}

ToolCompensation::ToolCompensation(const Options& o)
    : measured{this, "measured", Frame(o.frame)},
      measured_valid{this, "measured_valid", {}, true},
      dynamics{this, "dynamics", o.model.joints()},
      tool{this, "tool", {}, Checked(o.tool)},
      contact{this, "contact", Frame(o.frame)},
      model_{o.model},
      link_{o.model.link_index(o.frame)} {
  Compute(contact).From(measured, measured_valid, dynamics, tool).As(&ToolCompensation::Compensate);
}

Wrench ToolCompensation::Compensate(const Wrench& W, bool valid, const RobotDynamics& d,
                                    const ToolParameters& now) const {
  if (!valid) return {};
  return W - RestingWrench(now, LinkPose(model_, d, link_).rotation, model_.gravity());
}

ToolParameters ToolEstimate::deviation() const {
  const Eigen::Matrix<double, 10, 1> sigma = covariance.diagonal().cwiseSqrt();
  return {sigma(0), sigma.segment<3>(1), Wrench(sigma.tail<6>())};
}

ToolEstimate IdentifyTool(std::span<const ToolSample> samples, const Vector3d& gravity,
                          const Wrench& noise) {
  Check(samples, gravity, noise);
  const auto rows = static_cast<Eigen::Index>(3 * samples.size());
  const double g = gravity.norm();
  // Gravity has unit length here, so that all columns are alike: x = (m g, b_F) and (m c g, b_M).
  MatrixXd A_F(rows, 4), A_M(rows, 6);
  VectorXd F(rows), M(rows);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    const Vector3d u = samples[i].rotation.transpose() * gravity / g;
    const Matrix3d per_sigma_M = noise.head<3>().cwiseInverse().asDiagonal();
    const Matrix3d per_sigma_F = noise.tail<3>().cwiseInverse().asDiagonal();
    A_F.middleRows<3>(row) << per_sigma_F * u, per_sigma_F;
    A_M.middleRows<3>(row) << -per_sigma_M * Cross(u), per_sigma_M;
    M.segment<3>(row) = per_sigma_M * samples[i].wrench.head<3>();
    F.segment<3>(row) = per_sigma_F * samples[i].wrench.tail<3>();
  }
  const Solution force = LeastSquares(A_F, F);
  const Solution moment = LeastSquares(A_M, M);

  ToolEstimate estimate;
  estimate.condition = std::max(force.condition, moment.condition);
  const double m = force.x(0) / g;
  RequireInRange("", "the mass that the samples show", m, "kg", kPositive);
  const Vector3d c = moment.x.head<3>() / (m * g);
  estimate.tool.mass = m;
  estimate.tool.center = c;
  estimate.tool.bias << moment.x.tail<3>(), force.x.tail<3>();

  // d(m, c, b) = T d(m g, b_F, m c g, b_M), with dc = (d(m c) − c dm)/m.
  Eigen::Matrix<double, 10, 10> T = Eigen::Matrix<double, 10, 10>::Zero();
  T(0, 0) = 1 / g;
  T.block<3, 1>(1, 0) = -c / (m * g);
  T.block<3, 3>(1, 4).diagonal().setConstant(1 / (m * g));
  T.block<3, 3>(4, 7).setIdentity();
  T.block<3, 3>(7, 1).setIdentity();
  Eigen::Matrix<double, 10, 10> both = Eigen::Matrix<double, 10, 10>::Zero();
  both.topLeftCorner<4, 4>() = force.covariance;
  both.bottomRightCorner<6, 6>() = moment.covariance;
  estimate.covariance = T * both * T.transpose();

  Wrench squares;
  for (const ToolSample& sample : samples)
    squares += (sample.wrench - RestingWrench(estimate.tool, sample.rotation, gravity)).cwiseAbs2();
  estimate.residual = (squares / static_cast<double>(samples.size())).cwiseSqrt();
  return estimate;
}

}  // namespace pliant
