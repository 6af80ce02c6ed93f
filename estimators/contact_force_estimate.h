#pragma once

#include "pliant/plants/contacts.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// What of the forces at up to kMaxContacts points joints can feel. Rows 3i to 3i + 2 of a
/// direction belong to place i; what belongs to no contact is zero.
struct ContactObservability {
  static constexpr int kMaxRows = 3 * kMaxContacts;
  using Vector = Eigen::Matrix<double, kMaxRows, 1>;
  using Matrix = Eigen::Matrix<double, kMaxRows, kMaxRows>;

  using Space = Nothing;
  static constexpr Quantity quantity{"contact observability", ""};

  int rows = 0;                             ///< 3 for each contact
  int rank = 0;                             ///< how many of them are felt: σ_j ≥ σ₀
  double smallest = 0;                      ///< σ of the last row, 0 without a contact [m]
  Vector singular_values = Vector::Zero();  ///< σ_j, falling; of the rows there are [m]
  Matrix directions = Matrix::Zero();       ///< column j: the forces whose torque is σ_j for each
                                            ///< newton; from column `rank` on they are not observed

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("rows", rows, "");
    f("rank", rank, "");
    f("smallest", smallest, "m");
    f("singular_values", singular_values, "m");
    f("directions", directions, "");
  }
};

/// The forces at the points where an arm is touched, from the residual r of an observer: of all
/// that would explain r the smallest ones,
///
///   F̂ = (Jᵀ)^# r,   J = [J_1; J_2; …]                                                     (CF 7)
///
/// J_i is the 3×n Jacobian of the i-th point, translation only: fingers and palms exert no moment
/// worth its name. Only forces outside the null space of Jᵀ can be told. With the singular values
/// J = Σ σ_j u_j v_jᵀ
///
///   F̂ = Σ_j u_j v_jᵀ r / σ_j          for σ_j ≥ σ₀
///                   σ_j / σ₀² …        below, which falls to 0 with σ_j
///
/// so it is exact where all σ_j are 0 or at least σ₀, and it is continuous in between. σ is a lever
/// arm: an error of δ N·m in r becomes one of at most δ/σ₀ in F̂.
///
/// With several contacts it is exact if the joints can tell them apart: two on one link share the
/// six numbers of one wrench, and along the line between them only a sum is felt. Not touched,
/// there are no contacts. Contacts on links that the model does not have count as none.
///
/// Source: Magrini, Flacco & De Luca 2015 (CF); Magrini, Flacco & De Luca, IROS 2014.
class ContactForceEstimate final : public Block {
 public:
  struct Options {
    RobotModel model;
    Duration period;
    double smallest_lever = 0.05;  ///< σ₀ [m], > 0
  };

  /// All of one tick.
  struct Solution {
    Contacts contacts;
    ContactObservability observability;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("contacts", contacts, "");
      f("observability", observability, "");
    }
  };

  explicit ContactForceEstimate(const Options& o);

  Input<Contacts> places;  ///< links and points; their forces are not read
  Input<RobotDynamics> dynamics;
  Input<JointTorque> residual;  ///< r
  Input<bool> touched;          ///< yes if not connected
  Output<Contacts> contacts;    ///< places with F̂
  Output<ContactObservability> observability;
  Output<JointTorque> explained;  ///< Jᵀ F̂, what of r the contacts account for

 private:
  Solution Solve(const Contacts& places, const RobotDynamics& d, const JointTorque& r,
                 const bool& touched) const;
  JointTorque Explain(const Contacts& contacts, const RobotDynamics& d) const;

  const RobotModel model_;
  const double sigma_;
  Output<Solution> solution_;
};

}  // namespace pliant
