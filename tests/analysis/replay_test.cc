#include "pliant/analysis/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/delay.h"
#include "pliant/systems/discrete_integral.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/hold.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/low_pass.h"
#include "pliant/systems/pid.h"
#include "pliant/systems/simulator.h"
#include "pliant/systems/sine.h"
#include "pliant/systems/sum.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/recording_of.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Joints kJoints{"shoulder", "elbow"};

/// q̇ = v, v̇ = τ − 0.3 v.
class Plant final : public Block {
 public:
  explicit Plant(const Joints& joints)
      : torque{this, "torque", joints},
        position{this, "position", joints},
        velocity{this, "velocity", joints},
        q_{this, "q", joints},
        v_{this, "v", joints} {
    Derivative(q_).From(v_).As([](const JointVelocity& v) { return v; });
    Derivative(v_).From(v_, torque).As([](const JointVelocity& v, const JointTorque& tau) {
      return JointAcceleration(tau - 0.3 * v);
    });
    Compute(position).From(q_).As([](const JointPosition& q) { return q; });
    Compute(velocity).From(v_).As([](const JointVelocity& v) { return v; });
  }

  Input<JointTorque> torque;
  Output<JointPosition> position;
  Output<JointVelocity> velocity;

 private:
  Continuous<JointPosition> q_;
  Continuous<JointVelocity> v_;
};

/// τ = PID(q) − 2 LowPass(v) + what joins + half the torque of the last tick.
class Control final : public Composite {
 public:
  struct Options {
    Joints joints;
    double kp = 10;
    Duration period = 2ms;
  };

  explicit Control(const Options& o)
      : position{this, "position", o.joints},
        velocity{this, "velocity", o.joints},
        rest{this, "rest", o.joints},
        extra{this, "extra", o.joints},
        torque{this, "torque", o.joints},
        unfiltered{this, "unfiltered", o.joints},
        delayed{this, "delayed", o.joints} {
    const PerJoint ones = PerJoint::Ones(o.joints.size());
    auto& filter = Add<LowPass<JointVelocity>>(
        "filter", {.space = o.joints, .cutoff_hz = 40, .period = o.period});
    auto& damping =
        Add<Gain<JointVelocity, JointTorque>>("damping", {.space = o.joints, .gain = -2});
    auto& pid = Add<Pid<JointPosition, JointTorque>>("pid", {.space = o.joints,
                                                             .kp = o.kp * ones,
                                                             .ki = 5 * ones,
                                                             .kd = 1 * ones,
                                                             .filter_s = 5e-3,
                                                             .tracking_time_s = 0.1,
                                                             .lower = JointTorque(-8 * ones),
                                                             .upper = JointTorque(8 * ones),
                                                             .period = o.period});
    auto& half = Add<Gain<JointTorque>>("half", {.space = o.joints, .gain = 0.5});
    auto& delay = Add<Delay<JointTorque>>("delay", {.space = o.joints, .period = o.period});
    auto& sum = Add<Sum<JointTorque>>("sum", {.space = o.joints});
    auto& hold = Add<Hold<JointTorque>>("hold", {.space = o.joints, .period = o.period});

    Connect(position, pid.measured);
    Connect(rest, pid.reference);
    Connect(velocity, filter.u);
    Connect(filter.y, damping.u);
    Connect(pid.u, sum.plus);
    Connect(damping.y, sum.plus);
    Connect(half.y, sum.plus);
    Connect(extra, sum.plus);
    Connect(sum.y, hold.u);
    Connect(hold.y, torque);
    Connect(hold.y, delay.u);
    Connect(delay.y, half.u);
    Connect(delay.y, delayed);
    Connect(velocity, unfiltered);
  }

  Input<JointPosition> position;
  Input<JointVelocity> velocity;
  Input<JointPosition> rest;
  InputList<JointTorque> extra;
  Output<JointTorque> torque;
  Output<JointVelocity> unfiltered;
  Output<JointTorque> delayed;
};

/// A plant and its control, in one more composite.
class Rig final : public Composite {
 public:
  struct Options {
    Control::Options control;
  };

  explicit Rig(const Options& o)
      : push{this, "push", o.control.joints},
        position{this, "position", o.control.joints},
        velocity{this, "velocity", o.control.joints},
        torque{this, "torque", o.control.joints},
        delayed{this, "delayed", o.control.joints},
        unfiltered{this, "unfiltered", o.control.joints} {
    auto& plant = Add<Plant>("plant", o.control.joints);
    auto& rest = Add<Constant<JointPosition>>(
        "rest", {.space = o.control.joints, .value = JointPosition{0.4, -0.3}});
    auto& bias = Add<Constant<JointTorque>>(
        "bias", {.space = o.control.joints, .value = JointTorque{0.1, 0.2}});
    auto& control = Add<Control>("control", o.control);
    Connect(plant.position, control.position);
    Connect(plant.velocity, control.velocity);
    Connect(rest.y, control.rest);
    Connect(bias.y, control.extra);
    Connect(push, control.extra);
    Connect(control.torque, plant.torque);
    Connect(plant.position, position);
    Connect(plant.velocity, velocity);
    Connect(control.torque, torque);
    Connect(control.delayed, delayed);
    Connect(control.unfiltered, unfiltered);
  }

  InputList<JointTorque> push;
  Output<JointPosition> position;
  Output<JointVelocity> velocity;
  Output<JointTorque> torque, delayed;
  Output<JointVelocity> unfiltered;
};

/// The rig, pushed by a sine, and a logger of its ports.
LoggedDiagram MakeWhole(const Control::Options& o = {.joints = kJoints}, Duration rows = 1ms) {
  LoggedDiagram whole;
  DiagramBuilder& b = whole.builder;
  auto& sine = b.Add<Sine<JointTorque>>(
      "sine", {.space = o.joints, .amplitude = JointTorque{1.0, 0.5}, .frequency_hz = 1.7});
  auto& rig = b.Add<Rig>("rig", {.control = o});
  auto& logger = b.Add<Logger>("logger", {.period = rows});
  b.Connect(sine.y, rig.push);
  b.Connect(sine.y, logger.in);
  b.Connect(rig.position, logger.in);
  b.Connect(rig.velocity, logger.in);
  b.Connect(rig.torque, logger.in);
  b.Connect(rig.delayed, logger.in);
  b.Connect(rig.unfiltered, logger.in);
  whole.logger = &logger;
  return whole;
}

constexpr double kEnd = 0.5;
constexpr Eigen::Index kRows = 501;  // every 1 ms, both ends included

const Recording& Recorded() {
  static const Recording recording = RecordingOf(MakeWhole(), kEnd);
  return recording;
}

/// A recording with its signals changed, one by one; those for which `change` is false are left
/// out.
template <class Change>
Recording Changed(const Recording& recording, const Change& change) {
  std::vector<RecordedSignal> signals;
  for (RecordedSignal signal : recording.signals())
    if (change(signal)) signals.push_back(std::move(signal));
  return Recording(std::move(signals), {});
}

Recording Without(const std::set<std::string>& paths) {
  return Changed(Recorded(), [&](RecordedSignal& s) { return !paths.contains(s.path); });
}

/// Rows of which `keep` says so.
template <class Keep>
bool KeepRows(RecordedSignal& signal, const Keep& keep) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < signal.times.size(); ++k)
    if (keep(k)) rows.push_back(k);
  signal.times = Eigen::VectorXd(signal.times(rows));
  signal.numbers = Eigen::MatrixXd(signal.numbers(Eigen::all, rows));
  return true;
}

std::string ErrorOfReplay(const std::string& part, const Recording& recording) {
  return ErrorOf([&] { Replay(MakeWhole().builder, part, recording); });
}

TEST(Replay, OfAnUnchangedProgramIsIdenticalBitForBit) {
  const ReplayResult result = pliant::Replay(MakeWhole().builder, "rig.control", Recorded());
  EXPECT_TRUE(result.identical()) << result.text();
  // not `unfiltered`, which is an input passed through
  EXPECT_THAT(result.compared, ElementsAre("rig.torque", "rig.delayed"));
  EXPECT_EQ(result.rows, static_cast<std::size_t>(kRows));
  EXPECT_EQ(result.from, 0);
  EXPECT_EQ(result.to, kEnd);
  EXPECT_THAT(result.along, ElementsAre("rig.rest", "rig.bias"));
  EXPECT_THAT(result.text(), HasSubstr("identical: 2 signals over 501 rows, 0 s to 0.5 s\n"));
  EXPECT_THAT(result.text(), HasSubstr("not in the log, so computed again: rig.bias\n"));
}

TEST(Replay, RunsASingleBlockWithinComposites) {
  // what feeds the delay is the torque, which is recorded at a port of the outermost composite
  const ReplayResult result = pliant::Replay(MakeWhole().builder, "rig.control.delay", Recorded());
  EXPECT_TRUE(result.identical()) << result.text();
  EXPECT_THAT(result.compared, ElementsAre("rig.delayed"));
  EXPECT_THAT(result.along, IsEmpty());
}

TEST(Replay, ComputesAgainWhatTheLogLacks) {
  const ReplayResult result =
      Replay(MakeWhole().builder, "rig.control.delay", Without({"rig.torque"}));
  EXPECT_TRUE(result.identical()) << result.text();
  EXPECT_THAT(result.along, ElementsAre("rig.control.hold", "rig.control.sum", "rig.control.pid",
                                        "rig.control.damping", "rig.control.half", "rig.bias",
                                        "rig.rest", "rig.control.filter"));
}

TEST(Replay, FindsAChangedGainAtTheFirstInstantItActs) {
  const ReplayResult result =
      Replay(MakeWhole({.joints = kJoints, .kp = 11}).builder, "rig.control", Recorded());
  EXPECT_FALSE(result.identical());
  ASSERT_EQ(result.differences.size(), 4u);  // two joints of two signals, the first in time first
  const std::vector<double> rest{0.4, -0.3};
  for (std::size_t i = 0; i < 2; ++i) {
    const SignalDifference& d = result.differences[i];
    EXPECT_EQ(d.path, "rig.torque");
    EXPECT_EQ(d.element, i == 0 ? "[shoulder]" : "[elbow]");
    EXPECT_EQ(d.unit, "N·m");
    EXPECT_EQ(d.first_time, 0);
    // at rest at zero only the proportional part differs: 1 · rest; round-off of torques below 8
    EXPECT_NEAR(d.replayed - d.recorded, rest[i], 1e-14);
    EXPECT_EQ(d.recorded, Recorded()["rig.torque"].numbers(static_cast<Eigen::Index>(i), 0));
    EXPECT_GE(d.largest, std::abs(rest[i]) - 1e-14);
    EXPECT_EQ(d.rows, static_cast<std::size_t>(kRows));
  }
  // the delay shows the torque of tick 0 after it, first in the row of 1 ms
  EXPECT_EQ(result.differences[2].path, "rig.delayed");
  EXPECT_EQ(result.differences[2].first_time, 1e-3);
  EXPECT_EQ(result.differences[2].replayed - result.differences[2].recorded,
            result.differences[0].replayed - result.differences[0].recorded);
  EXPECT_THAT(result.text(), HasSubstr("different: 2 of 2 signals over 501 rows, 0 s to 0.5 s\n"));
}

TEST(Replay, OfAPerturbedRowDiffersInThatRowAlone) {
  // A changed row of an output is compared and fed to nothing.
  const Recording perturbed = Changed(Recorded(), [](RecordedSignal& s) {
    if (s.path == "rig.torque") s.numbers(1, 37) += 0.25;
    return true;
  });
  const ReplayResult control = Replay(MakeWhole().builder, "rig.control", perturbed);
  ASSERT_EQ(control.differences.size(), 1u) << control.text();
  const SignalDifference& d = control.differences.front();
  EXPECT_EQ(d.path + d.element, "rig.torque[elbow]");
  EXPECT_EQ(d.first_time, 0.037);
  EXPECT_EQ(d.rows, 1u);
  EXPECT_EQ(d.recorded - d.replayed, 0.25);
  EXPECT_EQ(d.largest, 0.25);

  // Between its ticks the delay does not look: row 37 is between those of 36 and 38 ms.
  EXPECT_TRUE(Replay(MakeWhole().builder, "rig.control.delay", perturbed).identical());
  const Recording at_a_tick = Changed(Recorded(), [](RecordedSignal& s) {
    if (s.path == "rig.torque") s.numbers(1, 40) += 0.25;
    return true;
  });
  const ReplayResult delay = Replay(MakeWhole().builder, "rig.control.delay", at_a_tick);
  ASSERT_EQ(delay.differences.size(), 1u) << delay.text();
  EXPECT_EQ(delay.differences.front().path, "rig.delayed");
  EXPECT_EQ(delay.differences.front().first_time, 0.041);  // shown after the tick at 40 ms
  EXPECT_EQ(delay.differences.front().rows, 2u);           // 41 and, before the update, 42 ms
}

TEST(Replay, HoldsTwoNotANumbersOfTheSameBitsForEqual) {
  const auto with_nan = [](double in, double out) {
    DiagramBuilder b;
    auto& source = b.Add<Constant<double>>("source", {.value = in});
    auto& hold = b.Add<Hold<double>>("hold", {.period = 1ms});
    b.Connect(source.y, hold.u);
    RecordedSignal u{{"source.y", "double", {""}, {""}}, {}, {}}, y = u;
    u.times = Eigen::VectorXd::Zero(1);
    u.numbers = Eigen::MatrixXd::Constant(1, 1, in);
    y = u;
    y.path = "hold.y";
    y.numbers(0, 0) = out;
    return Replay(std::move(b), "hold", Recording({u, y}, {}));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(with_nan(nan, nan).identical());
  EXPECT_FALSE(with_nan(0.0, -0.0).identical());
  const ReplayResult lost = with_nan(nan, 2);
  ASSERT_EQ(lost.differences.size(), 1u);
  EXPECT_EQ(lost.differences.front().largest, std::numeric_limits<double>::infinity());
  EXPECT_EQ(lost.text(),
            "different: 1 of 1 signal over 1 row, 0 s to 0 s\n"
            "  signal  first at (s)  recorded  replayed  largest difference  rows\n"
            "  hold.y  0             2         nan       inf                 1\n");
}

TEST(Replay, ReportsRecordedSignalsThatThePartNoLongerHas) {
  const Recording recording = Changed(Recorded(), [](RecordedSignal& s) {
    if (s.path == "rig.delayed") s.path = "rig.control.lag.y";
    return true;
  });
  const ReplayResult result = pliant::Replay(MakeWhole().builder, "rig.control", recording);
  EXPECT_FALSE(result.identical());
  EXPECT_THAT(result.unknown, ElementsAre("rig.control.lag.y"));
  EXPECT_THAT(result.text(), HasSubstr("identical, but not complete: 1 signal over 501 rows"));
  EXPECT_THAT(result.text(), HasSubstr("recorded, but not in the part: rig.control.lag.y\n"));
}

TEST(Replay, FindsAnInputUnderAnyOfItsNames) {
  // the velocity is recorded as `unfiltered` too
  const ReplayResult result = Replay(MakeWhole().builder, "rig.control", Without({"rig.velocity"}));
  EXPECT_TRUE(result.identical()) << result.text();
}

TEST(Replay, TellsWhichInputWasNotRecorded) {
  EXPECT_EQ(ErrorOfReplay("rig.control", Without({"rig.velocity", "rig.unfiltered"})),
            "cannot run rig.control by itself: what feeds it is not known\n"
            "  from  rig.plant.velocity : joint velocity [rad/s] (shoulder, elbow)\n"
            "  to    rig.control.velocity : joint velocity [rad/s] (shoulder, elbow)\n"
            "rig.plant.q changes between ticks, so it is not computed again; "
            "record rig.plant.velocity");
}

TEST(Replay, RefusesALogOfOtherJoints) {
  const Recording other = RecordingOf(MakeWhole({.joints = Joints{"hip", "knee"}}), kEnd);
  EXPECT_EQ(ErrorOfReplay("rig.control", other),
            "the log and the diagram differ on rig.position\n"
            "  log      joint position [hip] (rad), [knee] (rad)\n"
            "  diagram  joint position [shoulder] (rad), [elbow] (rad)\n"
            "replay with the robot and the settings that were recorded");
}

TEST(Replay, NamesTheNearestPart) {
  EXPECT_EQ(ErrorOfReplay("rig.contrl", Recorded()),
            "the diagram has no part 'rig.contrl'; did you mean 'rig.control'?");
}

TEST(Replay, RefusesAPartThatIsIntegrated) {
  EXPECT_EQ(ErrorOfReplay("rig", Recorded()),
            "cannot run rig by itself: rig.plant.q : joint position [rad] (shoulder, elbow) "
            "changes between ticks\n"
            "name a part that is sampled: rig.rest, rig.bias, rig.control");
}

TEST(Replay, RefusesALogThatBeginsLater) {
  const Recording late = Changed(Recorded(), [](RecordedSignal& s) {
    return KeepRows(s, [](Eigen::Index k) { return k >= 100; });
  });
  EXPECT_EQ(ErrorOfReplay("rig.control", late),
            "the log begins at t = 0.1 s, but rig.control ticks from t = 0 s on, from its initial "
            "state\nreplay a log from the beginning of the run");
}

TEST(Replay, RefusesALogWithoutARowAtATick) {
  const auto without_row = [](Eigen::Index row) {
    return Changed(Recorded(), [row](RecordedSignal& s) {
      return KeepRows(s, [row](Eigen::Index k) { return k != row; });
    });
  };
  EXPECT_EQ(ErrorOfReplay("rig.control", without_row(122)),
            "the log has no row of rig.position at t = 0.122 s, when rig.control ticks\n"
            "record a row at each of its ticks, and drop none");
  // the part does not look at a row between its ticks
  const ReplayResult between = Replay(MakeWhole().builder, "rig.control", without_row(123));
  EXPECT_TRUE(between.identical()) << between.text();
  EXPECT_EQ(between.rows, static_cast<std::size_t>(kRows - 1));
}

TEST(Replay, RefusesALogWithFewerRowsThanThePartHasTicks) {
  const Recording slow = RecordingOf(MakeWhole({.joints = kJoints}, 10ms), kEnd);
  EXPECT_THAT(ErrorOfReplay("rig.control", slow),
              HasSubstr("no row of rig.position at t = 0.002 s, when rig.control ticks"));
}

TEST(Replay, RefusesRowsThatAreOutOfOrder) {
  const Recording mixed = Changed(Recorded(), [](RecordedSignal& s) {
    std::swap(s.times(3), s.times(4));
    return true;
  });
  EXPECT_EQ(ErrorOfReplay("rig.control", mixed),
            "the rows of rig.position are not in the order of time: t = 0.003 s follows "
            "t = 0.004 s");
}

TEST(Replay, RefusesASignalWithoutRows) {
  const Recording empty = Changed(Recorded(), [](RecordedSignal& s) {
    return s.path != "rig.torque" || KeepRows(s, [](Eigen::Index) { return false; });
  });
  EXPECT_EQ(ErrorOfReplay("rig.control", empty), "the log has no row of rig.torque");
}

TEST(Replay, RefusesRowsBeforeTheStart) {
  const Recording early = Changed(Recorded(), [](RecordedSignal& s) {
    s.times.array() -= 0.25;
    return true;
  });
  EXPECT_EQ(ErrorOfReplay("rig.control", early),
            "the log begins at t = -0.25 s, before the start of a run: rig.position");
}

TEST(Replay, RefusesASignalOfAnotherShapeThanItsNames) {
  const Recording cut = Changed(Recorded(), [](RecordedSignal& s) {
    s.numbers.conservativeResize(1, Eigen::NoChange);
    return true;
  });
  EXPECT_EQ(ErrorOfReplay("rig.control", cut),
            "a recorded signal has a number for each element and time: rig.position");
}

TEST(Replay, RefusesInputsAndOutputsThatWereNeverRecordedTogether) {
  const Recording apart = Changed(Recorded(), [](RecordedSignal& s) {
    const bool output = s.path == "rig.torque" || s.path == "rig.delayed";
    return KeepRows(s, [&](Eigen::Index k) { return (k % 2 == 1) == output; });
  });
  EXPECT_EQ(ErrorOfReplay("rig.control", apart),
            "the log has no instant at which both what feeds rig.control and what it computes "
            "were recorded\nrecord both with the same period");
}

TEST(Replay, RefusesALogOfNothingThePartComputes) {
  EXPECT_EQ(ErrorOfReplay("rig.bias", Recorded()),
            "the log has no signal that rig.bias computes, so there is nothing to compare\n"
            "record one of its outputs");
}

TEST(Replay, ComparesSignalsRecordedAtDifferentPeriodsWhereTheyMeet) {
  const Recording thinned = Changed(Recorded(), [](RecordedSignal& s) {
    return s.path != "rig.torque" || KeepRows(s, [](Eigen::Index k) { return k % 50 == 0; });
  });
  const ReplayResult result = Replay(MakeWhole().builder, "rig.control", thinned);
  EXPECT_TRUE(result.identical()) << result.text();
  EXPECT_EQ(result.rows, static_cast<std::size_t>(kRows));  // `delayed` has them all
}

TEST(Replay, RunsPartsOfSeveralRates) {
  const auto make = [] {
    LoggedDiagram whole;
    DiagramBuilder& b = whole.builder;
    auto& sine = b.Add<Sine<double>>("sine", {.amplitude = 1, .frequency_hz = 3});
    auto& fast = b.Add<LowPass<double>>("fast", {.cutoff_hz = 20, .period = 1ms});
    auto& slow = b.Add<Hold<double>>("slow", {.period = 3ms, .offset = 2ms});
    auto& logger = b.Add<Logger>("logger", {.period = 500us});
    b.Connect(sine.y, fast.u);
    b.Connect(fast.y, slow.u);
    b.Connect(sine.y, logger.in);
    b.Connect(slow.y, logger.in);
    whole.logger = &logger;
    return whole;
  };
  const ReplayResult result = Replay(make().builder, "slow", RecordingOf(make(), kEnd));
  EXPECT_TRUE(result.identical()) << result.text();
  EXPECT_THAT(result.along, ElementsAre("fast"));
  EXPECT_EQ(result.rows, 1001u);
}

}  // namespace
}  // namespace pliant
