// Simulation, Port.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>

#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/python/simulation.h"
#include "pliant/systems/nearest_name.h"

namespace pliant::python {

namespace {

/// A simulation as Python has it: one thread at a time, until it is closed.
class Held {
 public:
  Held(const ExperimentFile& file, std::size_t run, TorqueLaw::Function law)
      : sim_{std::make_unique<Simulation>(file, run, std::move(law))} {}

  /// The simulation for as long as what is returned lives. Called with the GIL.
  class Use {
   public:
    explicit Use(Held& held) : held_{held} {
      if (!held.sim_) throw WrongUse("the simulation is closed");
      if (held.used_)
        throw WrongUse(
            "the simulation is being advanced: wait for advance_to to return; meanwhile there "
            "are only time and stop()");
      held.used_ = true;
    }
    ~Use() { held_.used_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;
    Simulation* operator->() const { return held_.sim_.get(); }

   private:
    Held& held_;
  };

  /// For what may be asked while it is advanced.
  Simulation& sim() const {
    if (!sim_) throw WrongUse("the simulation is closed");
    return *sim_;
  }
  void Close() {
    if (!sim_) return;
    const Use use(*this);
    sim_.reset();
  }

 private:
  std::unique_ptr<Simulation> sim_;
  bool used_ = false;
};

/// Calls Python at every tick, from a thread that does not hold the GIL.
TorqueLaw::Function LawOf(const py::object& control, int joints) {
  if (control.is_none()) return {};
  if (!PyCallable_Check(control.ptr()))
    throw py::type_error("control: expected a function of t, position, velocity, torque");
  // Let go of with the GIL, wherever that is.
  const std::shared_ptr<py::object> function(new py::object(control), [](py::object* o) {
    const py::gil_scoped_acquire acquire;
    delete o;
  });
  return [function, joints](double t, const JointPosition& q, const JointVelocity& v,
                            const JointTorque& tau) -> JointTorque {
    const py::gil_scoped_acquire acquire;
    const py::object torque = (*function)(t, VectorArray(q), VectorArray(v), VectorArray(tau));
    return VectorOf(torque, "the torque of control at t = " + Text(t) + " s", joints);
  };
}

py::object ValueOf(const ReadableValue& port, const std::vector<double>& numbers) {
  switch (port.kind) {
    case TunableValue::Kind::Number:
      return py::float_(numbers[0]);
    case TunableValue::Kind::Flag:
      return py::bool_(numbers[0] != 0);
    case TunableValue::Kind::Word:
      return py::str(port.words.at(static_cast<std::size_t>(numbers[0])));
    case TunableValue::Kind::Matrix:
      return MatrixArray(Eigen::MatrixXd::Map(numbers.data(), port.rows, port.cols));
    case TunableValue::Kind::Numbers:
      break;
  }
  return py::array_t<double>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

std::vector<double> NumbersOf(const ReadableValue& port, const py::object& value) {
  const auto copy = [](const auto& m) {
    return std::vector<double>(m.data(), m.data() + m.size());
  };
  switch (port.kind) {
    case TunableValue::Kind::Number: {
      const double x = NumberOf(value, port.path);
      if (port.whole && x != std::round(x))
        throw Error(port.path + ": expected a whole number, got " + Text(x));
      return {x};
    }
    case TunableValue::Kind::Flag:
      if (!py::isinstance<py::bool_>(value))
        throw Error(port.path + ": expected True or False, got " +
                    std::string(py::str(py::repr(value))));
      return {value.cast<bool>() ? 1.0 : 0.0};
    case TunableValue::Kind::Word: {
      const auto word = py::isinstance<py::str>(value)
                            ? std::ranges::find(port.words, value.cast<std::string>())
                            : port.words.end();
      if (word == port.words.end()) {
        std::string all;
        for (const std::string& one : port.words) all += (all.empty() ? "'" : ", '") + one + "'";
        throw Error(port.path + ": expected one of " + all + ", got " +
                    std::string(py::str(py::repr(value))));
      }
      return {static_cast<double>(word - port.words.begin())};
    }
    case TunableValue::Kind::Matrix:
      return copy(MatrixOf(value, port.path, port.rows, port.cols));
    case TunableValue::Kind::Numbers:
      break;
  }
  return copy(VectorOf(value, port.path, static_cast<Eigen::Index>(port.elements.size())));
}

void AdvanceTo(Held& held, double t) {
  Require(std::isfinite(t), "t must be finite [s]", t);
  const Held::Use sim(held);
  for (bool done = false; !done;) {
    {
      const py::gil_scoped_release release;
      done = sim->AdvanceFor(t, std::chrono::milliseconds(50));
    }
    if (PyErr_CheckSignals()) throw py::error_already_set();
  }
  sim->stop = false;
}

}  // namespace

std::size_t RunNamed(const ExperimentFile& file, const py::object& run) {
  const std::vector<RunOf>& runs = file.experiment.runs;
  std::vector<std::string> names;
  for (const RunOf& of : runs) names.push_back(of.name);
  if (run.is_none()) {
    if (runs.size() == 1) return 0;
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    throw Error("run: the scenario has " + std::to_string(runs.size()) + ", expected one of " +
                all);
  }
  if (PyIndex_Check(run.ptr())) {
    const py::ssize_t i =
        PyNumber_AsSsize_t(run.ptr(), nullptr);  // of what is too large the largest
    if (PyErr_Occurred()) throw py::error_already_set();
    if (i < 0 || i >= std::ssize(runs))
      throw py::index_error("run: the scenario has " + std::to_string(runs.size()) +
                            (runs.size() == 1 ? " run" : " runs") + ", got the index " +
                            py::str(run).cast<std::string>());
    return static_cast<std::size_t>(i);
  }
  if (!py::isinstance<py::str>(run)) throw py::type_error("run: expected a name or an index");
  const auto name = run.cast<std::string>();
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw UnknownName("the scenario has no run '" + name + "'" + DidYouMean(name, names));
  return static_cast<std::size_t>(found - names.begin());
}

void BindSimulation(py::module_& m) {
  py::class_<ReadableValue>(m, "Port", "A value of a diagram that can be read.")
      .def_readonly("path", &ReadableValue::path, "Such as 'arm.position'.")
      .def_readonly("role", &ReadableValue::role,
                    "'input', 'output', 'held output', 'discrete' or 'continuous'.")
      .def_readonly("type", &ReadableValue::type, "Its quantity, such as 'joint position'.")
      .def_readonly("elements", &ReadableValue::elements, "Such as '[elbow]' or '.force[x]'.")
      .def_readonly("units", &ReadableValue::units, "Of each element.")
      .def_readonly("settable", &ReadableValue::tunable,
                    "Whether it may be set: an input with a default that nothing is connected to.")
      .def("__repr__", [](const ReadableValue& p) {
        return "<pliant.Port '" + p.path + "', " + p.role + ", " + p.type + ">";
      });

  py::class_<Linearization>(m, "Linearization", R"(A diagram about a state:

  δẋ = A δx + B δu,   δy = C δx + D δu

with n states, m inputs, p outputs: A (n, n), B (n, m), C (p, n), D (p, m).)")
      .def_property_readonly(
          "A", [](const Linearization& l) { return MatrixArray(l.A); }, "(n, n)")
      .def_property_readonly(
          "B", [](const Linearization& l) { return MatrixArray(l.B); }, "(n, m)")
      .def_property_readonly(
          "C", [](const Linearization& l) { return MatrixArray(l.C); }, "(p, n)")
      .def_property_readonly(
          "D", [](const Linearization& l) { return MatrixArray(l.D); }, "(p, m)")
      .def_readonly("states", &Linearization::states, "Names, such as 'arm.plant.q[elbow]'.")
      .def_readonly("inputs", &Linearization::inputs, "Names of the m inputs.")
      .def_readonly("outputs", &Linearization::outputs, "Names of the p outputs.");

  py::class_<Held>(m, "Simulation",
                   R"(One run of a scenario, advanced by hand and recorded in memory.

run: the name or index of one of scenario.runs; None where there is one. control: a function in the
place of the scenario's controller, called at each of its ticks,

  τ = control(t, position, velocity, torque)

of the time [s] and of what the arm measures, joint position [rad], velocity [rad/s] and torque
[N·m], each of shape (n,); τ [N·m], shape (n,), is the whole torque, that of the arm's weight
included. What it raises comes out of advance_to.

sim["arm.position"] is a copy of a value; sim["control.stiffness"] = … sets an input of
sim.ports that is settable. The log has what was set.)")
      .def(py::init([](const ExperimentFile& scenario, const py::object& run,
                       const py::object& control) {
             const std::size_t i = RunNamed(scenario, run);
             const int joints = control.is_none() ? 0 : RobotOf(scenario.scenarios[i]).size();
             return std::make_unique<Held>(scenario, i, LawOf(control, joints));
           }),
           "scenario"_a, "run"_a = py::none(), py::kw_only(), "control"_a = py::none())
      .def("advance_to", &AdvanceTo, "t"_a, R"(Advances to t [s], or until the run ends.

Other threads of Python run meanwhile; KeyboardInterrupt and stop() end it early. The events at t
begin the next call: a run in many calls is the same run, bit for bit. Raises FailedRun if the
integrator cannot.)")
      .def(
          "run",
          [](Held& held) {
            if (held.sim().time() < held.sim().duration()) AdvanceTo(held, held.sim().duration());
            const Held::Use sim(held);
            const py::gil_scoped_release release;
            sim->TickAtEnd();
          },
          "Advances to the end of the scenario and through the tick there, as the command does.")
      .def(
          "stop", [](const Held& held) { held.sim().stop = true; },
          "Ends the advance_to that goes on in another thread, or else the next one.")
      .def_property_readonly(
          "time", [](const Held& held) { return held.sim().time(); }, "The time reached [s].")
      .def_property_readonly(
          "duration", [](const Held& held) { return held.sim().duration(); },
          "Of the scenario [s].")
      .def_property_readonly(
          "ended", [](Held& held) { return Held::Use(held)->ended(); },
          "Which block has ended the run, when and why; empty while it may go on.")
      .def_property_readonly(
          "ports",
          [](Held& held) {
            const Held::Use sim(held);
            py::dict ports;
            for (const ReadableValue& port : sim->ports()) ports[py::str(port.path)] = port;
            return ports;
          },
          "All values that can be read, by path.")
      .def(
          "__getitem__",
          [](Held& held, const std::string& path) {
            const Held::Use sim(held);
            const ReadableValue& port = sim->port(path);
            return ValueOf(port, sim->Get(port));
          },
          "path"_a)
      .def(
          "__setitem__",
          [](Held& held, const std::string& path, const py::object& value) {
            const Held::Use sim(held);
            const ReadableValue& port = sim->port(path);
            if (!port.tunable) {
              std::vector<std::string> paths;
              for (const ReadableValue& other : sim->ports())
                if (other.tunable) paths.push_back(other.path);
              throw Error(path + " cannot be set: it follows from others" +
                          DidYouMean(path, paths));
            }
            sim->Set(port, NumbersOf(port, value));
          },
          "path"_a, "value"_a)
      .def(
          "log", [](Held& held) { return std::make_shared<Recording>(Held::Use(held)->log()); },
          "A copy of what was recorded so far.")
      .def(
          "write_log",
          [](Held& held, const std::filesystem::path& file, bool force) {
            const Held::Use sim(held);
            const py::gil_scoped_release release;
            sim->WriteLog(file, force);
          },
          "file"_a, py::kw_only(), "force"_a = false,
          R"(Writes it as the command does: an MCAP file for read_log, pliant replay, Foxglove.

force writes over a file that is there; a write that fails leaves it. A run with a function for a
controller cannot be replayed, and its log does not say that it could.)")
      .def(
          "linearize",
          [](Held& held, const std::vector<std::string>& inputs,
             const std::vector<std::string>& outputs) {
            return Held::Use(held)->LinearizeBetween(inputs, outputs);
          },
          py::kw_only(), "inputs"_a, "outputs"_a, R"(Where the run is, by central differences.

inputs are settable, outputs anything that can be read. States are the continuous ones; what only
ticks change keeps its value.)")
      .def("close", &Held::Close, "Lets go of it; all else then raises RuntimeError.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](Held& held, const py::args&) { held.Close(); });
}

}  // namespace pliant::python
