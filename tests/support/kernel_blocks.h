#pragma once

#include <cmath>
#include <vector>

#include "pliant/systems/block.h"

/// Blocks of one line, for tests of the kernel.
namespace pliant {

/// y = f(t).
class Source final : public Block {
 public:
  explicit Source(double (*f)(double)) : y{this, "y"}, f_{f} {
    Compute(y).From(clock).As(&Source::At);
  }
  Output<double> y;

 private:
  double At(double t) const { return f_(t); }
  double (*const f_)(double);
};

/// y_k = u_k, held.
class Sampler final : public Block {
 public:
  struct Options {
    Duration period;
    Duration offset = {};
    double before = 0;
  };
  explicit Sampler(const Options& o) : u{this, "u"}, y{this, "y", {}, o.before} {
    Every(o.period, o.offset).Compute(y).From(u).As([](double now) { return now; });
  }
  Input<double> u;
  Output<double> y;
};

/// y_k = u_{k−1}.
class Delay final : public Block {
 public:
  struct Options {
    Duration period;
    double initial = 0;
  };
  explicit Delay(const Options& o) : u{this, "u"}, y{this, "y"}, x{this, "x", {}, o.initial} {
    Every(o.period).Update(x).From(u).As([](double now) { return now; });
    Compute(y).From(x).As([](double now) { return now; });
  }
  Input<double> u;
  Output<double> y;
  Discrete<double> x;
};

/// ẋ = u.
class Integral final : public Block {
 public:
  explicit Integral(double initial = 0) : u{this, "u"}, y{this, "y"}, x{this, "x", {}, initial} {
    Derivative(x).From(u).As([](double now) { return now; });
    Compute(y).From(x).As([](double now) { return now; });
  }
  Input<double> u;
  Output<double> y;
  Continuous<double> x;
};

/// y = a + b.
class Sum final : public Block {
 public:
  Sum() : a{this, "a"}, b{this, "b"}, y{this, "y"} {
    Compute(y).From(a, b).As([](double left, double right) { return left + right; });
  }
  Input<double> a, b;
  Output<double> y;
};

/// Writes down the time and two values at every tick.
class Recorder final : public Block {
 public:
  struct Row {
    double t, a, b;
    bool operator==(const Row&) const = default;
  };
  struct Options {
    std::vector<Row>& rows;
    Duration period;
    Duration offset = {};
  };
  explicit Recorder(const Options& o) : a{this, "a", {}, 0.0}, b{this, "b", {}, 0.0} {
    Every(o.period, o.offset)
        .Publish()
        .From(clock, a, b)
        .As([&rows = o.rows](double t, double left, double right) {
          rows.push_back({t, left, right});
        });
  }
  Input<double> a, b;
};

}  // namespace pliant
