#include "pliant/analysis/foxglove_session.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>

#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

using Json = FoxgloveSession::Json;

constexpr char kMessageData = 1;  // of the server and of the client
constexpr std::size_t kMostClientChannels = 64;
constexpr std::size_t kMostTopic = 256;  // bytes

template <class T>
void Append(std::string& bytes, T x) {
  bytes.append(reinterpret_cast<const char*>(&x), sizeof x);
}

const Json& Field(const Json& message, const char* key) {
  const auto found = message.find(key);
  if (found == message.end()) throw Error("expected a field '" + std::string(key) + "'");
  return *found;
}

const Json& ListIn(const Json& message, const char* key) {
  const Json& list = Field(message, key);
  if (!list.is_array()) throw Error("'" + std::string(key) + "' must be an array");
  return list;
}

std::uint32_t Id(const Json& id, const char* what) {
  if (!id.is_number_unsigned() ||
      id.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max())
    throw Error(std::string(what) + " must be a whole number of 32 bits");
  return id.get<std::uint32_t>();
}

/// By which a client knows the answer; null: it does not ask for one.
const Json* RequestId(const Json& message) {
  const auto id = message.find("id");
  if (id == message.end()) return nullptr;
  if (!id->is_string() || id->get_ref<const std::string&>().size() > 256)
    throw Error("'id' must be a string of at most 256 bytes");
  return &*id;
}

std::string Word(const Json& message, const char* key) {
  const Json& word = message.is_object() ? Field(message, key) : message;
  if (!word.is_string()) throw Error("'" + std::string(key) + "' must be a string");
  return word.get<std::string>();
}

Json ToJson(const LiveChannel& channel) {
  return {{"id", channel.id},
          {"topic", channel.topic},
          {"encoding", channel.encoding},
          {"schemaName", channel.schema_name},
          {"schema", channel.schema},
          {"schemaEncoding", channel.schema_encoding}};
}

}  // namespace

FoxgloveSession::FoxgloveSession(Options o) : options_{std::move(o)} {
  Tell({{"op", "serverInfo"},
        {"name", options_.name},
        {"capabilities", {"clientPublish", "parameters", "parametersSubscribe"}},
        {"supportedEncodings", {"json"}},
        {"metadata", Json::object()},
        {"sessionId", options_.session}});
  Json channels = Json::array();
  for (const LiveChannel& channel : options_.channels->all()) channels.push_back(ToJson(channel));
  if (!channels.empty()) Tell({{"op", "advertise"}, {"channels", channels}});
}

FoxgloveSession::~FoxgloveSession() {
  options_.commands->Leave(this);
  for (const auto& [id, channel] : channel_of_) --options_.channels->Find(channel)->subscribers;
}

void FoxgloveSession::Tell(const Json& message, bool may_be_lost) {
  options_.send({true, message.dump(-1, ' ', false, Json::error_handler_t::replace), may_be_lost});
}

void FoxgloveSession::Status(Level level, const std::string& text) {
  Tell({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", text}}, true);
}

template <class Act>
void FoxgloveSession::Try(const Act& act) {
  try {
    act();
  } catch (const std::exception& e) {
    Status(Level::Error, e.what());
  }
}

void FoxgloveSession::HearText(std::string_view text) {
  const Json message = Json::parse(text, nullptr, false);
  Try([&] {
    if (!message.is_object()) throw Error("a message must be a JSON object");
    Obey(message);
  });
}

void FoxgloveSession::HearBinary(std::string_view bytes) {
  Try([&] {
    constexpr std::size_t kHead = 1 + sizeof(std::uint32_t);
    if (bytes.size() < kHead || bytes[0] != kMessageData)
      throw Error("a binary message must begin with 1 and the number of a channel");
    std::uint32_t id;
    std::memcpy(&id, bytes.data() + 1, sizeof id);
    const auto channel = client_channels_.find(id);
    if (channel == client_channels_.end())
      throw Error("channel " + Text(id) + " was not advertised by this client");
    const Json message = Json::parse(bytes.substr(kHead), nullptr, false);
    if (message.is_discarded()) throw Error(channel->second.topic + ": the message is no JSON");
    options_.commands->Publish(channel->second.topic, message, this);
  });
}

void FoxgloveSession::Obey(const Json& message) {
  const std::string op = Word(message, "op");
  if (op == "subscribe") return Subscribe(message);
  if (op == "unsubscribe") return Unsubscribe(message);
  if (op == "advertise") return AdvertiseByClient(message);
  if (op == "unadvertise") return UnadvertiseByClient(message);
  if (op == "getParameters") return GetParameters(message);
  if (op == "setParameters") return SetParameters(message);
  if (op == "subscribeParameterUpdates") return SubscribeParameters(message, true);
  if (op == "unsubscribeParameterUpdates") return SubscribeParameters(message, false);
  throw Error("op '" + op.substr(0, 64) + "' is not served here");
}

void FoxgloveSession::Subscribe(const Json& message) {
  for (const Json& wanted : ListIn(message, "subscriptions"))
    Try([&] {
      if (!wanted.is_object()) throw Error("a subscription must be an object");
      const std::uint32_t id = Id(Field(wanted, "id"), "the id of a subscription");
      const std::uint32_t of = Id(Field(wanted, "channelId"), "channelId");
      LiveChannel* channel = options_.channels->Find(of);
      if (!channel) throw Error("there is no channel " + Text(of));
      if (subscription_of_.contains(of))
        throw Error("this client has subscribed to channel " + Text(of) + " already");
      if (!channel_of_.emplace(id, of).second)
        throw Error("there is a subscription " + Text(id) + " already");
      subscription_of_.emplace(of, id);
      ++channel->subscribers;
      if (!channel->only.empty()) Deliver(*channel, channel->time_ns, channel->only);
      if (options_.has_room()) options_.subscribed(*this, *channel);
    });
}

void FoxgloveSession::Unsubscribe(const Json& message) {
  for (const Json& number : ListIn(message, "subscriptionIds"))
    Try([&] {
      const std::uint32_t id = Id(number, "the id of a subscription");
      const auto found = channel_of_.find(id);
      if (found == channel_of_.end()) throw Error("there is no subscription " + Text(id));
      --options_.channels->Find(found->second)->subscribers;
      subscription_of_.erase(found->second);
      channel_of_.erase(found);
    });
}

void FoxgloveSession::AdvertiseByClient(const Json& message) {
  for (const Json& channel : ListIn(message, "channels"))
    Try([&] {
      if (!channel.is_object()) throw Error("a channel must be an object");
      const std::uint32_t id = Id(Field(channel, "id"), "the id of a channel");
      const std::string topic = Word(channel, "topic"), encoding = Word(channel, "encoding");
      if (encoding != "json")
        throw Error(topic.substr(0, kMostTopic) + ": the encoding must be json, got '" +
                    encoding.substr(0, 64) + "'");
      LiveCommands::RequireTopic(topic);
      if (client_channels_.size() >= kMostClientChannels)
        throw Error("a client may advertise " + Text(kMostClientChannels) + " channels at most");
      client_channels_[id] = {topic, encoding};
    });
}

void FoxgloveSession::UnadvertiseByClient(const Json& message) {
  for (const Json& number : ListIn(message, "channelIds"))
    Try([&] {
      const std::uint32_t id = Id(number, "the id of a channel");
      if (client_channels_.erase(id) == 0)
        throw Error("channel " + Text(id) + " was not advertised by this client");
    });
}

std::set<std::size_t> FoxgloveSession::ParametersNamed(const Json& message) const {
  std::set<std::size_t> which;
  const auto names = message.find("parameterNames");
  if (names != message.end() && !names->is_array())
    throw Error("'parameterNames' must be an array");
  if (names == message.end() || names->empty()) {
    for (std::size_t i = 0; i < options_.commands->parameters().size(); ++i) which.insert(i);
    return which;
  }
  for (const Json& name : *names)
    which.insert(options_.commands->parameters().Find(Word(name, "parameterNames")));
  return which;
}

void FoxgloveSession::GetParameters(const Json& message) {
  TellParameters(ParametersNamed(message), RequestId(message));
}

void FoxgloveSession::SetParameters(const Json& message) {
  std::set<std::size_t> named, changed;
  for (const Json& parameter : ListIn(message, "parameters"))
    Try([&] {
      if (!parameter.is_object()) throw Error("a parameter must be an object");
      const std::size_t i = options_.commands->parameters().Find(Word(parameter, "name"));
      named.insert(i);
      options_.commands->SetParameter(i, Field(parameter, "value"));
      changed.insert(i);
    });
  const Json* const id = RequestId(message);
  std::set<std::size_t> refused;
  std::ranges::set_difference(named, changed, std::inserter(refused, refused.end()));
  if (id)
    TellParameters(named, id);
  else if (!refused.empty())
    TellParameters(refused);
  if (!changed.empty()) options_.parameters_changed(changed);
}

void FoxgloveSession::SubscribeParameters(const Json& message, bool subscribe) {
  for (const std::size_t i : ParametersNamed(message))
    if (subscribe)
      watched_.insert(i);
    else
      watched_.erase(i);
}

void FoxgloveSession::TellParameters(const std::set<std::size_t>& which, const Json* id) {
  Json parameters = Json::array();
  const LiveParameters& all = options_.commands->parameters();
  for (const std::size_t i : which) {
    Json parameter{{"name", all[i].path}, {"value", all.Value(i)}};
    if (all[i].kind == TunableValue::Kind::Number) parameter["type"] = "float64";
    if (all[i].size() > 1 || parameter["value"].is_array()) parameter["type"] = "float64_array";
    parameters.push_back(std::move(parameter));
  }
  Json message{{"op", "parameterValues"}, {"parameters", std::move(parameters)}};
  if (id) message["id"] = *id;
  Tell(message);
}

void FoxgloveSession::ParametersChanged(const std::set<std::size_t>& which) {
  std::set<std::size_t> told;
  std::ranges::set_intersection(which, watched_, std::inserter(told, told.end()));
  if (!told.empty()) TellParameters(told);
}

void FoxgloveSession::Advertise(const LiveChannel& channel) {
  Tell({{"op", "advertise"}, {"channels", {ToJson(channel)}}});
}

void FoxgloveSession::Deliver(const LiveChannel& channel, std::int64_t time_ns,
                              std::string_view content) {
  const auto subscription = subscription_of_.find(channel.id);
  if (subscription == subscription_of_.end() || !options_.has_room()) return;
  std::string frame(1, kMessageData);
  frame.reserve(1 + sizeof subscription->second + sizeof time_ns + content.size());
  Append(frame, subscription->second);
  Append(frame, time_ns);
  frame += content;
  options_.send({false, std::move(frame), true});
}

}  // namespace pliant::internal
