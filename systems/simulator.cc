#include "pliant/systems/simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

using internal::Happening;
using internal::Plan;

namespace {

constexpr double kNever = 1e10;         // [s] later than any time a simulation may reach
constexpr double kFreshSpacing = 1e-9;  // [s] of guard samples right after an event

constexpr const char* kZenoRemedy =
    "\nlet its update end the motion, or change to a mode without the guard";

double Seconds(std::int64_t ns) { return static_cast<double>(ns) / 1e9; }

}  // namespace

Simulator::Simulator(const Diagram& diagram, const Options& options)
    : diagram_{diagram}, plan_{diagram.plan()}, options_{options}, context_{plan_} {
  Require(options_.guard_spacing_s > 0, "guard_spacing_s must be > 0", options_.guard_spacing_s);
  Require(options_.zeno_interval_s >= 0, "zeno_interval_s must be >= 0", options_.zeno_interval_s);
  if (plan_.states > 0)
    integrator_ =
        MakeIntegrator(options_.integrator, plan_.states, Derivatives(&Simulator::Rate, this));
  sides_.resize(plan_.guards.size());
  buffer_.resize(static_cast<std::size_t>(plan_.states));
  begin_.resize(buffer_.size());
  Start();
}

Simulator::~Simulator() = default;

Simulator::Statistics Simulator::statistics() const {
  return {integrator_ ? integrator_->statistics() : Integrator::Statistics{}, guards_fired_};
}

std::string Simulator::Statistics::text() const {
  return Integrator::Statistics::text() + "; " + Text(guards_fired) +
         (guards_fired == 1 ? " guard fired" : " guards fired");
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
    integrator_->Reset(time(), context_.state(), context_.line_.step);
  }
  begins_ = true;
  lo_ = hi_ = time();
  guard_ = -1;
  FindJumps();
}

void Simulator::AdvanceTo(double t) {
  Require(std::isfinite(t) && std::abs(t) < 9e9, "AdvanceTo: t must be finite and below 9e9 s", t);
  const double end = Seconds(std::llround(t * 1e9));
  if (end < time())
    throw Error("AdvanceTo: t must not lie before the time reached, " + Text(time()) + " s, got " +
                Text(t));
  while (time() < end) {
    if (Happens()) continue;
    if (HasEnded()) return;
    if (time() == hi_) TakeStep();
    Show(std::min({TickTime(), end, hi_}));
    if (time() == hi_ && integrator_) PublishAll(plan_.step);
  }
}

/// The next event of this instant, if there is one.
bool Simulator::Happens() {
  if (guard_ >= 0 && time() == hi_) {
    Fire(static_cast<std::size_t>(guard_));
    return true;
  }
  if (TickTime() > time()) return false;
  Tick();
  return true;
}

double Simulator::TickTime() const {
  return plan_.rates.empty() ? kNever : Seconds(context_.line_.due[NextRate()]);
}

void Simulator::AdvanceThroughTick() {
  Require(!plan_.rates.empty(), "nothing ticks: no rule of the diagram has Every(period)");
  const double next = Seconds(context_.line_.due[NextRate()]);
  Require(next < 9e9, "nothing ticks any more", time());
  AdvanceTo(next);
  if (HasEnded()) return;
  while (guard_ >= 0 && time() == hi_) Fire(static_cast<std::size_t>(guard_));
  Tick();
  if (HasEnded())
    while (Happens()) {
    }
}

std::optional<Simulator::Ending> Simulator::ended() const {
  if (!HasEnded()) return std::nullopt;
  const internal::Ending& by = plan_.endings[static_cast<std::size_t>(context_.line_.ended_by)];
  return Ending{.time = time(), .block = by.block, .reason = by.reason};
}

std::string Simulator::Ending::text() const {
  return std::string(block) + " ended the run at t = " + Text(time) + " s: " + std::string(reason);
}

std::int64_t Simulator::next_tick_ns() const {
  return plan_.rates.empty() ? std::numeric_limits<std::int64_t>::max()
                             : context_.line_.due[NextRate()];
}

std::size_t Simulator::NextRate() const {
  const std::vector<std::int64_t>& due = context_.line_.due;
  std::size_t next = 0;
  for (std::size_t r = 1; r < due.size(); ++r)
    if (due[r] < due[next]) next = r;
  return next;
}

/// The next tick that changes what derivatives or guards depend on: no step must pass it.
double Simulator::StopTime() const {
  double stop = kNever;
  for (std::size_t r = 0; r < plan_.rates.size(); ++r)
    if (plan_.rates[r].tick.stops_integration)
      stop = std::min(stop, Seconds(context_.line_.due[r]));
  return stop;
}

bool Simulator::Rate(void* self, double t, std::span<const double> x, std::span<double> rate) {
  Simulator& sim = *static_cast<Simulator*>(self);
  sim.context_.MoveTo(t, x);
  sim.context_.Evaluate(sim.plan_.derivatives);
  sim.context_.StoreRates(rate);
  return true;
}

/// Moves the context to t within the last step.
void Simulator::Show(double t) {
  if (integrator_) integrator_->Interpolate(t, buffer_);
  context_.MoveTo(t, buffer_);
}

void Simulator::TakeStep() {
  lo_ = time();
  std::ranges::copy(context_.state(), begin_.begin());
  const double step = context_.line_.step;
  try {
    const double stop = StopTime();
    if (integrator_) {
      hi_ = integrator_->Step(stop);
      if (begins_) context_.line_.step = integrator_->next_step();
      begins_ = false;
    } else {
      hi_ = plan_.guards.empty() ? stop : std::min(stop, lo_ + options_.integrator.max_step_s);
    }
    if (!plan_.guards.empty()) SampleGuards(lo_, hi_);
  } catch (const IntegratorFailure& failure) {
    GiveUpStep(step);
    if (failure.element() < 0) throw;
    throw Error(std::string(failure.what()) + "\n  state  " + plan_.StateName(failure.element()));
  } catch (...) {
    GiveUpStep(step);
    throw;
  }
}

/// Back to where the step began, ready to try again.
void Simulator::GiveUpStep(double step) {
  hi_ = lo_;
  guard_ = -1;
  context_.MoveTo(lo_, begin_);
  context_.line_.step = step;
  begins_ = true;
  if (integrator_) integrator_->Reset(lo_, begin_, step);
}

double Simulator::GuardNow(std::size_t guard) {
  const internal::GuardEntry& g = plan_.guards[guard];
  if (g.rule >= 0) context_.Evaluate(plan_.needs[static_cast<std::size_t>(g.rule)]);
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
    const double resolution =
        2 * std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
    if (b - a <= resolution || fb == 0) break;
    double c = (a * fb - b * fa) / (fb - fa);
    if (!(c > a && c < b) || i % 4 == 3) c = 0.5 * (a + b);
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
  double spacing = fresh_ ? kFreshSpacing : options_.guard_spacing_s;
  for (double a = from, b; a < to && guard_ < 0; a = b) {
    b = std::min(to, std::max(a + spacing, std::nextafter(a, kNever)));
    spacing = std::min(2 * spacing, options_.guard_spacing_s);
    Show(b);
    for (std::size_t g = 0; g < side.size(); ++g) {
      sides_[g] = GuardNow(g);
      if (!std::isfinite(sides_[g]))
        throw Error("the guard " + plan_.guards[g].value->path() +
                    " is not finite at t = " + Text(b) + " s");
    }
    for (std::size_t g = 0; g < side.size(); ++g)
      if (Crosses(g, side[g], sides_[g])) {
        const double at = Locate(g, a, b);
        if (guard_ >= 0 && at >= hi_) continue;
        hi_ = at;
        guard_ = static_cast<int>(g);
      }
    if (guard_ >= 0) break;
    if (fired_last_ >= 0) CheckFallingThrough(static_cast<std::size_t>(fired_last_), b);
    for (std::size_t g = 0; g < side.size(); ++g)
      if (sides_[g] != 0) side[g] = sides_[g];
    fired_last_ = -1;
  }
  fresh_ = fresh_ && !(hi_ > from);
  Show(from);
}

/// A guard that fired in quick succession, came back too little to be seen and goes on: it would
/// fire without end.
void Simulator::CheckFallingThrough(std::size_t guard, double t) const {
  const Context::TimeLine& line = context_.line_;
  const double before = line.side[guard], now = sides_[guard];
  const bool goes_on = plan_.guards[guard].direction != Direction::Both && before * now > 0 &&
                       std::abs(now) > std::abs(before) &&
                       (now < 0) == (plan_.guards[guard].direction == Direction::Falling);
  if (line.quick[guard] > 0 && goes_on && t - line.fired[guard] <= options_.zeno_interval_s)
    throw Error("Zeno behaviour: the guard " + plan_.guards[guard].value->path() +
                " fires without end at t = " + Text(t) + " s" + kZenoRemedy);
}

/// Before a change in mid-step: what was seen of the guards, at the end of the step, is seen here.
void Simulator::LookHere() {
  if (time() >= hi_) return;
  for (std::size_t g = 0; g < sides_.size(); ++g)
    if (const double now = GuardNow(g); now != 0) context_.line_.side[g] = now;
}

/// After an event: guards that jumped over zero fire now, one by one.
void Simulator::FindJumps() {
  std::vector<double>& side = context_.line_.side;
  for (std::size_t g = 0; g < side.size(); ++g) {
    const double now = GuardNow(g);
    if (Crosses(g, side[g], now)) {
      if (guard_ < 0) guard_ = static_cast<int>(g);
    } else if (now != 0) {
      side[g] = now;
    }
  }
}

void Simulator::Fire(std::size_t guard) {
  const internal::GuardEntry& g = plan_.guards[guard];
  Context::TimeLine& line = context_.line_;
  const bool quick = time() - line.fired[guard] <= options_.zeno_interval_s;
  line.quick[guard] = quick ? line.quick[guard] + 1 : 0;
  line.fired[guard] = time();
  if (line.quick[guard] >= 2)
    throw Error("Zeno behaviour: the guard " + g.value->path() +
                " fires again and again at t = " + Text(time()) + " s, three times within " +
                Text(2 * options_.zeno_interval_s) + " s" + kZenoRemedy);
  const double now = GuardNow(guard);
  line.side[guard] = now != 0 ? now : -line.side[guard];
  ++guards_fired_;
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
      line.due[r] =
          plan_.rates[r].offset.Times(1) + plan_.rates[r].period.Times(++line.next_tick[r]);
  if (stops) Restart();
}

/// Publishes, and asks who may end the run.
void Simulator::PublishAll(const Happening& h) {
  if (h.publishes.empty() && h.stops.empty()) return;
  context_.Evaluate(h.publish_needs);
  for (const internal::Action& action : h.publishes) action.step(context_.arena_);
  int& ended_by = context_.line_.ended_by;
  for (const internal::StopRule& stop : h.stops) {
    stop.step(context_.arena_);
    if (ended_by < 0 && internal::At<bool>(context_.arena_, plan_.stop_offset))
      ended_by = stop.number;
  }
}

void Simulator::Update(const Happening& h) {
  context_.Evaluate(h.update_needs);
  for (const internal::Action& action : h.updates) action.step(context_.arena_);
  context_.CommitUpdates(h);
}

/// From here on the run depends on the context alone.
void Simulator::Settle() {
  LookHere();
  fresh_ = true;
  fired_last_ = -1;
  Restart();
}

Context Simulator::Snapshot() {
  Settle();
  return context_;
}

void Simulator::Restore(const Context& snapshot) {
  context_ = snapshot;
  lo_ = hi_ = time();
  if (!context_.line_.started) Start();  // a new context: from the very beginning
  Settle();
}

void Simulator::Save(const std::filesystem::path& file) {
  Settle();
  context_.Save(file);
}

void Simulator::Restore(const std::filesystem::path& file) {
  Context snapshot(context_);
  snapshot.Load(file);
  Restore(snapshot);
}

}  // namespace pliant
