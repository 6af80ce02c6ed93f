#include "pliant/analysis/signal_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kPi = std::numbers::pi;

/// x and y over time, in metres, a row each millisecond from 0 to 2 s.
Recording Recorded(
    const std::function<double(double)>& x,
    const std::function<double(double)>& y = [](double) { return 0; }) {
  RecordedSignal signal{{"a.b", "position", {"[x]", "[y]"}, {"m", "m"}}, {}, {}};
  signal.times = Eigen::VectorXd::LinSpaced(2001, 0, 2);
  signal.numbers.resize(2, 2001);
  signal.numbers.row(0) = signal.times.unaryExpr(x).transpose();
  signal.numbers.row(1) = signal.times.unaryExpr(y).transpose();
  return {{signal}, {}};
}

SignalNumber Number(Statistic statistic) {
  return {.signal = "a.b", .elements = {"x"}, .statistic = statistic};
}

TEST(SignalNumber, TakesLeastAndRangeWithTheirSigns) {
  const Recording run = Recorded([](double t) { return std::cos(kPi * t) - 0.25; });
  EXPECT_NEAR(Number(Statistic::Peak).Of(run), 0.75, 1e-15);
  EXPECT_NEAR(Number(Statistic::Least).Of(run), -1.25, 1e-15);
  EXPECT_NEAR(Number(Statistic::Magnitude).Of(run), 1.25, 1e-15);
  EXPECT_NEAR(Number(Statistic::Range).Of(run), 2, 1e-15);
}

// e^{−5 t} ≤ 0.05 from ln 20 / 5 on; the first row of that.
TEST(SignalNumber, SettlesWhenADecayStaysInItsBand) {
  const Recording run = Recorded([](double t) { return std::exp(-5 * t); });
  SignalNumber settling = Number(Statistic::SettlingTime);
  settling.band = 0.05;
  const double theory = std::log(20) / 5;
  EXPECT_GE(settling.Of(run), theory);
  EXPECT_LT(settling.Of(run), theory + 1e-3);
  settling.from_s = 0.5;
  EXPECT_NEAR(settling.Of(run), std::ceil(1e3 * theory) * 1e-3 - 0.5, 1e-12);
  settling.from_s = 1;
  EXPECT_EQ(settling.Of(run), 0);  // it is there already
  EXPECT_EQ(settling.unit(run["a.b"]), "s");
}

// A decay to 3: it never comes to zero, and to its final mean as to zero, but for what of the
// decay is left in the last tenth, e⁻⁹.
TEST(SignalNumber, SettlesAtItsFinalMeanOrNever) {
  const Recording run = Recorded([](double t) { return 3 + std::exp(-5 * t); });
  SignalNumber settling = Number(Statistic::SettlingTime);
  settling.band = 0.05;
  EXPECT_EQ(settling.Of(run), kUnbounded);
  settling.settles_at = SettlesAt::Final;
  EXPECT_NEAR(settling.Of(run), std::log(20) / 5, std::exp(-9) / 0.05 / 5 + 1e-3);
}

// What counts is how far it is from where it was at 0.5 s, before the rows that are taken.
TEST(SignalNumber, IsRelativeToATimeThatNeedNotBeTaken) {
  const Recording run =
      Recorded([](double t) { return 3 + t; }, [](double t) { return 4 - t * t; });
  SignalNumber last = Number(Statistic::Last);
  last.elements = {};
  last.from_s = 1;
  last.relative_to_s = 0.5;
  EXPECT_NEAR(last.Of(run), std::hypot(2 - 0.5, 4 - 0.25), 1e-14);
  last.relative_to_s = 0.4995;  // between two rows: the one after it
  EXPECT_NEAR(last.Of(run), std::hypot(2 - 0.5, 4 - 0.25), 1e-14);
  last.elements = {"y"};
  EXPECT_NEAR(last.Of(run), -4 + 0.25, 1e-14);  // with its sign
  last.relative_to_s = 2.1;
  EXPECT_EQ(ErrorOf([&] { last.Of(run); }),
            "no row of a.b lies at or after relative_to_s, got 2.1");
}

// A norm that is constant hides a vector that turns.
TEST(SignalNumber, SettlesAsAVectorNotAsANorm) {
  const Recording run = Recorded([](double t) { return t < 1 ? std::cos(kPi * t) : -1; },
                                 [](double t) { return t < 1 ? std::sin(kPi * t) : 0; });
  SignalNumber settling = Number(Statistic::SettlingTime);
  settling.elements = {};
  settling.settles_at = SettlesAt::Final;
  settling.band = 0.1;
  // 2 sin(π (1 − t)/2) ≤ 0.1
  EXPECT_NEAR(settling.Of(run), 1 - 2 / kPi * std::asin(0.05), 1e-3);
}

TEST(SignalNumber, NeverSettlesOfNumbersThatAreNone) {
  const Recording run = Recorded([](double t) { return t == 2 ? std::nan("") : 0; });
  SignalNumber settling = Number(Statistic::SettlingTime);
  settling.band = 1;
  EXPECT_EQ(settling.Of(run), kUnbounded);
}

// a sin(2π f t) has the rms a/√2, of which the filter leaves its gain.
TEST(SignalNumber, TakesWhatLiesAboveAFrequency) {
  const auto gain = [](double f, double cutoff) {
    return 1 / (1 + std::pow(std::tan(kPi * cutoff * 1e-3) / std::tan(kPi * f * 1e-3), 4));
  };
  const Recording run = Recorded([](double t) {
    return 5 + 2 * t + 3 * std::sin(2 * kPi * 2 * t) + 0.5 * std::sin(2 * kPi * 80 * t);
  });
  SignalNumber rms = Number(Statistic::Rms);
  rms.above_hz = 20;
  rms.from_s = 0.5, rms.to_s = 1.499;  // whole periods of both, away from the ends
  const double slow = 3 * gain(2, 20), fast = 0.5 * gain(80, 20);
  EXPECT_NEAR(rms.Of(run), std::sqrt((slow * slow + fast * fast) / 2), 2e-6);
  rms.above_hz = 0;
  EXPECT_GT(rms.Of(run), 5);
}

TEST(SignalNumber, TakesWhatLiesBelowAFrequency) {
  const auto gain = [](double f, double cutoff) {
    return 1 / (1 + std::pow(std::tan(kPi * cutoff * 1e-3) / std::tan(kPi * f * 1e-3), 4));
  };
  const Recording run = Recorded(
      [](double t) { return 3 * std::sin(2 * kPi * 2 * t) + 0.5 * std::sin(2 * kPi * 80 * t); });
  SignalNumber rms = Number(Statistic::Rms);
  rms.below_hz = 20;
  rms.from_s = 0.5, rms.to_s = 1.499;
  const double slow = 3 * (1 - gain(2, 20)), fast = 0.5 * (1 - gain(80, 20));
  EXPECT_NEAR(rms.Of(run), std::sqrt((slow * slow + fast * fast) / 2), 2e-6);
  SignalNumber mean = Number(Statistic::Mean);
  mean.below_hz = 20;
  EXPECT_NEAR(mean.Of(Recorded([](double) { return 5; })), 5, 1e-9);
}

TEST(SignalNumber, SaysWhatItIs) {
  const RecordedSignal signal = Recorded([](double t) { return t; })["a.b"];
  SignalNumber number{.signal = "a.b"};
  EXPECT_EQ(number.text(signal), "peak norm of a.b");
  EXPECT_EQ(number.unit(signal), "m");
  number.elements = {"y"};
  number.statistic = Statistic::Rms;
  number.above_hz = 20;
  number.from_s = 0.5;
  number.to_s = 1.5;
  EXPECT_EQ(number.text(signal), "rms of a.b[y] above 20.0 Hz from 500 ms to 1.50 s");
  number.above_hz = 0;
  number.below_hz = 10;
  EXPECT_EQ(number.text(signal), "rms of a.b[y] below 10.0 Hz from 500 ms to 1.50 s");
  number = {.signal = "a.b", .statistic = Statistic::SettlingTime, .band = 0.002};
  EXPECT_EQ(number.text(signal), "settling time of a.b to within 2.00 mm of zero");
  number.settles_at = SettlesAt::Final;
  EXPECT_EQ(number.text(signal), "settling time of a.b to within 2.00 mm of its final mean");
  number = {.signal = "a.b", .from_s = 1, .relative_to_s = 0.5};
  EXPECT_EQ(number.text(signal), "peak norm of a.b relative to 500 ms from 1.00 s");
}

TEST(SignalNumber, RefusesWhatDoesNotGoTogether) {
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.duration_s = 1;
  const auto error = [&](const SignalNumber& number) {
    return ErrorOf([&] { number.RequireFit(scenario); });
  };
  EXPECT_EQ(error(Number(Statistic::SettlingTime)),
            "settling_time wants a band > 0, in the signal's unit, got 0");
  SignalNumber number = Number(Statistic::Peak);
  number.band = 1;
  EXPECT_EQ(error(number), "band is of settling_time only, got 1");
  number.band = 0;
  number.settles_at = SettlesAt::Final;
  EXPECT_EQ(error(number), "settles_at is of settling_time only");
  number = Number(Statistic::Rms);
  number.above_hz = 500;
  EXPECT_EQ(error(number), "above_hz must be < 500 Hz, half the rate of the log's rows, got 500");
  number.above_hz = 499;
  EXPECT_EQ(error(number), "no error");
  number.relative_to_s = 0;
  EXPECT_EQ(error(number), "relative_to_s does not go with above_hz, which leaves no constant");
  number = Number(Statistic::Rms);
  number.below_hz = 500;
  EXPECT_EQ(error(number), "below_hz must be < 500 Hz, half the rate of the log's rows, got 500");
  number.below_hz = 10;
  EXPECT_EQ(error(number), "no error");
  number.above_hz = 10;
  EXPECT_EQ(error(number), "above_hz must be < below_hz, got 10 and 10");
  number = Number(Statistic::Peak);
  number.relative_to_s = 1.5;
  EXPECT_EQ(error(number), "relative_to_s must be <= duration_s, 1, got 1.5");
}

TEST(SignalNumber, RefusesToFilterRowsThatAreNotEvenlySpaced) {
  Recording run = Recorded([](double t) { return t; });
  std::vector<RecordedSignal> signals = run.signals();
  signals[0].times.tail(1000).array() += 0.5;
  run = Recording(signals, {});
  SignalNumber rms = Number(Statistic::Rms);
  EXPECT_EQ(ErrorOf([&] { rms.Of(run); }), "no error");
  rms.above_hz = 20;
  EXPECT_EQ(ErrorOf([&] { rms.Of(run); }),
            "the rows of a.b are 1.00 ms apart at 1.00 ms, elsewhere 1.25 ms; above_hz and "
            "below_hz need rows that are evenly spaced");
}

}  // namespace
}  // namespace pliant
