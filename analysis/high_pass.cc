#include "pliant/analysis/high_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

/// One way over the columns, from rest.
class Butterworth {
 public:
  explicit Butterworth(double K) : b_{1 / (1 + std::numbers::sqrt2 * K + K * K)} {
    a1_ = 2 * (K * K - 1) * b_;
    a2_ = (1 - std::numbers::sqrt2 * K + K * K) * b_;
  }

  void Run(Eigen::MatrixXd& x) const {
    Eigen::VectorXd x1 = Eigen::VectorXd::Zero(x.rows()), x2 = x1, y1 = x1, y2 = x1;
    for (Eigen::Index k = 0; k < x.cols(); ++k) {
      const Eigen::VectorXd u = x.col(k);
      x.col(k) = b_ * (u - 2 * x1 + x2) - a1_ * y1 - a2_ * y2;
      x2 = x1;
      x1 = u;
      y2 = y1;
      y1 = x.col(k);
    }
  }

 private:
  double b_, a1_, a2_;
};

}  // namespace

Eigen::MatrixXd HighPass(const Eigen::MatrixXd& numbers, double cutoff_hz, Duration period) {
  const double h = seconds(period);
  Require(cutoff_hz > 0 && cutoff_hz < 0.5 / h,
          "the frequency above which to look must be > 0 and < " + Text(0.5 / h) +
              " Hz, half the rate of the rows",
          cutoff_hz);
  const Eigen::Index n = numbers.cols();
  if (n == 0) return numbers;
  const auto wanted = static_cast<Eigen::Index>(std::min(std::ceil(3 / (cutoff_hz * h)), 1e9));
  const Eigen::Index more = std::min(n - 1, wanted);
  Eigen::MatrixXd x(numbers.rows(), n + 2 * more);
  for (Eigen::Index k = 1; k <= more; ++k) {
    x.col(more - k) = 2 * numbers.col(0) - numbers.col(k);
    x.col(more + n - 1 + k) = 2 * numbers.col(n - 1) - numbers.col(n - 1 - k);
  }
  x.middleCols(more, n) = numbers;
  // The filter takes a constant away; without it there is no jump at the beginning.
  const Eigen::VectorXd first = x.col(0);
  x.colwise() -= first;
  const Butterworth filter(std::tan(std::numbers::pi * cutoff_hz * h));
  for (int way = 0; way < 2; ++way) {
    filter.Run(x);
    x = x.rowwise().reverse().eval();
  }
  return x.middleCols(more, n);
}

}  // namespace pliant
