// Scenario, experiments.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>

#include "pliant/analysis/experiment.h"
#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/python/simulation.h"

namespace pliant::python {

std::string YamlOf(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  const auto plain = py::cpp_function([](const py::object& x) -> py::object {
    if (py::hasattr(x, "tolist")) return x.attr("tolist")();
    throw py::type_error("set: expected text, numbers, lists or dicts, got " +
                         std::string(py::str(py::type::handle_of(x).attr("__name__"))));
  });
  return py::str(py::module_::import("json").attr("dumps")(value, "default"_a = plain));
}

namespace {

Overrides OverridesOf(const py::dict& set) {
  Overrides overrides;
  for (const auto& [path, value] : set) overrides.emplace_back(py::str(path), YamlOf(value));
  return overrides;
}

}  // namespace

void BindScenario(py::module_& m) {
  using Shared = std::shared_ptr<ExperimentFile>;
  py::class_<ExperimentFile, Shared>(
      m, "Scenario", R"(A scenario file: an arm, its controller, what pushes it, and for how long.

Everything is checked when it is read: what is wrong is an Error "file:line:column: …". `set` holds
values by path that go before those of the file, as --set of the command:
{"station.ideal": True, "duration_s": "500 ms"}.)")
      .def_static(
          "read",
          [](const std::filesystem::path& file, const py::dict& set) {
            return std::make_shared<ExperimentFile>(ExperimentFile::Read(file, OverridesOf(set)));
          },
          "file"_a, py::kw_only(), "set"_a = py::dict(), "Reads a file.")
      .def_static(
          "parse",
          [](const std::string& text, const py::dict& set) {
            return std::make_shared<ExperimentFile>(
                ExperimentFile::ReadText(text, "scenario", OverridesOf(set)));
          },
          "text"_a, py::kw_only(), "set"_a = py::dict(), "Reads YAML from a text.")
      .def_static(
          "named",
          [](const std::string& name, const py::dict& set) {
            for (const NamedExperiment& e : Experiments())
              if (e.name == name)
                return std::make_shared<ExperimentFile>(
                    ExperimentFile::Read(e.file, OverridesOf(set)));
            try {
              FindExperiment(name);
            } catch (const Error& e) {
              throw UnknownName(e.what());
            }
            throw UnknownName("there is no experiment '" + name + "'");
          },
          "name"_a, py::kw_only(), "set"_a = py::dict(),
          "One that comes with pliant; KeyError with the nearest name if there is none.")
      .def_property_readonly(
          "title", [](const ExperimentFile& f) { return f.experiment.title; }, "What it is.")
      .def_property_readonly(
          "summary", [](const ExperimentFile& f) { return f.experiment.summary; },
          "What it is about, in a sentence or two.")
      .def_property_readonly(
          "runs",
          [](const ExperimentFile& f) {
            std::vector<std::string> names;
            for (const RunOf& run : f.experiment.runs) names.push_back(run.name);
            return names;
          },
          "The names of its runs; of a file without runs there is one, 'run'.")
      .def_property_readonly(
          "repeat", [](const ExperimentFile& f) { return f.experiment.repeat; },
          "How often each run is made, each time with the next seed.")
      .def_property_readonly("text", &ExperimentFile::text,
                             "As YAML that reads back the same, with what `set` has changed.")
      .def("__repr__", [](const ExperimentFile& f) {
        return "<pliant.Scenario '" + f.experiment.title + "', " +
               std::to_string(f.scenarios.size()) + (f.scenarios.size() == 1 ? " run>" : " runs>");
      });
  m.def(
      "experiments",
      [] {
        std::map<std::string, std::string> titles;
        for (const NamedExperiment& e : Experiments()) titles[e.name] = e.title;
        return titles;
      },
      "The experiments that come with pliant: titles by name.");
}

}  // namespace pliant::python
