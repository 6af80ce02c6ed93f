#include "pliant/systems/tick_cost.h"

#include <algorithm>
#include <chrono>
#include <map>

#include "pliant/systems/simulator.h"
#include "pliant/systems/time_text.h"

namespace pliant {

namespace {

using internal::Happening;
using internal::Plan;

constexpr double kNotRun = -1;  // as the cost of a rule in a sample

double Median(std::vector<double>& x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::ranges::nth_element(x, middle);
  return *middle;
}

template <class Act>
double Timed(const Act& act) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  act();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// [s] Of looking at the clock twice.
double CostOfTheClock() {
  std::vector<double> costs(1001);
  for (double& cost : costs) cost = Timed([] {});
  return Median(costs);
}

}  // namespace

/// Does what Simulator::Tick does, but for publishing, rule by rule.
class Simulator::TickMeter {
 public:
  TickMeter(const Plan& plan, int samples)
      : plan_{plan}, context_{plan}, samples_{static_cast<std::size_t>(samples)} {
    context_.Evaluate(plan_.start.update_needs);
    for (const internal::Action& action : plan_.start.updates) action.step(context_.arena_);
    context_.CommitUpdates(plan_.start);
    for (const internal::Plan::RuleName& name : plan_.rule_names)
      rules_.push_back({name.block, std::vector<double>(samples_, kNotRun)});
    for (const internal::Rate& rate : plan_.rates)
      for (const internal::Action& action : rate.tick.updates)
        rules_.push_back({action.block, std::vector<double>(samples_, kNotRun)});
  }

  void Sample(std::size_t sample, double time) {
    sample_ = sample;
    context_.SetTime(time);
    context_.Invalidate(plan_.moving_dependents);
    EachTick([&](const Happening& h) { context_.Invalidate(h.stale); });
    for (std::uint32_t w = 0; w < plan_.words; ++w) {
      std::uint64_t held = 0;
      EachTick([&](const Happening& h) { held |= context_.Word(h.held, w); });
      RunWord(w, held);
    }
    EachTick([&](const Happening& h) { Evaluate(h.publish_needs); });
    EachTick([&](const Happening& h) { Evaluate(h.update_needs); });
    std::size_t rule = plan_.steps.size();
    EachTick([&](const Happening& h) {
      for (const internal::Action& action : h.updates) Run(action.step, rule++);
    });
    EachTick([&](const Happening& h) { context_.CommitUpdates(h); });
  }

  /// Of the rules that ran in most of the samples, and so at a tick.
  TickCost Total() {
    const double clock = CostOfTheClock();
    std::map<const Block*, TickCost::Block> blocks;
    TickCost total{};
    for (Rule& rule : rules_) {
      const double cost = Median(rule.costs);
      if (cost == kNotRun) continue;
      TickCost::Block& block = blocks[rule.block];
      block.cost += std::max(0.0, cost - clock);
      ++block.rules;
      ++total.rules;
    }
    for (auto& [block, cost] : blocks) {
      cost.path = block->path();
      total.blocks.push_back(std::move(cost));
    }
    std::ranges::sort(total.blocks, [](const TickCost::Block& a, const TickCost::Block& b) {
      return a.cost != b.cost ? a.cost > b.cost : a.path < b.path;
    });
    for (const TickCost::Block& block : total.blocks) total.cost += block.cost;
    return total;
  }

 private:
  struct Rule {
    const Block* block;
    std::vector<double> costs;  // [s] of each sample
  };

  template <class Act>
  void EachTick(const Act& act) {
    for (const internal::Rate& rate : plan_.rates) act(rate.tick);
  }

  void Evaluate(const internal::Bits& needed) {
    for (std::uint32_t w = needed.first; w < needed.first + needed.size; ++w)
      RunWord(w, context_.Word(needed, w));
  }

  void RunWord(std::uint32_t w, std::uint64_t needed) {
    std::uint64_t& valid = context_.Valid()[w];
    for (std::uint64_t run = needed & ~valid; run; run &= run - 1) {
      const std::size_t rule =
          64 * std::size_t{w} + static_cast<std::size_t>(std::countr_zero(run));
      Run(plan_.steps[rule], rule);
    }
    valid |= needed;
  }

  void Run(const internal::Step& step, std::size_t rule) {
    rules_[rule].costs[sample_] = Timed([&] { step(context_.arena_); });
  }

  const Plan& plan_;
  Context context_;
  const std::size_t samples_;
  std::size_t sample_ = 0;
  std::vector<Rule> rules_;  // the numbered ones, then the updates of each rate
};

TickCost EstimateTickCost(const Diagram& diagram, int samples) {
  const Plan& plan = diagram.plan();
  Require(samples >= 1, "samples must be >= 1", samples);
  Require(!plan.rates.empty(), "nothing ticks: no rule of the diagram has Every(period)");
  double period = seconds(plan.rates.front().period);
  for (const internal::Rate& rate : plan.rates) period = std::min(period, seconds(rate.period));
  Simulator::TickMeter meter(plan, samples);
  for (int k = 0; k < samples; ++k) meter.Sample(static_cast<std::size_t>(k), k * period);
  TickCost cost = meter.Total();
  cost.period = period;
  return cost;
}

std::string TickCost::text(int limit) const {
  std::string text = "estimated " + TimeText(cost) + " a tick of " + TimeText(period) + ", " +
                     Text(rules) + (rules == 1 ? " rule" : " rules");
  const std::size_t named = std::min(blocks.size(), static_cast<std::size_t>(std::max(0, limit)));
  for (std::size_t i = 0; i < named; ++i)
    text += (i == 0 ? "; " : ", ") + blocks[i].path + " " + TimeText(blocks[i].cost);
  if (const std::size_t more = blocks.size() - named; more > 0 && named > 0)
    text += " and " + Text(more) + (more == 1 ? " more block" : " more blocks");
  return text;
}

}  // namespace pliant
