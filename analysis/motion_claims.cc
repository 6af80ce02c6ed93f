#include "pliant/analysis/motion_claims.h"

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/analysis/series.h"
#include "pliant/analysis/signal_number.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

constexpr const char* kPosition = "tool.position";

const VirtualDoor::Options* DoorOf(const Scenario& scenario) {
  const auto& control = ComplianceOf(scenario.controller);
  return control.door ? &*control.door : nullptr;
}

/// A closed line about the hinge: its angle, rate, and way off the circle at each row.
struct Swing {
  Swing(const RunData& run, const VirtualDoor::Options& door)
      : axis{door.axis.normalized()}, theta(run.times().size()), rate(theta), off{0} {
    const Series& p = run[kPosition];
    const Series& V = run["tool.twist"];
    const auto from_hinge = [&](Eigen::Index k) {
      const Eigen::Vector3d r = p.col(k) - door.hinge;
      return Eigen::Vector3d(r - axis * axis.dot(r));
    };
    const Eigen::Vector3d r0 = from_hinge(0);
    for (Eigen::Index k = 0; k < theta.size(); ++k) {
      const Eigen::Vector3d r = from_hinge(k), moved = p.col(k) - p.col(0);
      theta(k) = std::atan2(axis.dot(r0.cross(r)), r0.dot(r));
      rate(k) = axis.cross(r).dot(V.col(k).tail<3>()) / r.squaredNorm();
      off = std::max(off, std::hypot(axis.dot(moved), r.norm() - r0.norm()));
    }
  }

  Eigen::Vector3d axis;
  Eigen::VectorXd theta, rate;
  double off;
};

/// τ_h − k (θ − θ₀) + τ_g − b θ̇ − c sgn θ̇ at each row.
Eigen::VectorXd MomentOf(const RunData& run, const VirtualDoor::Options& door, const Swing& swing) {
  const RobotModel& model = ModelOf(run.control);
  Eigen::VectorXd moment(swing.theta.size());
  RobotDynamics d(model, {ToolOf(run.control)});
  const Series& q = run["arm.position"];
  const std::vector<Push::Options> pushes = PushesOf(run.scenario);
  for (Eigen::Index k = 0; k < moment.size(); ++k) {
    const double turned = swing.theta(k);
    const Eigen::Vector3d arm =
        Eigen::AngleAxisd(turned, swing.axis) * Eigen::Vector3d(door.center - door.hinge);
    const double rate = swing.rate(k);
    moment(k) = -door.closer * (turned - door.rest_angle) +
                swing.axis.dot(arm.cross(Eigen::Vector3d(door.mass * model.gravity()))) -
                door.viscous * rate - door.coulomb * ((rate > 0) - (rate < 0));
    ComputeDynamics(model, q.col(k), JointVelocity::Zero(model.joints()), d);
    for (std::size_t i = 0; i < pushes.size(); ++i) {
      const Pose link = LinkPose(model, d, model.link_index(pushes[i].link));
      const Eigen::Vector3d at = link.position + link.rotation * pushes[i].point;
      const RecordedSignal& push = run.log["push_" + std::to_string(i + 1) + ".force"];
      const Eigen::Vector3d F(push.numbers(push.row("force[x]"), k),
                              push.numbers(push.row("force[y]"), k),
                              push.numbers(push.row("force[z]"), k));
      moment(k) += swing.axis.dot((at - door.hinge).cross(F));
    }
  }
  return moment;
}

}  // namespace

void MovesAlong::RequireFit(const Scenario& scenario) const {
  Require(direction.norm() > 0, "the length of direction must be > 0", direction.norm());
  RequireRowBetween(from_s, kUnbounded, scenario);
}

Claim MovesAlong::Check(const Runs& runs) const {
  const RunData& of = runs[run];
  const RowsBetween rows(of.times(), from_s, kUnbounded);
  const Series p = of[kPosition].middleCols(rows.begin, rows.size());
  const Series way = p.colwise() - p.col(0);
  const Eigen::Vector3d d = direction.normalized();
  const Eigen::RowVectorXd along = d.transpose() * way;
  const Series aside = way - d * along;
  const double longest = Largest(along.cwiseAbs()), across = Largest(Norms(aside));
  return claim.Stated(
      WithUnit(longest, "m") + " along, " + WithUnit(across, "m") + " across",
      "at least " + WithUnit(at_least, "m") + " along, across at most " + Text(part) + " of it",
      basis, longest >= at_least && across <= part * longest);
}

void KeepsDoor::RequireFit(const Scenario& scenario) const {
  const VirtualDoor::Options* door = DoorOf(scenario);
  Require(door, "the controller of its run has no door");
  Require(!door->stops, "the door of its run has stops, which no balance of moments knows");
  Require(!PushesOf(scenario).empty(), "there is no !Push in the environment of its run");
}

Claim KeepsDoor::Check(const Runs& runs) const {
  const RunData& of = runs[run];
  const VirtualDoor::Options& door = *DoorOf(of.scenario);
  const Swing swing(of, door);
  const Eigen::VectorXd moment = MomentOf(of, door, swing);
  const Eigen::VectorXd& t = of.times();
  double impulse = 0, xy = 0, xx = 0;
  for (Eigen::Index k = 1; k < t.size(); ++k) {
    impulse += 0.5 * (t(k) - t(k - 1)) * (moment(k) + moment(k - 1));
    const double change = swing.rate(k) - swing.rate(0);
    xy += change * impulse;
    xx += change * change;
  }
  const double inertia = xy / xx, error = inertia / door.inertia - 1;
  return claim.Stated(
      "at most " + WithUnit(swing.off, "m") + " off the circle while it turns by " +
          WithUnit(Largest(swing.theta.cwiseAbs()), "rad") + "; inertia " + Text(inertia) +
          " kg·m² for " + Text(door.inertia) + ", " + Text(std::round(1000 * error) / 10) + " %",
      "off the circle by at most " + WithUnit(off_circle, "m") + "; inertia within " +
          Text(100 * within) + " %",
      "the part of the inertia is that of the demonstration; the circle as the file says",
      swing.off <= off_circle && std::abs(error) <= within);
}

}  // namespace pliant
