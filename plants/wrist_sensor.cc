#include "pliant/plants/wrist_sensor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// What random numbers are for: other numbers than in other sensors, so that all may have one seed.
enum Use : std::uint64_t { kNoise = 200, kBias };

constexpr int kMostSteps = 1000;  // of delay; each is a state of its own

bool Carries(const RobotModel& model, int body, int other) {
  while (other != body && other >= 0)
    other = model.bodies()[static_cast<std::size_t>(other)].parent;
  return other == body;
}

/// Indices of the links beyond the sensing plane, which must move with what is sensed.
std::vector<int> Beyond(const WristSensor::Options& o) {
  const int body = o.model.link(o.model.link_index(o.frame)).body;
  std::vector<int> links;
  for (const std::string& name : o.beyond.empty() ? std::vector{o.frame} : o.beyond) {
    const int link = o.model.link_index(name);
    Require(Carries(o.model, body, o.model.link(link).body),
            "every link beyond the sensing plane must be carried by \"" + o.frame + "\"",
            "\"" + name + "\"");
    Require(!std::ranges::count(links, link), "every link beyond is named once",
            "\"" + name + "\" again");
    links.push_back(link);
  }
  return links;
}

Wrench Checked(const Wrench& w, const char* name, const Range& range) {
  RequireEachInRange(name, w, Wrench::quantity.unit, range);
  return w;
}

/// n of n h.
int StepsOf(Duration delay, Duration period) {
  Require(Duration{} < period, "a period must be > 0", period.text());
  int steps = 0;
  Duration sum;
  for (; sum < delay && steps < kMostSteps; ++steps) sum = sum + period;
  Require(sum == delay,
          "delay must be 0 to " + Text(kMostSteps) + " whole periods of " + period.text(),
          delay.text());
  return steps;
}

}  // namespace

WristSensor::WristSensor(const Options& o)
    : motion{this, "motion", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      contacts{this, "contacts"},
      wrench{this, "wrench", Frame(o.frame)},
      true_wrench{this, "true_wrench", Frame(o.frame)},
      model_{o.model},
      link_{o.model.link_index(o.frame)},
      beyond_{Beyond(o)},
      h_{seconds(o.period)},
      alpha_{o.cutoff_hz == 0 ? 1 : 1 - std::exp(-2 * std::numbers::pi * o.cutoff_hz * h_)},
      sigma_{Checked(o.noise, "noise", kNotNegative)},
      bias_{Checked(o.bias, "bias", kAnyNumber)},
      range_{Checked(o.range, "range", kNotNegative)},
      random_{RandomStream(o.seed).Part(kNoise)},
      filtered_{this, "filtered", Frame(o.frame)} {
  RequireInRange("", "cutoff_hz", o.cutoff_hz, "Hz", kNotNegative);
  constexpr auto same = [](const Wrench& w) { return w; };
  const PeriodicEvent tick = Every(o.period);
  Compute(true_wrench).From(motion, acceleration, contacts).As(&WristSensor::Load);
  tick.Compute(filtered_).From(filtered_, true_wrench, clock).As(&WristSensor::Filter);
  const int n = StepsOf(o.delay, o.period);
  for (int i = 1; i <= n; ++i) {
    past_.emplace_back(this, "past_" + std::to_string(i), Frame(o.frame));
    AtStart().Update(past_.back()).From(true_wrench).As(same);
    if (i == 1)
      tick.Update(past_.back()).From(filtered_).As(same);
    else
      tick.Update(past_.back()).From(past_[past_.size() - 2]).As(same);
  }
  if (n == 0)
    tick.Compute(wrench).From(filtered_, clock).As(&WristSensor::Read);
  else
    tick.Compute(wrench).From(past_.back(), clock).As(&WristSensor::Read);
}

Wrench WristSensor::Load(const RobotDynamics& d, const JointAcceleration& vdot,
                         const Joined<ContactForce>& joined) const {
  const Pose X_WS = LinkPose(model_, d, link_);
  Vector3d moment = Vector3d::Zero(), force = Vector3d::Zero();
  for (const int l : beyond_) {
    const auto& [m, c, I_L] = model_.link(l).inertial;
    const FrameDynamics at_c = PointDynamics(model_, d, l, c);
    const Vector6 A = at_c.J.lazyProduct(vdot) + at_c.Jdot_v;
    const Vector3d omega = at_c.twist.head<3>();
    const Matrix3d I = at_c.pose.rotation * I_L * at_c.pose.rotation.transpose();
    const Vector3d f = m * (model_.gravity() - A.tail<3>());
    const Vector3d I_omega = I * omega;
    moment +=
        (at_c.pose.position - X_WS.position).cross(f) - I * A.head<3>() - omega.cross(I_omega);
    force += f;
  }
  for (int i = 0; i < joined.size(); ++i) {
    const ContactForce& contact = joined[i];
    if (!std::ranges::count(beyond_, contact.link)) continue;
    const Pose X_WL = LinkPose(model_, d, contact.link);
    const Vector3d p = X_WL.position + X_WL.rotation * contact.point;
    moment += contact.moment + (p - X_WS.position).cross(contact.force);
    force += contact.force;
  }
  Wrench W;
  W.head<3>() = X_WS.rotation.transpose() * moment;
  W.tail<3>() = X_WS.rotation.transpose() * force;
  return W;
}

Wrench WristSensor::Filter(const Wrench& last, const Wrench& W, double t) const {
  if (alpha_ == 1 || TickAt(t, h_) == 0) return W;
  return last + alpha_ * (W - last);
}

Wrench WristSensor::Read(const Wrench& y, double t) const {
  const std::uint64_t k = TickAt(t, h_);
  Wrench reading = y + bias_;
  for (int i = 0; i < 6; ++i) {
    if (sigma_(i) > 0)
      reading(i) += sigma_(i) * random_.Part(static_cast<std::uint64_t>(i)).Normal(k);
    if (range_(i) > 0) reading(i) = std::clamp(reading(i), -range_(i), range_(i));
  }
  return reading;
}

WristSensor::Options SensOne(const RobotModel& model, std::uint64_t seed) {
  const RandomStream random = RandomStream(seed).Part(kBias);
  Wrench bias;
  for (int i = 0; i < 6; ++i)
    bias(i) = (i < 3 ? 0.1 : 3) * (2 * random.Uniform(static_cast<std::uint64_t>(i)) - 1);
  return {.model = model,
          .frame = "FT_sensor_wrench",
          .period = 1ms,
          .delay = 2ms,
          .noise = {0.0037, 0.0037, 0.0013, 0.16, 0.16, 0.16},
          .bias = bias,
          .range = {15, 15, 12, 500, 500, 1200},
          .seed = seed};
}

}  // namespace pliant
