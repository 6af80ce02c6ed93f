// sweep, read_sweep, SweepResults.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>

#include "pliant/analysis/run_sweep.h"
#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/python/interruptibly.h"
#include "pliant/python/simulation.h"
#include "pliant/systems/nearest_name.h"

namespace pliant::python {

namespace {

/// "path=values", as the command has them.
std::vector<std::string> OverOf(const py::dict& over) {
  std::vector<std::string> texts;
  for (const auto& [path, values] : over) {
    std::string text = std::string(py::str(path)) + "=";
    if (py::isinstance<py::str>(values)) {
      text += values.cast<std::string>();
    } else {
      bool first = true;
      for (const py::handle value : py::iter(values)) {
        text += (first ? "" : ",") + YamlOf(value);
        first = false;
      }
    }
    texts.push_back(text);
  }
  return texts;
}

/// Of each run; numbers as an array, if they all are.
py::object ValuesOf(const SweepResults& results, std::size_t i) {
  const std::vector<Swept>& over = results.sweep.over();
  if (over[i].is_random()) {
    const auto drawn = std::count_if(over.begin(), over.begin() + static_cast<std::ptrdiff_t>(i),
                                     [](const Swept& s) { return s.is_random(); });
    Eigen::VectorXd all(results.rows.size());
    std::ranges::transform(results.rows, all.begin(), [&](const SweepRow& row) {
      return row.drawn[static_cast<std::size_t>(drawn)];
    });
    return VectorArray(all);
  }
  py::list words;
  for (const SweepRow& row : results.rows)
    words.append(over[i].values()[results.sweep.IndicesOf(row.run)[i]]);
  try {
    return py::module_::import("numpy").attr("array")(words, "dtype"_a = "float64");
  } catch (py::error_already_set& e) {
    if (!e.matches(PyExc_ValueError)) throw;
    return words;
  }
}

py::dict AllValuesOf(const SweepResults& results) {
  py::dict values;
  for (std::size_t i = 0; i < results.sweep.over().size(); ++i)
    values[py::str(results.sweep.over()[i].path())] = ValuesOf(results, i);
  return values;
}

py::array_t<double> Column(const SweepResults& results, const std::string& name) {
  const std::vector<std::string> names = results.names();
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw UnknownName("the sweep has no number '" + name + "'" + DidYouMean(name, names));
  return VectorArray(results.numbers().col(found - names.begin()));
}

SweepResults SweepOver(const ExperimentFile& scenario, const py::dict& over, std::uint64_t runs,
                       const std::string& run, const std::optional<std::filesystem::path>& out,
                       int jobs) {
  Require(jobs >= 1, "jobs must be >= 1", jobs);
  const Sweep sweep(scenario, run, OverOf(over), runs);
  std::atomic<bool> stop{false};
  return Interruptibly(
      [&] {
        return RunSweep(
            sweep, {.out = out.value_or(std::filesystem::path()), .jobs = jobs, .stop = &stop});
      },
      stop);
}

}  // namespace

void BindSweep(py::module_& m) {
  py::class_<SweepResults>(m, "SweepResults",
                           R"(What the R runs of a sweep have left: K numbers of each.

results["farthest"] is one of the numbers, (R,), NaN where it could not be measured.)")
      .def_property_readonly(
          "runs", [](const SweepResults& r) { return r.sweep.runs(); },
          "How many runs the sweep has; R, if they are all made.")
      .def_property_readonly("whole", &SweepResults::whole, "Whether all are made.")
      .def_property_readonly(
          "index",
          [](const SweepResults& r) {
            py::array_t<std::int64_t> index(static_cast<py::ssize_t>(r.rows.size()));
            std::ranges::transform(r.rows, index.mutable_data(), [](const SweepRow& row) {
              return static_cast<std::int64_t>(row.run);
            });
            return index;
          },
          "Which runs they are, from 0, (R,).")
      .def_property_readonly("names", &SweepResults::names, "Of the K numbers.")
      .def_property_readonly(
          "units", [](const SweepResults& r) { return r.sweep.units(); }, "Of the K numbers.")
      .def_property_readonly(
          "numbers", [](const SweepResults& r) { return MatrixArray(r.numbers()); }, "(R, K)")
      .def_property_readonly("values", &AllValuesOf,
                             "What each run had of the swept values, by path: (R,), or a list of "
                             "words.")
      .def_property_readonly("causes", &SweepResults::causes,
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

  m.def("sweep", &SweepOver, "scenario"_a, "over"_a, py::kw_only(), "runs"_a = 0, "run"_a = "",
        "out"_a = py::none(), "jobs"_a = 1,
        R"(Makes many runs of a scenario, without logs, and keeps the `numbers` that it names.

over: values by path: a list, or text as of the command, '70:500:20' or 'uniform(0.5,1.5)'. Lists
make a grid, the last running fastest. runs: 0 is one for each cell of the grid. run: which, of a
scenario with several. out: a folder for what is made; a sweep that was interrupted goes on there.)");
  m.def(
      "read_sweep",
      [](const std::vector<std::filesystem::path>& folders) {
        const py::gil_scoped_release release;
        return ReadSweep(folders);
      },
      "folders"_a, "Reads what is made of a sweep, from the folders of all its parts.");
}

}  // namespace pliant::python
