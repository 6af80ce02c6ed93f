#include "pliant/plants/true_contacts.h"

#include <gtest/gtest.h>

#include <vector>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"

namespace pliant {
namespace {

ContactForce Force(int link, double newtons) {
  return {link, {0.1, 0.2, 0.3}, {0, 0, newtons}, Eigen::Vector3d::Zero()};
}

/// So many forces of the environment, each on a link of its own.
struct Rig {
  explicit Rig(int forces) {
    for (int i = 0; i < forces; ++i) joined.push_back(&t.Join(t->forces, Force(i, 0)));
  }
  void Push(int i, double newtons) {
    t.Set(*joined[static_cast<std::size_t>(i)], Force(i, newtons));
  }
  std::vector<int> Links() {
    t.Tick();
    std::vector<int> links;
    for (const ContactForce& contact : t.Get(t->contacts).at) links.push_back(contact.link);
    return links;
  }

  BlockTester<TrueContacts> t{TrueContacts::Options{.period = 1ms}};
  std::vector<const Input<ContactForce>*> joined;
};

using Places = std::vector<int>;

TEST(TrueContacts, AContactKeepsItsPlaceWhileItLasts) {
  Rig rig(4);
  EXPECT_EQ(rig.Links(), (Places{-1, -1, -1}));
  rig.Push(2, 5);
  EXPECT_EQ(rig.Links(), (Places{2, -1, -1}));
  rig.Push(0, 1);
  EXPECT_EQ(rig.Links(), (Places{2, 0, -1}));
  rig.Push(2, 0);
  EXPECT_EQ(rig.Links(), (Places{-1, 0, -1})) << "the other one does not move up";
  rig.Push(3, -1);
  EXPECT_EQ(rig.Links(), (Places{3, 0, -1})) << "the lowest that is free";
}

TEST(TrueContacts, SaysWhatTheForcesAre) {
  Rig rig(1);
  rig.Push(0, 7);
  rig.Links();
  EXPECT_EQ(rig.t.Get(rig.t->contacts).count(), 1);
  EXPECT_EQ(rig.t.Get(rig.t->contacts).at[0].force, Eigen::Vector3d(0, 0, 7));
  EXPECT_EQ(rig.t.Get(rig.t->contacts).at[0].point, Eigen::Vector3d(0.1, 0.2, 0.3));
}

TEST(TrueContacts, CountsTheContactsForWhichNoPlaceIsFreeUntilOneIs) {
  Rig rig(5);
  for (int i = 0; i < 5; ++i) rig.Push(i, 1);
  EXPECT_EQ(rig.Links(), (Places{0, 1, 2}));
  EXPECT_EQ(rig.t.Get(rig.t->left_out), 2);
  rig.Push(1, 0);
  EXPECT_EQ(rig.Links(), (Places{0, 3, 2}));
  EXPECT_EQ(rig.t.Get(rig.t->left_out), 1);
}

TEST(TrueContacts, HoldsTheLaws) {
  BlockTester<TrueContacts> t(TrueContacts::Options{.period = 1ms});
  for (int i = 0; i < 4; ++i) t.Join(t->forces, Force(i, 0));
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
