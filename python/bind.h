#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace pliant::python {

namespace py = pybind11;

/// A value as the YAML that --set would be given; JSON is YAML.
std::string YamlOf(const py::handle& value);

/// What each adds to the module stands at the top of its file.
void BindScenario(py::module_& m);
void BindLog(py::module_& m);
void BindSimulation(py::module_& m);
void BindExperiment(py::module_& m);
void BindSweep(py::module_& m);
void BindRobot(py::module_& m);
void BindEstimators(py::module_& m);
void BindControl(py::module_& m);
void BindFriction(py::module_& m);

}  // namespace pliant::python
