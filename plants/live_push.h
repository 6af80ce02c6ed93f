#pragma once

#include "pliant/plants/contacts.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// A push that somebody gives while a run goes on: `hand`, as far as it can act on the arm, sampled
/// every h and held,
///
///   F(k h) = hand   if its link is one of the model's and its numbers are finite
///            0      else
///
/// A log has what was given, so a run with it can be replayed.
class LivePush final : public Block {
 public:
  struct Options {
    static constexpr const char* kTag = "LivePush";

    RobotModel model;
    Duration period = 1ms;  ///< h

    template <class F>
    void Parameters(F&&) {}
  };

  explicit LivePush(const Options& o) : model_{o.model} {
    Every(o.period).Compute(force).From(hand).As(&LivePush::Sample);
  }

  Input<ContactForce> hand{this, "hand", {}, ContactForce{}};  ///< none if not connected
  Output<ContactForce> force{this, "force"};

 private:
  ContactForce Sample(const ContactForce& F) const {
    const bool acts = IsLink(model_, F.link) && F.point.allFinite() && F.force.allFinite() &&
                      F.moment.allFinite();
    return acts ? F : ContactForce{};
  }

  const RobotModel model_;
};

}  // namespace pliant
