#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pliant/controllers/pose_reference.h"
#include "pliant/diagrams/scenario.h"
#include "pliant/systems/pulse.h"

namespace pliant::internal {

inline Duration Seconds(double s) {
  return Duration::Nanoseconds(static_cast<std::int64_t>(std::round(1e9 * s)));
}

/// Where a hand that follows a pose wants its point, and how fast.
class HandCourse final : public Block {
 public:
  HandCourse() {
    Compute(path).From(pose).As([](const Pose& X) { return Position(X.position); });
    Compute(velocity).From(twist).As([](const Twist& V) { return LinearVelocity(V.tail<3>()); });
  }
  Input<Pose> pose{this, "pose"};
  Input<Twist> twist{this, "twist"};
  Output<Position> path{this, "path"};
  Output<LinearVelocity> velocity{this, "velocity"};
};

/// The way of a hand since it took hold.
inline PoseWaypoints::Options CourseOf(const HandHold& hold) {
  PoseWaypoints::Options course{.waypoints = {{.time_s = hold.start_s, .pose = {}}}};
  for (const HandWaypoint& next : hold.path) {
    const double time = hold.start_s + next.after_s;
    Require(time > course.waypoints.back().time_s,
            "after_s of a hand's path must be in order of time", next.after_s);
    course.waypoints.push_back({.time_s = time, .pose = {.position = next.by}});
  }
  return course;
}

/// The recorder of a scenario, if there is a sink, and its blocks that may end the run: their
/// inputs, to connect what they watch to.
std::vector<AnyInputs*> AddWatchers(DiagramBuilder& builder, const Scenario& scenario,
                                    Duration control_period, std::shared_ptr<RecordSink> sink);

/// Adds the parts of an environment, named push_1, push_2, hand_1, …
class Environment {
 public:
  Environment(DiagramBuilder& builder, SimulatedArm& arm, ContactTorque& true_torque,
              const RobotModel& model, Duration period)
      : builder_{builder}, arm_{arm}, true_torque_{true_torque}, model_{model}, period_{period} {}

  /// A push that changes at the controller's ticks only, so that the true torque is what acts.
  void operator()(Push::Options push) {
    push.model = model_;
    push.period = period_;
    Contact(builder_.Add<Push>(Name("push", ++pushes_), push).force);
  }
  void operator()(const HandHold& hold) {
    Hand::Options options = hold.hand;
    options.model = model_;
    options.anchored = true;
    const std::string name = Name("hand", ++hands_);
    auto& grip = builder_.Add<Pulse<double>>(
        name + "_grip",
        {.high = 1, .at = Seconds(hold.start_s), .width = Seconds(hold.duration_s)});
    auto& hand = builder_.Add<Hand>(name, options);
    auto& way = builder_.Add<PoseWaypoints>(name + "_way", CourseOf(hold));
    auto& course = builder_.Add<HandCourse>(name + "_course");
    builder_.Connect(way.pose, course.pose);
    builder_.Connect(way.twist, course.twist);
    builder_.Connect(course.path, hand.path);
    builder_.Connect(course.velocity, hand.path_velocity);
    builder_.Connect(grip.y, hand.grip);
    builder_.Connect(arm_.motion, hand.motion);
    Contact(hand.contact);
  }
  void operator()(MassOnRope::Options rope) {
    rope.model = model_;
    auto& mass = builder_.Add<MassOnRope>(Name("mass", ++masses_), rope);
    builder_.Connect(arm_.motion, mass.motion);
    Contact(mass.contact);
    recorded.push_back(&mass.position);
    recorded.push_back(&mass.tension);
  }
  void operator()(Surface::Options plane) {
    plane.model = model_;
    auto& surface = builder_.Add<Surface>(Name("surface", ++surfaces_), plane);
    builder_.Connect(arm_.motion, surface.motion);
    Contact(surface.contact);
    recorded.push_back(&surface.penetration);
  }

  void operator()(LivePush::Options push) {
    push.model = model_;
    push.period = period_;
    live_push = &builder_.Add<LivePush>(Name("live_push", ++live_pushes_), push);
    Contact(live_push->force);
  }

  std::vector<const Output<ContactForce>*> contacts;
  std::vector<const internal::Value*> recorded;
  LivePush* live_push = nullptr;  // the last one

 private:
  static std::string Name(const char* kind, int number) {
    return std::string(kind) + "_" + std::to_string(number);
  }
  void Contact(const Output<ContactForce>& contact) {
    builder_.Connect(contact, arm_.contacts);
    builder_.Connect(contact, true_torque_.contacts);
    contacts.push_back(&contact);
    recorded.push_back(&contact);
  }

  DiagramBuilder& builder_;
  SimulatedArm& arm_;
  ContactTorque& true_torque_;
  const RobotModel model_;
  const Duration period_;
  int pushes_ = 0, hands_ = 0, masses_ = 0, surfaces_ = 0, live_pushes_ = 0;
};

}  // namespace pliant::internal
