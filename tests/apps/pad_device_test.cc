#include "pliant/apps/pad_device.h"

#include <SDL.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "pliant/apps/live_pad.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// A DualShock 4 that is not there.
struct VirtualPad {
  VirtualPad() {
    SDL_VirtualJoystickDesc desc{};
    desc.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    desc.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    desc.naxes = SDL_CONTROLLER_AXIS_MAX;
    desc.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
    desc.vendor_id = 0x054c;
    desc.product_id = 0x05c4;
    desc.name = "virtual pad";
    index = SDL_JoystickAttachVirtualEx(&desc);
    joystick = SDL_JoystickOpen(index);
  }
  void Press(SDL_GameControllerButton button, bool down) {
    SDL_JoystickSetVirtualButton(joystick, button, down);
  }
  void Unplug() { SDL_JoystickDetachVirtual(index); }
  ~VirtualPad() { SDL_JoystickClose(joystick); }

  int index = -1;
  SDL_Joystick* joystick = nullptr;
};

/// Waits up to two seconds for what another thread is to see.
bool Becomes(const std::function<bool()>& what) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(2);
  while (!what() && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return what();
}

TEST(PadDevice, SaysThatNoneIsThere) {
  const PadDevice device;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(device.latest().connected);
  EXPECT_EQ(device.latest().buttons, 0U);
}

TEST(PadDevice, IsOneAtATime) {
  for (int k = 0; k < 3; ++k) {
    const PadDevice device;
    EXPECT_EQ(ErrorOf([] { PadDevice second; }),
              "game controllers are asked by one PadDevice at a time; there is one already");
  }
}

TEST(PadDevice, SeesButtonsAndThatItIsUnplugged) {
  const PadDevice device;
  VirtualPad pad;
  ASSERT_GE(pad.index, 0) << SDL_GetError();
  ASSERT_TRUE(Becomes([&] { return device.latest().connected; }));
  EXPECT_EQ(device.latest().buttons, 0U);
  double last = device.latest().stamp_s;
  for (const auto& [theirs, ours] : {std::pair{SDL_CONTROLLER_BUTTON_A, PadButton::Cross},
                                     {SDL_CONTROLLER_BUTTON_B, PadButton::Circle},
                                     {SDL_CONTROLLER_BUTTON_X, PadButton::Square},
                                     {SDL_CONTROLLER_BUTTON_Y, PadButton::Triangle},
                                     {SDL_CONTROLLER_BUTTON_LEFTSHOULDER, PadButton::L1},
                                     {SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, PadButton::R1},
                                     {SDL_CONTROLLER_BUTTON_DPAD_UP, PadButton::Up}}) {
    pad.Press(theirs, true);
    EXPECT_TRUE(Becomes([&, b = ours] { return device.latest().buttons == BitOf(b); }))
        << WordOf(ours);
    EXPECT_GT(device.latest().stamp_s, last);
    last = device.latest().stamp_s;
    pad.Press(theirs, false);
    EXPECT_TRUE(Becomes([&] { return device.latest().buttons == 0; }));
  }
  pad.Press(SDL_CONTROLLER_BUTTON_A, true);
  EXPECT_TRUE(Becomes([&] { return device.latest().buttons != 0; }));
  pad.Unplug();
  EXPECT_TRUE(Becomes([&] { return !device.latest().connected; }));
  EXPECT_EQ(device.latest().buttons, 0U);
}

TEST(LivePad, HandsTheStateToATickWithoutHeap) {
  const auto device = std::make_shared<const PadDevice>();
  BlockTester<LivePad> t(LivePad::Options{.device = device});
  t.Tick();
  EXPECT_FALSE(t.Get(t->state).connected);
  VirtualPad pad;
  pad.Press(SDL_CONTROLLER_BUTTON_Y, true);
  const long before = Allocations();
  EXPECT_TRUE(Becomes([&] {
    t.Tick();
    return t.Get(t->state).buttons == BitOf(PadButton::Triangle);
  }));
  EXPECT_LE(Allocations() - before, 1) << "the function object of this test";
  pad.Unplug();
  EXPECT_TRUE(Becomes([&] { return !device->latest().connected; }));
}

}  // namespace
}  // namespace pliant
