// FrictionFit, fit_friction, identify_friction.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <optional>

#include "pliant/analysis/friction_report.h"
#include "pliant/analysis/friction_run.h"
#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/systems/nearest_name.h"

namespace pliant::python {

namespace {

template <class E>
E OneOf(const std::string& word, const std::string& name) {
  const std::vector<std::string>& words = Words(E{});
  const auto found = std::ranges::find(words, word);
  if (found == words.end()) {
    std::string all;
    for (const std::string& one : words) all += ", '" + one + "'";
    throw Error(name + ": expected one of " + all.substr(2) + ", got '" + word + "'" +
                DidYouMean(word, words));
  }
  return static_cast<E>(found - words.begin());
}

/// None where the model is to be chosen.
std::optional<FrictionModel> ModelOf(const std::string& word) {
  if (word == "auto") return {};
  return OneOf<FrictionModel>(word, "model: 'auto', or");
}

}  // namespace

void BindFriction(py::module_& m) {
  py::class_<FrictionEstimate>(m, "Estimate", "A number that was estimated, in SI.")
      .def_readonly("name", &FrictionEstimate::name, "Such as 'coulomb'.")
      .def_readonly("value", &FrictionEstimate::value, "The most likely one.")
      .def_readonly("deviation", &FrictionEstimate::deviation, "Standard error.")
      .def_readonly("low", &FrictionEstimate::low,
                    "With high, the interval that holds the true number in 95 of 100 such fits.")
      .def_readonly("high", &FrictionEstimate::high, "See low.")
      .def("__repr__", [](const FrictionEstimate& e) {
        return "<pliant.Estimate " + e.name + " = " + Text(e.value) + ", 95 %: " + Text(e.low) +
               " … " + Text(e.high) + ">";
      });

  py::class_<FrictionFit>(
      m, "FrictionFit",
      R"(What was fitted to the friction torque y over the velocity ω of a joint that slides:

  coulomb_viscous   y = c sgn(ω) + d ω + b
  stribeck          y = (c + (s − c) exp(−(ω/ω_s)²)) sgn(ω) + d ω + b)")
      .def_property_readonly(
          "model",
          [](const FrictionFit& f) {
            return Words(f.options.model).at(static_cast<std::size_t>(f.options.model));
          },
          "'coulomb_viscous', 'stribeck' or 'lugre_static'.")
      .def_property_readonly(
          "estimates",
          [](const FrictionFit& f) {
            py::dict all;
            for (const FrictionEstimate& e : f.estimates) all[py::str(e.name)] = e;
            return all;
          },
          "Of what could be told, by name: coulomb c, viscous d, stiction s, stribeck_velocity "
          "ω_s, "
          "offset b.")
      .def_property_readonly(
          "unidentified",
          [](const FrictionFit& f) {
            py::dict all;
            for (const auto& [name, reason] : f.unidentified) all[py::str(name)] = reason;
            return all;
          },
          "What the samples do not tell, and why, by name.")
      .def_property_readonly(
          "covariance", [](const FrictionFit& f) { return MatrixArray(f.covariance); },
          "Of the estimates, in their order.")
      .def_readonly("samples", &FrictionFit::samples, "That slide.")
      .def_readonly("rms", &FrictionFit::rms, "Of the residuals [N·m].")
      .def_readonly("lacks_fit", &FrictionFit::lacks_fit,
                    "More is left than chance explains: a bias that no interval shows.")
      .def(
          "curve",
          [](const FrictionFit& f, const py::object& velocity) {
            const Eigen::VectorXd w = VectorOf(velocity, "velocity");
            return VectorArray(w.unaryExpr([&](double x) { return f.Curve(x); }));
          },
          "velocity"_a, "ŷ(ω) without the offset [N·m], of velocities [rad/s], (k,).");

  m.def(
      "fit_friction",
      [](const py::object& velocity, const py::object& torque, const std::string& model,
         const std::string& loss, bool separate, bool offset) {
        const Eigen::VectorXd w = VectorOf(velocity, "velocity");
        return FitChosen({.velocity = w, .torque = VectorOf(torque, "torque", w.size())},
                         ModelOf(model),
                         {.loss = OneOf<FrictionLoss>(loss, "loss"),
                          .separate = separate,
                          .offset = offset})
            .front();
      },
      "velocity"_a, "torque"_a, py::kw_only(), "model"_a = "auto", "loss"_a = "cauchy",
      "separate"_a = false, "offset"_a = true,
      R"(Fits friction to samples of one joint in order of time, each (k,).

velocity ω [rad/s]; torque y = κ i − τ − B v̇ [N·m], what the motor makes and the joint does not get.
model 'auto' takes the one of least BIC. loss: 'none', 'huber' or 'cauchy'. separate: parameters for
each direction; offset: that of the torque sensor is estimated too.)");

  m.def(
      "identify_friction",
      [](const std::filesystem::path& log, const std::string& model, const std::string& loss,
         bool separate, bool offset) {
        const std::optional<FrictionModel> wanted = ModelOf(model);
        const FrictionFitOptions options{.loss = OneOf<FrictionLoss>(loss, "loss"),
                                         .separate = separate,
                                         .offset = offset && !separate};
        std::vector<FrictionResult> results;
        {
          const py::gil_scoped_release release;
          const std::optional<RunData> run = FrictionRunOf(log);
          if (!run)
            throw Error(log.string() +
                        ": it is no log of a !FrictionExperiment; of other samples give velocity "
                        "and torque to fit_friction, or let `pliant identify friction` read them");
          for (TestedDrive& joint : TestedDrivesOf(*run))
            results.push_back(Identified(std::move(joint.log), wanted, options));
        }
        py::dict fits;
        for (FrictionResult& result : results)
          fits[py::str(result.log.joint)] = std::move(result.fit);
        return fits;
      },
      "log"_a, py::kw_only(), "model"_a = "auto", "loss"_a = "cauchy", "separate"_a = false,
      "offset"_a = true,
      "Friction of each joint that the run of a log has tested, by name, as pliant identify "
      "friction "
      "finds it.");
}

}  // namespace pliant::python
