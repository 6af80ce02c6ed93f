#include "pliant/analysis/tunable_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "pliant/analysis/readable_values.h"
#include "pliant/systems/block.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using Kind = TunableValue::Kind;

enum class Gait { Slow, Fast };
const std::vector<std::string>& Words(Gait) {
  static const std::vector<std::string> words{"slow", "fast"};
  return words;
}

const Joints kJoints{"shoulder", "elbow"};

class Walker final : public Block {
 public:
  Walker() {
    Compute(y).From(gain, wired).As([](double a, double b) { return a * b; });
  }

  Input<double> gain{this, "gain", {}, 2.5};
  Input<double> wired{this, "wired", {}, 1};
  Input<bool> on{this, "on", {}, true};
  Input<Gait> gait{this, "gait", {}, Gait::Fast};
  Input<int> legs{this, "legs", {}, 4};
  Input<JointTorque> limit{this, "limit", kJoints, JointTorque{30, 20}};
  Input<Eigen::Matrix<double, 2, 3>> matrix{
      this, "matrix", {}, (Eigen::Matrix<double, 2, 3>() << 1, 2, 3, 4, 5, 6).finished()};
  Input<Pose> place{this, "place", {}, Pose()};
  Output<double> y{this, "y"};
};

std::vector<TunableValue> OfWalker() {
  DiagramBuilder b;
  auto& walker = b.Add<Walker>("walker");
  b.Connect(b.Add<Constant<double>>("one", {.value = 1}).y, walker.wired);
  const Diagram diagram = b.Build();
  std::vector<TunableValue> all = TunableValuesOf(diagram);
  EXPECT_EQ(all.back().path, "one.value");
  all.pop_back();
  for (TunableValue& of : all) of.value = nullptr;  // of a diagram that is gone
  return all;
}

TEST(TunableValues, AreInputsWithADefaultThatNothingIsConnectedTo) {
  std::vector<std::string> paths;
  for (const TunableValue& of : OfWalker()) paths.push_back(of.path);
  EXPECT_THAT(paths, ElementsAre("walker.gain", "walker.on", "walker.gait", "walker.legs",
                                 "walker.limit", "walker.matrix"));
}

TEST(TunableValues, KnowTheirKindTheirUnitsAndTheirStart) {
  const std::vector<TunableValue> all = OfWalker();
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all[0].kind, Kind::Number);
  EXPECT_FALSE(all[0].whole);
  EXPECT_THAT(all[0].start, ElementsAre(2.5));
  EXPECT_EQ(all[1].kind, Kind::Flag);
  EXPECT_EQ(all[2].kind, Kind::Word);
  EXPECT_THAT(all[2].words, ElementsAre("slow", "fast"));
  EXPECT_THAT(all[2].start, ElementsAre(1));
  EXPECT_EQ(all[3].kind, Kind::Number);
  EXPECT_TRUE(all[3].whole);
  EXPECT_EQ(all[4].kind, Kind::Numbers);
  EXPECT_THAT(all[4].elements, ElementsAre("[shoulder]", "[elbow]"));
  EXPECT_THAT(all[4].units, ElementsAre("N·m", "N·m"));
  EXPECT_THAT(all[4].start, ElementsAre(30, 20));
}

TEST(TunableValues, HaveAMatrixColumnByColumn) {
  const TunableValue matrix = OfWalker().at(5);
  EXPECT_EQ(matrix.kind, Kind::Matrix);
  EXPECT_EQ(matrix.rows, 2);
  EXPECT_EQ(matrix.cols, 3);
  EXPECT_THAT(matrix.start, ElementsAre(1, 4, 2, 5, 3, 6));
}

TEST(TunableValues, OfACompositeAreItsInputsAndNotWhatTheyAreWiredTo) {
  struct House final : Composite {
    House() {
      auto& walker = Add<Walker>("walker");
      Connect(gain, walker.gain);
    }
    Input<double> gain{this, "gain", {}, 7};
  };
  DiagramBuilder b;
  b.Add<House>("house");
  const Diagram diagram = b.Build();
  std::vector<std::string> paths;
  for (const TunableValue& of : TunableValuesOf(diagram)) paths.push_back(of.path);
  EXPECT_THAT(paths, testing::Contains("house.gain"));
  EXPECT_THAT(paths, testing::Not(testing::Contains("house.walker.gain")));
}

TEST(ReadableValues, AreAllPortsOfNumbersAndAWiredInputShowsWhatItIsWiredTo) {
  DiagramBuilder b;
  auto& walker = b.Add<Walker>("walker");
  b.Connect(b.Add<Constant<double>>("one", {.value = 7}).y, walker.wired);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  const std::vector<ReadableValue> all = ReadableValuesOf(diagram);
  std::vector<std::string> tunable, others;
  std::map<std::string, double> read;  // the first number of each
  for (const ReadableValue& of : all) {
    (of.tunable ? tunable : others).push_back(of.path + " " + of.role);
    std::vector<double> numbers(of.size());
    sim.GetNumbers(*of.value, numbers);
    if (!of.tunable) read[of.path] = numbers[0];
  }
  EXPECT_THAT(tunable, ElementsAre("walker.gain input", "walker.on input", "walker.gait input",
                                   "walker.legs input", "walker.limit input", "walker.matrix input",
                                   "one.value input"));
  EXPECT_THAT(others, ElementsAre("walker.wired input", "walker.place input", "walker.y output",
                                  "one.y output"));
  EXPECT_EQ(read["walker.wired"], 7);
  EXPECT_EQ(read["walker.y"], 7 * 2.5);
}

}  // namespace
}  // namespace pliant
