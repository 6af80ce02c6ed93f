#include "pliant/plants/urdf.h"

#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cctype>
#include <limits>
#include <mutex>

#include "pliant/systems/error.h"

namespace pliant::internal {
namespace {

using Eigen::Vector3d;

/// Collects what urdfdom would print.
class Messages : public console_bridge::OutputHandler {
 public:
  Messages() : lock_{mutex_} { console_bridge::useOutputHandler(this); }
  ~Messages() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_WARN) all += "\n  " + text;
  }

  std::string all;

 private:
  static inline std::mutex mutex_;  // there is one handler for the process
  std::lock_guard<std::mutex> lock_;
};

Vector3d From(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }
Pose From(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {From(pose.position), Eigen::Quaterniond(r.w, r.x, r.y, r.z).toRotationMatrix()};
}

/// Appends the shape, unless it is a mesh.
void AppendShape(const std::string& name, const urdf::Pose& pose, const urdf::Geometry& geometry,
                 const Eigen::Vector4d& color, std::vector<Shape>& shapes) {
  Shape shape{name, Shape::Kind::Box, From(pose), Vector3d::Zero(), color};
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
    shape.size = From(box->dim);
  } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
    shape.kind = Shape::Kind::Sphere;
    shape.size.x() = sphere->radius;
  } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
    shape.kind = Shape::Kind::Cylinder;
    shape.size << cylinder->radius, cylinder->length, 0;
  } else {
    return;
  }
  shapes.push_back(shape);
}

/// Makes one capsule of N_capsule_body, N_capsule_a and N_capsule_b.
void FuseCapsules(std::vector<Shape>& shapes) {
  const auto find = [&](const std::string& name, Shape::Kind kind) {
    return std::ranges::find_if(shapes,
                                [&](const Shape& s) { return s.name == name && s.kind == kind; });
  };
  const std::string ending = "_capsule_body";
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!shapes[i].name.ends_with(ending) || shapes[i].kind != Shape::Kind::Cylinder) continue;
    const std::string name = shapes[i].name.substr(0, shapes[i].name.size() - 5);
    const auto a = find(name + "_a", Shape::Kind::Sphere),
               b = find(name + "_b", Shape::Kind::Sphere);
    if (a == shapes.end() || b == shapes.end()) continue;
    const Vector3d axis = b->pose.position - a->pose.position;
    Shape& capsule = shapes[i];
    capsule.name = name;
    capsule.kind = Shape::Kind::Capsule;
    capsule.size << a->size.x(), axis.norm(), 0;
    capsule.pose.position = 0.5 * (a->pose.position + b->pose.position);
    capsule.pose.rotation.col(2) = axis.normalized();
    capsule.pose.rotation.col(0) = axis.unitOrthogonal();
    capsule.pose.rotation.col(1) = capsule.pose.rotation.col(2).cross(capsule.pose.rotation.col(0));
    std::erase_if(shapes,
                  [&](const Shape& s) { return s.name == name + "_a" || s.name == name + "_b"; });
    i = 0;
  }
}

Link From(const urdf::Link& from) {
  Link link;
  link.name = from.name;
  if (from.inertial) {
    const urdf::Inertial& i = *from.inertial;
    const Pose pose = From(i.origin);
    Eigen::Matrix3d I;
    I << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
    link.inertial = {i.mass, pose.position, pose.rotation * I * pose.rotation.transpose()};
  }
  const Eigen::Vector4d grey{0.7, 0.7, 0.7, 1};
  for (const auto& visual : from.visual_array) {
    const urdf::Material* m = visual->material.get();
    const Eigen::Vector4d color =
        m ? Eigen::Vector4d(m->color.r, m->color.g, m->color.b, m->color.a) : grey;
    AppendShape(visual->name, visual->origin, *visual->geometry, color, link.visuals);
  }
  for (const auto& collision : from.collision_array)
    AppendShape(collision->name, collision->origin, *collision->geometry, grey, link.collisions);
  FuseCapsules(link.collisions);
  return link;
}

UrdfJoint From(const urdf::Joint& from) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  UrdfJoint j;
  j.origin = From(from.parent_to_joint_origin_transform);
  j.joint.name = from.name;
  j.fixed = from.type == urdf::Joint::FIXED;
  if (j.fixed) return j;
  j.axis = From(from.axis).normalized();
  j.joint.type = from.type == urdf::Joint::PRISMATIC    ? Joint::Type::Prismatic
                 : from.type == urdf::Joint::CONTINUOUS ? Joint::Type::Continuous
                                                        : Joint::Type::Revolute;
  const bool endless = from.type == urdf::Joint::CONTINUOUS;
  j.joint.lower = endless ? -kInfinity : from.limits->lower;
  j.joint.upper = endless ? kInfinity : from.limits->upper;
  j.joint.velocity = from.limits ? from.limits->velocity : kInfinity;
  j.joint.effort = from.limits ? from.limits->effort : kInfinity;
  if (from.dynamics) {
    j.joint.damping = from.dynamics->damping;
    j.joint.friction = from.dynamics->friction;
  }
  return j;
}

}  // namespace

UrdfRobot ReadUrdf(const std::string& text, const std::string& source) {
  CheckUrdf(text, source);
  // XML counts tabs and line ends inside an attribute as blanks, urdfdom does not.
  std::string blanks = Padded(text);
  std::ranges::replace_if(
      blanks, [](unsigned char c) { return std::isspace(c) != 0; }, ' ');
  Messages messages;
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(blanks);
  Require(model != nullptr, source + ": urdfdom cannot read this file:" + messages.all);

  // urdfdom sorts by name; the document knows the order of the file, and the lines.
  TiXmlDocument document;
  document.Parse(Padded(text).c_str(), nullptr, TIXML_ENCODING_UTF8);
  const TiXmlElement& root = *document.RootElement();
  UrdfRobot robot;
  robot.name = model->getName();
  robot.source = source;
  // Tabs, and references such as &#955;, are something else to urdfdom.
  const auto named = [&](const auto& found, const TiXmlElement& e) {
    if (!found)
      throw Error(source + ":" + Text(e.Row()) + ": not every reader reads the name \"" +
                  e.Attribute("name") +
                  "\" alike; write it without tabs, line ends and references to characters");
    return *found;
  };
  for (const TiXmlElement* e = root.FirstChildElement("link"); e; e = e->NextSiblingElement("link"))
    robot.links.push_back(From(named(model->getLink(e->Attribute("name")), *e)));
  const auto index = [&](const std::string& name) {
    return static_cast<int>(std::ranges::find(robot.links, name, &Link::name) -
                            robot.links.begin());
  };
  for (const TiXmlElement* e = root.FirstChildElement("joint"); e;
       e = e->NextSiblingElement("joint")) {
    const urdf::Joint from = named(model->getJoint(e->Attribute("name")), *e);
    UrdfJoint j = From(from);
    j.line = e->Row();
    j.joint.parent = index(from.parent_link_name);
    j.joint.child = index(from.child_link_name);
    robot.joints.push_back(j);
  }
  robot.root = index(model->getRoot()->name);
  return robot;
}

}  // namespace pliant::internal
