#include "pliant/analysis/dynamics_identification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// Sums of sines of each joint about a posture, by a seed: some 0.1 to 0.7 Hz, up to a radian.
struct Excitation {
  explicit Excitation(const RobotModel& model, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(-1, 1);
    const auto drawn = [&]() -> Eigen::MatrixXd {
      return Eigen::MatrixXd::NullaryExpr(model.size(), 5, [&] { return draw(random); });
    };
    sine = 0.25 * drawn();
    cosine = 0.25 * drawn();
    middle = Eigen::VectorXd::NullaryExpr(model.size(), [&] { return draw(random); });
  }
  /// q, v or a: derivative 0, 1 or 2.
  Eigen::VectorXd At(double t, int derivative) const {
    Eigen::VectorXd x = derivative == 0 ? middle : Eigen::VectorXd::Zero(middle.size()).eval();
    for (int k = 1; k <= 5; ++k) {
      const double w = 2 * std::numbers::pi * 0.14 * k;
      const double phase = w * t + derivative * std::numbers::pi / 2;  // each turns sin on
      x += std::pow(w, derivative) *
           (std::sin(phase) * sine.col(k - 1) + std::cos(phase) * cosine.col(k - 1));
    }
    return x;
  }
  Eigen::MatrixXd sine, cosine;
  Eigen::VectorXd middle;
};

struct Noise {
  double position = 0, velocity = 0, torque = 0;  ///< σ, white
};

/// What sensors of an arm would show that moves so, torques by the recursive kernel.
Samples Moved(const RobotModel& model, const Excitation& motion, double duration, Noise noise = {},
              const PerJoint& coulomb = {}, double rate = 500) {
  const Eigen::Index n = model.size(), count = static_cast<Eigen::Index>(duration * rate);
  Samples samples;
  for (const Joint& j : model.joint_data()) samples.joints.push_back(j.name);
  samples.begin = {0};
  samples.time = Eigen::VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1) / rate);
  samples.position = samples.velocity = samples.torque = Eigen::MatrixXd(n, count);
  std::mt19937 random(99);
  std::normal_distribution<double> normal;
  const auto white = [&](double sigma) -> Eigen::VectorXd {
    return Eigen::VectorXd::NullaryExpr(n, [&] { return sigma * normal(random); });
  };
  RobotDynamics d(model);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = samples.time[k];
    const JointPosition q = motion.At(t, 0);
    const JointVelocity v = motion.At(t, 1);
    ComputeDynamics(model, q, v, d);
    Eigen::VectorXd tau = InverseDynamics(d, motion.At(t, 2));
    if (coulomb.size() > 0) tau += coulomb.cwiseProduct((v / 0.01).array().tanh().matrix());
    samples.position.col(k) = q + white(noise.position);
    samples.velocity.col(k) = v + white(noise.velocity);
    samples.torque.col(k) = tau + white(noise.torque);
  }
  return samples;
}

const Inertial kTool{0.8, {0.02, -0.01, 0.06}, Eigen::Vector3d(3e-3, 2.5e-3, 1e-3).asDiagonal()};
constexpr JointTerms kNone{.coulomb = false, .viscous = false, .offset = false};

TEST(DynamicsIdentification, FindsAPayloadOfWhichNothingIsKnown) {
  const RobotModel model = Gen3();
  const RobotModel loaded = model.WithPayload("bracelet_link", kTool);
  const Excitation motion(model, 3);
  const DynamicsResult result = IdentifyDynamics(model, Moved(loaded, motion, 20),
                                                 {.payload = "bracelet_link", .terms = kNone});
  // Only the smoothing's bias is left: (2π 0.7 Hz · 0.05 s)⁴/280 = 1e-5 of the torques.
  const Inertial& found = result.links.at(0).found.inertial;
  EXPECT_NEAR(found.mass, kTool.mass, 1e-3 * kTool.mass);
  EXPECT_LT((found.center - kTool.center).norm(), 1e-3 * kTool.center.norm());
  EXPECT_LT((found.inertia - kTool.inertia).norm(), 0.05 * kTool.inertia.norm());
  EXPECT_EQ(result.combinations.size(), 10u);
  EXPECT_EQ(result.alone.size(), 10u) << "all but the payload is known";
}

TEST(DynamicsIdentification, GravityTorquesWithAPayloadAreRightWithinOnePercent) {
  const RobotModel model = Gen3();
  const RobotModel loaded = model.WithPayload("bracelet_link", kTool);
  const DynamicsResult result =
      IdentifyDynamics(model,
                       Moved(loaded, Excitation(model, 3), 20, {1e-4, 5e-3, 0.3},
                             PerJoint::Constant(model.size(), 0.5)),
                       {.payload = "bracelet_link"});
  RandomStates random(model);
  RobotDynamics right(loaded), found(result.model), without(model);
  const JointVelocity zero = JointVelocity::Zero(model.joints());
  double error = 0, scale = 0, before = 0;
  for (int k = 0; k < 200; ++k) {
    const JointPosition q = random.q();
    ComputeDynamics(loaded, q, zero, right);
    ComputeDynamics(result.model, q, zero, found);
    ComputeDynamics(model, q, zero, without);
    error += (found.gravity - right.gravity).squaredNorm();
    before += (without.gravity - right.gravity).squaredNorm();
    scale += right.gravity.squaredNorm();
  }
  EXPECT_LT(std::sqrt(error / scale), 0.01);
  EXPECT_GT(std::sqrt(before / scale), 0.1) << "not to begin with";
  const ConsistentInertia& tool = result.links.at(0).found;
  EXPECT_NEAR(tool.inertial.mass, kTool.mass, 4 * tool.deviation.mass) << "4 σ: once in 16 000";
  for (const JointTermValues& terms : result.terms) EXPECT_NEAR(terms.coulomb, 0.5, 0.05);
}

TEST(DynamicsIdentification, PredictsAnotherMotionFromAModelThatWasWrong) {
  const RobotModel truth = Gen3();
  RobotModel wrong = truth;
  for (const Link& link : truth.links())
    if (link.inertial.mass > 0)
      wrong = wrong.WithInertial(link.name, {1.3 * link.inertial.mass, 0.8 * link.inertial.center,
                                             1.5 * link.inertial.inertia});
  const double sigma = 0.1;
  const Samples log = Moved(truth, Excitation(truth, 5), 60, {0, 0, sigma});
  const Samples other = Moved(truth, Excitation(truth, 8), 20);
  const DynamicsResult result = IdentifyDynamics(wrong, log, {.terms = kNone}, &other);
  ASSERT_TRUE(result.validated);
  // Noise of σ at 500 Hz, of which a cubic's window of 0.1 s leaves 9/8 · 2/50 σ²; with p of the
  // numbers N that are independent fitted, the prediction of another motion of the same kind errs
  // by √(p/N) of that, N = 60 s/0.1 s a joint, p = 43 over 7 joints. Twice that for another motion.
  const double smooth = sigma * std::sqrt(9.0 / 8 / 50 * 2);
  const double bound = 2 * smooth * std::sqrt(43.0 / (7 * 600)) * 3;
  for (int j = 0; j < truth.size(); ++j) {
    EXPECT_LT(result.validated->identified[j], bound) << "joint " << j + 1;
    EXPECT_LE(result.fitted.free[j], 1.5 * smooth) << "joint " << j + 1;
  }
  EXPECT_GT(result.validated->prior[1], 20 * bound);
}

TEST(DynamicsIdentification, HasTheFortyThreeBaseParametersOfAnArmOfSevenJoints) {
  // Gautier & Khalil 1990: 10 n less what regroups: 43 for seven revolute joints whose first axis
  // is vertical and whose neighbours are perpendicular.
  for (const RobotModel& model : {Gen3(), Lwr()}) {
    const DynamicsResult result =
        IdentifyDynamics(model, Moved(model, Excitation(model, 2), 30), {.terms = kNone});
    EXPECT_EQ(result.combinations.size(), 43u) << model.name();
  }
}

TEST(DynamicsIdentification, NamesWhatHasNoEffectAndWhatIsToldInCombinationsOnly) {
  const RobotModel model = Gen3();
  const DynamicsResult result =
      IdentifyDynamics(model, Moved(model, Excitation(model, 2), 30), {.terms = kNone});
  // The first axis is vertical: neither the mass of the first link nor its moment along the axis,
  // nor any of its moments of inertia but that about the axis, has a torque.
  EXPECT_THAT(result.without, Contains("shoulder_link.m"));
  EXPECT_THAT(result.combined, Contains("half_arm_1_link.m"));
  EXPECT_THAT(result.alone, Contains("bracelet_link.mc_x"));
}

TEST(DynamicsIdentification, GivesABodyWhereLeastSquaresGivesNone) {
  // A feather of 1 g under noise of newtons: least squares is as likely to find less than nothing.
  const RobotModel model = Gen3();
  const Inertial feather{1e-3, {0, 0, 0.02}, Eigen::Matrix3d::Identity() * 1e-6};
  int impossible = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const DynamicsResult result = IdentifyDynamics(
        model,
        Moved(model.WithPayload("bracelet_link", feather), Excitation(model, seed), 10, {0, 0, 2}),
        {.payload = "bracelet_link", .terms = kNone});
    InertialParameters free;
    for (Eigen::Index k = 0; k < 10; ++k)
      free[k] = result.combinations[static_cast<std::size_t>(k)].value;
    const auto least = [](const InertialParameters& pi) {
      return Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(PseudoInertiaOf(pi)).eigenvalues()[0];
    };
    if (least(free) < 0) ++impossible;
    EXPECT_GT(least(ParametersOf(result.links.at(0).found.inertial)), 0);
    // χ² grows by no more than some of the ten numbers that noise moved: of thousands of points.
    for (int j = 0; j < model.size(); ++j)
      EXPECT_LT(result.fitted.identified[j], 1.05 * result.fitted.free[j]);
  }
  EXPECT_GT(impossible, 0);
}

TEST(DynamicsIdentification, IntervalsHoldTheTruthAsOftenAsTheySay) {
  const RobotModel model = Gen3(), loaded = model.WithPayload("bracelet_link", kTool);
  const InertialParameters truth = ParametersOf(kTool);
  int held = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const DynamicsResult result =
        IdentifyDynamics(model, Moved(loaded, Excitation(model, seed), 10, {0, 0, 0.5}),
                         {.payload = "bracelet_link", .terms = kNone});
    for (Eigen::Index k = 0; k < 10; ++k) {
      const IdentifiedCombination& c = result.combinations[static_cast<std::size_t>(k)];
      if (std::abs(c.value - truth[k]) < c.half_width) ++held;
    }
  }
  // Binomial, 60 at 95 %: 50 or fewer once in a thousand times, if they were independent.
  EXPECT_GT(held, 50);
}

TEST(DynamicsIdentification, RobustWeightsLeaveContactsOut) {
  const RobotModel model = Gen3(), loaded = model.WithPayload("bracelet_link", kTool);
  Samples log = Moved(loaded, Excitation(model, 3), 30, {0, 0, 0.1});
  for (Eigen::Index k = 3000; k < 3600; ++k) log.torque.col(k).array() += 10;  // 1.2 s of 30 s
  DynamicsOptions o{.payload = "bracelet_link", .terms = kNone};
  const double plain = IdentifyDynamics(model, log, o).links.at(0).found.inertial.mass;
  o.robust = true;
  const double robust = IdentifyDynamics(model, log, o).links.at(0).found.inertial.mass;
  EXPECT_LT(std::abs(robust - kTool.mass), 0.2 * std::abs(plain - kTool.mass));
}

TEST(DynamicsIdentification, DropsRepeatedRowsAndKeepsIrregularStamps) {
  const RobotModel model = Gen3(), loaded = model.WithPayload("bracelet_link", kTool);
  const Samples even = Moved(loaded, Excitation(model, 3), 20);
  Samples odd = even;
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < even.time.size(); ++k)
    if (k % 7 != 3) columns.push_back(k);
  odd.time = even.time(columns);
  odd.position = even.position(Eigen::all, columns);
  odd.velocity = even.velocity(Eigen::all, columns);
  odd.torque = even.torque(Eigen::all, columns);
  for (Eigen::Index k = 20; k < odd.time.size(); k += 20) {
    odd.position.col(k) = odd.position.col(k - 1);
    odd.velocity.col(k) = odd.velocity.col(k - 1);
    odd.torque.col(k) = odd.torque.col(k - 1);
  }
  const DynamicsResult result =
      IdentifyDynamics(model, odd, {.payload = "bracelet_link", .terms = kNone});
  EXPECT_EQ(result.repeated, (odd.time.size() - 1) / 20);
  EXPECT_NEAR(result.links.at(0).found.inertial.mass, kTool.mass, 1e-3 * kTool.mass);
}

TEST(DynamicsIdentification, KeepsEveryRowOfAnArmThatRestsWithoutNoise) {
  // Twenty postures of 0.2 s at 1 kHz, of which a simulated sensor says the same at every tick.
  const RobotModel model = Gen3();
  Samples log = Moved(model, Excitation(model, 3), 4, {}, {}, 1000);
  for (Eigen::Index k = 0; k < log.time.size(); ++k) {
    log.position.col(k) = log.position.col(k / 200 * 200);
    log.velocity.col(k).setZero();
    log.torque.col(k) = log.torque.col(k / 200 * 200);
  }
  const SmoothMotion motion = Smooth(log);
  EXPECT_EQ(motion.repeated, 0);
  EXPECT_EQ(motion.gaps, 0);
  EXPECT_EQ(motion.size(), 156) << "one every 25 ms of 3.999 s without half a window at either end";
  // A stale row now and then is none of an arm that rests.
  log = Moved(model, Excitation(model, 3), 4, {}, {}, 1000);
  for (Eigen::Index k = 1; k < log.time.size(); k += 2) {
    log.position.col(k) = log.position.col(k - 1);
    log.velocity.col(k) = log.velocity.col(k - 1);
    log.torque.col(k) = log.torque.col(k - 1);
  }
  EXPECT_EQ(Smooth(log).repeated, 2000);
}

TEST(DynamicsIdentification, RefusesPointsThatAreCloserThanRows) {
  const Samples log = Moved(Gen3(), Excitation(Gen3(), 3), 4);
  EXPECT_EQ(ErrorOf([&] { Smooth(log, {.step_s = 1e-6}); }),
            "the step must be >= the time from row to row, 0.002 s: points between rows say "
            "nothing new, got 1e-06");
  EXPECT_EQ(Smooth(log, {.step_s = 2e-3}).gaps, 0);
}

// ---- what is refused --------------------------------------------------------------------------

std::string Refused(const Samples& samples, const DynamicsOptions& o = {}) {
  return ErrorOf([&] { IdentifyDynamics(Gen3(), samples, o); });
}

TEST(DynamicsIdentification, RefusesAnArmThatDoesNotMove) {
  Samples still = Moved(Gen3(), Excitation(Gen3(), 1), 20, {0, 1e-6, 0.1});
  still.position.colwise() = Eigen::VectorXd(still.position.col(0));
  EXPECT_THAT(Refused(still), HasSubstr("the arm does not move: no joint leaves a range of "));
}

TEST(DynamicsIdentification, RefusesTooFewPoints) {
  EXPECT_EQ(
      Refused(Moved(Gen3(), Excitation(Gen3(), 1), 1)),
      "too few points: expected at least 730 for the 73 numbers that a joint's torque depends "
      "on, one every 0.025 s, got 36; give a longer log");
  EXPECT_THAT(Refused(Moved(Gen3(), Excitation(Gen3(), 1), 20, {}, {}, 20)),
              HasSubstr("too few samples: no window of 0.1 s has six of them (400 rows, 0 repeat"));
}

TEST(DynamicsIdentification, RefusesLinksThatTellNothing) {
  const Samples log = Moved(Gen3(), Excitation(Gen3(), 1), 20);
  EXPECT_THAT(Refused(log, {.payload = "braclet_link"}),
              HasSubstr("has no link \"braclet_link\"; did you mean \"bracelet_link\"?"));
  EXPECT_EQ(Refused(log, {.payload = "base_link"}),
            "link \"base_link\" does not move, so no torque tells of its mass; name one that a "
            "joint moves");
  EXPECT_EQ(Refused(log, {.links = {"tool_frame"}}),
            "link \"tool_frame\" has no mass in the model, so there is nothing to begin from; give "
            "it an <inertial>, or look for a payload on it");
  EXPECT_EQ(Refused(log, {.links = {"bracelet_link", "bracelet_link"}}),
            "link \"bracelet_link\" is named twice");
  EXPECT_EQ(Refused(log, {.links = {"bracelet_link"}, .payload = "bracelet_link"}),
            "either links or a payload is identified, not both");
}

TEST(DynamicsIdentification, RefusesSamplesOfOtherJoints) {
  Samples log = Moved(Gen3(), Excitation(Gen3(), 1), 20);
  log.torque.conservativeResize(6, Eigen::NoChange);
  EXPECT_THAT(Refused(log), HasSubstr("expected torques of the 7 joints of robot "));
}

TEST(DynamicsIdentification, RefusesOptionsOutOfRange) {
  const Samples log = Moved(Gen3(), Excitation(Gen3(), 1), 20);
  EXPECT_EQ(Refused(log, {.smoothing = {.window_s = 0}}), "the window must be > 0 s, got 0");
  EXPECT_EQ(Refused(log, {.smoothing = {.step_s = -1}}), "the step must be > 0 s, got -1");
  EXPECT_EQ(Refused(log, {.prior_deviation = 0}), "the prior's deviation must be > 0, got 0");
  EXPECT_EQ(Refused(log, {.terms = {.zero_velocity = 0}}), "zero_velocity must be > 0, got 0");
}

}  // namespace
}  // namespace pliant
