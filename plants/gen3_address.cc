#include "pliant/plants/gen3_address.h"

#include <charconv>
#include <optional>
#include <string_view>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

std::optional<int> Port(std::string_view text) {
  int port = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, port);
  if (error != std::errc() || stop != end || port < 1 || port > 65535) return {};
  return port;
}

}  // namespace

Gen3Address Gen3Address::Of(const std::string& text) {
  const Error refused("an arm's address is such as 192.168.1.10 or 192.168.1.10:10000, got '" +
                      text + "'");
  Gen3Address address;
  std::string_view ports;
  const std::string_view whole = text;
  if (whole.starts_with('[')) {
    const std::size_t end = whole.find(']');
    if (end == whole.npos) throw refused;
    address.host = whole.substr(1, end - 1);
    ports = whole.substr(end + 1);
  } else {
    const std::size_t colon = whole.find(':');
    address.host = whole.substr(0, colon);
    if (colon != whole.npos) ports = whole.substr(colon);
  }
  if (address.host.empty() || address.host.find_first_of(" \t\n/,") != address.host.npos)
    throw refused;
  if (ports.empty()) return address;
  const std::size_t comma = ports.find(',');
  const std::optional<int> tcp = Port(ports.substr(1, comma == ports.npos ? comma : comma - 1));
  const std::optional<int> udp = comma == ports.npos
                                     ? (tcp && *tcp < 65535 ? std::optional(*tcp + 1) : tcp)
                                     : Port(ports.substr(comma + 1));
  if (ports[0] != ':' || !tcp || !udp) throw refused;
  address.tcp_port = *tcp;
  address.udp_port = *udp;
  return address;
}

std::string Gen3Address::text() const {
  const bool v6 = host.find(':') != std::string::npos;
  return (v6 ? "[" + host + "]" : host) + ":" + std::to_string(tcp_port);
}

}  // namespace pliant
