#include "pliant/analysis/dynamics_identification.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "pliant/analysis/row_triangle.h"
#include "pliant/plants/inertial_regressor.h"
#include "pliant/systems/error.h"

namespace pliant {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr double kHuber = 1.345;       // 95 % as good as squares where the noise is normal
constexpr double kHuberMean = 0.7102;  // E[min(|e|, k)²] of normal noise of deviation 1
constexpr double kNormal95 = 1.959964;

/// Where the numbers that are sought stand: those of links, then those of joint after joint.
struct Layout {
  std::vector<int> links;
  Index terms = 0, joints = 0;

  Index inertial() const { return 10 * std::ssize(links); }
  Index size() const { return inertial() + terms * joints; }
  Index local() const { return inertial() + terms; }  ///< of the rows of one joint

  /// x of the rows of joint j.
  VectorXd Of(const VectorXd& x, Index j) const {
    VectorXd part(local());
    part << x.head(inertial()), x.segment(inertial() + j * terms, terms);
    return part;
  }
  /// Rows of joint j as rows of the whole.
  MatrixXd Whole(const MatrixXd& rows, Index j) const {
    MatrixXd whole = MatrixXd::Zero(rows.rows(), size());
    whole.leftCols(inertial()) = rows.leftCols(inertial());
    whole.middleCols(inertial() + j * terms, terms) = rows.middleCols(inertial(), terms);
    return whole;
  }
};

/// Calls act(point, Y, rest) with Y, n × local, the inertial columns and those of each joint's own
/// terms, and the torque that is left for them.
class Rows {
 public:
  Rows(const RobotModel& model, const Layout& layout, const VectorXd& prior,
       const JointTerms& terms)
      : model_{model}, layout_{layout}, prior_{prior}, terms_{terms} {}

  template <class F>
  void ForEach(const SmoothMotion& motion, F&& act) const {
    const Index n = layout_.joints;
    RobotDynamics d(model_);
    MatrixXd Y(n, layout_.local());
    for (Index k = 0; k < motion.size(); ++k) {
      const JointPosition q = motion.position.col(k);
      const JointVelocity v = motion.velocity.col(k);
      const JointAcceleration a = motion.acceleration.col(k);
      ComputeDynamics(model_, q, v, d);
      ComputeInertialRegressor(model_, d, a, layout_.links, Y.leftCols(layout_.inertial()));
      Index column = layout_.inertial();
      if (terms_.coulomb) Y.col(column++) = (v / terms_.zero_velocity).array().tanh().matrix();
      if (terms_.viscous) Y.col(column++) = v;
      if (terms_.offset) Y.col(column++).setOnes();
      if (terms_.rotor) Y.col(column++) = a;
      const VectorXd rest =
          motion.torque.col(k) - InverseDynamics(d, a) + Y.leftCols(layout_.inertial()) * prior_;
      act(k, Y, rest);
    }
  }

 private:
  const RobotModel& model_;
  const Layout& layout_;
  const VectorXd& prior_;
  const JointTerms& terms_;
};

using Triangles = std::vector<RowTriangle>;

Triangles TrianglesOf(const Rows& rows, const Layout& layout, const SmoothMotion& motion,
                      const VectorXd* x = nullptr, const VectorXd* scale = nullptr) {
  Triangles all(static_cast<std::size_t>(layout.joints), RowTriangle(layout.local()));
  rows.ForEach(motion, [&](Index, const MatrixXd& Y, const VectorXd& rest) {
    for (Index j = 0; j < layout.joints; ++j) {
      double root = 1;  // of Huber's weight
      if (x) {
        const double e = std::abs(rest[j] - Y.row(j).dot(layout.Of(*x, j))) / (*scale)[j];
        if (e > kHuber) root = std::sqrt(kHuber / e);
      }
      all[static_cast<std::size_t>(j)].Add(root * Y.row(j), root * rest[j]);
    }
  });
  return all;
}

/// The rows of all joints, each joint's multiplied by its weight: (T, b).
InertiaRows Weighted(Triangles& triangles, const Layout& layout, const VectorXd& weights) {
  const Index rows = layout.local() + 1;
  InertiaRows all{MatrixXd(rows * layout.joints, layout.size()), VectorXd(rows * layout.joints)};
  for (Index j = 0; j < layout.joints; ++j) {
    const MatrixXd& T = triangles[static_cast<std::size_t>(j)].triangle();
    all.T.middleRows(j * rows, rows) = weights[j] * layout.Whole(T, j);
    all.b.segment(j * rows, rows) = weights[j] * T.col(layout.local());
  }
  return all;
}

/// Zero where a column is not kept.
VectorXd LeastSquares(const InertiaRows& rows, const BaseParameters& base) {
  const MatrixXd A = rows.T(Eigen::all, base.kept);
  const VectorXd scale = A.colwise().norm();
  VectorXd x = VectorXd::Zero(rows.T.cols());
  const VectorXd y = (A * scale.cwiseInverse().asDiagonal()).householderQr().solve(rows.b);
  x(base.kept) = y.cwiseQuotient(scale);
  return x;
}

VectorXd Deviations(const InertiaRows& rows, const BaseParameters& base) {
  const MatrixXd A = rows.T(Eigen::all, base.kept);
  const VectorXd scale = A.colwise().norm();
  const Eigen::HouseholderQR<MatrixXd> qr(A * scale.cwiseInverse().asDiagonal());
  MatrixXd inverse = MatrixXd::Identity(A.cols(), A.cols());
  qr.matrixQR().topRows(A.cols()).triangularView<Eigen::Upper>().solveInPlace(inverse);
  return inverse.rowwise().norm().cwiseQuotient(scale);
}

VectorXd ResidualScale(Triangles& triangles, const Layout& layout, const VectorXd& x,
                       Index fitted) {
  VectorXd scale(layout.joints);
  for (Index j = 0; j < layout.joints; ++j) {
    RowTriangle& t = triangles[static_cast<std::size_t>(j)];
    const double n = static_cast<double>(t.count());
    const double part = static_cast<double>(fitted) / static_cast<double>(layout.joints);
    scale[j] = t.rms(layout.Of(x, j)) * std::sqrt(n / std::max(1.0, n - part));
  }
  // A joint that is explained to rounding must not outweigh all others.
  return scale.cwiseMax(std::max(1e-9, 1e-6 * scale.maxCoeff()));
}

/// Proposal 2 of Huber, one step from `scale`.
VectorXd RobustScale(const Rows& rows, const Layout& layout, const SmoothMotion& motion,
                     const VectorXd& x, const VectorXd& scale) {
  VectorXd sum = VectorXd::Zero(layout.joints);
  rows.ForEach(motion, [&](Index, const MatrixXd& Y, const VectorXd& rest) {
    for (Index j = 0; j < layout.joints; ++j) {
      const double e = std::abs(rest[j] - Y.row(j).dot(layout.Of(x, j)));
      sum[j] += std::pow(std::min(e, kHuber * scale[j]), 2);
    }
  });
  const VectorXd next = (sum / (kHuberMean * static_cast<double>(motion.size()))).cwiseSqrt();
  return next.cwiseMax(std::max(1e-9, 1e-6 * next.maxCoeff()));
}

/// T_j.
VectorXd Correlation(const Rows& rows, const Layout& layout, const SmoothMotion& motion,
                     const VectorXd& x) {
  MatrixXd e(layout.joints, motion.size());
  rows.ForEach(motion, [&](Index k, const MatrixXd& Y, const VectorXd& rest) {
    for (Index j = 0; j < layout.joints; ++j) e(j, k) = rest[j] - Y.row(j).dot(layout.Of(x, j));
  });
  VectorXd T = VectorXd::Ones(layout.joints);
  for (Index j = 0; j < layout.joints; ++j) {
    const double variance = e.row(j).squaredNorm();
    if (!(variance > 0)) continue;
    double sum = 1;
    for (Index lag = 1; lag < motion.size() / 2 && static_cast<double>(lag) < 5 * sum + 1; ++lag) {
      double product = 0;
      for (std::size_t file = 0; file < motion.begin.size(); ++file) {
        const Index from = motion.begin[file];
        const Index to = file + 1 < motion.begin.size() ? motion.begin[file + 1] : motion.size();
        const Index count = to - from - lag;
        if (count > 0)
          product += e.row(j).segment(from, count).dot(e.row(j).segment(from + lag, count));
      }
      sum += 2 * product / variance;
    }
    T[j] = std::max(1.0, sum);
  }
  return T;
}

/// The joint terms that fit best with these inertial parameters.
VectorXd WithTerms(Triangles& triangles, const Layout& layout, const VectorXd& inertial) {
  VectorXd x = VectorXd::Zero(layout.size());
  x.head(layout.inertial()) = inertial;
  if (layout.terms == 0) return x;
  for (Index j = 0; j < layout.joints; ++j) {
    const MatrixXd& T = triangles[static_cast<std::size_t>(j)].triangle();
    x.segment(layout.inertial() + j * layout.terms, layout.terms) =
        T.middleCols(layout.inertial(), layout.terms)
            .completeOrthogonalDecomposition()
            .solve(T.col(layout.local()) - T.leftCols(layout.inertial()) * inertial);
  }
  return x;
}

struct Candidates {
  VectorXd model, prior, free, identified;
};

TorqueResiduals ResidualsOf(const std::string& log, Triangles& triangles, const Layout& layout,
                            const SmoothMotion& motion, const Candidates& x) {
  const auto rms = [&](const VectorXd& candidate) {
    PerJoint all(layout.joints);
    for (Index j = 0; j < layout.joints; ++j)
      all[j] = triangles[static_cast<std::size_t>(j)].rms(layout.Of(candidate, j));
    return all;
  };
  const VectorXd mean = motion.torque.rowwise().mean();
  const PerJoint torque =
      (motion.torque.colwise() - mean).rowwise().norm() / std::sqrt(double(motion.size()));
  return {log, torque, rms(x.model), rms(x.prior), rms(x.free), rms(x.identified)};
}

std::string Quoted(std::string_view name) { return '"' + std::string(name) + '"'; }

std::vector<int> LinksOf(const RobotModel& model, const DynamicsOptions& o) {
  std::vector<int> links;
  if (!o.payload.empty()) {
    Require(o.links.empty(), "either links or a payload is identified, not both");
    links.push_back(model.link_index(o.payload));
  } else if (o.links.empty()) {
    std::map<int, int> heaviest;
    for (int i = 0; i < static_cast<int>(model.links().size()); ++i) {
      const Link& link = model.link(i);
      if (link.body < 0 || !(link.inertial.mass > 0)) continue;
      const auto [at, first] = heaviest.emplace(link.body, i);
      if (!first && model.link(at->second).inertial.mass < link.inertial.mass) at->second = i;
    }
    for (const auto& [body, link] : heaviest) links.push_back(link);
  }
  for (const std::string& name : o.links) {
    const int link = model.link_index(name);
    Require(!std::ranges::count(links, link), "link " + Quoted(name) + " is named twice");
    links.push_back(link);
  }
  for (const int i : links) {
    const Link& link = model.link(i);
    Require(link.body >= 0, "link " + Quoted(link.name) +
                                " does not move, so no torque tells of its mass; name one that "
                                "a joint moves");
    Require(!o.payload.empty() || link.inertial.mass > 0,
            "link " + Quoted(link.name) +
                " has no mass in the model, so there is nothing to begin from; give it an "
                "<inertial>, or look for a payload on it");
  }
  // From the base to the tip, so that combinations read link + what it carries.
  std::ranges::stable_sort(links, {}, [&](int i) { return model.link(i).body; });
  return links;
}

void RequireSamples(const RobotModel& model, const Samples& samples) {
  const Index n = model.size();
  for (const auto& [numbers, what] :
       {std::pair{&samples.position, "positions"}, std::pair{&samples.velocity, "velocities"},
        std::pair{&samples.torque, "torques"}})
    Require(numbers->rows() == n && numbers->cols() == samples.time.size(),
            "expected " + std::string(what) + " of the " + Text(n) + " joints of robot " +
                Quoted(model.name()) + ", one for each time; the log has those of " +
                Text(numbers->rows()));
}

/// Something is told only by an arm that moves.
void RequireMotion(const SmoothMotion& motion) {
  const VectorXd range =
      motion.position.rowwise().maxCoeff() - motion.position.rowwise().minCoeff();
  Require(range.maxCoeff() > 0.01,
          "the arm does not move: no joint leaves a range of " + Text(range.maxCoeff()) +
              " rad; expected a motion, or postures, of some tenths of a radian");
}

std::vector<std::string> NamesOf(const RobotModel& model, const Layout& layout,
                                 const DynamicsOptions& o) {
  std::vector<std::string> names;
  for (const int link : layout.links)
    for (const char* name : kInertialNames)
      names.push_back((o.payload.empty() ? model.link(link).name : "payload") + "." + name);
  for (const Joint& j : model.joint_data()) {
    const std::string& joint = j.name;
    if (o.terms.coulomb) names.push_back(joint + ".coulomb");
    if (o.terms.viscous) names.push_back(joint + ".viscous");
    if (o.terms.offset) names.push_back(joint + ".offset");
    if (o.terms.rotor) names.push_back(joint + ".rotor");
  }
  return names;
}

JointTermValues TermsAt(const VectorXd& x, const Layout& layout, Index j, const JointTerms& terms) {
  JointTermValues values;
  Index at = layout.inertial() + j * layout.terms;
  if (terms.coulomb) values.coulomb = x[at++];
  if (terms.viscous) values.viscous = x[at++];
  if (terms.offset) values.offset = x[at++];
  if (terms.rotor) values.rotor = x[at++];
  return values;
}

}  // namespace

DynamicsResult IdentifyDynamics(const RobotModel& model, const Samples& samples,
                                const DynamicsOptions& o, const Samples* validation) {
  Require(o.terms.zero_velocity > 0, "zero_velocity must be > 0", o.terms.zero_velocity);
  const bool payload = !o.payload.empty();
  const Layout layout{LinksOf(model, o), o.terms.count(), model.size()};
  RequireSamples(model, samples);
  const SmoothMotion motion = Smooth(samples, o.smoothing);
  RequireMotion(motion);
  Require(motion.size() >= 10 * layout.local(),
          "too few points: expected at least " + Text(10 * layout.local()) + " for the " +
              Text(layout.local()) + " numbers that a joint's torque depends on, one every " +
              Text(o.smoothing.step_s) + " s, got " + Text(motion.size()) + "; give a longer log");

  std::vector<Inertial> prior;
  VectorXd prior_parameters = VectorXd::Zero(layout.inertial());  // that are in the model
  for (std::size_t k = 0; k < layout.links.size(); ++k) {
    prior.push_back(payload ? o.payload_prior : model.link(layout.links[k]).inertial);
    if (!payload)
      prior_parameters.segment<10>(10 * static_cast<Index>(k)) = ParametersOf(prior.back());
  }
  const Rows rows(model, layout, prior_parameters, o.terms);
  Triangles squares = TrianglesOf(rows, layout, motion);

  // Least squares and the scale of its residuals.
  Triangles weighted = squares;
  VectorXd scale = VectorXd::Ones(layout.joints), x;
  const BaseParameters base = FindBaseParameters(Weighted(squares, layout, scale).T);
  Require(!base.kept.empty(), "nothing can be identified: no number that is sought has an effect");
  for (int pass = 0; pass < 20; ++pass) {
    x = LeastSquares(Weighted(weighted, layout, scale.cwiseInverse()), base);
    const VectorXd before = scale;
    if (o.robust) {
      if (pass == 0) scale = ResidualScale(squares, layout, x, std::ssize(base.kept));
      scale = RobustScale(rows, layout, motion, x, scale);
      weighted = TrianglesOf(rows, layout, motion, &x, &scale);
    } else {
      scale = ResidualScale(weighted, layout, x, std::ssize(base.kept));
    }
    if ((scale - before).cwiseQuotient(scale).cwiseAbs().maxCoeff() < 1e-4) break;
  }

  DynamicsResult result;
  result.model = model;
  result.payload = payload;
  result.points = motion.size();
  result.repeated = motion.repeated;
  result.gaps = motion.gaps;
  result.scale = scale;
  const VectorXd correlation = Correlation(rows, layout, motion, x);
  result.correlation = correlation;
  const VectorXd weights = (scale.cwiseProduct(correlation.cwiseSqrt())).cwiseInverse();
  const InertiaRows counted = Weighted(weighted, layout, weights);
  const VectorXd free = LeastSquares(counted, base);
  const VectorXd deviations = Deviations(counted, base);

  const std::vector<std::string> names = NamesOf(model, layout, o);
  VectorXd prior_x = VectorXd::Zero(layout.size());
  prior_x.head(layout.inertial()) = prior_parameters;
  const VectorXd prior_base = base.Of(prior_x);
  for (std::size_t k = 0; k < base.kept.size(); ++k)
    result.combinations.push_back({base.text(k, names), prior_base[static_cast<Index>(k)],
                                   free[base.kept[k]],
                                   kNormal95 * deviations[static_cast<Index>(k)]});
  const auto named = [&](const std::vector<Index>& columns) {
    std::vector<std::string> all;
    for (const Index k : columns) all.push_back(names[static_cast<std::size_t>(k)]);
    return all;
  };
  const std::vector<Index> alone = base.alone();
  result.alone = named(alone);
  result.without = named(base.without);
  std::vector<Index> combined = base.dropped;
  std::ranges::copy_if(base.kept, std::back_inserter(combined),
                       [&](Index k) { return !std::ranges::count(alone, k); });
  std::ranges::sort(combined);
  result.combined = named(combined);
  result.condition = FindBaseParameters(counted.T).condition;

  // Links that could be built.
  std::vector<Index> left_out = base.dropped;
  left_out.insert(left_out.end(), base.without.begin(), base.without.end());
  const ConsistentFit fit = FitConsistentInertia(counted, prior, o.prior_deviation, left_out);
  for (std::size_t k = 0; k < layout.links.size(); ++k) {
    const Link& link = model.link(layout.links[k]);
    result.links.push_back({link.name, payload ? Inertial{} : prior[k], fit.links[k]});
    const Inertial& found = fit.links[k].inertial;
    result.model = payload ? result.model.WithPayload(link.name, found)
                           : result.model.WithInertial(link.name, found);
  }
  for (Index j = 0; j < layout.joints; ++j)
    result.terms.push_back(TermsAt(fit.x, layout, j, o.terms));

  const Candidates candidates{prior_x, WithTerms(squares, layout, prior_parameters), free, fit.x};
  result.fitted = ResidualsOf("fitted", squares, layout, motion, candidates);
  if (validation) {
    RequireSamples(model, *validation);
    const SmoothMotion other = Smooth(*validation, o.smoothing);
    Triangles triangles = TrianglesOf(rows, layout, other);
    result.validated = ResidualsOf("validated", triangles, layout, other, candidates);
  }
  return result;
}

}  // namespace pliant
