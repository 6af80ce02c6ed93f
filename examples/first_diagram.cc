// A joint on a spring: one block of our own, one ready-made, and the wires between them.

#include <iostream>

#include "pliant/systems/diagram.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/simulator.h"

using namespace pliant;

/// A joint with inertia m and viscous friction d:   q̇ = v,   m v̇ = τ − d v
class Joint final : public Block {
 public:
  struct Options {
    Joints joints;
    double m, d;  ///< [kg·m²], [N·m·s/rad]
  };

  explicit Joint(const Options& o)
      : torque{this, "torque", o.joints},
        position{this, "position", o.joints},
        q_{this, "q", o.joints, {0.5}},
        v_{this, "v", o.joints},
        m_{o.m},
        d_{o.d} {
    Derivative(q_).From(v_).As([](const JointVelocity& v) { return v; });
    Derivative(v_).From(v_, torque).As(&Joint::Accelerate);
    Compute(position).From(q_).As([](const JointPosition& q) { return q; });
  }

  Input<JointTorque> torque;
  Output<JointPosition> position;

 private:
  JointAcceleration Accelerate(const JointVelocity& v, const JointTorque& tau) const {
    return (tau - d_ * v) / m_;
  }

  Continuous<JointPosition> q_;
  Continuous<JointVelocity> v_;
  const double m_, d_;
};

// shown: begin
int main() {
  const Joints joints{"elbow"};
  DiagramBuilder b;
  auto& arm = b.Add<Joint>("arm", {.joints = joints, .m = 1, .d = 2});
  auto& spring = b.Add<Gain<JointPosition, JointTorque>>(
      "spring", {.space = joints, .gain = -101});  // N·m/rad
  b.Connect(arm.position, spring.u);
  b.Connect(spring.y, arm.torque);
  const Diagram diagram = b.Build();

  Simulator sim{diagram};
  for (const double t : {0.1, 0.2, 0.4, 0.8}) {
    sim.AdvanceTo(t);
    std::cout << "t = " << t << " s   q = " << sim.Get(arm.position) << " rad\n";
  }
}
// shown: end
