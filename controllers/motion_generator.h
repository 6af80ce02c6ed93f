#pragma once

#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// p − p_d: how far a point is from the path it is to be on.
struct PathError : Signal<PathError, Frame, 3> {
  using Signal::Signal;
  static constexpr Quantity quantity{"path error", "m"};
};

/// How fast a point is to move, by where it is and not by when:
///
///   ṗ̃_d = f(p, ṗ)
///
/// Held or led away and let go, it goes on from where it is. World axes.
///
/// Source: Khoramshahi et al., IROS 2018; Yang, Wang & Kermani 2025 (NS), (3) and (4).
class MotionGenerator : public Block {
 public:
  Input<Position> position{this, "position"};        ///< p
  Input<LinearVelocity> velocity{this, "velocity"};  ///< ṗ
  Output<LinearVelocity> desired{this, "desired"};   ///< ṗ̃_d
  Output<Position> nearest{this, "nearest"};         ///< p_d, the point of the path that p goes by
  Output<PathError> path_error{this, "path_error"};  ///< p − p_d

 protected:
  MotionGenerator();
};

/// Round a circle of radius ε_d about O_d, in a horizontal plane:
///
///   Δp = λ̄₁⁻¹ (p − O_d),   λ̄₁ = diag(λ₁, λ₁, 1),   λ₁ = ε_d/ε
///   ρ = ‖(Δp_x, Δp_y)‖,   δ = atan2(Δp_y, Δp_x)                                      (NS 16)
///   ρ̇ = k_ρ (ρ_d − ρ),   ρ_d = ε
///   ṗ̃_d = λ̄₁ [ρ̇ cos δ − ρ δ̇ sin δ;  ρ̇ sin δ + ρ δ̇ cos δ;  ż̃_d]                      (NS 17)
///   ż̃_d = k_P (z_d − z) − k_D ż                                                       (NS 18)
///
/// p_d is the point of the circle at the same angle δ. A point that follows ṗ̃_d exactly has
/// ρ(t) = ρ_d + (ρ(0) − ρ_d) e^{−k_ρ t}, and λ₁ drops out of ṗ̃_d.
///
/// At the centre every direction leads out, and none is nearer than another: there, δ = 0. So the
/// field is not continuous at the centre, where it turns from one side to the other with a length
/// of k_ρ ε_d; no field that leads out of a disc is.
///
/// Source: Yang, Wang & Kermani 2025 (NS).
class CircleGenerator final : public MotionGenerator {
 public:
  struct Options {
    static constexpr const char* kTag = "Circle";

    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< O_d [m]
    double radius = kToBeGiven;                        ///< ε_d [m]
    double template_radius = 0.1;                      ///< ε [m]
    double angular_velocity = kToBeGiven;              ///< δ̇ [rad/s], about +z
    double radial_gain = kToBeGiven;                   ///< k_ρ [1/s]
    double height_gain = kToBeGiven;                   ///< k_P [1/s]
    double height_damping = 0;                         ///< k_D

    template <class F>
    void Parameters(F&& f) {
      f("center", center, "m");
      f("radius", radius, "m", kPositive);
      f("template_radius", template_radius, "m", kPositive);
      f("angular_velocity", angular_velocity, "rad/s");
      f("radial_gain", radial_gain, "1/s", kPositive);
      f("height_gain", height_gain, "1/s", kPositive);
      f("height_damping", height_damping, "", kNotNegative);
    }
  };

  explicit CircleGenerator(const Options& o);

 private:
  LinearVelocity Desire(const Position& p, const LinearVelocity& v) const;
  Position Nearest(const Position& p) const;

  const Options o_;
};

/// One term of a Fourier series in an angle δ: c cos kδ + s sin kδ, k from 1 on.
struct Harmonic {
  double cosine = 0;  ///< c [m]
  double sine = 0;    ///< s [m]

  template <class F>
  void Parameters(F&& f) {
    f("cosine", cosine, "m");
    f("sine", sine, "m");
  }
};

/// Round a closed curve in a plane, star-shaped about its centre. With [x; y; z] = Rᵀ (p − O), z
/// along the plane's normal, and x = ρ cos δ, y = ρ sin δ:
///
///   ρ_d(δ) = r + Σ_k (c_k cos kδ + s_k sin kδ) > 0
///   ρ̇ = k_ρ (ρ_d(δ) − ρ) + ρ_d'(δ) δ̇
///   ṗ̃_d = R [ρ̇ cos δ − ρ δ̇ sin δ;  ρ̇ sin δ + ρ δ̇ cos δ;  −k_P z − k_D ż]
///
/// A point that follows ṗ̃_d exactly has ρ − ρ_d(δ) = (ρ(0) − ρ_d(δ(0))) e^{−k_ρ t}: the curve is a
/// limit cycle. Without harmonics it is a circle, CircleGenerator's where R = I. p_d is the point
/// of the curve at the same angle; at the centre, δ = 0.
class LimitCycleGenerator final : public MotionGenerator {
 public:
  struct Options {
    static constexpr const char* kTag = "LimitCycle";

    Eigen::Vector3d center = Eigen::Vector3d::Zero();    ///< O [m]
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< R, as columns: x, y and the normal
    double radius = kToBeGiven;                          ///< r [m]
    std::vector<Harmonic> harmonics = {};                ///< k = 1, 2, …
    double angular_velocity = kToBeGiven;                ///< δ̇ [rad/s]
    double radial_gain = kToBeGiven;                     ///< k_ρ [1/s]
    double height_gain = kToBeGiven;                     ///< k_P [1/s]
    double height_damping = 0;                           ///< k_D

    template <class F>
    void Parameters(F&& f) {
      f("center", center, "m");
      f("axes", axes);
      f("radius", radius, "m", kPositive);
      f("harmonics", harmonics);
      f("angular_velocity", angular_velocity, "rad/s");
      f("radial_gain", radial_gain, "1/s", kPositive);
      f("height_gain", height_gain, "1/s", kPositive);
      f("height_damping", height_damping, "", kNotNegative);
    }
  };

  /// Most harmonics of a curve.
  static constexpr int kMaxHarmonics = 16;

  explicit LimitCycleGenerator(const Options& o);

 private:
  struct Radius {
    double rho, slope;  // ρ_d, ρ_d'
  };
  Radius At(double delta) const;
  LinearVelocity Desire(const Position& p, const LinearVelocity& v) const;
  Position Nearest(const Position& p) const;

  const Options o_;
};

/// To a point, and there at rest:
///
///   u = −A (p − p_d),   ṗ̃_d = u/√(1 + ‖u‖²/v_max²),   A + Aᵀ ≻ 0
///
/// ½‖p − p_d‖² falls at every p but p_d, and ‖ṗ̃_d‖ < v_max.
class GoalGenerator final : public MotionGenerator {
 public:
  struct Options {
    static constexpr const char* kTag = "Goal";

    Eigen::Vector3d goal = Eigen::Vector3d::Constant(kToBeGiven);  ///< p_d [m]
    Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();            ///< A [1/s]
    double speed = kToBeGiven;                                     ///< v_max [m/s]

    template <class F>
    void Parameters(F&& f) {
      f("goal", goal, "m");
      f("gain", gain, "1/s");
      f("speed", speed, "m/s", kPositive);
    }
  };

  explicit GoalGenerator(const Options& o);

 private:
  LinearVelocity Desire(const Position& p, const LinearVelocity& v) const;
  Position Nearest(const Position& p) const;

  const Options o_;
};

}  // namespace pliant
