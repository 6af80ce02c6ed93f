#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "pliant/controllers/compliance_qp.h"
#include "pliant/controllers/external_acceleration.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/controllers/virtual_door.h"
#include "pliant/diagrams/simulated_arm.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/push.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"

// An ideal Gen3 that holds the handle of a virtual door, at 1 kHz.
//
// What disturbs the handle is the push that the controller does not know, τ_e − τ̂_e, and that a
// torque is held for a sample: it is late by half of its change. A critically damped task answers
// a disturbance a with no more than a/λ₂, since its impulse response t e^{−½λ₁t} is positive.
namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod = 1e-3;
const std::string kTool = "tool_frame";
const JointPosition kHome{0, 0.2618, 3.1416, -2.2689, 0, 0.9599, 1.5708};

/// Γ = Y Λ, for a task that takes no mobility itself.
class MobilityAsCompliance final : public Block {
 public:
  struct Options {
    Joints joints;
  };
  explicit MobilityAsCompliance(const Options& o)
      : frame{this, "frame"},
        dynamics{this, "dynamics", o.joints},
        mobility{this, "mobility", {}, TaskMatrix::Zero(6, 6)},
        compliance{this, "compliance", {}, TaskMatrix::Zero(6, 6)} {
    Compute(compliance)
        .From(mobility, frame, dynamics)
        .As([](const TaskMatrix& Y, const FrameDynamics& f, const RobotDynamics& d) {
          const Eigen::MatrixXd J = f.J;
          const Eigen::MatrixXd K = J * d.M.llt().solve(J.transpose());
          return TaskMatrix(Y * K.inverse());
        });
  }
  Input<FrameDynamics> frame;
  Input<RobotDynamics> dynamics;
  Input<TaskMatrix> mobility;
  Output<TaskMatrix> compliance;
};

template <class Task>
void LendMobility(DiagramBuilder& b, VirtualDoor& door, ModelDynamics& dynamics, Task& task) {
  if constexpr (requires { task.mobility; }) {
    b.Connect(door.mobility, task.mobility);
  } else {
    auto& adapter = b.Add<MobilityAsCompliance>("adapter", {.joints = Gen3().joints()});
    b.Connect(door.mobility, adapter.mobility);
    b.Connect(task.frame, adapter.frame);
    b.Connect(dynamics.dynamics, adapter.dynamics);
    b.Connect(adapter.compliance, task.compliance);
  }
}

Pose ToolAtHome() {
  const RobotModel m = Gen3();
  RobotDynamics d(m);
  ComputeDynamics(m, kHome, JointVelocity::Zero(m.joints()), d);
  return LinkPose(m, d, m.link_index(kTool));
}

/// An upright hinge 0.4 m to the left of the tool.
VirtualDoor::Options Door(double inertia) {
  VirtualDoor::Options o;
  o.joints = Gen3().joints();
  o.closed = ToolAtHome();
  o.hinge = o.closed.position + Vector3d(0, 0.4, 0);
  o.axis = {0, 0, 1};
  o.inertia = inertia;
  return o;
}

Push::Options PushOf(const Vector3d& force, double duration) {
  return {.model = Gen3(),
          .link = kTool,
          .force = force,
          .start_s = 0.1,
          .duration_s = duration,
          .edge_s = 0.1};
}

constexpr double kStiffness = 400, kDamping = 40;  // λ₂ = ¼ λ₁²

enum class Estimate { True, Observed };

struct Rig {
  Rig(const VirtualDoor::Options& o, const Push::Options& pushed, Estimate estimate) {
    const RobotModel m = Gen3();
    const Joints& joints = m.joints();
    DiagramBuilder b;
    auto& push = b.Add<Push>("push", pushed);
    auto& arm = b.Add<SimulatedArm>(
        "arm", {.model = m, .position = kHome, .engine = SimbodyPlant::Engine::Recursive});
    dynamics = &b.Add<ModelDynamics>("dynamics", {.model = m});
    truth = &b.Add<ContactTorque>("truth", {.model = m});
    auto& observer = b.Add<MomentumObserver>(
        "observer", {.joints = joints, .gain = PerJoint::Constant(7, 100), .period = 1ms});
    auto& external = b.Add<ExternalAcceleration>("external", {.joints = joints});
    door = &b.Add<VirtualDoor>("door", o);
    task = &b.Add<FrameTask>("task", {.model = m,
                                      .frame = kTool,
                                      .target = o.closed,
                                      .stiffness = TaskVector::Constant(6, kStiffness),
                                      .damping = TaskVector::Constant(6, kDamping),
                                      .weight = 1e4});
    auto& posture = b.Add<PostureTask>("posture", {.model = m,
                                                   .target = kHome,
                                                   .stiffness = PerJoint::Constant(7, 1),
                                                   .damping = PerJoint::Constant(7, 5),
                                                   .weight = 1e-3});
    qp = &b.Add<ComplianceQp>("qp", {.model = m, .period = 1ms});

    b.Connect(push.force, arm.contacts);
    b.Connect(push.force, truth->contacts);
    b.Connect(arm.measured_position, dynamics->position);
    b.Connect(arm.measured_velocity, dynamics->velocity);
    b.Connect(dynamics->dynamics, truth->dynamics);
    b.Connect(dynamics->dynamics, observer.dynamics);
    b.Connect(arm.measured_torque, observer.torque);
    tau_e = estimate == Estimate::True ? &truth->torque : &observer.residual;
    b.Connect(dynamics->dynamics, external.dynamics);
    b.Connect(*tau_e, external.external_torque);
    b.Connect(dynamics->dynamics, task->dynamics);
    b.Connect(external.acceleration, task->external_acceleration);
    b.Connect(task->frame, door->frame);
    b.Connect(dynamics->dynamics, door->dynamics);
    b.Connect(external.acceleration, door->external_acceleration);
    b.Connect(door->pose, task->target);
    b.Connect(door->twist, task->target_twist);
    b.Connect(door->acceleration, task->target_acceleration);
    LendMobility(b, *door, *dynamics, *task);
    b.Connect(dynamics->dynamics, posture.dynamics);
    b.Connect(dynamics->dynamics, qp->dynamics);
    b.Connect(*tau_e, qp->external_torque);
    b.Connect(task->objective, qp->objectives);
    b.Connect(posture.objective, qp->objectives);
    b.Connect(qp->torque, arm.torque_command);
    diagram.emplace(b.Build());
    sim.emplace(*diagram);
  }

  /// A tick.
  DoorMotion Tick() {
    sim->AdvanceThroughTick();
    const JointTorque tau = sim->Get(qp->torque);
    const PerJoint unknown = sim->Get(truth->torque) - sim->Get(*tau_e);
    const PerJoint late = last.size() > 0 ? PerJoint(0.5 * (tau - last)) : PerJoint::Zero(7);
    last = tau;
    const Eigen::LLT<Eigen::MatrixXd> M(sim->Get(dynamics->dynamics).M);
    const Jacobian& J = sim->Get(task->frame).J;
    error = std::max(error, sim->Get(task->error).norm());
    disturbance = std::max(disturbance, (J * M.solve(unknown)).norm() + (J * M.solve(late)).norm());
    return sim->Get(door->door);
  }

  VirtualDoor* door;
  FrameTask* task;
  ModelDynamics* dynamics;
  ContactTorque* truth;
  ComplianceQp* qp;
  const Output<JointTorque>* tau_e;
  std::optional<Diagram> diagram;
  std::optional<Simulator> sim;
  PerJoint last;           // torque
  double error = 0;        // the largest
  double disturbance = 0;  // of the handle's acceleration, the largest
};

/// About the hinge, of the force on the handle of a door at θ.
double MomentOf(const VirtualDoor::Options& o, const Push::Options& push, double t, double theta) {
  const double T = push.duration_s, s = t - push.start_s;
  const double edge = std::clamp(std::min(s, T - s) / push.edge_s, 0.0, 1.0);
  const Vector3d n = o.axis.normalized();
  const Vector3d r = Eigen::AngleAxisd(theta, n) * Vector3d(o.closed.position - o.hinge);
  return 0.5 * (1 - std::cos(std::numbers::pi * edge)) * n.dot(r.cross(push.force));
}

/// I θ̈ = τ_e(t, θ) + τ(θ, θ̇), by Runge and Kutta with a tenth of a period; θ at the ticks.
std::vector<double> Expected(const VirtualDoor::Options& o, const Push::Options& push, int ticks,
                             const std::function<double(double, double)>& torque) {
  Eigen::Vector2d x(0, 0);
  const auto rate = [&](double t, const Eigen::Vector2d& y) {
    return Eigen::Vector2d(y(1), (MomentOf(o, push, t, y(0)) + torque(y(0), y(1))) / o.inertia);
  };
  std::vector<double> angles;
  const double h = kPeriod / 10;
  for (int k = 0; k < ticks; ++k) {
    angles.push_back(x(0));
    for (int i = 0; i < 10; ++i) {
      const double t = k * kPeriod + i * h;
      const Eigen::Vector2d a = rate(t, x), b = rate(t + h / 2, x + h / 2 * a),
                            c = rate(t + h / 2, x + h / 2 * b), d = rate(t + h, x + h * c);
      x += h / 6 * (a + 2 * b + 2 * c + d);
    }
  }
  return angles;
}

/// The inertia that the impulse about the hinge and the change of rate show, while pushed.
double Identified(Rig& rig, const VirtualDoor::Options& o, const Push::Options& push) {
  double impulse = 0, rate = 0;
  for (int k = 0; k < 800; ++k) {
    const DoorMotion now = rig.Tick();
    impulse += kPeriod * MomentOf(o, push, k * kPeriod, now.angle);
    rate = now.rate;
  }
  return impulse / rate;
}

// A tick's acceleration is held for a sample: θ̇ is late by ½ h θ̈, θ by ½ h θ̇.
TEST(VirtualDoorLoop, MovesTheHandleWithTheInertiaAskedFor) {
  for (const double inertia : {0.5, 2.0, 8.0}) {
    const VirtualDoor::Options o = Door(inertia);
    const Push::Options push = PushOf({2 * inertia, -3, 4}, 0.6);
    Rig rig(o, push, Estimate::True);
    const std::vector<double> expected =
        Expected(o, push, 1000, [](double, double) { return 0.0; });
    double worst = 0, rate = 0, acceleration = 0;
    for (const double theta : expected) {
      const DoorMotion now = rig.Tick();
      worst = std::max(worst, std::abs(now.angle - theta));
      rate = std::max(rate, std::abs(now.rate));
      acceleration = std::max(acceleration, std::abs(now.acceleration));
    }
    EXPECT_GT(expected.back(), 0.2) << inertia;
    EXPECT_LT(worst, 0.5 * kPeriod * (rate + acceleration)) << inertia;  // of one second
    EXPECT_LE(rig.error, rig.disturbance / kStiffness) << inertia;
    Rig again(o, push, Estimate::True);
    EXPECT_NEAR(Identified(again, o, push) / inertia, 1, 0.01);
  }
}

TEST(VirtualDoorLoop, FollowsItsCloserAndViscousFriction) {
  VirtualDoor::Options o = Door(2);
  o.closer = 6;
  o.rest_angle = 0.1;
  o.viscous = 1.5;
  const Push::Options push = PushOf({9, -2, 1}, 0.8);
  Rig rig(o, push, Estimate::True);
  const std::vector<double> expected = Expected(o, push, 3000, [&](double theta, double rate) {
    return -o.closer * (theta - o.rest_angle) - o.viscous * rate;
  });
  double worst = 0, most = 0;
  for (const double theta : expected) {
    worst = std::max(worst, std::abs(rig.Tick().angle - theta));
    most = std::max(most, std::abs(theta));
  }
  EXPECT_GT(most, 0.3);
  // Late by half a sample: the damping of the swing changes by h ω²/2, and its phase.
  EXPECT_LT(worst, 0.01 * most);
  EXPECT_LE(rig.error, rig.disturbance / kStiffness);
}

TEST(VirtualDoorLoop, IsStiffAcrossItsCircle) {
  const VirtualDoor::Options o = Door(2);
  // toward the hinge, and along its axis
  for (const Vector3d& force : {Vector3d(0, 25, 0), Vector3d(0, 0, 25)}) {
    Rig rig(o, PushOf(force, 0.6), Estimate::True);
    double most = 0;
    for (int k = 0; k < 800; ++k) most = std::max(most, std::abs(rig.Tick().angle));
    EXPECT_LT(most, 1e-6);  // round-off and the integrator's tolerance
    EXPECT_LT(rig.error, 1e-6);
  }
}

TEST(VirtualDoorLoop, SticksUntilItIsPushedHarderThanItsFriction) {
  VirtualDoor::Options o = Door(2);
  o.coulomb = 3;
  for (const double moment : {2.5, 4.0}) {
    const Push::Options push = PushOf({moment / 0.4, 0, 0}, 0.6);
    Rig rig(o, push, Estimate::True);
    DoorMotion now;
    for (int k = 0; k < 1500; ++k) now = rig.Tick();
    if (moment < o.coulomb) {
      EXPECT_LT(std::abs(now.angle), 1e-6);
    } else {
      // ½ I θ̇² of the push is spent on the way
      EXPECT_GT(now.angle, 0.01);
      EXPECT_LT(std::abs(now.rate), 1e-5) << "and it stops again";
    }
  }
}

// With K = 100 /s the estimate lags by 10 ms, and what is not known yet is not let through.
TEST(VirtualDoorLoop, ShowsTheInertiaAskedForWithAnObserver) {
  for (const double inertia : {1.0, 4.0}) {
    const VirtualDoor::Options o = Door(inertia);
    const Push::Options push = PushOf({2 * inertia, -3, 4}, 0.6);
    Rig rig(o, push, Estimate::Observed);
    EXPECT_NEAR(Identified(rig, o, push) / inertia, 1, 0.05);
    EXPECT_LE(rig.error, rig.disturbance / kStiffness);
  }
}

}  // namespace
}  // namespace pliant
