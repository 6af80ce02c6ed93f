// Log, Signal, read_log.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>

#include "pliant/analysis/recording.h"
#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/python/simulation.h"

namespace pliant::python {

namespace {

template <class F>
decltype(auto) OrUnknownName(const F& f) {
  try {
    return f();
  } catch (const Error& e) {
    throw UnknownName(e.what());
  }
}

/// A row for each time; the memory is the array's own.
py::array_t<double> Rows(const RecordedSignal& signal) {
  return py::array_t<double>({signal.numbers.cols(), signal.numbers.rows()}, signal.numbers.data());
}

/// Without the brackets or the dot around them.
std::vector<std::string> NamesOf(const RecordedSignal& signal) {
  std::vector<std::string> names;
  for (const std::string& element : signal.elements) {
    const bool in_brackets = element.starts_with('[') && element.find(']') == element.size() - 1;
    names.push_back(in_brackets                ? element.substr(1, element.size() - 2)
                    : element.starts_with('.') ? element.substr(1)
                                               : element);
  }
  return names;
}

}  // namespace

void BindLog(py::module_& m) {
  py::class_<RecordedSignal, std::shared_ptr<RecordedSignal>>(
      m, "Signal", R"(A recorded value over time: T rows, E elements.

Arrays are copies. signal["elbow"] is the column of an element; numpy.asarray(signal) is
signal.numbers.)")
      .def_readonly("path", &RecordedSignal::path, "Such as 'arm.position'.")
      .def_readonly("type", &RecordedSignal::type, "Its quantity, such as 'joint position'.")
      .def_property_readonly("elements", &NamesOf, "Names of the E elements, such as the joints.")
      .def_readonly("units", &RecordedSignal::units, "Units of the E elements.")
      .def_property_readonly(
          "times", [](const RecordedSignal& s) { return VectorArray(s.times); },
          "Times of the rows [s], shape (T,).")
      .def_property_readonly("numbers", &Rows, "Shape (T, E).")
      .def(
          "__array__",
          [](const RecordedSignal& s, const py::object& dtype) -> py::array {
            py::array all = Rows(s);
            return dtype.is_none() ? all : py::array(all.attr("astype")(dtype));
          },
          "dtype"_a = py::none())
      .def(
          "__getitem__",
          [](const RecordedSignal& s, const std::string& element) {
            const Eigen::Index row = OrUnknownName([&] { return s.row(element); });
            return VectorArray(s.numbers.row(row).transpose());
          },
          "element"_a)
      .def("__len__", [](const RecordedSignal& s) { return s.times.size(); })
      .def("__repr__", [](const RecordedSignal& s) {
        return "<pliant.Signal '" + s.path + "', " + s.type + ", " +
               std::to_string(s.times.size()) + " rows of " + std::to_string(s.elements.size()) +
               ">";
      });

  using Shared = std::shared_ptr<Recording>;
  // Signals point into their log.
  py::class_<Recording, Shared>(m, "Log", "What a run has recorded: signals by path, like a dict.")
      .def(
          "__getitem__",
          [](const Shared& log, const std::string& path) {
            const RecordedSignal& signal =
                OrUnknownName([&]() -> const RecordedSignal& { return (*log)[path]; });
            // Lives as long as its log; Python only reads.
            return std::shared_ptr<RecordedSignal>(log, const_cast<RecordedSignal*>(&signal));
          },
          "path"_a)
      .def(
          "__contains__",
          [](const Recording& log, const std::string& path) { return log.has(path); }, "path"_a)
      .def("__len__", [](const Recording& log) { return log.signals().size(); })
      .def(
          "keys",
          [](const Recording& log) {
            std::vector<std::string> paths;
            for (const RecordedSignal& signal : log.signals()) paths.push_back(signal.path);
            return paths;
          },
          "The paths of the signals, in the order in which they were recorded.")
      .def("__iter__", [](const py::object& log) { return py::iter(log.attr("keys")()); })
      .def_property_readonly("metadata", &Recording::metadata,
                             "What the file says of the run: words by name, by record.")
      .def_property_readonly("robot_description", &Recording::robot_description,
                             "URDF; empty if there is none.")
      .def("__repr__", [](const Recording& log) {
        return "<pliant.Log of " + std::to_string(log.signals().size()) + " signals>";
      });

  m.def(
      "read_log",
      [](const std::filesystem::path& file) {
        const py::gil_scoped_release release;
        return std::make_shared<Recording>(Recording::Read(file));
      },
      "file"_a,
      "Reads a log that pliant has written. Damage is an Error with the place in the file.");
}

}  // namespace pliant::python
