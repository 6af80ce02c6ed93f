#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/systems/signal.h"
#include "pliant/systems/space.h"

namespace pliant {

/// A shape on a link, to draw or to keep clear of. The length of a capsule is that of its axis.
struct Shape {
  enum class Kind { Box, Sphere, Cylinder, Capsule };

  std::string name;
  Kind kind = Kind::Sphere;
  Pose pose;  ///< X_LS of the shape's centre in the link; cylinder, capsule: along z
  Eigen::Vector3d size = Eigen::Vector3d::Zero();   ///< box: edges; else (radius, length, 0) [m]
  Eigen::Vector4d color = Eigen::Vector4d::Ones();  ///< red, green, blue, opacity, each in [0, 1]
};

/// Mass, centre of mass and inertia about the centre of mass, in the axes of the link.
struct Inertial {
  double mass = 0;                                    ///< [kg]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   ///< [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< [kg·m²]
};

/// A link is a frame; it moves with its body.
struct Link {
  std::string name;
  int body = -1;                  ///< index of its body, −1: fixed to the world
  Pose pose;                      ///< X_BL, of the link in its body's frame, or in the world
  Inertial inertial;              ///< all zero: only a frame
  std::vector<Shape> visuals;     ///< boxes, spheres, cylinders
  std::vector<Shape> collisions;  ///< boxes, spheres, cylinders, capsules
};

/// A movable joint. For a prismatic one read m for rad and N for N·m.
struct Joint {
  enum class Type { Revolute, Continuous, Prismatic };

  std::string name;
  Type type = Type::Revolute;
  int parent = -1, child = -1;  ///< indices of links
  double lower = 0, upper = 0;  ///< [rad]; continuous: ∓∞
  double velocity = 0;          ///< largest speed [rad/s]; ∞ if a continuous joint states none
  double effort = 0;            ///< largest torque [N·m]; ∞ if a continuous joint states none
  double damping = 0;           ///< as in the file, not part of the dynamics [N·m·s/rad]
  double friction = 0;          ///< as in the file, not part of the dynamics [N·m]
};

/// Links that are fixed to one another, moved by one joint about or along z of the body's frame.
struct Body {
  int parent = -1;       ///< index of a body before this one, −1: the world
  int joint = -1;        ///< index of the joint that moves it
  bool revolute = true;  ///< about z; otherwise along z
  Pose pose;             ///< X_PB, of this body in its parent at q = 0
  double mass = 0;       ///< m [kg]
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();   ///< m c, first moment of mass [kg·m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the body's origin [kg·m²]
};

/// A robot arm: a tree of links on a fixed base, joined by revolute, continuous, prismatic and
/// fixed joints. Immutable, cheap to copy.
///
/// Joints and links have the order in which the file names them; `joints()` are the movable ones.
/// The world is the frame of the root link.
class RobotModel {
 public:
  /// A robot without links, until one is assigned.
  RobotModel();

  /// Reads a URDF file. Everything that makes no robot is refused with file, line, what was
  /// expected and what was found; so are floating and planar joints, mimic joints, and joints
  /// without `<axis>`, which URDF would take for x. A link without `<inertial>` has no mass, an
  /// `<origin>` left out is the identity, an axis of any length is normalised. Meshes and textures
  /// are not read. Collision shapes named N_capsule_body, N_capsule_a and N_capsule_b (a cylinder
  /// and two spheres) become one capsule N_capsule.
  ///
  /// Source: wiki.ros.org/urdf/XML.
  static RobotModel FromUrdf(const std::filesystem::path& file);

  /// The same from a text; `source` stands for the file's name in messages.
  static RobotModel FromUrdfText(const std::string& text, const std::string& source = "URDF");

  const std::string& name() const;
  const Joints& joints() const;
  int size() const { return joints().size(); }  ///< number of movable joints

  std::span<const Link> links() const;
  std::span<const Joint> joint_data() const;  ///< in the order of `joints()`
  std::span<const Body> bodies() const;       ///< parents first
  const Link& link(int index) const { return links()[static_cast<std::size_t>(index)]; }
  const Joint& joint(int index) const { return joint_data()[static_cast<std::size_t>(index)]; }

  /// Indices of names; unknown ones are refused with the nearest known name.
  int link_index(std::string_view name) const;
  int joint_index(std::string_view name) const;

  JointPosition lower_limit() const;
  JointPosition upper_limit() const;
  JointVelocity velocity_limit() const;
  JointTorque effort_limit() const;

  double mass() const;                     ///< of everything that moves [kg]
  const Eigen::Vector3d& gravity() const;  ///< in the world, (0, 0, −9.80665) unless said [m/s²]

  RobotModel WithGravity(const Eigen::Vector3d& gravity) const;
  /// With a mass fixed to a link, in addition to the link's own.
  RobotModel WithPayload(std::string_view link, const Inertial& payload) const;
  /// With other figures for a link, such as identified ones.
  RobotModel WithInertial(std::string_view link, const Inertial& inertial) const;

  bool operator==(const RobotModel& o) const { return data_ == o.data_; }  ///< the same instance

 private:
  struct Data;
  explicit RobotModel(std::shared_ptr<const Data> data) : data_{std::move(data)} {}
  static std::shared_ptr<Data> Assemble(const std::string& text, const std::string& source);

  std::shared_ptr<const Data> data_;
};

}  // namespace pliant
