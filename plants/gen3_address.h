#pragma once

#include <chrono>
#include <string>

namespace pliant {

/// Where a Gen3 listens, who comes, and how long is waited; as the arm leaves the factory.
struct Gen3Address {
  std::string host = "192.168.1.10";
  int tcp_port = 10000;  ///< everything but the exchange
  int udp_port = 10001;  ///< the exchange of each millisecond
  std::string user = "admin", password = "admin";

  /// What the arm is asked to wait for a silent session, and for a silent connection.
  std::chrono::milliseconds session_timeout{60'000}, connection_timeout{2'000};
  std::chrono::milliseconds connect_limit{2'000};  ///< of connecting, and of answers by UDP
  std::chrono::milliseconds answer_limit{10'000};  ///< of a service's answer

  /// Of "192.168.1.10", "arm.local:10000", "[fe80::1]:10000,10001": HOST[:TCP[,UDP]], where the
  /// port of UDP is the one behind TCP's unless told. Throws Error if it is none.
  static Gen3Address Of(const std::string& text);

  /// The host and its port of TCP.
  std::string text() const;
};

}  // namespace pliant
