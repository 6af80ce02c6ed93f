#include "pliant/plants/robot_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>

#include "pliant/plants/urdf.h"
#include "pliant/systems/error.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using internal::UrdfJoint;
using internal::UrdfRobot;

/// A rotation whose third column is `z`.
Matrix3d WithThirdAxis(const Vector3d& z) {
  if (z == Vector3d::UnitZ()) return Matrix3d::Identity();
  Matrix3d R;
  R.col(2) = z;
  R.col(0) = z.unitOrthogonal();
  R.col(1) = z.cross(R.col(0));
  return R;
}

/// −[c]²: the inertia of a unit mass at c about the origin.
Matrix3d PointInertia(const Vector3d& c) {
  return c.squaredNorm() * Matrix3d::Identity() - c * c.transpose();
}

std::string Quoted(const std::string& name) { return '"' + name + '"'; }

template <class T>
int IndexOf(std::string_view name, const std::vector<T>& all, const char* kind,
            const std::string& robot) {
  const auto it = std::ranges::find(all, name, &T::name);
  if (it != all.end()) return static_cast<int>(it - all.begin());
  std::vector<std::string> known;
  for (const T& item : all) known.push_back(item.name);
  std::string list;
  for (const std::string& item : known) list += (list.empty() ? "" : ", ") + item;
  throw Error("robot " + Quoted(robot) + " has no " + kind + ' ' + Quoted(std::string(name)) +
              internal::DidYouMean(name, known) + "\n  " + kind + "s: " + list);
}

}  // namespace

struct RobotModel::Data {
  std::string name;
  Joints joints;
  std::vector<Link> links;
  std::vector<Joint> joint_data;
  std::vector<Body> bodies;
  Vector3d gravity{0, 0, -9.80665};

  /// The mass of a body is that of its links. Refuses what makes M singular.
  void SumMasses(const std::string& source, const std::vector<int>& lines);
};

void RobotModel::Data::SumMasses(const std::string& source, const std::vector<int>& lines) {
  for (Body& body : bodies) {
    body.mass = 0;
    body.moment.setZero();
    body.inertia.setZero();
  }
  for (const Link& link : links) {
    if (link.body < 0) continue;
    Body& body = bodies[static_cast<std::size_t>(link.body)];
    const Inertial& i = link.inertial;
    const Vector3d c = link.pose.position + link.pose.rotation * i.center;
    const Matrix3d& R = link.pose.rotation;
    body.mass += i.mass;
    body.moment += i.mass * c;
    const Matrix3d I = R * i.inertia * R.transpose() + i.mass * PointInertia(c);
    body.inertia += 0.5 * (I + I.transpose());
  }
  std::vector<bool> carries(bodies.size(), false);
  for (std::size_t i = bodies.size(); i-- > 0;) {
    const Body& body = bodies[i];
    if (body.parent >= 0) carries[static_cast<std::size_t>(body.parent)] = true;
    if (carries[i]) continue;
    const double moved = body.revolute ? body.inertia(2, 2) : body.mass;
    if (moved > 0) continue;
    const Joint& j = joint_data[static_cast<std::size_t>(body.joint)];
    const int line = lines.empty() ? 0 : lines[static_cast<std::size_t>(body.joint)];
    throw Error(
        source + (line > 0 ? ":" + Text(line) : "") + ": joint " + Quoted(j.name) + " moves link " +
        Quoted(links[static_cast<std::size_t>(j.child)].name) +
        (body.revolute ? ", whose inertia about the joint's axis is 0" : ", whose mass is 0") +
        ": the joint inertia matrix would be singular; expected an <inertial> on this link or "
        "on one fixed to it");
  }
}

std::shared_ptr<RobotModel::Data> RobotModel::Assemble(const std::string& text,
                                                       const std::string& source) {
  UrdfRobot urdf = internal::ReadUrdf(text, source);
  auto data = std::make_shared<Data>();
  data->name = urdf.name;
  data->links = std::move(urdf.links);

  std::vector<std::string> names;
  std::vector<int> lines;
  for (const UrdfJoint& j : urdf.joints) {
    if (j.fixed) continue;
    Require(static_cast<int>(names.size()) < kMaxJoints,
            source + ":" + Text(j.line) + ": joint " + Quoted(j.joint.name) +
                " is movable joint number " + Text(names.size() + 1) + ", expected at most " +
                Text(kMaxJoints) +
                "; make some of them fixed, or configure with -DPLIANT_MAX_JOINTS=…");
    names.push_back(j.joint.name);
    lines.push_back(j.line);
    data->joint_data.push_back(j.joint);
  }
  Require(!names.empty(), source + ": robot " + Quoted(urdf.name) + " has no movable joint");
  data->joints = Joints(names);

  // From the root outwards; `reached` grows while it is read.
  std::vector<int> reached{urdf.root};
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const Link parent = data->links[static_cast<std::size_t>(reached[k])];
    int joint = -1;
    for (const UrdfJoint& j : urdf.joints) {
      if (!j.fixed) ++joint;
      if (j.joint.parent != reached[k]) continue;
      Link& child = data->links[static_cast<std::size_t>(j.joint.child)];
      const Pose X_BC = parent.pose * j.origin;
      if (j.fixed) {
        child.body = parent.body;
        child.pose = X_BC;
      } else {
        Body body;
        body.parent = parent.body;
        body.joint = joint;
        body.revolute = j.joint.type != Joint::Type::Prismatic;
        const Matrix3d R = WithThirdAxis(j.axis);
        body.pose = X_BC * Pose{Vector3d::Zero(), R};
        child.body = static_cast<int>(data->bodies.size());
        child.pose = Pose{Vector3d::Zero(), R.transpose()};
        data->bodies.push_back(body);
      }
      reached.push_back(j.joint.child);
    }
  }
  data->SumMasses(source, lines);
  return data;
}

RobotModel RobotModel::FromUrdf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  Require(in && !std::filesystem::is_directory(file),
          file.string() +
              ": cannot read this file; expected a URDF file (relative paths start at " +
              std::filesystem::current_path().string() + ")");
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return FromUrdfText(text, file.string());
}

RobotModel RobotModel::FromUrdfText(const std::string& text, const std::string& source) {
  return RobotModel(Assemble(text, source));
}

RobotModel::RobotModel() : data_{std::make_shared<const Data>()} {}

const std::string& RobotModel::name() const { return data_->name; }
const Joints& RobotModel::joints() const { return data_->joints; }
std::span<const Link> RobotModel::links() const { return data_->links; }
std::span<const Joint> RobotModel::joint_data() const { return data_->joint_data; }
std::span<const Body> RobotModel::bodies() const { return data_->bodies; }
const Vector3d& RobotModel::gravity() const { return data_->gravity; }

int RobotModel::link_index(std::string_view name) const {
  return IndexOf(name, data_->links, "link", data_->name);
}
int RobotModel::joint_index(std::string_view name) const {
  return IndexOf(name, data_->joint_data, "joint", data_->name);
}

namespace {
template <class S>
S Collect(std::span<const Joint> joints, double Joint::*field) {
  S all;
  all.resize(static_cast<Eigen::Index>(joints.size()));
  std::ranges::transform(joints, all.begin(), [field](const Joint& j) { return j.*field; });
  return all;
}
}  // namespace

JointPosition RobotModel::lower_limit() const {
  return Collect<JointPosition>(joint_data(), &Joint::lower);
}
JointPosition RobotModel::upper_limit() const {
  return Collect<JointPosition>(joint_data(), &Joint::upper);
}
JointVelocity RobotModel::velocity_limit() const {
  return Collect<JointVelocity>(joint_data(), &Joint::velocity);
}
JointTorque RobotModel::effort_limit() const {
  return Collect<JointTorque>(joint_data(), &Joint::effort);
}

double RobotModel::mass() const {
  double sum = 0;
  for (const Body& body : bodies()) sum += body.mass;
  return sum;
}

RobotModel RobotModel::WithGravity(const Vector3d& gravity) const {
  Require(gravity.allFinite(), "gravity must be finite", gravity.transpose());
  auto data = std::make_shared<Data>(*data_);
  data->gravity = gravity;
  return RobotModel(std::move(data));
}

RobotModel RobotModel::WithPayload(std::string_view link, const Inertial& payload) const {
  internal::CheckInertial(payload, "payload on link " + Quoted(std::string(link)));
  const Inertial& own = this->link(link_index(link)).inertial;
  Inertial sum;
  sum.mass = own.mass + payload.mass;
  sum.center = (own.mass * own.center + payload.mass * payload.center) / sum.mass;
  sum.inertia = own.inertia + own.mass * PointInertia(own.center - sum.center) + payload.inertia +
                payload.mass * PointInertia(payload.center - sum.center);
  return WithInertial(link, sum);
}

RobotModel RobotModel::WithInertial(std::string_view link, const Inertial& inertial) const {
  internal::CheckInertial(inertial, "inertial of link " + Quoted(std::string(link)));
  auto data = std::make_shared<Data>(*data_);
  data->links[static_cast<std::size_t>(link_index(link))].inertial = inertial;
  data->SumMasses("robot " + Quoted(name()), {});
  return RobotModel(std::move(data));
}

}  // namespace pliant
