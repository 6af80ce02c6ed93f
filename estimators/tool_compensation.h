#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What a wrist sensor shows while nothing touches the tool: the tool's weight and its own offset.
struct ToolParameters {
  using Space = Nothing;
  static constexpr Quantity quantity{"tool parameters", ""};

  double mass = 0;                                   ///< m, beyond the sensing plane [kg]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< c, of the mass, in the sensor's frame [m]
  Wrench bias;                                       ///< b

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("mass", mass, "kg");
    f("center", center, "m");
    f("bias", bias, "N·m, N");
  }
};

/// The reading at rest, in the sensor's frame S, of a tool in gravity γ (world axes):
///
///   W_0 = [m c × R_WSᵀ γ;  m R_WSᵀ γ] + b
Wrench RestingWrench(const ToolParameters& tool, const Eigen::Matrix3d& R_WS,
                     const Eigen::Vector3d& gravity);

/// What touches the tool: the reading of a wrist sensor without the tool's weight and the offset,
///
///   W_e = W − W_0,
///
/// in the sensor's frame. What moves the tool, m c̈ and I ω̇, is left in it. While the reading is
/// not valid W_e = 0, whatever W is.
class ToolCompensation final : public Block {
 public:
  struct Options {
    RobotModel model;
    std::string frame;         ///< link whose frame is the sensor's
    ToolParameters tool = {};  ///< until one is connected
  };

  explicit ToolCompensation(const Options& o);

  Input<Wrench> measured;
  Input<bool> measured_valid;  ///< true if not connected
  Input<RobotDynamics> dynamics;
  Input<ToolParameters> tool;
  Output<Wrench> contact;

 private:
  Wrench Compensate(const Wrench& W, bool valid, const RobotDynamics& d,
                    const ToolParameters& tool) const;

  const RobotModel model_;
  const int link_;
};

/// A reading of a wrist sensor that rests in some orientation and is touched by nothing.
struct ToolSample {
  Eigen::Matrix3d rotation;  ///< R_WS
  Wrench wrench;
};

/// The tool that explains samples, and how well they tell it.
struct ToolEstimate {
  ToolParameters tool;
  /// Of (m, c, b), where the samples' noise is white and c is linearised about the estimate. The
  /// square roots of its diagonal are the standard deviations.
  Eigen::Matrix<double, 10, 10> covariance;
  Wrench residual;   ///< root mean square of what the tool leaves unexplained
  double condition;  ///< of the worse of the two problems, mass and first moment; at best √1.5

  ToolParameters deviation() const;  ///< standard deviation of each figure
};

/// Finds m, c and b by least squares. Forces decide m and b_F, moments decide the first moment m c
/// and b_M; with γ_S = R_WSᵀ γ, over all samples
///
///   ‖ (F − m γ_S − b_F) / σ_F ‖² → min,   ‖ (M − (m c) × γ_S − b_M) / σ_M ‖² → min
///
/// The covariances are s² (Aᵀ A)⁻¹, with s² the mean square of the residuals per degree of freedom
/// of each problem: of `noise`, the σ of the elements, only the ratios within the moments and
/// within the forces matter.
///
/// At least three samples are needed, with different directions of gravity in the sensor's frame.
/// They are refused if the condition, at unit gravity, is above 100, which is where gravity stays
/// within a degree or two, and if they show no mass.
///
/// Source: Golub & Van Loan, Matrix Computations, 4th ed., sec. 5.3; Kubus, Kröger & Wahl, IROS
/// 2007 (the linear parametrisation).
ToolEstimate IdentifyTool(std::span<const ToolSample> samples, const Eigen::Vector3d& gravity,
                          const Wrench& noise = {1, 1, 1, 1, 1, 1});

}  // namespace pliant
