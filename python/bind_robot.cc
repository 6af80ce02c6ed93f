// RobotModel.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/python/simulation.h"

namespace pliant::python {

namespace {

/// Everything at (q, v); v may be None, at rest.
RobotDynamics At(const RobotModel& model, const py::object& q, const py::object& v = py::none()) {
  RobotDynamics d(model);
  const Eigen::Index n = model.size();
  ComputeDynamics(
      model, VectorOf(q, "q", n),
      v.is_none() ? JointVelocity::Zero(model.joints()) : JointVelocity(VectorOf(v, "v", n)), d);
  return d;
}

/// The frame of a link, or of a point of it.
FrameDynamics FrameAt(const RobotModel& model, const RobotDynamics& d, const std::string& link,
                      const py::object& point) {
  const int index = [&] {
    try {
      return model.link_index(link);
    } catch (const Error& e) {
      throw UnknownName(e.what());
    }
  }();
  const Eigen::Vector3d at =
      point.is_none() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(VectorOf(point, "point", 3));
  return PointDynamics(model, d, index, at);
}

std::vector<std::string> NamesOf(const Joints& joints) {
  std::vector<std::string> names;
  for (int j = 0; j < joints.size(); ++j) names.push_back(joints[j]);
  return names;
}

}  // namespace

void BindRobot(py::module_& m) {
  using Model = const RobotModel&;
  py::class_<RobotModel>(m, "RobotModel",
                         R"(An arm with n joints; arrays are in the order of `joints`, in SI.

  M(q) v̇ + C(q, v) v + g(q) = τ + τ_e

Spatial vectors have their angular part first and stand in the world's axes. For a prismatic joint
read m for rad and N for N·m. An argument v that is None is zero.)")
      .def_static("read", &RobotModel::FromUrdf, "file"_a, "Reads a URDF file.")
      .def_static(
          "parse", [](const std::string& urdf) { return RobotModel::FromUrdfText(urdf); }, "urdf"_a,
          "Reads URDF from a text.")
      .def_static(
          "named",
          [](const std::string& robot) {
            try {
              return ModelNamed(robot);
            } catch (const Error& e) {
              throw UnknownName(e.what());
            }
          },
          "robot"_a, "One that comes with pliant: gen3, gen3_bota, lwr.")
      .def_property_readonly("name", &RobotModel::name, "Of the robot.")
      .def_property_readonly(
          "joints", [](Model r) { return NamesOf(r.joints()); }, "Names of the n joints.")
      .def_property_readonly(
          "links",
          [](Model r) {
            std::vector<std::string> names;
            for (const Link& link : r.links()) names.push_back(link.name);
            return names;
          },
          "Names of the links.")
      .def_property_readonly("mass", &RobotModel::mass, "Of all that moves [kg].")
      .def_property_readonly(
          "lower", [](Model r) { return VectorArray(r.lower_limit()); },
          "Least position [rad], (n,).")
      .def_property_readonly(
          "upper", [](Model r) { return VectorArray(r.upper_limit()); },
          "Greatest position [rad], (n,).")
      .def_property_readonly(
          "velocity_limit", [](Model r) { return VectorArray(r.velocity_limit()); },
          "Largest speed [rad/s], (n,).")
      .def_property_readonly(
          "effort_limit", [](Model r) { return VectorArray(r.effort_limit()); },
          "Largest torque [N·m], (n,).")
      .def(
          "mass_matrix", [](Model r, const py::object& q) { return MatrixArray(At(r, q).M); },
          "q"_a, "M(q) [kg·m²], (n, n), symmetric and positive definite.")
      .def(
          "gravity", [](Model r, const py::object& q) { return VectorArray(At(r, q).gravity); },
          "q"_a, "g(q) [N·m], (n,).")
      .def(
          "coriolis",
          [](Model r, const py::object& q, const py::object& v) {
            return VectorArray(At(r, q, v).coriolis);
          },
          "q"_a, "v"_a, "C(q, v) v [N·m], (n,).")
      .def(
          "coriolis_transposed",
          [](Model r, const py::object& q, const py::object& v) {
            return VectorArray(At(r, q, v).coriolis_transposed);
          },
          "q"_a, "v"_a, "C(q, v)ᵀ v [N·m], (n,), of which momentum observers are made.")
      .def(
          "inverse_dynamics",
          [](Model r, const py::object& q, const py::object& v, const py::object& a) {
            return VectorArray(InverseDynamics(At(r, q, v), VectorOf(a, "a", r.size())));
          },
          "q"_a, "v"_a, "a"_a, "τ = M a + C v + g [N·m], (n,).")
      .def(
          "forward_dynamics",
          [](Model r, const py::object& q, const py::object& v, const py::object& tau,
             const py::object& external) {
            return VectorArray(ForwardDynamics(
                At(r, q, v), VectorOf(tau, "tau", r.size()),
                external.is_none() ? JointTorque::Zero(r.joints())
                                   : JointTorque(VectorOf(external, "external", r.size()))));
          },
          "q"_a, "v"_a, "tau"_a, "external"_a = py::none(),
          "v̇ = M⁻¹ (τ + τ_e − C v − g) [rad/s²], (n,).")
      .def(
          "pose",
          [](Model r, const py::object& q, const std::string& link) {
            const Pose X = FrameAt(r, At(r, q), link, py::none()).pose;
            Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
            T.topLeftCorner<3, 3>() = X.rotation;
            T.topRightCorner<3, 1>() = X.position;
            return MatrixArray(T);
          },
          "q"_a, "link"_a, "Where a link is in the world: rotation and position [m], (4, 4).")
      .def(
          "jacobian",
          [](Model r, const py::object& q, const std::string& link, const py::object& point) {
            return MatrixArray(FrameAt(r, At(r, q), link, point).J);
          },
          "q"_a, "link"_a, "point"_a = py::none(),
          R"(J with V = J v, (6, n): of a point in the link's frame [m], without one of its origin.)")
      .def(
          "jacobian_rate",
          [](Model r, const py::object& q, const py::object& v, const std::string& link,
             const py::object& point) {
            return VectorArray(FrameAt(r, At(r, q, v), link, point).Jdot_v);
          },
          "q"_a, "v"_a, "link"_a, "point"_a = py::none(),
          "J̇ v [rad/s², m/s²], (6,): the acceleration at v̇ = 0.")
      .def("__repr__", [](Model r) {
        return "<pliant.RobotModel '" + r.name() + "', " + std::to_string(r.size()) + " joints>";
      });
}

}  // namespace pliant::python
