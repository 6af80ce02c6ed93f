#include "pliant/analysis/linearize.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/systems/simulator.h"

namespace pliant {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::Access;
using internal::Kind;
using internal::Value;

std::span<double> SpanOf(VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// The numbers of several values of a context, one after the other.
class Stack {
 public:
  explicit Stack(const Values& values) {
    for (const Value& value : values) Add(value);
  }

  Eigen::Index size() const { return static_cast<Eigen::Index>(names_.size()); }
  const std::vector<std::string>& names() const { return names_; }

  VectorXd Get(Context& context) const {
    VectorXd x(size());
    std::span<double> rest = SpanOf(x);
    for (const auto& [value, count] : parts_) {
      context.GetNumbers(*value, rest.first(count));
      rest = rest.subspan(count);
    }
    return x;
  }

  void Set(Context& context, const VectorXd& x) const {
    std::span<const double> rest{x.data(), names_.size()};
    for (const auto& [value, count] : parts_) {
      context.SetNumbers(*value, rest.first(count));
      rest = rest.subspan(count);
    }
  }

 private:
  void Add(const Value& value) {
    const auto& declared = Access::Of(value);
    Require(declared.kind != Kind::InputList && declared.kind != Kind::Scratch,
            value.path() + " has no numbers of its own; name ports and states");
    Require(declared.type->columns != nullptr,
            value.describe() + " is not made of numbers; give its type a function template Fields");
    Require(declared.initial != nullptr,
            value.describe() + " is connected; name the output it is connected to");
    std::vector<internal::Column> columns;
    declared.type->columns(declared.initial.get(), declared.space, columns);
    for (const internal::Column& column : columns) names_.push_back(value.path() + column.name);
    parts_.emplace_back(&value, columns.size());
  }

  std::vector<std::pair<const Value*, std::size_t>> parts_;
  std::vector<std::string> names_;
};

Values ContinuousOf(const Diagram& diagram) {
  Values states;
  for (const internal::ContinuousEntry& entry : diagram.plan().continuous)
    states.push_back(*entry.value);
  return states;
}

Values SampledOf(const Diagram& diagram) {
  Values states;
  for (const internal::Slot& slot : diagram.plan().slots)
    if (slot.role == internal::Role::Discrete || slot.role == internal::Role::Held)
      states.push_back(*slot.value);
  return states;
}

VectorXd RatesOf(Context& context) {
  VectorXd rates(static_cast<Eigen::Index>(context.state().size()));
  context.Derivatives(SpanOf(rates));
  return rates;
}

/// ∂f/∂x by central differences; f is evaluated on the context, which is left as it was.
template <class F>
MatrixXd Differences(Context& context, const Stack& stack, const F& f) {
  const VectorXd x = stack.Get(context);
  MatrixXd J(f(context).size(), x.size());
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const double h =
        std::cbrt(3 * std::numeric_limits<double>::epsilon()) * std::max(1.0, std::abs(x(j)));
    VectorXd above = x, below = x;
    above(j) += h;
    below(j) -= h;
    stack.Set(context, above);
    const VectorXd f_above = f(context);
    stack.Set(context, below);
    const VectorXd f_below = f(context);
    J.col(j) = (f_above - f_below) / (above(j) - below(j));
  }
  stack.Set(context, x);
  return J;
}

/// `f` gives the rates or the next values of the states, and below them the outputs.
template <class F>
Linearization Linearized(Context context, const Values& states, const Ports& ports, const F& f) {
  const Stack x(states), u(ports.inputs), y(ports.outputs);
  const MatrixXd by_x = Differences(context, x, f);
  const MatrixXd by_u = Differences(context, u, f);
  return {by_x.topRows(x.size()),
          by_u.topRows(x.size()),
          by_x.bottomRows(y.size()),
          by_u.bottomRows(y.size()),
          x.names(),
          u.names(),
          y.names()};
}

VectorXd Stacked(const VectorXd& above, const VectorXd& below) {
  VectorXd both(above.size() + below.size());
  both << above, below;
  return both;
}

std::string Moving(const Diagram& diagram, const VectorXd& rates) {
  Eigen::Index worst = 0;
  for (Eigen::Index i = 0; i < rates.size(); ++i)
    if (!(std::abs(rates(i)) <= std::abs(rates(worst)))) worst = i;
  return "the rate of " + diagram.plan().StateName(static_cast<int>(worst)) + " is " +
         Text(rates(worst));
}

}  // namespace

Linearization Linearize(const Diagram& diagram, const Context& about, const Ports& ports) {
  const Stack outputs(ports.outputs);
  return Linearized(about, ContinuousOf(diagram), ports, [&](Context& context) {
    return Stacked(RatesOf(context), outputs.Get(context));
  });
}

Linearization LinearizeSampled(const Diagram& diagram, const Context& about, const Ports& ports) {
  const internal::Plan& plan = diagram.plan();
  Require(
      plan.continuous.empty(),
      "a sampled linearisation is of a diagram without Continuous values; this one integrates " +
          (plan.continuous.empty() ? "nothing" : plan.continuous.front().value->path()));
  Require(plan.rates.size() == 1, "a sampled linearisation is of a diagram of one sample rate",
          plan.rates.size());
  const Values sampled = SampledOf(diagram);
  const Stack states(sampled), outputs(ports.outputs);
  Simulator sim{diagram};
  return Linearized(about, sampled, ports, [&](Context& context) {
    sim.Restore(context);
    sim.AdvanceThroughTick();
    return Stacked(states.Get(sim.context()), outputs.Get(sim.context()));
  });
}

Context FindEquilibrium(const Diagram& diagram, const Context& start, const Values& free,
                        const EquilibriumOptions& o) {
  Require(o.tolerance > 0, "tolerance must be > 0", o.tolerance);
  Require(o.most_steps >= 1, "most_steps must be ≥ 1", o.most_steps);
  Require(!diagram.plan().continuous.empty(),
          "the diagram has no Continuous value, so all is still");
  for (const Value& value : free)
    Require(Access::Of(value).kind == Kind::Input || Access::Of(value).kind == Kind::Continuous,
            value.path() + " cannot be free: name unconnected inputs and Continuous values");
  const Stack stack(free);
  Context context = start;
  VectorXd z = stack.Get(context);
  VectorXd r = RatesOf(context);
  if (!r.allFinite()) throw Error("there is no equilibrium to look for: " + Moving(diagram, r));

  const Eigen::Index n = stack.size();
  double lambda = 1e-6;
  int steps = 0;
  for (; r.lpNorm<Eigen::Infinity>() > o.tolerance && steps < o.most_steps; ++steps) {
    // min |J dz + r|² + λ |dz|², as one least-squares problem: JᵀJ would lose half the digits.
    MatrixXd damped(r.size() + n, n);
    damped.topRows(r.size()) = Differences(context, stack, RatesOf);
    damped.bottomRows(n) = MatrixXd::Identity(n, n) * std::sqrt(lambda);
    const VectorXd dz = damped.colPivHouseholderQr().solve(-Stacked(r, VectorXd::Zero(n)));

    stack.Set(context, z + dz);
    const VectorXd r_there = RatesOf(context);
    if (r_there.squaredNorm() < r.squaredNorm()) {
      z += dz;
      r = r_there;
      lambda = std::max(lambda / 100, 1e-15);
    } else {
      stack.Set(context, z);
      lambda *= 10;
    }
  }
  if (r.lpNorm<Eigen::Infinity>() > o.tolerance)
    throw Error("found no equilibrium in " + Text(steps) + " steps: " + Moving(diagram, r) +
                ", tolerance " + Text(o.tolerance) +
                "\nlet more values be free, or start nearer to one");
  return context;
}

}  // namespace pliant
