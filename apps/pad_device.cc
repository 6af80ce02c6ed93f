#include "pliant/apps/pad_device.h"

#include <SDL.h>

#include <array>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <utility>

#include "pliant/systems/error.h"

#ifdef __SANITIZE_ADDRESS__
/// What SDL does not give back is no leak of ours.
extern "C" const char* __lsan_default_suppressions() { return "leak:libSDL2"; }
#endif

namespace pliant {

namespace {

constexpr unsigned kConnectedBit = 16, kStampBit = 17;

/// SDL's state is the program's: two threads would pump the same events.
std::atomic<bool> there_is_one{false};

struct Close {
  void operator()(SDL_GameController* pad) const { SDL_GameControllerClose(pad); }
};
using OpenPad = std::unique_ptr<SDL_GameController, Close>;

OpenPad FirstPad() {
  for (int i = 0; i < SDL_NumJoysticks(); ++i)
    if (SDL_IsGameController(i))
      if (OpenPad pad{SDL_GameControllerOpen(i)}) return pad;
  return {};
}

PadButtons ButtonsOf(SDL_GameController* pad) {
  using enum PadButton;
  static constexpr std::array<std::pair<SDL_GameControllerButton, PadButton>, 10> kButtons{
      {{SDL_CONTROLLER_BUTTON_A, Cross},
       {SDL_CONTROLLER_BUTTON_B, Circle},
       {SDL_CONTROLLER_BUTTON_X, Square},
       {SDL_CONTROLLER_BUTTON_Y, Triangle},
       {SDL_CONTROLLER_BUTTON_LEFTSHOULDER, L1},
       {SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, R1},
       {SDL_CONTROLLER_BUTTON_DPAD_UP, Up},
       {SDL_CONTROLLER_BUTTON_DPAD_DOWN, Down},
       {SDL_CONTROLLER_BUTTON_DPAD_LEFT, Left},
       {SDL_CONTROLLER_BUTTON_DPAD_RIGHT, Right}}};
  PadButtons down = 0;
  for (const auto& [theirs, ours] : kButtons)
    if (SDL_GameControllerGetButton(pad, theirs)) down |= BitOf(ours);
  return down;
}

/// Empty, or why game controllers cannot be asked.
std::string Start() {
  // No window is there to have the focus, and signals are the program's.
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  return SDL_Init(SDL_INIT_GAMECONTROLLER) == 0 ? "" : SDL_GetError();
}

}  // namespace

PadDevice::PadDevice() {
  Require(!there_is_one.exchange(true),
          "game controllers are asked by one PadDevice at a time; there is one already");
  std::promise<std::string> started;
  std::future<std::string> fault = started.get_future();
  thread_ = std::thread([this, started = std::move(started)]() mutable {
    const std::string error = Start();
    started.set_value(error);
    if (error.empty()) Ask();
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  });
  const std::string error = fault.get();
  if (error.empty()) return;
  thread_.join();
  there_is_one = false;
  throw Error("game controllers cannot be asked: " + error);
}

PadDevice::~PadDevice() {
  stop_ = true;
  thread_.join();
  there_is_one = false;
}

void PadDevice::Ask() {
  using namespace std::chrono;
  const auto began = steady_clock::now();
  OpenPad pad;
  std::uint64_t last = 0;
  while (!stop_) {
    SDL_PumpEvents();
    SDL_FlushEvents(SDL_FIRSTEVENT, SDL_LASTEVENT);
    if (pad && !SDL_GameControllerGetAttached(pad.get())) pad.reset();
    if (!pad) pad = FirstPad();
    const std::uint64_t now =
        pad ? ButtonsOf(pad.get()) | std::uint64_t{1} << kConnectedBit : std::uint64_t{0};
    if (now != last) {
      last = now;
      const auto since = duration_cast<microseconds>(steady_clock::now() - began).count();
      word_.store(now | static_cast<std::uint64_t>(since) << kStampBit, std::memory_order_relaxed);
    }
    std::this_thread::sleep_for(milliseconds(2));
  }
}

PadState PadDevice::latest() const noexcept {
  const std::uint64_t word = word_.load(std::memory_order_relaxed);
  return {.connected = (word >> kConnectedBit & 1) != 0,
          .buttons = static_cast<PadButtons>(word & 0xffff),
          .stamp_s = 1e-6 * static_cast<double>(word >> kStampBit)};
}

}  // namespace pliant
