#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "pliant/controllers/pad_modes.h"
#include "pliant/controllers/pad_player.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using enum PadButton;
using enum PadHappening;

PadState With(std::initializer_list<PadButton> down) {
  PadState state{.connected = true};
  for (const PadButton button : down) state.buttons |= BitOf(button);
  return state;
}

struct Person {
  explicit Person(const PadModes::Options& o = {}) : t(o) { Say(With({})); }
  void Say(const PadState& state) {
    t.Set(t->pad, state);
    t.Tick();
  }
  void Press(PadButton button) {
    Say(With({button}));
    Say(With({}));
  }
  ComplianceMode mode() { return t.Get(t->mode); }
  ArmControl control() { return t.Get(t->control); }
  BlockTester<PadModes> t;
};

TEST(PadModes, ChangesWhatItsButtonsAreFor) {
  Person person;
  EXPECT_EQ(person.mode(), ComplianceMode::NullSpace);
  person.Press(Square);
  EXPECT_EQ(person.mode(), ComplianceMode::FullBody);
  person.Press(Cross);
  EXPECT_EQ(person.mode(), ComplianceMode::Dual);
  person.Press(Cross);
  person.Press(Square);
  person.Press(Triangle);
  EXPECT_EQ(person.mode(), ComplianceMode::Stiff);
  EXPECT_EQ(person.control(), ArmControl::ProposedTorque);
  person.Press(L1);
  EXPECT_EQ(person.control(), ArmControl::KinovaTorque);
  person.Press(Circle);
  EXPECT_EQ(person.control(), ArmControl::Position);
  person.Press(R1);
  EXPECT_EQ(person.control(), ArmControl::Position);
  person.Press(Circle);
  EXPECT_EQ(person.control(), ArmControl::ProposedTorque);
  for (const auto& [button, dynamic] :
       {std::pair{Up, true}, {Down, false}, {Right, true}, {Left, false}}) {
    person.Press(button);
    EXPECT_EQ(person.t.Get(person.t->dynamic), dynamic);
  }
}

TEST(PadModes, TakesAPressOnceHoweverLongItLasts) {
  Person person;
  for (int k = 0; k < 100; ++k) person.Say(With({Cross}));
  EXPECT_EQ(person.mode(), ComplianceMode::Dual);
}

TEST(PadModes, StaysInItsModesWhenThePadIsUnplugged) {
  Person person;
  person.Press(Circle);
  person.Say(With({Cross}));
  const auto stays = [&] {
    EXPECT_EQ(person.mode(), ComplianceMode::Dual);
    EXPECT_EQ(person.control(), ArmControl::Position);
  };
  person.Say({});
  stays();
  person.Say(With({Cross, Circle}));  // down when it comes back
  stays();
  person.Say(With({}));
  stays();
  person.Press(Circle);
  EXPECT_EQ(person.control(), ArmControl::ProposedTorque);
}

TEST(PadModes, StartsWithWhatItIsTold) {
  for (const auto mode : {ComplianceMode::Stiff, ComplianceMode::NullSpace,
                          ComplianceMode::FullBody, ComplianceMode::Dual})
    for (const auto control :
         {ArmControl::Position, ArmControl::KinovaTorque, ArmControl::ProposedTorque}) {
      Person person({.mode = mode, .dynamic = true, .control = control});
      EXPECT_EQ(person.mode(), mode);
      EXPECT_EQ(person.control(), control);
      EXPECT_TRUE(person.t.Get(person.t->dynamic));
    }
}

const PadEvents kRecording{{{.at_s = 0.002, .what = Connect},
                            {.at_s = 0.004, .what = Press, .button = Cross},
                            {.at_s = 0.004, .what = Press, .button = L1},
                            {.at_s = 0.006, .what = Release, .button = Cross},
                            {.at_s = 0.008, .what = Disconnect}}};

TEST(PadPlayer, SaysAtEachTickWhatWasRecorded) {
  BlockTester<PadPlayer> t(PadPlayer::Options{.recording = kRecording});
  const std::vector<PadState> expected{{false, 0, 0},
                                       {true, 0, 0.002},
                                       {true, BitOf(Cross) | BitOf(L1), 0.004},
                                       {true, BitOf(L1), 0.006},
                                       {false, 0, 0.008}};
  t.Tick();
  const long before = Allocations();
  for (int k = 0; k < 10; ++k) {
    const PadState& state = t.Get(t->state);
    const PadState& at = expected[static_cast<std::size_t>(k / 2)];
    ASSERT_EQ(state.connected, at.connected) << k;
    ASSERT_EQ(state.buttons, at.buttons) << k;
    ASSERT_EQ(state.stamp_s, at.stamp_s) << k;
    t.Tick();
  }
  EXPECT_EQ(Allocations() - before, 0);
}

TEST(PadEvents, AreBetweenTheStatesThatTheyMake) {
  std::vector<PadEvent> again;
  PadState state;
  for (const PadEvent& event : kRecording.events) {
    const PadState next = After(state, event);
    for (const PadEvent& found : EventsBetween(state, next)) again.push_back(found);
    state = next;
  }
  ASSERT_EQ(again.size(), kRecording.events.size());
  for (std::size_t i = 0; i < again.size(); ++i)
    EXPECT_EQ(LineOf(again[i]), LineOf(kRecording.events[i]));
}

class PadFile : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string ErrorIn(const std::string& text) {
    std::ofstream(file_) << text;
    std::string error = ErrorOf([&] { PadEvents::Read(file_); });
    const std::string prefix = file_.string() + ":";
    return error.starts_with(prefix) ? error.substr(prefix.size()) : error;
  }
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("pad_" + std::to_string(::getpid()));
  const std::filesystem::path file_ = folder_ / "pad.yaml";
};

TEST_F(PadFile, ReadsWhatItWrites) {
  std::string text = "events:\n";
  for (const PadEvent& event : kRecording.events) text += "  - " + LineOf(event) + "\n";
  EXPECT_EQ(ErrorIn(text), "no error");
  const PadEvents read = PadEvents::Read(file_);
  ASSERT_EQ(read.events.size(), kRecording.events.size());
  for (std::size_t i = 0; i < read.events.size(); ++i)
    EXPECT_EQ(LineOf(read.events[i]), LineOf(kRecording.events[i]));
}

TEST_F(PadFile, IsRefusedWhereItIsNone) {
  EXPECT_EQ(ErrorIn("events:\n  - {at_s: 1, what: pres, button: cross}\n"),
            "2:21: expected one of connect, disconnect, press, release, got 'pres'; did you mean "
            "'press'?");
  EXPECT_EQ(ErrorIn("events:\n  - {at_s: 1, what: press, button: crss}\n").substr(0, 4), "2:36");
  EXPECT_EQ(ErrorIn("events:\n  - {what: connect}\n").substr(0, 3), "2:5");
  EXPECT_EQ(ErrorIn("events:\n  - {at_s: 1, what: press}\n"),
            " event 1: expected the button of a press or release");
  EXPECT_EQ(ErrorIn("events:\n  - {at_s: 1, what: connect, button: cross}\n"),
            " event 1: expected no button, unless it is a press or release");
  EXPECT_EQ(ErrorIn("events:\n  - {at_s: 1, what: connect}\n  - {at_s: 0.5, what: disconnect}\n"),
            " event 2: must not be before the one before it, at 1 s, got 0.5 s");
}

}  // namespace
}  // namespace pliant
