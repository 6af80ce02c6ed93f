#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"
#include "pliant/systems/random.h"

namespace pliant {

/// A six-axis force and torque sensor in an arm. Through its sensing plane goes what acts on the
/// links beyond it, less what moves them; about the origin o of its frame, contacts (p, F, N) and
/// links with mass m, centre c and inertia I about c:
///
///   f_l = m (γ − c̈),   n_l = (c − o) × f_l − (I ω̇ + ω × I ω)
///   W = [ Σ N + (p − o) × F + Σ n_l;  Σ F + Σ f_l ]
///
/// turned into the sensor's axes. It is the wrench of the environment on the robot: a tool at rest
/// shows its weight, pointing down; a link beyond adds −Jᵀ W to the torques that move the arm.
///
/// Every h, and held:
///
///   y_k = y_{k−1} + α (W_k − y_{k−1}),   α = 1 − exp(−2π f h),   y_0 = W_0
///   wrench_k = clamp(y_{k−n} + b + σ ∘ ξ_k, ±range),   ξ_k ~ N(0, I)
///
/// ξ_k is a function of the seed and k. Before the start the arm was as it is then: y_{−n} = y_0.
/// With n ≥ 1 the reading does not depend on the acceleration of its own tick, which a controller
/// may decide.
///
/// Source: Newton–Euler equations, as in Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 2.
class WristSensor final : public Block {
 public:
  struct Options {
    RobotModel model;                      ///< of the plant: its links have the masses
    std::string frame;                     ///< link whose frame is the sensor's
    std::vector<std::string> beyond = {};  ///< links past the sensing plane; empty: `frame` alone
    Duration period = 1ms;                 ///< h
    Duration delay = {};                   ///< n h, from the load to the reading; n ≤ 1000
    Wrench noise = {};                     ///< σ, each ≥ 0
    Wrench bias = {};                      ///< b
    Wrench range = {};                     ///< largest reading, each ≥ 0; 0: any
    double cutoff_hz = 0;                  ///< f ≥ 0; 0: no filter, y = W
    std::uint64_t seed = 0;
  };

  explicit WristSensor(const Options& o);

  Input<RobotDynamics> motion;  ///< of the plant; needs no frames
  Input<JointAcceleration> acceleration;
  InputList<ContactForce> contacts;  ///< those on links beyond are felt
  Output<Wrench> wrench;             ///< as measured
  Output<Wrench> true_wrench;        ///< W, at every instant

 private:
  Wrench Load(const RobotDynamics& d, const JointAcceleration& vdot,
              const Joined<ContactForce>& contacts) const;
  Wrench Filter(const Wrench& last, const Wrench& W, double t) const;
  Wrench Read(const Wrench& y, double t) const;

  const RobotModel model_;
  const int link_;
  const std::vector<int> beyond_;
  const double h_, alpha_;
  const Wrench sigma_, bias_, range_;
  const RandomStream random_;
  Output<Wrench> filtered_;            // y
  std::deque<Discrete<Wrench>> past_;  // y of 1, 2, …, n ticks ago
};

/// A Bota SensONE at 1 kHz on a Gen3, in the frame FT_sensor_wrench of its model: σ = 0.0037,
/// 0.0037, 0.0013 N·m and 0.16 N, n h = 2 ms, b uniform within ±0.1 N·m and ±3 N as the seed
/// decides.
///
/// σ is the data sheet's noise-free resolution, six deviations wide at 100 Hz, at ten times the
/// rate. The delay is that of the digital filter, 1.5 × 51 samples at 51.2 kHz, and of the
/// transport, rounded up. The ranges are those of the sister sensor Rokubi: 15, 15, 12 N·m; 500,
/// 500, 1200 N. The size of b is a guess: it differs from start to start and is what a tare
/// removes.
WristSensor::Options SensOne(const RobotModel& model, std::uint64_t seed);

}  // namespace pliant
