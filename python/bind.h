#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>

namespace pliant {
struct ExperimentFile;
}

namespace pliant::python {

namespace py = pybind11;

/// A value as the YAML that --set would be given; JSON is YAML.
std::string YamlOf(const py::handle& value);

/// The index of a run by its name or index; None is the only one. Throws UnknownName, Error if
/// there are several, or Python's IndexError or TypeError.
std::size_t RunNamed(const ExperimentFile& file, const py::object& run);

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
