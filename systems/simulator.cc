#include "pliant/systems/simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

using internal::Happening;
using internal::Plan;

namespace {

constexpr double kNever = 1e10;  // [s] later than any time a simulation may reach

double Seconds(std::int64_t ns) { return static_cast<double>(ns) / 1e9; }

}  // namespace

Simulator::Simulator(const Diagram& diagram, const Options& options)
    : diagram_{diagram}, plan_{diagram.plan()}, options_{options}, context_{plan_} {
  Require(options_.guard_spacing_s > 0, "guard_spacing_s must be > 0", options_.guard_spacing_s);
  Require(options_.zeno_interval_s >= 0, "zeno_interval_s must be >= 0", options_.zeno_interval_s);
  if (plan_.states > 0)
    integrator_ = MakeIntegrator(options_.integrator, plan_.states, Derivatives(&Simulator::Rate, this));
  sides_.resize(plan_.guards.size());
  buffer_.resize(static_cast<std::size_t>(plan_.states));
  Start();
}

Simulator::~Simulator() = default;

Integrator::Statistics Simulator::statistics() const {
  return integrator_ ? integrator_->statistics() : Integrator::Statistics{};
}

void Simulator::Start() {
  if (!context_.line_.started) {
    context_.line_.started = true;
    PublishAll(plan_.start);
    Update(plan_.start);
    context_.line_.step = options_.integrator.initial_step_s;
  }
  for (std::size_t g = 0; g < plan_.guards.size(); ++g) context_.line_.side[g] = GuardNow(g);
  lo_ = hi_ = time();
  guard_ = -1;
  if (integrator_) integrator_->Reset(time(), context_.state(), context_.line_.step);
}

/// Begins a new stretch here: the state or what the derivatives depend on has changed.
void Simulator::Restart() {
  if (integrator_) {
    if (hi_ > lo_) context_.line_.step = integrator_->next_step();
    integrator_->Reset(time(), context_.state(), context_.line_.step);
  }
  lo_ = hi_ = time();
  guard_ = -1;
  FindJumps();
}

void Simulator::AdvanceTo(double t) {
  Require(std::isfinite(t) && std::abs(t) < 9e9, "AdvanceTo: t must be finite and below 9e9 s", t);
  const double end = Seconds(std::llround(t * 1e9));
  Require(end >= time(), "AdvanceTo: t must not lie before the time reached, " + Text(time()) + " s", t);
  while (time() < end) {
    if (guard_ >= 0 && time() == hi_) {
      Fire(static_cast<std::size_t>(guard_));
      continue;
    }
    const double tick = plan_.rates.empty() ? kNever : Seconds(context_.line_.due[NextRate()]);
    if (tick <= time()) {
      Tick();
      continue;
    }
    if (time() == hi_) TakeStep();
    Show(std::min({tick, end, hi_}));
    if (time() == hi_ && !plan_.step.publishes.empty()) PublishAll(plan_.step);
  }
}

std::size_t Simulator::NextRate() const {
  const std::vector<std::int64_t>& due = context_.line_.due;
  std::size_t next = 0;
  for (std::size_t r = 1; r < due.size(); ++r)
    if (due[r] < due[next]) next = r;
  return next;
}

/// The next tick that changes what the derivatives depend on: the integrator must not pass it.
double Simulator::StopTime() const {
  double stop = kNever;
  for (std::size_t r = 0; r < plan_.rates.size(); ++r)
    if (plan_.rates[r].tick.stops_integration)
      stop = std::min(stop, Seconds(context_.line_.due[r]));
  return stop;
}

bool Simulator::Rate(void* self, double t, std::span<const double> x, std::span<double> rate) {
  Simulator& sim = *static_cast<Simulator*>(self);
  Context& context = sim.context_;
  if (!context.Holds(t, x.data())) {
    context.SetTime(t);
    std::copy(x.begin(), x.end(), context.StateData());
    context.LoadState(x.data());
    context.Invalidate(sim.plan_.moving_dependents);
  }
  context.Evaluate(sim.plan_.derivatives);
  for (const internal::ContinuousEntry& entry : sim.plan_.continuous)
    entry.rate_type->store(context.arena_ + entry.rate_offset, rate.data() + entry.first);
  return true;
}

/// Moves the context to t within the last step.
void Simulator::Show(double t) {
  if (integrator_) {
    integrator_->Interpolate(t, buffer_);
    if (context_.Holds(t, buffer_.data())) return;
    std::copy(buffer_.begin(), buffer_.end(), context_.StateData());
    context_.LoadState(buffer_.data());
    context_.SetTime(t);
    context_.Invalidate(plan_.moving_dependents);
  } else if (context_.time() != t) {
    context_.SetTime(t);
    context_.Invalidate(plan_.time_dependents);
  }
}

void Simulator::TakeStep() {
  lo_ = time();
  const double stop = StopTime();
  if (integrator_) {
    try {
      hi_ = integrator_->Step(stop);
    } catch (const IntegratorFailure& failure) {
      const std::string state = failure.element() >= 0 ? plan_.StateName(failure.element()) : "";
      throw Error(std::string(failure.what()) + (state.empty() ? "" : "\n  state  " + state));
    }
  } else {
    hi_ = plan_.guards.empty() ? stop : std::min(stop, lo_ + options_.integrator.max_step_s);
  }
  if (!plan_.guards.empty()) SampleGuards(lo_, hi_);
}

double Simulator::GuardNow(std::size_t guard) {
  const internal::GuardEntry& g = plan_.guards[guard];
  context_.Evaluate(plan_.needs[static_cast<std::size_t>(g.rule)]);
  return internal::At<double>(context_.arena_, g.offset);
}

double Simulator::GuardAt(std::size_t guard, double t) {
  Show(t);
  return GuardNow(guard);
}

bool Simulator::Crosses(std::size_t guard, double before, double now) const {
  const Direction d = plan_.guards[guard].direction;
  return (d != Direction::Falling && before < 0 && now >= 0) ||
         (d != Direction::Rising && before > 0 && now <= 0);
}

/// The first double at which the guard has crossed, given that it has not at a and has at b:
/// regula falsi (Illinois) until the bracket is a few units in the last place.
double Simulator::Locate(std::size_t guard, double a, double b) {
  const double before = context_.line_.side[guard];
  double fa = GuardAt(guard, a), fb = GuardAt(guard, b);
  if (!Crosses(guard, before, fb)) return b;
  for (int i = 0; i < 200; ++i) {
    const double resolution = 2 * std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
    if (b - a <= resolution || fb == 0) break;
    double c = (a * fb - b * fa) / (fb - fa);
    if (!(c > a && c < b) || i % 8 == 7) c = 0.5 * (a + b);
    const double fc = GuardAt(guard, c);
    if (Crosses(guard, before, fc)) {
      b = c, fb = fc, fa *= 0.5;
    } else {
      a = c, fa = fc, fb *= 0.5;
    }
  }
  return b;
}

/// Looks for the first crossing in (from, to] and cuts the step there.
void Simulator::SampleGuards(double from, double to) {
  std::vector<double>& side = context_.line_.side;
  double spacing = fresh_ ? 1e-9 : options_.guard_spacing_s;
  double a = from;
  while (a < to && guard_ < 0) {
    const double b = std::min(to, a + spacing);
    spacing = std::min(2 * spacing, options_.guard_spacing_s);
    if (!(b > a)) break;
    double first = kNever;
    for (std::size_t g = 0; g < side.size(); ++g) {
      sides_[g] = GuardAt(g, b);
      if (!std::isfinite(sides_[g]))
        throw Error("the guard " + plan_.guards[g].value->path() + " is not finite at t = " + Text(b) + " s");
      if (!Crosses(g, side[g], sides_[g])) continue;
      const double at = Locate(g, a, b);
      if (at < first) first = at, guard_ = static_cast<int>(g);
    }
    if (guard_ >= 0) {
      hi_ = first;
      break;
    }
    for (std::size_t g = 0; g < side.size(); ++g)
      if (sides_[g] != 0) {
        // A guard that fired, came back too little to be seen and goes on: bounces without end.
        if (fired_last_ == static_cast<int>(g) && context_.line_.quick[g] > 0 &&
            sides_[g] * side[g] > 0 && std::abs(sides_[g]) > std::abs(side[g]) &&
            b - context_.line_.fired[g] < options_.zeno_interval_s &&
            ((plan_.guards[g].direction == Direction::Falling && sides_[g] < 0) ||
             (plan_.guards[g].direction == Direction::Rising && sides_[g] > 0)))
          throw Error("Zeno behaviour: the guard " + plan_.guards[g].value->path() +
                      " fires without end at t = " + Text(b) +
                      " s\nlet its update end the motion, or change to a mode without the guard");
        side[g] = sides_[g];
      }
    fired_last_ = -1;
    a = b;
  }
  if (hi_ > from) fresh_ = false;
  Show(from);
}

/// After an event: guards that jumped over zero fire now, one by one.
void Simulator::FindJumps() {
  std::vector<double>& side = context_.line_.side;
  for (std::size_t g = 0; g < side.size(); ++g) {
    const double now = GuardNow(g);
    if (Crosses(g, side[g], now)) {
      lo_ = hi_ = time();
      guard_ = static_cast<int>(g);
      return;
    }
    if (now != 0) side[g] = now;
  }
}

void Simulator::Fire(std::size_t guard) {
  const internal::GuardEntry& g = plan_.guards[guard];
  Context::TimeLine& line = context_.line_;
  line.quick[guard] = time() - line.fired[guard] < options_.zeno_interval_s ? line.quick[guard] + 1 : 0;
  line.fired[guard] = time();
  if (line.quick[guard] >= 2)
    throw Error("Zeno behaviour: the guard " + g.value->path() + " fires again and again at t = " +
                Text(time()) + " s, three times within " + Text(2 * options_.zeno_interval_s) +
                " s\nlet its update end the motion, or change to a mode without the guard");
  const double now = GuardNow(guard);
  line.side[guard] = now != 0 ? now : -line.side[guard];
  PublishAll(g.event);
  Update(g.event);
  fresh_ = true;
  fired_last_ = static_cast<int>(guard);
  Restart();
}

void Simulator::Tick() {
  Context::TimeLine& line = context_.line_;
  const std::int64_t now = line.due[NextRate()];
  const auto each_due = [&](const auto& act) {
    for (std::size_t r = 0; r < line.due.size(); ++r)
      if (line.due[r] == now) act(plan_.rates[r].tick);
  };
  bool stops = false;
  int due = 0;
  each_due([&](const Happening& h) {
    context_.Invalidate(h.stale);
    stops = stops || h.stops_integration;
    ++due;
  });
  if (due == 1) {
    each_due([&](const Happening& h) { context_.Evaluate(h.held); });
  } else {  // several rates at once: one pass in the order of the signals
    for (std::uint32_t w = 0; w < plan_.words; ++w) {
      std::uint64_t run = 0;
      each_due([&](const Happening& h) { run |= context_.Word(h.held, w); });
      context_.RunWord(w, run);
    }
  }
  each_due([&](const Happening& h) { PublishAll(h); });
  each_due([&](const Happening& h) { context_.Evaluate(h.update_needs); });
  each_due([&](const Happening& h) {
    for (const internal::Action& action : h.updates) action.step(context_.arena_);
  });
  each_due([&](const Happening& h) { context_.CommitUpdates(h); });
  for (std::size_t r = 0; r < line.due.size(); ++r)
    if (line.due[r] == now)
      line.due[r] = plan_.rates[r].offset.Times(1) + plan_.rates[r].period.Times(++line.next_tick[r]);
  if (stops) {
    Restart();
  } else if (!plan_.guards.empty()) {
    FindJumps();
  }
}

void Simulator::PublishAll(const Happening& h) {
  if (h.publishes.empty()) return;
  context_.Evaluate(h.publish_needs);
  for (const internal::Action& action : h.publishes) action.step(context_.arena_);
}

void Simulator::Update(const Happening& h) {
  context_.Evaluate(h.update_needs);
  for (const internal::Action& action : h.updates) action.step(context_.arena_);
  context_.CommitUpdates(h);
}

Context Simulator::Snapshot() {
  Restart();
  fresh_ = true;
  fired_last_ = -1;
  return context_;
}

void Simulator::Restore(const Context& snapshot) {
  context_ = snapshot;
  lo_ = hi_ = time();
  Restart();
  fresh_ = true;
  fired_last_ = -1;
}

void Simulator::Save(const std::filesystem::path& file) {
  Restart();
  fresh_ = true;
  fired_last_ = -1;
  context_.Save(file);
}

void Simulator::Restore(const std::filesystem::path& file) {
  Context snapshot(context_);
  snapshot.Load(file);
  Restore(snapshot);
}

}  // namespace pliant
