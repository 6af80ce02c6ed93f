#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/estimators/tool_compensation.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/composite.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Where a controller has τ̂_e from.
enum class TorqueEstimate {
  True,                 ///< the environment's, as only a simulation knows it
  Observer,             ///< momentum observer
  SuperTwisting,        ///< sliding-mode momentum observer
  Fusion,               ///< momentum observer and wrist sensor, complementary
  SuperTwistingFusion,  ///< wrist sensor, and a sliding mode for the rest
  Sensor,               ///< wrist sensor alone: for arms that do not sense their joints' torques
  Zero,                 ///< nowhere: it is taken for 0
};

inline const std::vector<std::string>& Words(TorqueEstimate) {
  static const std::vector<std::string> words{
      "true", "observer", "super_twisting", "fusion", "super_twisting_fusion", "sensor", "zero"};
  return words;
}

/// A wrist sensor, and what hangs on it.
struct WristTool {
  std::string frame;         ///< link whose frame is the sensor's
  ToolParameters tool = {};  ///< its weight and the sensor's offset
};

/// The external torque, one way or another:
///
///   dynamics, torque ─▶ observer ─▶ residual ───▶ fusion ─▶ external_torque
///   wrench ─▶ tool ─▶ contact ─▶ wrist ─▶ τ_s ─────┘
///
/// While the wrench is not valid `contact` is 0 and the fusions give what their observer says
/// alone; the estimate Sensor, which has none, gives 0. When it is valid again the fusions go on
/// without a jump.
class ExternalTorqueEstimate final : public Composite {
 public:
  struct Options {
    RobotModel model;
    PerJoint rotor_inertia = {};  ///< B in `dynamics` but not in τ [kg·m²]; empty: none
    Duration period;
    TorqueEstimate estimate = TorqueEstimate::Observer;
    double gain = 50;                     ///< K_I [1/s]
    double rate = 500;                    ///< L [N·m/s], of the sliding modes
    std::optional<WristTool> wrist = {};  ///< which the fusions need
  };

  explicit ExternalTorqueEstimate(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> torque;            ///< τ, as measured
  Input<JointTorque> true_torque;       ///< τ_e; 0 if not connected
  Input<Wrench> wrench;                 ///< as measured at the wrist; 0 if not connected
  Input<bool> wrench_valid;             ///< true if not connected
  Output<JointTorque> external_torque;  ///< τ̂_e
  Output<JointTorque> residual;         ///< of the observer; 0 without one
  Output<Wrench> contact;               ///< at the wrist, without the tool; 0 without a reading
};

}  // namespace pliant
