#include "pliant/plants/simbody_arm.h"

#include "pliant/plants/simbody.h"

#include <Eigen/Cholesky>
#include <array>
#include <limits>
#include <mutex>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

SimTK::Vec3 ToSimbody(const Vector3d& v) { return {v[0], v[1], v[2]}; }
SimTK::Rotation ToSimbody(const Matrix3d& R) {
  return SimTK::Rotation(
      SimTK::Mat33(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
      true);
}
Vector3d FromSimbody(const SimTK::Vec3& v) { return {v[0], v[1], v[2]}; }
Matrix3d FromSimbody(const SimTK::Rotation& rotation) {
  Matrix3d R;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) R(i, k) = rotation[i][k];
  return R;
}

SimTK::MassProperties MassOf(const Body& body) {
  if (body.mass == 0) return SimTK::MassProperties(0, SimTK::Vec3(0), SimTK::Inertia(0));
  const Matrix3d& I = body.inertia;
  return SimTK::MassProperties(
      body.mass, ToSimbody(Vector3d(body.moment / body.mass)),
      SimTK::Inertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
}

}  // namespace

/// No force subsystem: with one, Simbody 3.7 keeps the state at work in the system, and two threads
/// disturb each other. Gravity and all forces are handed in.
struct SimbodyArm::System {
  explicit System(const RobotModel& model) {
    for (const Body& body : model.bodies()) {
      const std::string& name = model.joint(body.joint).name;
      try {
        SimTK::MobilizedBody& parent =
            body.parent < 0 ? matter.updGround()
                            : matter.updMobilizedBody(SimTK::MobilizedBodyIndex(body.parent + 1));
        const SimTK::Transform X_PB(ToSimbody(body.pose.rotation), ToSimbody(body.pose.position));
        const SimTK::Body::Rigid rigid(MassOf(body));
        if (body.revolute) {
          SimTK::MobilizedBody::Pin(parent, X_PB, rigid, SimTK::Transform());
        } else {
          // A Slider moves along x of its frames.
          const SimTK::Transform F(SimTK::Rotation(SimTK::UnitVec3(0, 0, 1), SimTK::XAxis));
          SimTK::MobilizedBody::Slider(parent, X_PB * F, rigid, F);
        }
      } catch (const std::exception& e) {
        throw Error("Simbody refuses the body moved by joint \"" + name + "\": " + e.what());
      }
    }
    system.realizeTopology();
  }

  const SimTK::MobilizedBody& body(int index) const {
    return matter.getMobilizedBody(SimTK::MobilizedBodyIndex(index + 1));
  }

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  mutable std::mutex making_state;
};

struct SimbodyArm::Workspace::State {
  State(const std::shared_ptr<const System>& s, int bodies)
      : system{s},
        force(bodies),
        zero(bodies, 0.0),
        out(bodies),
        body_force(bodies + 1),
        M(bodies, bodies) {
    const std::lock_guard lock(s->making_state);
    state = s->system.getDefaultState();
    s->system.realizeModel(state);
  }

  std::shared_ptr<const System> system;
  SimTK::State state;
  SimTK::Vector force, zero, out;
  SimTK::Vector_<SimTK::SpatialVec> body_force, body_acceleration;
  SimTK::Matrix M;
};

SimbodyArm::Workspace::Workspace() = default;
SimbodyArm::Workspace::Workspace(const Workspace&) {}
SimbodyArm::Workspace& SimbodyArm::Workspace::operator=(const Workspace&) { return *this; }
SimbodyArm::Workspace::Workspace(Workspace&&) noexcept = default;
SimbodyArm::Workspace& SimbodyArm::Workspace::operator=(Workspace&&) noexcept = default;
SimbodyArm::Workspace::~Workspace() = default;

SimbodyArm::SimbodyArm(const RobotModel& model)
    : model_{model}, system_{std::make_shared<const System>(model)} {}

SimbodyArm::Workspace::State& SimbodyArm::Prepare(const JointPosition& q, const JointVelocity& v,
                                                  Workspace& w) const {
  const std::span<const Body> bodies = model_.bodies();
  const int n = static_cast<int>(bodies.size());
  if (!w.state_ || w.state_->system != system_)
    w.state_ = std::make_unique<Workspace::State>(system_, n);
  SimTK::Vector& y = w.state_->state.updY();
  for (int i = 0; i < n; ++i) {
    y[i] = q(bodies[static_cast<std::size_t>(i)].joint);
    y[n + i] = v(bodies[static_cast<std::size_t>(i)].joint);
  }
  return *w.state_;
}

JointAcceleration SimbodyArm::ForwardDynamics(const JointPosition& q, const JointVelocity& v,
                                              const JointTorque& tau,
                                              std::span<const ContactForce> forces,
                                              const PerJoint& rotor_inertia, Workspace& w) const
    try {
  Workspace::State& s = Prepare(q, v, w);
  const SimTK::SimbodyMatterSubsystem& matter = system_->matter;
  const std::span<const Body> bodies = model_.bodies();
  const int n = static_cast<int>(bodies.size());
  const bool rotors = (rotor_inertia.array() != 0).any();
  system_->system.realize(s.state, rotors ? SimTK::Stage::Velocity : SimTK::Stage::Dynamics);

  const SimTK::Vec3 gravity = ToSimbody(model_.gravity());
  for (int i = 0; i < n; ++i) {
    const Body& body = bodies[static_cast<std::size_t>(i)];
    const SimTK::Rotation& R = system_->body(i).getBodyRotation(s.state);
    s.body_force[i + 1] =
        SimTK::SpatialVec((R * ToSimbody(body.moment)) % gravity, body.mass * gravity);
    s.force[i] = tau(body.joint);
  }
  for (const ContactForce& F : forces) {
    if (F.link < 0) continue;
    if (F.link >= static_cast<int>(model_.links().size()))
      return PerJoint::Constant(n, std::numeric_limits<double>::quiet_NaN());
    const Link& link = model_.link(F.link);
    if (link.body < 0) continue;
    const Vector3d point = link.pose.position + link.pose.rotation * F.point;
    const SimTK::Vec3 force = ToSimbody(F.force);
    const SimTK::Vec3 r = system_->body(link.body).getBodyRotation(s.state) * ToSimbody(point);
    s.body_force[link.body + 1] += SimTK::SpatialVec(ToSimbody(F.moment) + r % force, force);
  }

  JointAcceleration a;
  a.resize(n);
  if (!rotors) {
    matter.calcAccelerationIgnoringConstraints(s.state, s.force, s.body_force, s.out,
                                               s.body_acceleration);
    for (int i = 0; i < n; ++i) a(bodies[static_cast<std::size_t>(i)].joint) = s.out[i];
    return a;
  }
  // Simbody has no rotors: (M + diag(B)) v̇ = −(C v + g − τ − τ_e).
  matter.calcResidualForceIgnoringConstraints(s.state, s.force, s.body_force, s.zero, s.out);
  // Its calcM goes through the tree once for each joint; what each body carries is found at once.
  matter.realizeCompositeBodyInertias(s.state);
  std::array<SimTK::SpatialVec, kMaxJoints> S;
  JointMatrix M = JointMatrix::Zero(n, n);
  PerJoint b(n);
  for (int i = 0; i < n; ++i) {
    const Body& body = bodies[static_cast<std::size_t>(i)];
    const SimTK::MobilizedBody& node = system_->body(i);
    S[static_cast<std::size_t>(i)] = node.getHCol(s.state, SimTK::MobilizerUIndex(0));
    b(body.joint) = -s.out[i];
    SimTK::SpatialVec h = matter.getCompositeBodyInertia(s.state, node.getMobilizedBodyIndex()) *
                          S[static_cast<std::size_t>(i)];
    SimTK::Vec3 origin = node.getBodyOriginLocation(s.state);
    for (int k = i; k >= 0; k = bodies[static_cast<std::size_t>(k)].parent) {
      const SimTK::Vec3& to = system_->body(k).getBodyOriginLocation(s.state);
      h[0] += (origin - to) % h[1];
      origin = to;
      const int column = bodies[static_cast<std::size_t>(k)].joint;
      M(body.joint, column) = M(column, body.joint) = ~S[static_cast<std::size_t>(k)] * h;
    }
  }
  M.diagonal() += rotor_inertia;
  const Eigen::LLT<Eigen::Ref<JointMatrix>> L(M);
  Require(L.info() == Eigen::Success, "M + diag(B) must be positive definite");
  L.solveInPlace(b);
  return b;
} catch (const std::exception&) {
  return JointAcceleration(PerJoint::Constant(q.size(), std::numeric_limits<double>::quiet_NaN()));
}

void SimbodyArm::ComputeDynamics(const JointPosition& q, const JointVelocity& v, RobotDynamics& d,
                                 Workspace& w) const {
  using SimTK::MobilizerUIndex;
  Workspace::State& s = Prepare(q, v, w);
  const SimTK::SimbodyMatterSubsystem& matter = system_->matter;
  const std::span<const Body> bodies = model_.bodies();
  const int n = static_cast<int>(bodies.size());
  const auto joint = [&](int i) { return bodies[static_cast<std::size_t>(i)].joint; };
  system_->system.realize(s.state, SimTK::Stage::Velocity);
  d.q = q;
  d.v = v;

  matter.calcM(s.state, s.M);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) d.M(joint(i), joint(k)) = s.M(i, k);

  s.force = 0;
  s.body_force = SimTK::SpatialVec(SimTK::Vec3(0), SimTK::Vec3(0));
  matter.calcResidualForceIgnoringConstraints(s.state, s.force, s.body_force, s.zero, s.out);
  for (int i = 0; i < n; ++i) d.coriolis(joint(i)) = s.out[i];

  const SimTK::Vec3 gravity = ToSimbody(model_.gravity());
  for (int i = 0; i < n; ++i) {
    const Body& body = bodies[static_cast<std::size_t>(i)];
    const SimTK::Rotation& R = system_->body(i).getBodyRotation(s.state);
    s.body_force[i + 1] =
        SimTK::SpatialVec((R * ToSimbody(body.moment)) % gravity, body.mass * gravity);
  }
  matter.multiplyBySystemJacobianTranspose(s.state, s.body_force, s.out);
  for (int i = 0; i < n; ++i) d.gravity(joint(i)) = -s.out[i];

  // Momenta of all that each joint carries, about its body's origin, from the tips inwards.
  s.body_force = SimTK::SpatialVec(SimTK::Vec3(0), SimTK::Vec3(0));
  for (int i = n - 1; i >= 0; --i) {
    const SimTK::MobilizedBody& body = system_->body(i);
    const SimTK::SpatialVec V = body.getBodyVelocity(s.state);
    SimTK::SpatialVec& h = s.body_force[i + 1];
    h += body.getBodySpatialInertiaInGround(s.state) * V;
    const SimTK::SpatialVec S = body.getHCol(s.state, MobilizerUIndex(0));
    d.p(joint(i)) = ~S * h;
    d.coriolis_transposed(joint(i)) = ~h[0] * (V[0] % S[0]) + ~h[1] * (V[0] % S[1] + V[1] % S[0]);
    const int parent = bodies[static_cast<std::size_t>(i)].parent;
    if (parent < 0) continue;
    const SimTK::Vec3 r =
        body.getBodyOriginLocation(s.state) - system_->body(parent).getBodyOriginLocation(s.state);
    s.body_force[parent + 1] += SimTK::SpatialVec(h[0] + r % h[1], h[1]);
  }

  for (int i = 0; i < n; ++i) {
    const SimTK::MobilizedBody& body = system_->body(i);
    BodyMotion& B = d.body[static_cast<std::size_t>(i)];
    B.position = FromSimbody(body.getBodyOriginLocation(s.state));
    B.rotation = FromSimbody(body.getBodyRotation(s.state));
    B.omega = FromSimbody(body.getBodyAngularVelocity(s.state));
    B.velocity = FromSimbody(body.getBodyOriginVelocity(s.state));
    const SimTK::SpatialVec bias =
        matter.calcBiasForFrameJacobian(s.state, body.getMobilizedBodyIndex(), SimTK::Vec3(0));
    B.alpha = FromSimbody(bias[0]);
    B.acceleration = FromSimbody(bias[1]);
  }

  SimTK::Matrix J;
  for (std::size_t f = 0; f < static_cast<std::size_t>(d.frames); ++f) {
    FrameDynamics& frame = d.frame[f];
    const Link& link = model_.link(frame.link);
    frame.pose = LinkPose(model_, d, frame.link);
    frame.J.setZero(6, n);
    frame.Jdot_v.setZero();
    frame.twist.setZero();
    if (link.body < 0) continue;
    const SimTK::MobilizedBodyIndex body(link.body + 1);
    const SimTK::Vec3 origin = ToSimbody(link.pose.position);
    matter.calcFrameJacobian(s.state, body, origin, J);
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < 6; ++k) frame.J(k, joint(i)) = J(k, i);
    const SimTK::SpatialVec bias = matter.calcBiasForFrameJacobian(s.state, body, origin);
    const SimTK::SpatialVec V =
        matter.getMobilizedBody(body).findFrameVelocityInGround(s.state, SimTK::Transform(origin));
    frame.Jdot_v << FromSimbody(bias[0]), FromSimbody(bias[1]);
    frame.twist.head<3>() = FromSimbody(V[0]);
    frame.twist.tail<3>() = FromSimbody(V[1]);
  }
}

}  // namespace pliant
