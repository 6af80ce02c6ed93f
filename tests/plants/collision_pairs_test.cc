#include "pliant/plants/collision_pairs.h"

#include <gmock/gmock.h>

#include "pliant/plants/collision_geometry.h"
#include "pliant/plants/shared_file.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

std::vector<std::string> NamesOf(const CollisionGeometry& geometry) {
  std::vector<std::string> all;
  for (int i = 0; i < geometry.size(); ++i) all.push_back(geometry.names()[i]);
  return all;
}
std::vector<std::string> Names(const RobotModel& m, const CollisionPairs& pairs,
                               const std::vector<Obstacle>& obstacles = {}) {
  return NamesOf(CollisionGeometry(m, pairs, obstacles));
}

CollisionPairs Gen3Pairs(const RobotModel& m) {
  return CollisionPairs::Read(ModelFile("gen3/collisions.yaml"), m);
}

TEST(CollisionPairs, AreAllOfLinksThatNoJointConnects) {
  // Eight shapes make 28 pairs, 7 of them of neighbours.
  const std::vector<std::string> names = Names(Gen3(), {});
  EXPECT_THAT(names, SizeIs(21));
  EXPECT_THAT(names, Contains("base_link-half_arm_1_link"));
  EXPECT_THAT(names, Not(Contains("base_link-shoulder_link")));
  EXPECT_THAT(names, Not(Contains("forearm_link-spherical_wrist_1_link")));
}

TEST(CollisionPairs, LeaveOutLinksOfOneBody) {
  // The sensor on the bracelet: five links with six shapes on body 7, next to body 6.
  const std::vector<std::string> names = Names(RobotModel::FromUrdf(kGen3BotaFile), {});
  EXPECT_THAT(names, Not(Contains("bracelet_link-FT_adapter")));
  EXPECT_THAT(names, Not(Contains("FT_adapter-FT_sensor_wrench")));
  EXPECT_THAT(names, Not(Contains("spherical_wrist_2_link-FT_adapter")));
  EXPECT_THAT(names, Contains("spherical_wrist_1_link-FT_adapter"));
  EXPECT_THAT(names, Contains("base_link-FT_sensor_mounting_plug")) << "one of two shapes";
}

TEST(CollisionPairs, AreThoseWatchedWithoutThoseIgnored) {
  const CollisionPairs pairs = CollisionPairs::ReadText(
      "watch:\n"
      "  - {links: [base_link, shoulder_link], against: [bracelet_link, forearm_link]}\n"
      "ignore:\n"
      "  - {links: [bracelet_link], against: [shoulder_link]}\n",
      Gen3());
  EXPECT_THAT(Names(Gen3(), pairs),
              testing::ElementsAre("base_link-forearm_link", "base_link-bracelet_link",
                                   "shoulder_link-forearm_link"));
}

TEST(CollisionPairs, OfTheModelsFit) {
  EXPECT_THAT(Names(Gen3(), Gen3Pairs(Gen3())), SizeIs(4 * 3));
  const RobotModel bota = RobotModel::FromUrdf(kGen3BotaFile);
  EXPECT_THAT(Names(bota, Gen3Pairs(bota)), SizeIs(4 * 7)) << "two shapes on FT_sensor_mounting";
  EXPECT_THAT(Names(Lwr(), CollisionPairs::Read(ModelFile("lwr/collisions.yaml"), Lwr())),
              SizeIs(2 * 4));
}

double SmallestDistance(const RobotModel& m, const JointPosition& q) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, JointVelocity::Zero(m.joints()), d);
  return CollisionGeometry(m, Gen3Pairs(m), {}).Distances(d).minCoeff();
}

TEST(CollisionPairs, OfTheGen3AreApartInItsNamedPostures) {
  const double pi = 3.141592653589793;
  // Figures to a millimetre, of the capsules of models/gen3.
  EXPECT_NEAR(SmallestDistance(Gen3(), {0, 0.2618, pi, -2.2689, 0, 0.9599, pi / 2}), 0.087, 6e-4);
  EXPECT_NEAR(SmallestDistance(Gen3(), {0, -0.349, pi, -2.548, 0, -0.873, pi / 2}), 0.038, 6e-4);
}

/// Least of the distances over random postures within the limits, for pairs that are in `all` and
/// not in `watched`.
double LeastUnwatched(const RobotModel& m, const CollisionGeometry& all,
                      const std::vector<std::string>& watched, int postures) {
  RandomStates random(m, 4);
  RobotDynamics d(m);
  double least = 1;
  for (int k = 0; k < postures; ++k) {
    JointPosition q = random.q();
    for (int i = 0; i < m.size(); ++i)
      if (std::isfinite(m.joint(i).upper)) q(i) *= m.joint(i).upper / 3.1;
    ComputeDynamics(m, q, JointVelocity::Zero(m.joints()), d);
    const PairDistances e = all.Distances(d);
    for (int i = 0; i < all.size(); ++i)
      if (std::ranges::find(watched, all.names()[i]) == watched.end())
        least = std::min(least, e(i));
  }
  return least;
}

TEST(CollisionPairs, ThatAreNotWatchedAreKeptApartByTheJointRanges) {
  const RobotModel bota = RobotModel::FromUrdf(kGen3BotaFile);
  EXPECT_GT(LeastUnwatched(bota, {bota, {}, {}}, Names(bota, Gen3Pairs(bota)), 3000), 0.0125);
  const RobotModel lwr = Lwr();
  const CollisionPairs wrist{.ignore = {{{"link_5"}, {"link_7"}}}};
  const std::vector<std::string> watched =
      Names(lwr, CollisionPairs::Read(ModelFile("lwr/collisions.yaml"), lwr));
  EXPECT_GT(LeastUnwatched(lwr, {lwr, wrist, {}}, watched, 3000), 0.067);
}

TEST(CollisionPairs, NameWhatIsWrongInTheirFile) {
  const auto error = [](const std::string& text) {
    return ErrorOf([&] { CollisionPairs::ReadText(text, Gen3(), "pairs.yaml"); });
  };
  EXPECT_THAT(error("ignore:\n  - {links: [base_link], against: [bracelet]}"),
              HasSubstr("pairs.yaml:2:36: expected one of base_link, "));
  EXPECT_THAT(error("ignore:\n  - {links: [base_link], against: [bracelet]}"),
              HasSubstr("got 'bracelet'; did you mean 'bracelet_link'?"));
  EXPECT_EQ(error("watch:\n  - {links: [tool], against: [tool]}\noptional: [tool]"), "no error");
  EXPECT_THAT(error("watched: []"), HasSubstr("pairs.yaml:1:1: there is no 'watched' here"));
  EXPECT_THAT(error("watch:\n  - {link: [base_link]}"), HasSubstr("pairs.yaml:2:6: "));
  EXPECT_EQ(error("watch: base_link"), "pairs.yaml:1:8: expected a list, got 'base_link'");
  EXPECT_EQ(ErrorOf([] { CollisionPairs::Read("no/such.yaml", Gen3()); }),
            "no/such.yaml: cannot be read");
}

TEST(CollisionGeometry, RefusesPairsThatAreNone) {
  const auto error = [](const CollisionPairs& pairs, const std::vector<Obstacle>& obstacles = {}) {
    return ErrorOf([&] { CollisionGeometry(Gen3(), pairs, obstacles); });
  };
  EXPECT_THAT(error({.watch = {{{"base_link"}, {"forearm"}}}}),
              HasSubstr("has no link \"forearm\""));
  EXPECT_EQ(error({.watch = {{{"base_link"}, {}}}}),
            "a group of pairs names `links` and links `against` which they are");
  EXPECT_EQ(error({.watch = {{{"base_link"}, {"tool_frame"}}}}),
            "the watched link 'tool_frame' has no collision shape");
  const SphereObstacle ball{.name = "ball", .center = {1, 0, 0}, .radius = 0.1};
  EXPECT_EQ(error({}, {ball, ball}),
            "an obstacle must have a name that no other and no link has, "
            "got ball");
  SphereObstacle link = ball;
  link.name = "base_link";
  EXPECT_EQ(error({}, {link}),
            "an obstacle must have a name that no other and no link has, "
            "got base_link");
  SphereObstacle excepting = ball;
  excepting.except = {"forearm"};
  EXPECT_THAT(error({}, {excepting}), HasSubstr("has no link \"forearm\""));

  std::vector<Obstacle> many;
  for (int i = 0; i < 7; ++i) {
    SphereObstacle one = ball;
    one.name += std::to_string(i);
    many.push_back(one);
  }
  EXPECT_EQ(error({}, many),
            "at most 64 pairs of shapes are kept apart; name fewer in `watch`, or more in `ignore` "
            "or `except`, got 70");
}

TEST(CollisionGeometry, PairsAnObstacleWithEachLinkThatMovesAndThatItDoesNotExcept) {
  const CollisionPairs none{.ignore = {{{"base_link"}, {"bracelet_link"}}}};
  const BoxObstacle stand{.name = "stand",
                          .center = {0, 0, -0.5},
                          .size = {1, 1, 1},
                          .except = {"shoulder_link", "half_arm_1_link"}};
  const std::vector<std::string> names = Names(Gen3(), none, {stand});
  EXPECT_THAT(names, SizeIs(20 + 5));
  EXPECT_THAT(names, Contains("stand-half_arm_2_link"));
  EXPECT_THAT(names, Not(Contains("stand-base_link"))) << "neither moves";
  EXPECT_THAT(names, Not(Contains("stand-shoulder_link")));
}

TEST(CollisionGeometry, HasTheDistancesOfThePlacedShapes) {
  const RobotModel m = Lwr();
  const BoxObstacle table{.name = "table", .center = {0.5, 0, -0.1}, .size = {1, 1, 0.2}};
  const CollisionGeometry geometry(m, {}, {table});
  std::vector<CollisionShape> shapes;  // of the links, and the table
  for (const Link& link : m.links())
    shapes.push_back(link.collisions.empty() ? CollisionShape()
                                             : CollisionShape::Of(link.collisions[0]));
  shapes.push_back(ShapeOf(table));
  std::vector<Pose> poses(shapes.size());
  RandomStates random(m, 9);
  RobotDynamics d(m);
  for (int k = 0; k < 100; ++k) {
    ComputeDynamics(m, random.q(), random.v(), d);
    for (int i = 0; i < std::ssize(m.links()); ++i)
      poses[static_cast<std::size_t>(i)] = LinkPose(m, d, i);
    const PairDistances e = geometry.Distances(d);
    for (int i = 0; i < geometry.size(); ++i) {
      const auto placed = [&](int part) {
        const int link = geometry.part(part).link;
        const std::size_t at = link < 0 ? shapes.size() - 1 : static_cast<std::size_t>(link);
        return PlacedShape(shapes[at], poses[at].rotation, poses[at].position);
      };
      const auto [a, b] = geometry.pairs()[static_cast<std::size_t>(i)];
      EXPECT_NEAR(Closest(placed(a), placed(b)).distance, e(i), 1e-12) << geometry.names()[i];
    }
  }
}

}  // namespace
}  // namespace pliant
