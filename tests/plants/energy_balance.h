#pragma once

#include <algorithm>
#include <string>

#include "pliant/plants/robot_model.h"
#include "pliant/plants/simbody_plant.h"
#include "pliant/systems/block.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"

namespace pliant {

/// What must not change: Σ energy + ∫ (Σ dissipation − Σ power) dt.
class EnergyBalance final : public Block {
 public:
  struct Options {};

  explicit EnergyBalance(const Options&)
      : energy{this, "energy"},
        dissipation{this, "dissipation"},
        power{this, "power"},
        stored{this, "stored"},
        total{this, "total"},
        least_dissipation{this, "least_dissipation"},
        lost_{this, "lost"} {
    using Terms = Joined<double>;
    Compute(stored).From(energy).As([](const Terms& terms) { return Sum(terms); });
    Compute(total).From(stored, lost_).As([](double E, double lost) { return E + lost; });
    Compute(least_dissipation).From(dissipation).As([](const Terms& terms) {
      double least = terms[0];
      for (int i = 1; i < terms.size(); ++i) least = std::min(least, terms[i]);
      return least;
    });
    Derivative(lost_).From(dissipation, power).As([](const Terms& out, const Terms& in) {
      return Sum(out) - Sum(in);
    });
  }

  InputList<double> energy, dissipation, power;
  Output<double> stored, total, least_dissipation;

 private:
  static double Sum(const Joined<double>& terms) {
    double sum = 0;
    for (int i = 0; i < terms.size(); ++i) sum += terms[i];
    return sum;
  }

  Continuous<double> lost_;
};

/// A point mass that three prismatic joints x, y, z let move freely, a "tip" on it.
inline RobotModel Gantry(double mass) {
  const auto slide = [](const std::string& axis, const std::string& parent,
                        const std::string& child, const std::string& xyz) {
    return "<joint name=\"" + axis + "\" type=\"prismatic\"><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/><axis xyz=\"" + xyz +
           "\"/><limit lower=\"-1\" upper=\"1.5\" velocity=\"9\" effort=\"99\"/></joint>\n";
  };
  return RobotModel::FromUrdfText(
      "<robot name=\"gantry\"><link name=\"ground\"/><link name=\"beam\"/><link name=\"cart\"/>\n"
      "<link name=\"tip\"><inertial><mass value=\"" +
      Text(mass) +
      "\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/>"
      "</inertial></link>\n" +
      slide("x", "ground", "beam", "1 0 0") + slide("y", "beam", "cart", "0 1 0") +
      slide("z", "cart", "tip", "0 0 1") + "</robot>\n");
}

/// A plant by the recursive engine, its torque a constant, and the balance of its energy.
struct Scene {
  explicit Scene(const SimbodyPlant::Options& o)
      : plant{b.Add<SimbodyPlant>("plant", Recursive(o))},
        torque{b.Add<Constant<JointTorque>>(
            "torque", {.space = o.model.joints(), .value = JointTorque::Zero(o.model.joints())})},
        balance{b.Add<EnergyBalance>("balance", EnergyBalance::Options{})} {
    b.Connect(torque.y, plant.torque);
    b.Connect(plant.energy, balance.energy);
    b.Connect(plant.dissipation, balance.dissipation);
  }

  static SimbodyPlant::Options Recursive(SimbodyPlant::Options o) {
    o.engine = SimbodyPlant::Engine::Recursive;
    return o;
  }

  /// Adds a block that reads the plant's motion and pushes on it.
  template <class T>
  T& AddContact(const std::string& name, const typename T::Options& o) {
    T& block = b.Add<T>(name, o);
    b.Connect(plant.motion, block.motion);
    b.Connect(block.contact, plant.contacts);
    b.Connect(block.energy, balance.energy);
    b.Connect(block.dissipation, balance.dissipation);
    if constexpr (requires { block.power; }) b.Connect(block.power, balance.power);
    return block;
  }

  DiagramBuilder b;
  SimbodyPlant& plant;
  Constant<JointTorque>& torque;
  EnergyBalance& balance;
};

/// Steps short enough for the cubic between them, which also gives the state at a guard.
inline const Simulator::Options kAccurately{.integrator = {.method = Method::kDormandPrince,
                                                           .relative_tolerance = 1e-11,
                                                           .absolute_tolerance = 1e-12,
                                                           .max_step_s = 5e-4}};

/// Gravity of the models [m/s²].
inline constexpr double kGravity = 9.80665;

}  // namespace pliant
