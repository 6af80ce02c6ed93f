#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "pliant/diagrams/gen3_body.h"
#include "pliant/plants/kortex_frame.h"

namespace pliant {

/// The base of an emulated Gen3: it answers requests of the Kortex protocol, one by one.
///
///   Session         CreateSession, CloseSession, KeepAlive
///   Base            SetServoingMode, GetServoingMode, ClearFaults, ApplyEmergencyStop,
///                   GetActuatorCount, GetArmState
///   DeviceManager   ReadAllDevices
///   ActuatorConfig  GetControlMode, SetControlMode, ClearFaults, of the devices 1 … 7
///   BaseCyclic      Refresh, RefreshCommand, RefreshFeedback
///
/// The stream (TCP) answers all of them, datagrams (UDP) only Session and BaseCyclic. Each has its
/// own sessions; a session belongs to who opened it. One that asks nothing for the time-out it was
/// opened with ends, and with that of who began low-level servoing this ends too. A connection
/// that is lost does not end its session. Of more than `most_sessions` the one that was silent for
/// longest ends.
///
/// What is refused, by the names of the protocol:
///
///   UNSUPPORTED_SERVICE   not above, or not on this channel; UNSUPPORTED_METHOD: not of a service
///   INVALID_SESSION       not the one that was opened by who asks
///   INVALID_PASSWORD, USER_NOT_FOUND
///   PAYLOAD_DECODING_ERR  the payload is not the function's message
///   INVALID_DEVICE        not 1 … 7 for ActuatorConfig, not 0 for the others
///   WRONG_SERVOING_MODE   a control mode outside low-level servoing
///   ROBOT_IN_FAULT        low-level servoing or a control mode in a fault; ROBOT_IN_EMERGENCY_STOP
///   ROBOT_NOT_READY       low-level servoing, while the fault servoing_refused is shown
///   INVALID_PARAM         a mode that is none; UNIMPLEMENTED: one that is not emulated
///   CONTROL_ACTUATOR_COUNT_MISMATCH  a command of other than 7 actuators
///
/// Documented: names and numbers of functions and errors. Observed by others: session ids in the
/// first answer, sessions per channel. Ours: which error is of which class and comes first, that a
/// lost connection keeps its session, that a command outside low-level servoing is answered by
/// feedback and does not act, and that anybody with a session may command.
class Gen3Base {
 public:
  enum class Channel : std::uint8_t { Stream, Datagrams };

  struct Options {
    std::string user = "admin", password = "admin";
    bool lock_step = false;  ///< Refresh and RefreshCommand step the arm, before the answer
    std::size_t most_sessions = 256;  ///< of a channel, > 0
  };

  struct Request {
    Channel channel = Channel::Stream;
    std::uint64_t peer = 0;       ///< who asks: a connection, or an address
    double time_s = 0;            ///< now, on any clock that does not go back
    std::uint32_t jitter_us = 0;  ///< how far from 1 ms after the last one
    kortex::Header header;
    std::span<const std::byte> payload;
  };

  struct Answer {
    kortex::Header header;
    std::span<const std::byte> payload;  ///< until the next request
  };

  Gen3Base(Gen3Body& arm, const Options& o);
  ~Gen3Base();

  /// None if it is nothing that is answered, such as a response.
  std::optional<Answer> Serve(const Request& request);

  /// Ends the sessions whose time is over.
  void Expire(double time_s);
  void EndAllSessions();

  bool refuses_servoing = false;  ///< the fault servoing_refused is shown

  std::size_t sessions(Channel channel) const;
  std::int64_t opened() const { return opened_; }    ///< sessions, since the start
  std::int64_t refused() const { return refused_; }  ///< requests answered by an error

 private:
  struct Session {
    std::uint64_t peer;
    double last_s, patience_s;
    std::int64_t last_use;
  };
  using Sessions = std::map<std::uint16_t, Session>;
  struct Messages;
  struct Refusal;

  Sessions& Of(Channel channel) { return sessions_[static_cast<std::size_t>(channel)]; }
  template <class Message>
  void Read(const Request& request, Message& message);
  void RefuseInFault() const;
  void Do(const Request& request, kortex::Header& answer);
  void Open(const Request& request, kortex::Header& answer);
  void End(Channel channel, std::uint16_t session);
  void SetServoing(const Request& request);
  void SetMode(const Request& request, int joint);
  void Take(const Request& request);
  void WriteFeedback();
  void ListDevices();

  Gen3Body& arm_;
  const Options o_;
  Sessions sessions_[2];
  std::uint16_t next_session_[2] = {1, 1};
  std::optional<std::uint16_t> servoing_by_;  // the session that began low-level servoing
  std::int64_t uses_ = 0, opened_ = 0, refused_ = 0;
  std::unique_ptr<Messages> messages_;
  std::string payload_;
};

}  // namespace pliant
