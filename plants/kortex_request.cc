#include "pliant/plants/kortex_request.h"

#include <Errors.pb.h>
#include <Session.pb.h>

namespace pliant::kortex {

namespace {

using Kinova::Api::SubErrorCodes;

std::string WayOut(int code) {
  switch (code) {
    case Kinova::Api::INVALID_PASSWORD:
    case Kinova::Api::USER_NOT_FOUND:
      return "user and password are those of the arm's web page: --user and --password";
    case Kinova::Api::ROBOT_IN_FAULT:
      return "mend what the faults are about, then clear them: `pliant recover gen3 "
             "--clear-faults`";
    case Kinova::Api::ROBOT_IN_EMERGENCY_STOP:
      return "release the emergency stop, then clear the faults: `pliant recover gen3 "
             "--clear-faults`";
    case Kinova::Api::WRONG_SERVOING_MODE:
    case Kinova::Api::SINGLE_LEVEL_SERVOING:
    case Kinova::Api::LOW_LEVEL_SERVOING:
    case Kinova::Api::CONTROL_WRONG_MODE:
      return "set the servoing mode first; `pliant recover gen3` brings back an arm that was left "
             "in another";
    case Kinova::Api::SESSION_NOT_IN_CONTROL:
    case Kinova::Api::INVALID_USER_SESSION_ACCESS:
    case Kinova::Api::CONTROL_PERMISSION_DENIED:
      return "another session is in control: end other programs and pages that move the arm";
    case Kinova::Api::INVALID_SESSION:
      return "the session has ended: connect anew";
    case Kinova::Api::INVALID_DEVICE:
      return "has the arm seven actuators?";
    case Kinova::Api::ROBOT_NOT_READY:
    case Kinova::Api::DEVICE_NOT_READY:
      return "wait until the arm has started";
    default:
      return "";
  }
}

template <class Enum>
std::string Name(int code, const std::string& (*name)(Enum)) {
  const std::string& known = name(static_cast<Enum>(code));
  return known.empty() ? "code " + std::to_string(code) : known;
}

}  // namespace

Request SessionRequest(const Gen3Address& address) {
  Kinova::Api::Session::CreateSessionInfo info;
  info.set_username(address.user);
  info.set_password(address.password);
  info.set_session_inactivity_timeout(static_cast<std::uint32_t>(address.session_timeout.count()));
  info.set_connection_inactivity_timeout(
      static_cast<std::uint32_t>(address.connection_timeout.count()));
  std::vector<std::byte> payload(info.ByteSizeLong());
  info.SerializeToArray(payload.data(), static_cast<int>(payload.size()));
  return {.function = Function::CreateSession,
          .text = "CreateSession for user '" + address.user + "'",
          .payload = std::move(payload)};
}

Error Refusal(const Gen3Address& address, const Request& request, const Frame& answer) {
  int code = answer.header.error, sub_code = answer.header.error_code;
  std::string words;
  Kinova::Api::Error error;
  if (error.ParseFromArray(answer.payload.data(), static_cast<int>(answer.payload.size())) &&
      error.error_code() != Kinova::Api::ERROR_NONE) {
    code = error.error_code();
    sub_code = static_cast<int>(error.error_sub_code());
    words = error.error_sub_string();
  }
  return Refusal(address, request.text, code, sub_code, words);
}

Error Refusal(const Gen3Address& address, const std::string& asked, int code, int sub_code,
              const std::string& words) {
  const std::string way_out = WayOut(sub_code);
  return Error(address.text() + " refused " + asked + ": " +
               Name(code, &Kinova::Api::ErrorCodes_Name<Kinova::Api::ErrorCodes>) + ", " +
               Name(sub_code, &Kinova::Api::SubErrorCodes_Name<SubErrorCodes>) +
               (words.empty() ? "" : ", \"" + words + "\"") +
               (way_out.empty() ? "" : "; " + way_out));
}

Error Silence(const Gen3Address& address, const Request& request, std::chrono::milliseconds limit) {
  return Error(address.text() + " did not answer " + request.text + " within " +
               Text(std::chrono::duration<double>(limit).count()) +
               " s; is it a Kinova Gen3, and has it started?");
}

Error Unreachable(const Gen3Address& address, const std::string& reason) {
  return Error("cannot reach an arm at " + address.text() + ": " + reason +
               "; is it switched on and wired, and this machine in its network (a Gen3's is "
               "192.168.1.0/24)?");
}

}  // namespace pliant::kortex
