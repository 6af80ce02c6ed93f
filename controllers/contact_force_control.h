#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "pliant/controllers/contact_anchor.h"
#include "pliant/controllers/contact_inertia.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What a force control does at a place.
enum class ContactForceStatus : std::uint8_t {
  Idle,        ///< no point has been touched
  Regulating,  ///< the force
  Holding,     ///< the point where it was released
  TooFast,     ///< the guard stopped it for its speed: holds the point where that was
  TooFar,      ///< the guard stopped it for its way: the same
};

inline const std::vector<std::string>& Words(ContactForceStatus) {
  static const std::vector<std::string> words{"idle", "regulating", "holding", "too_fast",
                                              "too_far"};
  return words;
}

/// F_d, the same all the time.
struct FixedForce {
  static constexpr const char* kTag = "Fixed";

  Eigen::Vector3d force = Eigen::Vector3d::Constant(kToBeGiven);  ///< world axes [N]

  template <class F>
  void Parameters(F&& f) {
    f("force", force, "N");
  }
};

/// A force of a given size in the direction in which the arm is pushed,
///
///   F_d = F̄ F̂ / max(‖F̂‖, F_0)
///
/// so that it asks for nothing where there is nothing to press against. Below F_0, where noise has
/// no direction, F_d falls to 0 with F̂.
struct CompatibleForce {
  static constexpr const char* kTag = "Compatible";

  double force = 15;  ///< F̄ [N]
  double floor = 3;   ///< F_0 [N]

  template <class F>
  void Parameters(F&& f) {
    f("force", force, "N", kNotNegative);
    f("floor", floor, "N", kPositive);
  }
};

/// The force at a touched point is brought to F_d:
///
///   M_d ẍ_c + K_d ẋ_c = K_f (F̂ − F_d)                                       (CF 27, sign mended)
///
/// as a term of three rows, J_c q̈ = M_d⁻¹ (K_f (F̂ − F_d) − K_d ẋ_c) − J̇_c q̇. F̂ and F_d are of the
/// environment on the arm: pushed harder than wanted it retreats, pushed less it follows. CF prints
/// K_f (F_d − F̂), which is right of the force of the arm on the environment and, of this one, flees
/// from a weak push: for a spring of k_e the loop would be m s² + k_d s − k_f k_e. As it is, with
/// F̂ = K_I/(s + K_I) F of an observer,
///
///   m s³ + (m K_I + k_d) s² + k_d K_I s + k_f k_e K_I = 0
///   stable for  k_e < k_d (K_I + k_d/m)/k_f
///
/// so soft hands are held well and stiff ones are not; a hand's own damping helps.
///
/// Regulation starts when the contact begins and ends with it. Then, the point is held where it is,
///
///   M_d ẍ_c = K_h (x_h − x_c) − D_h ẋ_c + F̂
///
/// Where nobody presses back against a wanted force, the arm runs away along it. So does it,
/// without being asked, with an F̂ that is wrong. A guard ends that: from a tick at which the point
/// is faster than `speed_limit` or further than `way_limit` from where regulation began, the point
/// is held there, until it is let go and touched again. `status` says so. Either limit may be
/// kUnbounded.
///
/// Sampled every h. Source: Magrini, Flacco & De Luca 2015 (CF), IV-B, V-D.
class ContactForceControl final : public Block {
 public:
  struct Settings {
    static constexpr const char* kTag = "Force";

    std::variant<FixedForce, CompatibleForce> wanted = CompatibleForce{};
    TaskMatrix inertia = {};  ///< M_d, as ContactInertia has it; empty: the natural one
    /// K_d [N·s/m], a number, a diagonal or a matrix, ⪰ 0
    TaskMatrix damping = TaskMatrix::Constant(1, 1, 10.5);
    TaskMatrix force_gain = TaskMatrix::Constant(1, 1, 4.1);      ///< K_f, the same way
    TaskMatrix hold_stiffness = TaskMatrix::Constant(1, 1, 500);  ///< K_h [N/m], the same way
    TaskMatrix hold_damping = TaskMatrix::Constant(1, 1, 80);     ///< D_h [N·s/m], the same way
    double speed_limit = 0.5;                                     ///< [m/s]
    double way_limit = 0.3;                                       ///< [m]

    template <class F>
    void Parameters(F&& f) {
      f("wanted", wanted);
      f("inertia", inertia);
      f("damping", damping);
      f("force_gain", force_gain);
      f("hold_stiffness", hold_stiffness);
      f("hold_damping", hold_damping);
      f("speed_limit", speed_limit, "m/s", kLimit);
      f("way_limit", way_limit, "m", kLimit);
    }
  };
  struct Options {
    RobotModel model;
    Duration period;
    Settings settings;
    double weight = 1;  ///< of the term, > 0
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    ContactForceStatus status = ContactForceStatus::Idle;
    Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< where regulation began [m]
    Eigen::Vector3d hold = Eigen::Vector3d::Zero();   ///< x_h [m]

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("status", status, "");
      f("start", start, "m");
      f("hold", hold, "m");
    }
  };

  explicit ContactForceControl(const Options& o);

  Input<AnchoredContact> contact;
  Input<RobotDynamics> dynamics;
  Output<ContactForceStatus> status;
  Output<Force> wanted;  ///< F_d; 0 unless it regulates
  Output<Objective> objective;

 private:
  Memory Next(const Memory& last, const AnchoredContact& c, const RobotDynamics& d) const;
  Force Wanted(const Memory& m, const AnchoredContact& c) const;
  void Want(Objective& out, const Memory& m, const AnchoredContact& c, const RobotDynamics& d,
            const Force& F_d) const;

  const RobotModel model_;
  const Settings settings_;
  const ContactInertia inertia_;
  const Eigen::Matrix3d K_d_, K_f_, K_h_, D_h_;
  const double weight_;
  Output<Memory> memory_;
};

}  // namespace pliant
