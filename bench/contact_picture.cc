// A picture of the depth camera, as docs/contact-localization.md shows it: a KUKA LWR IV+ as the
// experiments start it, pushed on its wrist. Grey is depth, black no reading; what is left of the
// picture without the arm is yellow, a green cross is where the arm is pushed, a red one where the
// contact was localised.
//
//   contact_picture FILE.ppm

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <vector>

#include "pliant/estimators/contact_localization.h"
#include "pliant/plants/depth_camera.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/block_tester.h"

namespace pliant {
namespace {

using Color = std::array<unsigned char, 3>;

constexpr Color kLeft{230, 200, 60}, kTrue{40, 220, 60}, kFound{240, 40, 40};

/// A cross about a pixel.
void Mark(std::vector<Color>& picture, const Pinhole& view, const Eigen::Vector2d& at,
          const Color& color) {
  for (int along = -9; along <= 9; ++along)
    for (const auto& [dx, dy] : {std::pair(along, 0), std::pair(0, along)}) {
      const int column = static_cast<int>(std::lround(at.x())) + dx;
      const int row = static_cast<int>(std::lround(at.y())) + dy;
      if (column < 0 || column >= view.width || row < 0 || row >= view.height) continue;
      picture[static_cast<std::size_t>(row * view.width + column)] = color;
    }
}

void Write(const char* file) {
  const RobotModel model = RobotModel::FromUrdf(ModelFile("lwr/lwr4p.urdf"));
  const JointPosition q{0, 0.698, 0, -1.571, 0, 0.873, 0};
  RobotDynamics d(model);
  ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), d);
  const int link = model.link_index("link_6");
  const Pose X_WL = LinkPose(model, d, link);
  const ContactForce push{.link = link,
                          .point = X_WL.rotation.transpose() * Eigen::Vector3d(0, 0.0783, 0),
                          .force = {0, -20, 0},
                          .moment = Eigen::Vector3d::Zero()};

  DepthCamera::Options c{.model = model};
  c.view.pose = LookingAt({1.7, 0, 1.1}, {-0.2, 0, 0.5});
  BlockTester<DepthCamera> camera(c);
  camera.Join(camera->contacts, push);
  camera.Set(camera->position, q);
  camera.Tick();
  const DepthImage& image = camera.Get(camera->image);
  ContactLocalization::Options o{.model = model};
  o.view = c.view;
  BlockTester<ContactLocalization> localization(o);
  localization.Set(localization->dynamics, d);
  localization.Set(localization->image, image);
  localization.Tick();
  const ContactForce found = localization.Get(localization->contacts).at[0];
  const SelfFilter filter({.model = model, .view = c.view});
  SelfFilter::View left = filter.MakeView();
  filter.Apply(image, d, left);

  std::vector<Color> picture(image.depth.size());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const double z = image.depth[i];
    const auto grey = static_cast<unsigned char>(z > 0 ? std::fmax(40, 255 - 120 * (z - 1)) : 0);
    picture[i] = left.depth[i] > 0 ? kLeft : Color{grey, grey, grey};
  }
  const Pose X_CW = c.view.pose.inverse();
  const auto mark = [&](const ContactForce& contact, const Color& color) {
    const Eigen::Vector3d x = MotionOf(model, d, contact.link, contact.point).position;
    Mark(picture, c.view, c.view.Project(X_CW.position + X_CW.rotation * x), color);
    return x;
  };
  const Eigen::Vector3d truth = mark(push, kTrue);
  if (found.link >= 0) {
    const Eigen::Vector3d x = mark(found, kFound);
    std::printf("pushed on %s, found on %s, %.0f mm off\n", model.link(link).name.c_str(),
                model.link(found.link).name.c_str(), 1e3 * (x - truth).norm());
  } else {
    std::printf("pushed on %s, not seen\n", model.link(link).name.c_str());
  }
  std::ofstream out(file, std::ios::binary);
  out << "P6\n" << c.view.width << " " << c.view.height << "\n255\n";
  out.write(reinterpret_cast<const char*>(picture.data()),
            static_cast<std::streamsize>(3 * picture.size()));
  if (!out.flush()) throw Error(std::string("cannot write ") + file);
}

}  // namespace
}  // namespace pliant

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("contact_picture FILE.ppm\n", stderr);
    return 2;
  }
  try {
    pliant::Write(argv[1]);
  } catch (const pliant::Error& error) {
    std::fprintf(stderr, "contact_picture: %s\n", error.what());
    return 1;
  }
}
