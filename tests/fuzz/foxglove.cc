#include <optional>
#include <string_view>

#include "pliant/analysis/foxglove_session.h"
#include "pliant/plants/shared_file.h"
#include "pliant/tests/fuzz/targets.h"

namespace pliant::fuzz {

namespace {

using namespace internal;
using Kind = TunableValue::Kind;

TunableValue Named(const char* path, Kind kind, std::vector<double> start,
                   std::vector<std::string> words = {}) {
  TunableValue of;
  of.path = path;
  of.kind = kind;
  of.elements.assign(start.size(), "");
  of.units.assign(start.size(), "");
  of.start = std::move(start);
  of.words = std::move(words);
  return of;
}

}  // namespace

/// A line is a message; one that begins with 1 is a binary one.
bool Foxglove(const std::string& bytes) {
  static const RobotModel model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  LiveCommands commands({.tunables = {Named("gain", Kind::Number, {1}),
                                      Named("mode", Kind::Word, {0}, {"stiff", "soft"}),
                                      Named("limits", Kind::Numbers, {1, 2})},
                         .pushed = model,
                         .control = true,
                         .stop = [] {},
                         .acknowledge = [] {}});
  std::optional<FoxgloveSession> session;
  LiveChannels channels([&](const LiveChannel& of) { session->Advertise(of); },
                        [&](const LiveChannel& to, std::int64_t t, std::string_view content) {
                          session->Deliver(to, t, content);
                        });
  bool delivered = false;
  const auto told = [&](const FoxgloveSession::Frame& frame) {
    Check(!frame.text || FoxgloveSession::Json::accept(frame.content), "what is told is JSON");
    delivered |= !frame.text;
  };
  session.emplace(FoxgloveSession::Options{
      .name = "fuzz",
      .session = "1",
      .channels = &channels,
      .commands = &commands,
      .send = told,
      .has_room = [] { return true; },
      .parameters_changed =
          [&](const std::set<std::size_t>& which) { session->ParametersChanged(which); },
      .subscribed = [](FoxgloveSession&, const LiveChannel&) {}});
  const std::uint16_t schema = channels.AddSchema("number", "ros2msg", "float64 data");
  const std::uint16_t channel = channels.AddChannel(schema, "/first", "cdr", {});

  for (std::string_view left = bytes; !left.empty();) {
    const std::string_view line = left.substr(0, left.find('\n'));
    if (line.starts_with('\1'))
      session->HearBinary(line);
    else
      session->HearText(line);
    channels.Tell(channel, 1, "12345678");
    while (commands.Next()) {
    }
    left.remove_prefix(std::min(left.size(), line.size() + 1));
  }
  session.reset();  // before its channels
  return delivered;
}

}  // namespace pliant::fuzz
