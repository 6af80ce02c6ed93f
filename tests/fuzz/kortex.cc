#include <Session.pb.h>

#include <algorithm>
#include <span>
#include <vector>

#include "pliant/diagrams/gen3_base.h"
#include "pliant/plants/kortex_cyclic.h"
#include "pliant/plants/kortex_frame.h"
#include "pliant/tests/fuzz/targets.h"

namespace pliant::fuzz {

namespace {

using Bytes = std::span<const std::byte>;
using Channel = Gen3Base::Channel;

/// An emulated arm; what one input has done to it, the next does not see.
class Server {
 public:
  Server() : base_{Body(), {}} {
    Kinova::Api::Session::CreateSessionInfo who;
    who.set_username("admin");
    who.set_password("admin");
    who.set_session_inactivity_timeout(60000);
    const std::string payload = who.SerializeAsString();
    for (const Channel channel : {Channel::Stream, Channel::Datagrams})
      Serve(channel, {{.function = kortex::Function::CreateSession},
                      Bytes(std::as_bytes(std::span(payload)))});
  }

  void Serve(Channel channel, const kortex::Frame& frame) {
    if (const auto answer = base_.Serve({.channel = channel,
                                         .peer = 1,
                                         .time_s = 0,
                                         .header = frame.header,
                                         .payload = frame.payload})) {
      std::vector<std::byte> out(answer->payload.size() + kortex::kEnvelope);
      out.resize(kortex::WriteFrame(answer->header, answer->payload, out));
      const auto read = kortex::ReadFrame(out);
      Check(read && read->header == answer->header &&
                std::ranges::equal(read->payload, answer->payload),
            "an answer can be read");
    }
  }

 private:
  static Gen3Body& Body() {
    static Gen3Body body({});
    body.ClearFaults();
    body.LeaveLowLevel();
    return body;
  }
  Gen3Base base_;
};

bool Hear(Server& server, Channel channel, Bytes bytes) {
  const auto frame = kortex::ReadFrame(bytes);
  if (!frame) return false;
  std::vector<std::byte> out(frame->payload.size() + kortex::kEnvelope);
  out.resize(kortex::WriteFrame(frame->header, frame->payload, out));
  const auto again = kortex::ReadFrame(out);
  Check(
      again && again->header == frame->header && std::ranges::equal(again->payload, frame->payload),
      "a frame reads back the same");
  server.Serve(channel, *frame);
  static kortex::Cyclic cyclic;
  Gen3Feedback feedback;
  cyclic.Read(frame->payload, feedback);
  return true;
}

}  // namespace

bool KortexFrames(const std::string& text) {
  const Bytes bytes = std::as_bytes(std::span(text));
  Server server;
  bool heard = Hear(server, Channel::Datagrams, bytes);
  kortex::FrameStream stream;
  std::size_t put = 0;
  Takes([&] {
    while (put < bytes.size()) {
      const std::span<std::byte> room = stream.Room();
      const std::size_t n = std::min({room.size(), bytes.size() - put, std::size_t{17}});
      std::ranges::copy(bytes.subspan(put, n), room.begin());
      stream.Filled(n);
      put += n;
      while (const auto frame = stream.Next()) heard |= Hear(server, Channel::Stream, *frame);
    }
  });
  return heard;
}

}  // namespace pliant::fuzz
