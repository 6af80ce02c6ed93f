#pragma once

#include <atomic>
#include <memory>

#include "pliant/controllers/safety_supervisor.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What somebody who watches the arm says, from any thread, and what the supervisor answers.
struct OperatorPanel {
  std::atomic<bool> stop{false};
  std::atomic<std::uint32_t> acknowledged{0};

  std::atomic<SafetyState> state{SafetyState::Engaging};
  std::atomic<SafetyCause> cause{SafetyCause::None};
  std::atomic<int> joint{-1};
  std::atomic<double> value{0}, limit{0};
  std::atomic<bool> stopped{false};  ///< the run is to end
};

/// Brings the words of an operator to a supervisor and shows its report, at each tick. From
/// `stop_at_s` on the arm is stopped as if the operator had said so.
///
/// It reads and writes words of other threads, so a run is not repeated by restoring it.
class Operator final : public Block {
 public:
  struct Options {
    std::shared_ptr<OperatorPanel> panel = {};  ///< null: nobody is there
    double stop_at_s = kUnbounded;
    Duration period = 1ms;
  };

  explicit Operator(const Options& o)
      : report{this, "report"}, word{this, "word"}, panel_{o.panel}, stop_at_{o.stop_at_s} {
    Every(o.period).Compute(word).From(clock).As(&Operator::Say);
    Every(o.period).Publish().From(report).As(&Operator::Show);
  }

  Input<SafetyReport> report;
  Output<OperatorWord> word;

 private:
  OperatorWord Say(double t) const {
    return {.stop = t >= stop_at_ || (panel_ && panel_->stop),
            .acknowledged = panel_ ? panel_->acknowledged.load() : 0};
  }
  void Show(const SafetyReport& r) const {
    if (!panel_) return;
    panel_->cause = r.cause;
    panel_->joint = r.joint;
    panel_->value = r.value;
    panel_->limit = r.limit;
    panel_->state = r.state;
    if (r.state == SafetyState::Stopped) panel_->stopped = true;
  }

  const std::shared_ptr<OperatorPanel> panel_;
  const double stop_at_;
};

}  // namespace pliant
