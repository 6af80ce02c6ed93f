// sweep, read_sweep, SweepResults.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/analysis/run_sweep.h"
#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/python/interruptibly.h"
#include "pliant/python/simulation.h"
#include "pliant/systems/nearest_name.h"

namespace pliant::python {

namespace {

/// One of a list: text that would be several values, or a law, stands in quotes.
std::string ListedOf(const py::handle& value) {
  const std::string text = YamlOf(value);
  const bool splits = py::isinstance<py::str>(value) && text.find_first_of("{[") == text.npos &&
                      text.find_first_of(",:(") != text.npos;
  return splits ? std::string(py::str(py::module_::import("json").attr("dumps")(value))) : text;
}

/// "path=values", as the command has them.
std::vector<std::string> OverOf(const py::dict& over) {
  std::vector<std::string> texts;
  for (const auto& [path, values] : over) {
    const std::string name = py::str(path);
    if (py::isinstance<py::str>(values)) {
      texts.push_back(name + "=" + values.cast<std::string>());
      continue;
    }
    const bool whole = PyBytes_Check(values.ptr()) || PyDict_Check(values.ptr());
    const auto all =
        py::reinterpret_steal<py::object>(whole ? nullptr : PySequence_Fast(values.ptr(), ""));
    if (!all) {
      PyErr_Clear();
      throw py::type_error(name + ": expected a list of values, or text such as '0:1:3', got " +
                           std::string(py::repr(values)));
    }
    std::string text = name + "=";
    for (bool first = true; const py::handle value : all)
      text += (std::exchange(first, false) ? "" : ",") + ListedOf(value);
    texts.push_back(text);
  }
  return texts;
}

/// (R,) of numbers, a list of texts.
py::object CellsOf(const SweepColumn& column) {
  if (const auto* numbers = std::get_if<std::vector<double>>(&column.cells))
    return VectorArray(
        Eigen::VectorXd::Map(numbers->data(), static_cast<Eigen::Index>(numbers->size())));
  return py::cast(std::get<std::vector<std::string>>(column.cells));
}

/// The cells of the columns of these names, which the results have.
py::dict CellsOf(const SweepResults& results, const std::vector<std::string>& names) {
  py::dict cells;
  for (const SweepColumn& column : results.columns())
    if (std::ranges::find(names, column.name) != names.end())
      cells[py::str(column.name)] = CellsOf(column);
  return cells;
}

py::object CellsOf(const SweepResults& results, const std::string& name) {
  return CellsOf(results, std::vector{name})[py::str(name)];
}

py::dict ValuesOf(const SweepResults& results) {
  std::vector<std::string> paths;
  for (const SweptValue& swept : results.sweep.over()) paths.push_back(swept.path());
  return CellsOf(results, paths);
}

std::vector<std::string> NamesOf(const SweepResults& results) {
  std::vector<std::string> names;
  for (const NamedNumber& number : results.sweep.numbers()) names.push_back(number.name);
  return names;
}

py::object Column(const SweepResults& results, const std::string& name) {
  std::vector<std::string> names;
  for (const SweepColumn& column : results.columns()) names.push_back(column.name);
  if (std::ranges::find(names, name) == names.end())
    throw UnknownName("the sweep has no column '" + name + "'" + DidYouMean(name, names));
  return CellsOf(results, name);
}

/// Shows lines as warnings, whatever bytes are in them.
void Warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    const auto text = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(line.data(), static_cast<py::ssize_t>(line.size()), "replace"));
    if (!text || PyErr_WarnFormat(PyExc_RuntimeWarning, 1, "%U", text.ptr()) != 0)
      throw py::error_already_set();
  }
}

SweepResults SweepOver(const ExperimentFile& scenario, const py::dict& over, std::uint64_t runs,
                       const py::object& run, const std::optional<std::filesystem::path>& out,
                       int jobs) {
  Require(jobs >= 1, "jobs must be >= 1", jobs);
  const std::string& name = scenario.experiment.runs[RunNamed(scenario, run)].name;
  const Sweep sweep(scenario, name, OverOf(over), runs);
  std::vector<std::string> damage;
  std::atomic<bool> stop{false};
  const SweepOptions options{.out = out.value_or(std::filesystem::path()),
                             .jobs = jobs,
                             .stop = &stop,
                             .say = [&](const std::string& line) { damage.push_back(line); }};
  SweepResults results = Interruptibly([&] { return RunSweep(sweep, options); }, stop);
  Warn(damage);
  return results;
}

SweepResults Read(const std::vector<std::filesystem::path>& folders) {
  SweepResults results = [&] {
    const py::gil_scoped_release release;
    return ReadSweep(folders);
  }();
  Warn(results.told);
  return results;
}

}  // namespace

void BindSweep(py::module_& m) {
  py::class_<SweepResults>(m, "SweepResults",
                           R"(What the R runs of a sweep have left: K numbers of each.

results["farthest"] is a column of results.csv: one of the numbers, (R,), NaN where it could not be
measured; a swept value, by its path; "run", "seed"; why it "ended" early or "failed", texts.)")
      .def_property_readonly(
          "runs", [](const SweepResults& r) { return r.sweep.runs(); },
          "How many runs the sweep has; R, if they are all made.")
      .def_property_readonly("whole", &SweepResults::whole, "Whether all are made.")
      .def_property_readonly(
          "index",
          [](const SweepResults& r) {
            return py::array_t<std::int64_t>::ensure(CellsOf(r, "run"));
          },
          "Which runs they are, from 0, (R,).")
      .def_property_readonly("names", &NamesOf, "Of the K numbers.")
      .def_property_readonly(
          "units", [](const SweepResults& r) { return r.sweep.units(); }, "Of the K numbers.")
      .def_property_readonly(
          "numbers", [](const SweepResults& r) { return MatrixArray(r.numbers()); }, "(R, K)")
      .def_property_readonly("values", &ValuesOf,
                             "What each run had of the swept values, by path: (R,), or a list of "
                             "words.")
      .def_property_readonly(
          "causes", [](const SweepResults& r) { return CellsOf(r, "failed").cast<py::list>(); },

          "Why runs failed; empty where they did not.")
      .def("__getitem__", &Column, "name"_a)
      .def("__len__", [](const SweepResults& r) { return r.rows.size(); })
      .def(
          "write",
          [](const SweepResults& r, const std::filesystem::path& folder) {
            const py::gil_scoped_release release;
            WriteSweepTables(r, folder);
          },
          "folder"_a, "Writes results.csv and results.h5.")
      .def("__repr__", [](const SweepResults& r) {
        return "<pliant.SweepResults of " + std::to_string(r.rows.size()) + " of " +
               std::to_string(r.sweep.runs()) + " runs>";
      });

  m.def("sweep", &SweepOver, "scenario"_a, "over"_a, py::kw_only(), "runs"_a = 0,
        "run"_a = py::none(), "out"_a = py::none(), "jobs"_a = 1,
        R"(Makes many runs of a scenario, without logs, and keeps the `numbers` that it names.

over: values by path: a list, or text as of the command, '70:500:20' or 'uniform(0.5,1.5)'. Lists
make a grid, the last running fastest. runs: 0 is one for each cell of the grid. run: name or index, of a
scenario with several. out: a folder for what is made; a sweep that was interrupted goes on there, and
what is damaged there is a RuntimeWarning.)");
  m.def(
      "read_sweep",
      [](const std::variant<std::filesystem::path, std::vector<std::filesystem::path>>& folders) {
        const auto* one = std::get_if<std::filesystem::path>(&folders);
        return Read(one ? std::vector{*one} : std::get<1>(folders));
      },
      "folders"_a,
      "Reads what is made of a sweep, from the folder of its parts or from all of them. What is "
      "damaged is a RuntimeWarning.");
}

}  // namespace pliant::python
