#pragma once

#include <array>
#include <chrono>
#include <cstdint>

namespace pliant {

inline constexpr int kGen3Joints = 7;

/// What an actuator of a Gen3 does with its command; the numbers are the protocol's.
enum class Gen3Mode : std::uint8_t {
  Position = 1,
  Torque = 3,
  Current = 4,
  TorqueHighVelocity = 6
};

/// Who moves the arm: its own motion planner, or frames of ours, each millisecond.
enum class Gen3Servoing : std::uint8_t { SingleLevel = 2, LowLevel = 3 };

/// What a Gen3 is told each millisecond, in the units of the wire. Torques and currents have the
/// joint's direction, unlike the torque that it measures.
struct Gen3Command {
  struct Actuator {
    float position = 0;  ///< [°], within 0 … 360
    float velocity = 0;  ///< [°/s]
    float torque = 0;    ///< [N·m]
    float current = 0;   ///< [A]
  };
  std::array<Actuator, kGen3Joints> actuator = {};
};

/// What it says: the answer to a command, in the units of the wire and its signs.
struct Gen3Feedback {
  struct Actuator {
    std::uint32_t command_id = 0;    ///< of the command it acts on
    std::uint32_t status_flags = 0;  ///< StatusFlags
    std::uint32_t jitter_us = 0;     ///< of the communication [µs]
    float position = 0;              ///< [°], within 0 … 360
    float velocity = 0;              ///< [°/s]
    float torque = 0;                ///< [N·m]
    float current = 0;               ///< [A]
    float voltage = 0;               ///< [V]
    float motor_temperature = 0;     ///< [°C]
    float core_temperature = 0;      ///< [°C]
    std::uint32_t fault_a = 0, fault_b = 0, warning_a = 0, warning_b = 0;  ///< SafetyIdentifier
  };
  std::uint16_t answers = 0;               ///< the id of the command this answers
  std::uint32_t frame_id = 0;              ///< the base's own
  std::uint32_t arm_state = 0;             ///< ArmState
  std::uint32_t fault_a = 0, fault_b = 0;  ///< of the base
  std::uint32_t warning_a = 0, warning_b = 0;
  std::array<Actuator, kGen3Joints> actuator = {};
};

/// What a way to the arm has counted since it was opened.
struct Gen3Traffic {
  std::int64_t sent = 0, received = 0;  ///< commands; feedback that could be read
  std::int64_t unsent = 0;              ///< commands the kernel refused
  std::int64_t refused = 0;             ///< answers with an error instead of feedback
  std::int64_t unreadable = 0;          ///< datagrams that are no answer to any request
};

/// The way to an arm: sessions are open while it lives, and kept alive.
///
/// Services take up to seconds, throw Error with what the arm answered, and may be called from any
/// thread but that of the exchange. The exchange is for one thread and its ticks: it neither
/// allocates nor throws nor waits longer than it is told. `Read` shares its way with the exchange:
/// before it or after it, not beside it.
class Gen3Link {
 public:
  virtual ~Gen3Link() = default;
  Gen3Link(const Gen3Link&) = delete;
  Gen3Link& operator=(const Gen3Link&) = delete;

  virtual void ClearFaults() = 0;
  virtual std::uint32_t ArmState() = 0;  ///< as in Gen3Feedback
  virtual int ActuatorCount() = 0;
  virtual Gen3Servoing Servoing() = 0;
  virtual void SetServoing(Gen3Servoing servoing) = 0;
  virtual Gen3Mode Mode(int joint) = 0;  ///< joint: 0 … 6
  virtual void SetMode(int joint, Gen3Mode mode) = 0;
  /// What the sensors say now, without a command.
  virtual Gen3Feedback Read() = 0;

  /// Sends a command under the next id, which goes from 65535 to 0 and is never sent twice in a
  /// row. The id; or −1 if it could not be sent.
  virtual int Send(const Gen3Command& command) noexcept = 0;
  /// The next feedback in the order of arrival; false if none arrives within `patience`.
  virtual bool Receive(Gen3Feedback& feedback, std::chrono::nanoseconds patience) noexcept = 0;

  virtual Gen3Traffic traffic() const noexcept = 0;
  /// False once services cannot be called any more, whatever the exchange does.
  virtual bool connected() const noexcept { return true; }

 protected:
  Gen3Link() = default;
};

}  // namespace pliant
