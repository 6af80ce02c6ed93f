#include "pliant/plants/kortex_exchange.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <optional>

namespace pliant::kortex {

namespace {

using namespace std::chrono_literals;

// Asking again costs little; a datagram that is lost costs the limit otherwise.
constexpr auto kAskAgain = 100ms;

// As many datagrams as a call looks at: what floods us must not keep us.
constexpr int kMost = 1000;

Socket Connected(const Gen3Address& address) {
  try {
    return ConnectUdp(address.host, address.udp_port);
  } catch (const Error& e) {
    throw Unreachable(address, e.what());
  }
}

}  // namespace

Exchange::Exchange(const Gen3Address& address) : address_{address}, socket_{Connected(address)} {
  session_ = Ask(SessionRequest(address), address.connect_limit).header.session;
}

Exchange::~Exchange() {
  try {
    Drain();
    Ask({.function = Function::CloseSession, .text = "CloseSession"}, 200ms);
  } catch (const std::exception&) {
    // The arm ends a silent session by itself.
  }
}

Gen3Feedback Exchange::Read() {
  Drain();
  const Request request{.function = Function::RefreshFeedback, .text = "RefreshFeedback"};
  const Frame answer = Ask(request, address_.connect_limit);
  Gen3Feedback feedback{.answers = answer.header.id};
  if (!cyclic_.Read(answer.payload, feedback))
    throw Error("cannot read the feedback of " + address_.text() +
                ": expected that of 7 actuators, got " + Text(answer.payload.size()) +
                " bytes of something else; is it a Gen3 of 7 degrees of freedom?");
  return feedback;
}

int Exchange::Send(const Gen3Command& command) noexcept {
  if (unheard_.exchange(false)) Drain();
  const std::uint16_t id = next_id_++;
  const Header header{.session = session_, .id = id, .function = Function::Refresh};
  if (!Put(header, cyclic_.Write(id, command))) {
    ++counts_.unsent;
    return -1;
  }
  ++counts_.sent;
  return id;
}

bool Exchange::Receive(Gen3Feedback& feedback, std::chrono::nanoseconds patience) noexcept {
  const auto until = patience > 0ns ? Clock::now() + patience : Clock::time_point::min();
  for (int i = 0; i < kMost; ++i) {
    const ssize_t size = Take();
    if (size >= 0) {
      if (Understand(std::span(in_).first(static_cast<std::size_t>(size)), feedback)) return true;
      continue;
    }
    if (patience <= 0ns) return false;
    patience = until - Clock::now();
    if (patience <= 0ns || !socket_.WaitToRead(patience)) return false;
  }
  return false;
}

void Exchange::KeepAlive(std::chrono::milliseconds silent) noexcept {
  if (Clock::now().time_since_epoch().count() - last_sent_ <
      std::chrono::nanoseconds(silent).count())
    return;
  std::array<std::byte, 64> bytes;
  const Header header{.session = session_, .id = next_id_++, .function = Function::KeepAlive};
  const std::size_t size = WriteFrame(header, {}, bytes);
  // Its answers wait in the socket, unheard, until the exchange begins.
  unheard_ = true;
  send(socket_.descriptor(), bytes.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL);
  last_sent_ = Clock::now().time_since_epoch().count();
}

Gen3Traffic Exchange::traffic() const noexcept {
  return {.sent = counts_.sent,
          .received = counts_.received,
          .unsent = counts_.unsent,
          .refused = counts_.refused,
          .unreadable = counts_.unreadable};
}

Frame Exchange::Ask(const Request& request, std::chrono::milliseconds limit) {
  const auto until = Clock::now() + limit;
  const std::uint16_t first = next_id_;
  while (Clock::now() < until) {
    Put({.session = session_, .id = next_id_++, .function = request.function}, request.payload);
    const auto again = std::min(until, Clock::now() + kAskAgain);
    do {
      const ssize_t size = Take();
      if (size < 0) {
        socket_.WaitToRead(again - Clock::now());
        continue;
      }
      const auto frame = ReadFrame(std::span(in_).first(static_cast<std::size_t>(size)));
      // Any of the times it was asked may be answered.
      if (!frame || frame->header.type != FrameType::Response ||
          frame->header.function != request.function ||
          static_cast<std::uint16_t>(frame->header.id - first) >=
              static_cast<std::uint16_t>(next_id_ - first))
        continue;
      if (frame->header.error != 0) throw Refusal(address_, request, *frame);
      return *frame;
    } while (Clock::now() < again);
  }
  throw Silence(address_,
                {.function = request.function,
                 .text = request.text + " by UDP, at port " + Text(address_.udp_port)},
                limit);
}

bool Exchange::Put(const Header& header, std::span<const std::byte> payload) noexcept {
  const std::size_t size = WriteFrame(header, payload, out_);
  last_sent_ = Clock::now().time_since_epoch().count();
  return size > 0 && send(socket_.descriptor(), out_.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL) ==
                         static_cast<ssize_t>(size);
}

ssize_t Exchange::Take() noexcept {
  // An error that the kernel reports here, such as a port where nobody listens, is silence.
  for (int i = 0; i < 4; ++i) {
    const ssize_t size = recv(socket_.descriptor(), in_.data(), in_.size(), MSG_DONTWAIT);
    if (size >= 0 || errno == EAGAIN) return size;
  }
  return -1;
}

void Exchange::Drain() noexcept {
  for (int i = 0; i < kMost && Take() >= 0; ++i) {
  }
}

bool Exchange::Understand(std::span<const std::byte> datagram, Gen3Feedback& feedback) noexcept {
  const std::optional<Frame> frame = ReadFrame(datagram);
  const auto unreadable = [&] {
    ++counts_.unreadable;
    return false;
  };
  if (!frame || frame->header.type != FrameType::Response) return unreadable();
  const Header& header = frame->header;
  // Ids run around: the half of them before the next one were asked.
  const auto behind = static_cast<std::uint16_t>(next_id_ - header.id);
  if (behind == 0 || behind > 0x8000) return unreadable();
  if (header.error != 0) {
    ++counts_.refused;
    return false;
  }
  if (header.session != session_) return unreadable();
  // A late answer to what is not the exchange's.
  if (header.function == Function::KeepAlive || header.function == Function::RefreshFeedback ||
      header.function == Function::CreateSession)
    return false;
  if (header.function != Function::Refresh || !cyclic_.Read(frame->payload, feedback))
    return unreadable();
  feedback.answers = header.id;
  ++counts_.received;
  return true;
}

}  // namespace pliant::kortex
