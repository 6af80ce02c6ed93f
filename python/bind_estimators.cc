// MomentumObserver, ComplementaryFusion.

#include <cmath>
#include <memory>

#include "pliant/estimators/complementary_fusion.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/systems/block_tester.h"

namespace pliant::python {

namespace {

Duration PeriodOf(double period) {
  Require(period >= 1e-9 && period <= 1e9, "period must be 1e-9 s to 1e9 s", period);
  return Duration::Nanoseconds(std::llround(1e9 * period));
}

/// A gain for each joint, or one for all.
PerJoint GainOf(const py::object& gain, int joints, const std::string& name) {
  if (PyNumber_Check(gain.ptr()) && !PySequence_Check(gain.ptr()))
    return PerJoint::Constant(joints, NumberOf(gain, name));
  return VectorOf(gain, name, joints);
}

class Observer {
 public:
  Observer(const RobotModel& model, const py::object& gain, double period)
      : model_{model},
        dynamics_(model),
        block_({.joints = model.joints(),
                .gain = GainOf(gain, model.size(), "gain"),
                .period = PeriodOf(period),
                .rotor_inertia = {}}) {}

  py::array_t<double> Update(const py::object& q, const py::object& v, const py::object& torque) {
    const Eigen::Index n = model_.size();
    ComputeDynamics(model_, VectorOf(q, "q", n), VectorOf(v, "v", n), dynamics_);
    block_.Set(block_->torque, VectorOf(torque, "torque", n));
    block_.Set(block_->dynamics, dynamics_);
    block_.Tick();
    return VectorArray(block_.Get(block_->residual));
  }

 private:
  const RobotModel model_;
  RobotDynamics dynamics_;
  BlockTester<MomentumObserver> block_;
};

int RequireJoints(int joints) {
  Require(joints >= 1 && joints <= kMaxJoints, "joints must be 1 to " + Text(kMaxJoints), joints);
  return joints;
}

class Fusion {
 public:
  Fusion(int joints, const py::object& gain, double period)
      : joints_{RequireJoints(joints)},
        block_({.joints = Joints::Numbered(joints),
                .gain = GainOf(gain, joints, "gain"),
                .period = PeriodOf(period)}) {}

  py::array_t<double> Update(const py::object& residual, const py::object& sensor_torque,
                             bool valid) {
    block_.Set(block_->residual, VectorOf(residual, "residual", joints_));
    block_.Set(block_->sensor_torque, VectorOf(sensor_torque, "sensor_torque", joints_));
    block_.Set(block_->sensor_valid, valid);
    block_.Tick();
    return VectorArray(block_.Get(block_->external_torque));
  }

 private:
  const int joints_;
  BlockTester<ComplementaryFusion> block_;
};

}  // namespace

void BindEstimators(py::module_& m) {
  py::class_<Observer>(m, "MomentumObserver",
                       R"(The external torque that explains how the momentum p = M v changes:

  ṙ = K (τ_e − r),   r = K [p − ∫ (τ + Cᵀ v − g + r) dt]

sampled every `period` [s], exact for a momentum that changes evenly. `gain` K [1/s] is a number or (n,).
Source: De Luca & Mattone, ICRA 2005.)")
      .def(py::init<const RobotModel&, const py::object&, double>(), "model"_a, py::kw_only(),
           "gain"_a, "period"_a)
      .def(
          "update", &Observer::Update, "q"_a, "v"_a, "torque"_a,
          "One sample: position [rad], velocity [rad/s], and the torque [N·m] that acted since the "
          "last one, each (n,); returns r [N·m], (n,).");

  py::class_<Fusion>(
      m, "ComplementaryFusion",
      R"(The external torque below K/2π Hz from an observer, above it from a wrist sensor:

  τ̂_e = r + s/(K + s) τ_s

with the observer's `gain` K [1/s] and `period` [s]. While the sensor is not valid, τ̂_e = r.
Source: Celerier et al. 2025 (26).)")
      .def(py::init<int, const py::object&, double>(), "joints"_a, py::kw_only(), "gain"_a,
           "period"_a)
      .def("update", &Fusion::Update, "residual"_a, "sensor_torque"_a, "valid"_a = true,
           "One sample: r and τ_s [N·m], each (n,); returns τ̂_e [N·m], (n,).");
}

}  // namespace pliant::python
