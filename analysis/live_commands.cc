#include "pliant/analysis/live_commands.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"
#include "pliant/systems/parameter.h"
#include "pliant/systems/value_type.h"

namespace pliant::internal {

namespace {

constexpr std::size_t kRingCells = 1 << 14;
constexpr auto kHold = std::chrono::milliseconds(250);
constexpr double kMostForce = 200;    // [N]
constexpr double kFarthestPoint = 2;  // from the origin of a link [m]

constexpr std::string_view kPushTopic = "/push";
constexpr std::string_view kStopTopic = "/pliant/stop";
constexpr std::string_view kAcknowledgeTopic = "/pliant/acknowledge";

std::vector<TunableValue> Without(std::vector<TunableValue> tunables, std::size_t most) {
  std::erase_if(tunables, [&](const TunableValue& t) { return t.size() > most; });
  return tunables;
}

Eigen::Vector3d VectorOf(const LiveCommands::Json& message, const char* key, double most,
                         const char* unit) {
  const auto found = message.find(key);
  Eigen::Vector3d v;
  bool good = found != message.end() && found->is_array() && found->size() == 3 &&
              std::ranges::all_of(*found, [](const auto& x) { return x.is_number(); });
  if (good) {
    for (int i = 0; i < 3; ++i) v[i] = (*found)[static_cast<std::size_t>(i)].get<double>();
    good = v.allFinite() && v.norm() <= most;
  }
  if (!good)
    throw Error("/push: " + std::string(key) + " must be three numbers, of a length of at most " +
                Text(most) + " " + unit);
  return v;
}

}  // namespace

LiveCommands::LiveCommands(Options o)
    : options_{std::move(o)},
      parameters_{Without(options_.tunables, kRingCells / 2 - 8)},
      changes_{kRingCells} {}

void LiveCommands::SetParameter(std::size_t i, const Json& value) {
  const std::string& name = parameters_[i].path;
  if (!options_.control) throw Error(name + " cannot be set: give --control to allow that");
  std::vector<double> numbers = parameters_.Read(i, value);
  if (!Put(static_cast<int>(i), numbers))
    throw Error(name + " was not set: changes come faster than the run takes them");
  parameters_.Set(i, std::move(numbers));
}

void LiveCommands::RequireTopic(std::string_view topic) {
  if (topic != kPushTopic && topic != kStopTopic && topic != kAcknowledgeTopic)
    throw Error("nothing listens to the topic '" + std::string(topic.substr(0, 200)) +
                "'; expected /push, /pliant/stop or /pliant/acknowledge");
}

void LiveCommands::Publish(std::string_view topic, const Json& message, const void* client) {
  RequireTopic(topic);
  if (topic == kStopTopic) return options_.stop();
  if (topic == kPushTopic) return Push(message, client);
  if (!options_.acknowledge)
    throw Error("there is nothing to acknowledge: the run has no supervisor");
  if (!options_.control)
    throw Error("it cannot be acknowledged here: give --control to allow that");
  options_.acknowledge();
}

void LiveCommands::Push(const Json& message, const void* client) {
  if (!options_.pushed) throw Error("/push: nothing can be pushed here but a simulated arm");
  if (!options_.control) throw Error("/push: give --control to allow that");
  const auto link = message.is_object() ? message.find("link") : message.end();
  if (!message.is_object() || link == message.end() || !link->is_string())
    throw Error("/push: expected {\"link\": name, \"point\": [x, y, z], \"force\": [x, y, z]}");
  const std::string name = link->get_ref<const std::string&>().substr(0, 200);
  std::vector<std::string> names;
  for (const Link& of : options_.pushed->links()) names.push_back(of.name);
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw Error("/push: there is no link '" + name + "'" + DidYouMean(name, names));
  const ContactForce F{.link = static_cast<int>(found - names.begin()),
                       .point = VectorOf(message, "point", kFarthestPoint, "m"),
                       .force = VectorOf(message, "force", kMostForce, "N")};
  const bool acts = F.force != Eigen::Vector3d::Zero();
  if (!PutPush(acts ? F : ContactForce()))
    throw Error("/push: changes come faster than the run takes them");
  pusher_ = acts ? client : nullptr;
  pushed_ = Clock::now();
}

void LiveCommands::Leave(const void* client) {
  if (pusher_ == client) pushed_ = {};
}

void LiveCommands::LetGoOfOld(Clock::time_point now) {
  if (!pusher_ || now < pushed_ + kHold) return;
  if (PutPush({})) pusher_ = nullptr;  // else at the next call
}

bool LiveCommands::PutPush(const ContactForce& F) {
  std::vector<double> numbers;
  Numbers(F, numbers);
  return Put(kPush, numbers);
}

bool LiveCommands::Put(int target, std::span<const double> numbers) {
  const std::span<double> room = changes_.Begin(target, 0, 0, numbers.size());
  if (room.empty()) return false;
  std::ranges::copy(numbers, room.begin());
  changes_.Commit();
  return true;
}

std::optional<LiveCommands::Change> LiveCommands::Next() {
  if (taken_) changes_.Pop();
  const std::optional<RowRing::Row> row = changes_.Front();
  taken_ = row.has_value();
  if (!row) return {};
  return Change{row->stream, row->numbers};
}

}  // namespace pliant::internal
