#include "pliant/diagrams/contact_place.h"

#include <limits>

#include "pliant/systems/constant.h"

namespace pliant {

namespace {

/// The force at a place, and what it is off that of the nearest true contact.
class ForceAtPlace final : public Block {
 public:
  struct Options {
    RobotModel model;
    int place;
  };

  explicit ForceAtPlace(const Options& o)
      : dynamics{this, "dynamics", o.model.joints()},
        model_{o.model},
        place_{static_cast<std::size_t>(o.place)} {
    Compute(force).From(contacts).As(&ForceAtPlace::Of);
    Compute(error).From(contacts, true_contacts, dynamics).As(&ForceAtPlace::Error);
    Compute(observed)
        .From(contacts, true_contacts, observability, dynamics)
        .As(&ForceAtPlace::Observed);
  }

  Input<Contacts> contacts{this, "contacts"}, true_contacts{this, "true_contacts"};
  Input<ContactObservability> observability{this, "observability"};
  Input<RobotDynamics> dynamics;
  Output<Force> force{this, "force"}, error{this, "error"}, observed{this, "observed"};

 private:
  Force Of(const Contacts& all) const { return all.at[place_].force; }
  Force Error(const Contacts& all, const Contacts& truth, const RobotDynamics& d) const {
    return ErrorAt(place_, all, truth, d);
  }
  Force Observed(const Contacts& all, const Contacts& truth, const ContactObservability& seen,
                 const RobotDynamics& d) const {
    ContactObservability::Vector error;
    for (std::size_t i = 0; i < all.at.size(); ++i)
      error.segment<3>(static_cast<Eigen::Index>(3 * i)) = ErrorAt(i, all, truth, d);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int j = 0; j < seen.rank; ++j) {
      const ContactObservability::Vector u = seen.directions.col(j);
      sum += u.dot(error) * u.segment<3>(static_cast<Eigen::Index>(3 * place_));
    }
    return Force(sum);
  }
  Force ErrorAt(std::size_t place, const Contacts& all, const Contacts& truth,
                const RobotDynamics& d) const {
    const ContactForce& here = all.at[place];
    if (!IsLink(model_, here.link)) return Force(-truth.at[place].force);
    const Eigen::Vector3d x = MotionOf(model_, d, here.link, here.point).position;
    const ContactForce* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const ContactForce& contact : truth.at) {
      if (!IsLink(model_, contact.link)) continue;
      const double off = (MotionOf(model_, d, contact.link, contact.point).position - x).norm();
      if (off >= least) continue;
      least = off;
      nearest = &contact;
    }
    return nearest ? Force(here.force - nearest->force) : Force(here.force);
  }

  const RobotModel model_;
  const std::size_t place_;
};

}  // namespace

ContactPlace::ContactPlace(const Options& o)
    : contacts{this, "contacts"},
      true_contacts{this, "true_contacts"},
      observability{this, "observability"},
      dynamics{this, "dynamics", o.model.joints()},
      contact{this, "contact"},
      error{this, "error"},
      velocity{this, "velocity"},
      force{this, "force"},
      force_error{this, "force_error"},
      observed_error{this, "observed_error"},
      wanted{this, "wanted"},
      status{this, "status"},
      objective{this, "objective", o.model.joints()} {
  auto& anchor = Add<ContactAnchor>(
      "anchor",
      {.model = o.model, .place = o.place, .period = o.period, .same_point = o.same_point});
  auto& at = Add<ForceAtPlace>("force_at", {.model = o.model, .place = o.place});
  Connect(contacts, anchor.contacts);
  Connect(dynamics, anchor.dynamics);
  Connect(contacts, at.contacts);
  Connect(dynamics, at.dynamics);
  Connect(true_contacts, at.true_contacts);
  Connect(anchor.contact, contact);
  Connect(anchor.error, error);
  Connect(anchor.velocity, velocity);
  Connect(at.force, force);
  Connect(observability, at.observability);
  Connect(at.error, force_error);
  Connect(at.observed, observed_error);

  const auto follow = [&](auto& law) {
    Connect(anchor.contact, law.contact);
    Connect(dynamics, law.dynamics);
    Connect(law.objective, objective);
  };
  if (const auto* gains = std::get_if<ContactImpedance::Gains>(&o.behavior)) {
    follow(Add<ContactImpedance>("impedance",
                                 {.model = o.model, .gains = *gains, .weight = o.weight}));
    Connect(Add<Constant<Force>>("no_force", {.value = Force()}).y, wanted);
    Connect(Add<Constant<ContactForceStatus>>("no_status", {.value = ContactForceStatus::Idle}).y,
            status);
    return;
  }
  auto& regulation = Add<ContactForceControl>(
      "regulation", {.model = o.model,
                     .period = o.period,
                     .settings = std::get<ContactForceControl::Settings>(o.behavior),
                     .weight = o.weight});
  follow(regulation);
  Connect(regulation.wanted, wanted);
  Connect(regulation.status, status);
}

}  // namespace pliant
