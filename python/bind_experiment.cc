// run, report, Report, Claim, Table.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>

#include "pliant/analysis/run_experiment.h"
#include "pliant/python/bind.h"
#include "pliant/python/interruptibly.h"
#include "pliant/python/simulation.h"

namespace pliant::python {

namespace py = pybind11;
using namespace py::literals;

namespace {

/// What is reported, and the logs it is about.
struct PythonReport {
  RunsReport of;
  std::vector<std::filesystem::path> logs;
};

PythonReport ReportOn(const std::vector<std::filesystem::path>& logs) {
  const py::gil_scoped_release release;
  return {ReportOf(logs), logs};
}

const Claim& ClaimNamed(const PythonReport& report, const std::string& id) {
  const std::vector<Claim>& claims = report.of.report.claims;
  const auto found = std::ranges::find(claims, id, &Claim::id);
  if (found != claims.end()) return *found;
  std::vector<std::string> ids;
  for (const Claim& claim : claims) ids.push_back(claim.id);
  throw UnknownName("the report has no claim '" + id + "'" + DidYouMean(id, ids));
}

}  // namespace

void BindExperiment(py::module_& m) {
  py::class_<Claim>(m, "Claim", "What a paper claims, held against what was measured.")
      .def_readonly("id", &Claim::id, "Unique in its report.")
      .def_readonly("source", &Claim::source, "The paper and the place in it.")
      .def_readonly("paper", &Claim::paper, "What it says.")
      .def_readonly("measured", &Claim::measured, "With its unit.")
      .def_readonly("criterion", &Claim::criterion, "When the claim is taken to hold.")
      .def_readonly("basis", &Claim::basis, "Where the criterion comes from.")
      .def_readonly("holds", &Claim::holds, "The verdict.")
      .def("__bool__", [](const Claim& claim) { return claim.holds; })
      .def("__repr__", [](const Claim& claim) {
        return "<pliant.Claim '" + claim.id + "' " + (claim.holds ? "holds" : "FAILS") + ": " +
               claim.measured + ">";
      });

  py::class_<Table>(m, "Table", "Cells as a report shows them.")
      .def_readonly("title", &Table::title, "What it shows.")
      .def_readonly("columns", &Table::columns, "Names of the columns.")
      .def_readonly("rows", &Table::rows, "A cell for each column.")
      .def_readonly("caption", &Table::caption, "What stands below it.");

  py::class_<PythonReport>(m, "Report", "What came out of the runs of an experiment.")
      .def_property_readonly(
          "title", [](const PythonReport& r) { return r.of.report.title; }, "Of the experiment.")
      .def_property_readonly(
          "summary", [](const PythonReport& r) { return r.of.report.summary; },
          "Of the experiment.")
      .def_property_readonly(
          "claims", [](const PythonReport& r) { return r.of.report.claims; },
          "The verdict on each claim.")
      .def_property_readonly(
          "results", [](const PythonReport& r) { return r.of.report.results; },
          "The tables that were asked for.")
      .def_property_readonly(
          "holds",
          [](const PythonReport& r) {
            return std::ranges::all_of(r.of.report.claims, &Claim::holds);
          },
          "Whether all claims do.")
      .def_readonly("logs", &PythonReport::logs, "The files it is about.")
      .def("__getitem__", &ClaimNamed, "id"_a, py::return_value_policy::reference_internal)
      .def(
          "write",
          [](const PythonReport& r, const std::filesystem::path& folder) {
            const py::gil_scoped_release release;
            WriteReport(r.of.report, r.of.runs(), folder);
          },
          "folder"_a, "Writes report.html, verdict.json and the figures into a folder.");

  m.def(
      "run",
      [](const ExperimentFile& scenario, const std::filesystem::path& out, int jobs, bool force) {
        std::atomic<bool> stop{false};
        const auto logs = Interruptibly(
            [&] {
              return RunExperiment(scenario,
                                   {.out = out, .jobs = jobs, .force = force, .stop = &stop});
            },
            stop);
        return ReportOn(logs);
      },
      "scenario"_a, "out"_a, py::kw_only(), "jobs"_a = 1, "force"_a = false,
      R"(Makes all runs of a scenario, `jobs` at a time, and reports on them.

Logs go to out/logs; with force over those that are there. Other threads of Python run meanwhile;
after KeyboardInterrupt the logs of what was run are whole files. Raises FailedRun, with the log,
when a run cannot go on.)");
  m.def("report", &ReportOn, "logs"_a, "Reports on logs of the runs of one experiment.");
}

}  // namespace pliant::python
