// The module, and what its exceptions are.

#include <cstring>
#include <string>

#include "pliant/analysis/run_experiment.h"
#include "pliant/python/bind.h"
#include "pliant/python/simulation.h"

namespace pliant::python {

namespace {

/// What is no UTF-8, such as of a file name, is replaced.
void Raise(PyObject* type, const char* what) {
  const auto text = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(what, static_cast<Py_ssize_t>(std::strlen(what)), "replace"));
  PyErr_SetObject(type, text.ptr());
}

}  // namespace

PYBIND11_MODULE(_pliant, m) {
  m.doc() = "The compiled part of pliant.";
  m.attr("__version__") = PLIANT_VERSION;

  // The one that is registered last is asked first.
  static py::exception<Error> error(m, "Error", PyExc_ValueError);
  static py::exception<FailedRun> failed(m, "FailedRun", error.ptr());
  error.attr("__module__") = "pliant";
  failed.attr("__module__") = "pliant";
  error.attr("__doc__") =
      "What a user can mend: a wrong file, value, shape or name of a parameter. The message says "
      "what is wrong, where, what was expected, what was found, and the way out.";
  failed.attr("__doc__") =
      "A run could not go on: its integrator failed, or its log could not be written.";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const UnknownName& e) {
      Raise(PyExc_KeyError, e.what());
    } catch (const WrongUse& e) {
      Raise(PyExc_RuntimeError, e.what());
    } catch (const FailedRun& e) {
      Raise(failed.ptr(), e.what());
    } catch (const Error& e) {
      Raise(error.ptr(), e.what());
    }
  });

  BindScenario(m);
  BindLog(m);
  BindSimulation(m);
  BindExperiment(m);
  BindSweep(m);
  BindRobot(m);
  BindEstimators(m);
  BindControl(m);
  BindFriction(m);
}

}  // namespace pliant::python
