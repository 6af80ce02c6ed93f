// How well contacts are found from a depth camera, over the whole surface of a KUKA LWR IV+: points
// drawn uniformly from the surface of each link, in several postures, pushed by 20 N within 20° of
// the inward normal. A camera as in the experiments renders the hand with its noise; the contact is
// localised from that one picture, and the force found from the residual by ContactForceEstimate.
//
//   contact_localization [SAMPLES [SEED]]
//
// SAMPLES for each link and posture, 60 unless told. Prints a table in Markdown.
//
// The link that the residual isolates is that of the last joint that feels three times its error.
// A point is drawn again where no hand fits: inside another link, or where the ball or the forearm
// would cut into one. `seen` is the share of the contacts of which something was localised, `link`
// the share of these on the right link. Errors of forces are those in the directions that joints
// feel at the place; `direction lost` is the share of pushes at whose true place that is not all
// three. The residual is exact, or off by a normal error as large as what a good model of this arm
// leaves in recordings.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pliant/estimators/contact_force_estimate.h"
#include "pliant/estimators/contact_localization.h"
#include "pliant/plants/depth_camera.h"
#include "pliant/plants/pushing_hand.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/block_tester.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kPostures = 8;  // the first is where the experiments start
constexpr double kForce = 20, kCone = 20 * std::numbers::pi / 180;
constexpr double kHand = 0.04, kForearm = 0.03, kForearmLength = 0.3;
/// Rms of the residual of a model fitted to recordings of an LWR4+ [N·m].
const PerJoint kResidualError{{0.28, 0.35, 0.22, 0.29, 0.25, 0.20, 0.24}};

struct Draw {
  double Uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
  }
  double Normal() { return std::normal_distribution<double>()(random); }
  Vector3d Direction() { return Vector3d(Normal(), Normal(), Normal()).normalized(); }
  std::mt19937_64 random;
};

JointPosition PostureOf(int index, const RobotModel& m, Draw& draw) {
  constexpr double kPi = std::numbers::pi;
  if (index == 0) return {0, 2 * kPi / 9, 0, -kPi / 2, 0, 5 * kPi / 18, 0};
  JointPosition q = JointPosition::Zero(m.joints());
  for (int i = 0; i < m.size(); ++i) q(i) = draw.Uniform(m.lower_limit()(i), m.upper_limit()(i));
  return q;
}

/// A point of a capsule's or a cylinder's surface, uniform by area.
SurfacePoint OnSurface(const Solid& s, Draw& draw) {
  const double side = 2 * s.half.z(), ball = s.kind == Solid::Kind::Round ? 2 * s.radius : s.radius;
  const Vector3d a = s.axis();
  if (draw.Uniform(0, side + ball) < side) {  // areas over 2πr
    Vector3d n = draw.Direction();
    n = (n - n.dot(a) * a).normalized();
    const double along = draw.Uniform(-s.half.z(), s.half.z());
    return {0, s.center + along * a + s.radius * n, n};
  }
  const Vector3d n = draw.Direction();
  const double end = n.dot(a) < 0 ? -1 : 1;
  return {0, s.center + end * s.half.z() * a + s.radius * n, n};
}

double Quantile(std::vector<double> x, double p) {
  if (x.empty()) return NAN;
  std::ranges::sort(x);
  return x[std::min(x.size() - 1, static_cast<std::size_t>(p * static_cast<double>(x.size())))];
}

struct Row {
  int pushes = 0, seen = 0, right_link = 0, lost_rank = 0;
  std::vector<double> place, exact, noisy, known;
};

class Study {
 public:
  explicit Study(std::uint64_t seed) : draw_{std::mt19937_64(seed)} {
    view_.pose = LookingAt({1.7, 0, 1.1}, {-0.2, 0, 0.5});
  }

  void Run(int samples) {
    for (int p = 0; p < kPostures; ++p) {
      q_ = PostureOf(p, model_, draw_);
      ComputeDynamics(model_, q_, JointVelocity::Zero(model_.joints()), d_);
      surface_.Place(d_, Pose(), 0, placed_);
      for (int part = 0; part < surface_.size(); ++part) {
        if (surface_.part(part).body < 0) continue;
        for (int k = 0; k < samples; ++k) Push(part);
      }
    }
  }

  bool Print() const {
    std::printf(
        "| link | pushes | seen | right link | place median | 95 %% | force, true place | "
        "exact residual median | 95 %% | residual with errors median | 95 %% | "
        "direction lost |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    Row all;
    for (int part = 0; part < surface_.size(); ++part) {
      if (surface_.part(part).body < 0) continue;
      const Row& row = rows_[static_cast<std::size_t>(part)];
      PrintRow(model_.link(surface_.part(part).link).name.c_str(), row);
      all.pushes += row.pushes;
      all.seen += row.seen;
      all.right_link += row.right_link;
      all.lost_rank += row.lost_rank;
      for (const auto& list : {&Row::place, &Row::exact, &Row::noisy, &Row::known})
        (all.*list).insert((all.*list).end(), (row.*list).begin(), (row.*list).end());
    }
    PrintRow("all", all);
    return Quantile(all.place, 0.5) < 0.04;  // a hand's thickness: anything worse is broken
  }

 private:
  static void PrintRow(const char* name, const Row& r) {
    const auto share = [](int n, int of) { return of ? 100.0 * n / of : NAN; };
    std::printf(
        "| %s | %d | %.0f %% | %.0f %% | %.1f mm | %.1f mm | %.1f N | %.1f N | %.1f N | "
        "%.1f N | %.1f N | %.0f %% |\n",
        name, r.pushes, share(r.seen, r.pushes), share(r.right_link, r.seen),
        1e3 * Quantile(r.place, 0.5), 1e3 * Quantile(r.place, 0.95), Quantile(r.known, 0.5),
        Quantile(r.exact, 0.5), Quantile(r.exact, 0.95), Quantile(r.noisy, 0.5),
        Quantile(r.noisy, 0.95), share(r.lost_rank, r.pushes));
  }

  /// Whether a hand at this point is off all links; its own is touched.
  bool Fits(const SurfacePoint& at, int part, const Vector3d& force) const {
    const Vector3d center = at.point + kHand * at.normal;
    const Vector3d elbow = center - kForearmLength * force.normalized();
    for (int i = 0; i < surface_.size(); ++i) {
      if (i == part) continue;
      const Solid& other = placed_[static_cast<std::size_t>(i)];
      if (NearestOn(other, center).distance < kHand) return false;
      for (double s = 0.1; s <= 1; s += 0.1)
        if (NearestOn(other, center + s * (elbow - center)).distance < kForearm) return false;
    }
    return true;
  }

  void Push(int part) {
    SurfacePoint at;
    Vector3d force;
    int tries = 0;
    do {
      if (++tries > 10'000) return;  // no hand gets there in this posture
      at = OnSurface(placed_[static_cast<std::size_t>(part)], draw_);
      Vector3d tilt = draw_.Direction();
      tilt = (tilt - tilt.dot(at.normal) * at.normal).normalized();
      const double angle = std::acos(1 - draw_.Uniform(0, 1 - std::cos(kCone)));
      force = -kForce * (std::cos(angle) * at.normal + std::sin(angle) * tilt);
    } while (!Fits(at, part, force));

    const int link = surface_.part(part).link;
    const Pose X_WL = LinkPose(model_, d_, link);
    const ContactForce push{link, X_WL.rotation.transpose() * (at.point - X_WL.position), force,
                            Vector3d::Zero()};
    Row& row = rows_[static_cast<std::size_t>(part)];
    ++row.pushes;
    const PerJoint r = ExternalTorque(model_, d_, std::span(&push, 1));
    PerJoint r_off = r;
    for (int i = 0; i < 7; ++i) r_off(i) += kResidualError(i) * draw_.Normal();

    int isolated = -1;  // by the last joint that feels more than three times the error
    for (int i = 0; i < 7; ++i)
      if (std::abs(r_off(i)) > 3 * kResidualError(i)) isolated = model_.joint(i).child;
    const ContactForce found = Look(push, isolated);
    const double of_true_place = ForceError(push, r_off, force);
    if (force_.Get(force_->observability).rank < 3) ++row.lost_rank;
    if (found.link < 0) return;
    ++row.seen;
    row.right_link += found.link == link;
    const Vector3d x = MotionOf(model_, d_, found.link, found.point).position;
    row.place.push_back((x - at.point).norm());
    row.known.push_back(of_true_place);
    row.exact.push_back(ForceError(found, r, force));
    row.noisy.push_back(ForceError(found, r_off, force));
  }

  /// ‖F̂ − F‖ in the directions that joints feel at the place.
  double ForceError(const ContactForce& at, const PerJoint& residual, const Vector3d& force) {
    Contacts places;
    places.at[0] = at;
    BlockTester<ContactForceEstimate>& t = force_;
    t.Set(t->places, places);
    t.Set(t->dynamics, d_);
    t.Set(t->residual, residual);
    t.Tick();
    const ContactObservability& seen = t.Get(t->observability);
    const Vector3d error = t.Get(t->contacts).at[0].force - force;
    double squared = 0;
    for (int k = 0; k < seen.rank; ++k) {
      const Vector3d direction = seen.directions.col(k).head<3>();
      squared += std::pow(direction.dot(error), 2);
    }
    return std::sqrt(squared);
  }

  /// One picture; before it, one in which nothing is touched, so that nothing is known.
  ContactForce Look(const ContactForce& push, int isolated) {
    camera_.Set(camera_->position, q_);
    camera_.Set(seen_, push);
    localization_.Set(localization_->dynamics, d_);
    localization_.Set(localization_->isolated, isolated);
    for (const bool touched : {false, true}) {
      camera_.Tick();
      localization_.Set(localization_->image, camera_.Get(camera_->image));
      localization_.Set(localization_->touched, touched);
      localization_.Tick();
    }
    return localization_.Get(localization_->contacts).at[0];
  }

  DepthCamera::Options CameraOptions() const {
    DepthCamera::Options o{.model = model_};
    o.view = view_;
    return o;
  }
  ContactLocalization::Options LocalizationOptions() const {
    ContactLocalization::Options o{.model = model_};
    o.view = view_;
    o.contacts = 1;
    return o;
  }

  const RobotModel model_ = RobotModel::FromUrdf(ModelFile("lwr/lwr4p.urdf"));
  const RobotSurface surface_{model_};
  Draw draw_;
  Pinhole view_{.width = 640,
                .height = 480,
                .focal = 575.8,
                .pose = LookingAt({1.7, 0, 1.1}, {-0.2, 0, 0.5})};
  RobotDynamics d_{model_};
  JointPosition q_;
  std::vector<Solid> placed_ = surface_.Solids();
  std::vector<Row> rows_ = std::vector<Row>(placed_.size());
  BlockTester<DepthCamera> camera_{CameraOptions()};
  BlockTester<ContactLocalization> localization_{LocalizationOptions()};
  BlockTester<ContactForceEstimate> force_{
      ContactForceEstimate::Options{.model = model_, .period = 1ms}};
  const Input<ContactForce>& seen_ = camera_.Join(camera_->contacts, {});
};

}  // namespace
}  // namespace pliant

int main(int argc, char** argv) {
  const int samples = argc > 1 ? std::atoi(argv[1]) : 60;
  const int seed = argc > 2 ? std::atoi(argv[2]) : 1;
  pliant::Study study(static_cast<std::uint64_t>(seed));
  study.Run(samples);
  return study.Print() ? 0 : 1;
}
