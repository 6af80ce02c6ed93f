#include "pliant/analysis/live_view.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "pliant/analysis/html_page.h"
#include "pliant/analysis/live_channels.h"
#include "pliant/analysis/live_commands.h"
#include "pliant/analysis/live_history.h"
#include "pliant/analysis/live_server.h"
#include "pliant/analysis/page_run.h"
#include "pliant/analysis/ros_log.h"
#include "pliant/analysis/row_ring.h"
#include "pliant/analysis/run_log.h"
#include "pliant/analysis/tunable_values.h"
#include "pliant/controllers/safety_text.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

using internal::Json;
using internal::RowRing;
using WallClock = std::chrono::steady_clock;

constexpr std::size_t kRingCells = (8 << 20) / sizeof(double);
constexpr int kRowsAtATime = 4000;  // of the ring, so that clients are heard in between
constexpr int kChangesAtATick = 256;
constexpr auto kBetweenReports = std::chrono::milliseconds(500);
constexpr auto kBetweenRows = std::chrono::milliseconds(50);
constexpr std::size_t kPageCharacters = 8'000'000;
constexpr const char* kPoses = "arm.measured_position";  // in the rows that the page shows

constexpr const char* kRunSchema =
    R"({"type": "object", "properties": {"state": {"enum": ["running", "ended"]},
"time": {"type": "number"}, "reason": {"type": "string"}, "pace": {"type": "number"},
"late": {"type": "integer"}, "dropped": {"type": "integer"}, "safety": {"type": "string"}}})";

/// Rows for a log and for those who look on.
class SharedRows final : public RecordSink {
 public:
  struct Stream {
    std::vector<RecordedValue> values;
    std::vector<double> row;
    int in_log = 0;
  };

  SharedRows(std::shared_ptr<RecordSink> log, internal::RosLog& messages, RowRing& ring)
      : log_{std::move(log)}, messages_{messages}, ring_{ring} {}

  int Open(std::vector<RecordedValue> values) override {
    std::size_t n = 0;
    for (const RecordedValue& value : values) n += value.elements.size();
    Require(RowRing::CellsFor(n) <= kRingCells, "a row has too many numbers to be shown", n);
    Stream stream{values, std::vector<double>(n)};
    if (log_) stream.in_log = log_->Open(values);
    streams_.push_back(std::move(stream));
    return messages_.Open(std::move(values));
  }
  std::span<double> Begin(int stream, std::int64_t time_ns) noexcept override {
    stream_ = &streams_[static_cast<std::size_t>(stream)];
    number_ = stream;
    time_ns_ = time_ns;
    return stream_->row;
  }
  void Commit() noexcept override {
    const std::vector<double>& row = stream_->row;
    if (log_)
      if (const std::span<double> room = log_->Begin(stream_->in_log, time_ns_); !room.empty()) {
        std::ranges::copy(row, room.begin());
        log_->Commit();
      }
    const std::span<double> room = ring_.Begin(number_, time_ns_, dropped_, row.size());
    if (room.empty() || time_ns_ < 0) {
      ++dropped_;
      return;
    }
    std::ranges::copy(row, room.begin());
    ring_.Commit();
  }

  const std::deque<Stream>& streams() const { return streams_; }
  RecordSink* log() const { return log_.get(); }

 private:
  const std::shared_ptr<RecordSink> log_;
  internal::RosLog& messages_;
  RowRing& ring_;
  std::deque<Stream> streams_;
  Stream* stream_ = nullptr;
  int number_ = 0;
  std::int64_t time_ns_ = 0, dropped_ = 0;
};

/// What is worth a place at the top of the page: modes, and how an arm gives way.
Json ShownFirst(const internal::LiveParameters& parameters) {
  Json shown = Json::array();
  const auto show = [&](const auto& wanted) {
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (wanted(parameters[i])) shown.push_back(parameters[i].path);
  };
  show([](const TunableValue& of) { return of.kind == TunableValue::Kind::Word; });
  for (const std::string_view name : {".compliance", ".stiffness", ".damping"})
    show([&](const TunableValue& of) {
      return of.path.starts_with("control.") && of.path.ends_with(name);
    });
  return shown;
}

internal::RosLog::Options MessagesOf(const Scenario& scenario) {
  McapLog::Options log = RunLogOf({.file = "", .experiment = "", .run = {}, .scenario = scenario});
  return {.robot = std::move(log.robot),
          .robot_description = std::move(log.robot_description),
          .position = std::move(log.position),
          .velocity = std::move(log.velocity),
          .torque = std::move(log.torque)};
}

}  // namespace

struct LiveView::State {
  explicit State(const Options& o)
      : options{o},
        channels{[this](const internal::LiveChannel& channel) { server.Advertise(channel); },
                 [this](const internal::LiveChannel& to, std::int64_t t, std::string_view content) {
                   server.Deliver(to, t, content);
                 }},
        server{ServerOptions(o)} {}

  static internal::LiveServer::Options ServerOptions(const Options& o) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    internal::LiveServer::Options of{.address = o.address,
                                     .port = o.port,
                                     .name = "pliant",
                                     .session = std::to_string(now.count())};
    of.origins.insert(of.origins.end(), o.origins.begin(), o.origins.end());
    return of;
  }

  // ---- of the server's thread ------------------------------------------------------------------

  void Pump() {
    const WallClock::time_point now = WallClock::now();
    commands->LetGoOfOld(now);
    int left = kRowsAtATime;
    for (std::optional<RowRing::Row> row; left > 0 && (row = ring.Front()); --left) {
      messages->Write(channels, row->stream, row->time_ns, row->numbers);
      if (row->stream == shown) history->Add(row->time_ns, row->numbers);
      dropped = row->dropped;
      ring.Pop();
    }
    channels.Flush();
    if (now >= rows_told + kBetweenRows) {
      rows_told = now;
      if (const std::string rows = history->Fresh(); !rows.empty())
        channels.Tell(rows_channel, time_ns, rows);
    }
    if (now >= report_told + kBetweenReports) TellHowItGoes(now);
  }

  void TellHowItGoes(WallClock::time_point now) {
    const std::int64_t time = time_ns;
    const double wall = std::chrono::duration<double>(now - report_told).count();
    Json report{{"state", ended ? "ended" : "running"},
                {"time", 1e-9 * static_cast<double>(time)},
                {"reason", reason},
                {"pace", 1e-9 * static_cast<double>(time - time_told) / wall},
                {"late", late.load()},
                {"dropped", dropped}};
    if (run.panel) report["safety"] = WordOf(run.panel->state.load());
    report_told = now;
    time_told = time;
    channels.Tell(run_channel, time, report.dump());
  }

  /// Before the first row there is nothing to show.
  std::string Page() const {
    const std::string title = run.run.title;
    if (history->empty())
      return internal::HtmlPage(title,
                                "<meta http-equiv=\"refresh\" content=\"0.5\">\n"
                                "<p>The run is about to begin.</p>\n");
    internal::FittedData data = internal::FitPageData(history->columns(), kPageCharacters);
    std::vector<const RecordedValue*> values;
    for (const RecordedValue& value : rows->streams()[static_cast<std::size_t>(shown)].values)
      values.push_back(&value);
    const RobotModel& model = *messages_options.robot;
    Json of_run = internal::PageRun(title, values, model, PushesOf(run.scenario));
    of_run["data"] = "data-0";
    of_run["rows"] = data.rows;
    of_run["decimation"] = data.decimation;
    const Json page{{"plots", {{kPoses}, {"control.torque"}, {"control.pose_error"}}},
                    {"runs", {of_run}},
                    {"robot", internal::PageRobot(model, ToolOf(run.scenario.controller))},
                    {"live",
                     {{"title", title},
                      {"duration", run.scenario.duration_s},
                      {"control", options.control},
                      {"push", commands->pushes()},
                      {"supervised", run.panel != nullptr},
                      {"shown", ShownFirst(commands->parameters())},
                      {"parameters", commands->parameters().Description()}}}};
    return internal::HtmlPage(title, "<h1>" + internal::Escaped(title) +
                                         "</h1>\n<section id=\"replay\"></section>\n" +
                                         internal::PageEnd(page, {data.text}, "live"));
  }

  // ---- of the thread that ticks ----------------------------------------------------------------

  void BeforeTick(Simulator& sim, const RunReport& report) {
    bool some = false;
    for (int left = kChangesAtATick; left > 0; --left) {
      const std::optional<internal::LiveCommands::Change> change = commands->Next();
      if (!change) break;
      if (change->target == internal::LiveCommands::kPush) {
        sim.SetNumbers(run.scene->live_push->hand, change->numbers);
        continue;
      }
      Change& of = changes[static_cast<std::size_t>(change->target)];
      std::ranges::copy(change->numbers, of.numbers.begin());
      some = of.to_set = of.to_record = true;
    }
    if (some) SetAll(sim);
    if (some || unrecorded) unrecorded = !RecordAll(sim.next_tick_ns());
    time_ns.store(sim.next_tick_ns(), std::memory_order_relaxed);
    late.store(report.missed, std::memory_order_relaxed);
  }

  /// However often a value was changed since the last tick, once.
  void SetAll(Simulator& sim) {
    for (Change& change : changes)
      if (std::exchange(change.to_set, false)) sim.SetNumbers(*change.value, change.numbers);
  }

  /// What the changed values are from this tick on. False if the log had no room for some: they are
  /// recorded at a later tick.
  bool RecordAll(std::int64_t tick_ns) {
    bool all = true;
    for (Change& change : changes) {
      if (!change.to_record) continue;
      if (change.in_log >= 0) {
        const std::span<double> row = rows->log()->Begin(change.in_log, tick_ns);
        if (row.empty()) {
          all = false;
          continue;
        }
        std::ranges::copy(change.numbers, row.begin());
        rows->log()->Commit();
      }
      change.to_record = false;
    }
    return all;
  }

  void Begin(const Run& of) {
    run = of;
    const auto& streams = rows->streams();
    const auto with_poses = std::ranges::find_if(streams, [](const auto& stream) {
      return std::ranges::find(stream.values, kPoses, &RecordedValue::path) != stream.values.end();
    });
    if (with_poses == streams.end())
      throw Error(std::string("nothing records ") + kPoses + ", which the page is to show");
    shown = static_cast<int>(with_poses - streams.begin());
    history.emplace(with_poses->row.size());

    is_there = run.scene->hardware != nullptr;
    std::vector<TunableValue> tunables = TunableValuesOf(*run.diagram);
    // Of an arm that is there nobody changes what its supervisor and its own blocks are fed with.
    if (is_there)
      std::erase_if(tunables, [](const auto& t) { return !t.path.starts_with("control."); });
    for (const TunableValue& tunable : tunables) {
      changes.push_back({tunable.value, tunable.start});
      const auto has_it = [&](const SharedRows::Stream& stream) {
        return std::ranges::find(stream.values, tunable.path, &RecordedValue::path) !=
               stream.values.end();
      };
      if (rows->log() && std::ranges::none_of(streams, has_it))
        changes.back().in_log = rows->log()->Open({tunable});
    }
    const bool can_push = run.scene->live_push != nullptr;
    commands.emplace(internal::LiveCommands::Options{
        .tunables = std::move(tunables),
        .pushed = can_push ? messages_options.robot : std::nullopt,
        .control = options.control,
        .stop = [this] { RequestStop(); },
        .acknowledge =
            run.panel ? [panel = run.panel] { ++panel->acknowledged; } : std::function<void()>()});
    rows_channel =
        channels.AddChannel(channels.AddSchema("pliant/msg/Rows", "ros2msg", "float64[] numbers"),
                            "/pliant/rows", "cdr", {});
    run_channel = channels.AddChannel(channels.AddSchema("pliant.Run", "jsonschema", kRunSchema),
                                      "/pliant/run", "json", {});
    rows_told = report_told = WallClock::now();
    server.Begin({.channels = &channels,
                  .commands = &*commands,
                  .page = [this] { return Page(); },
                  .pump = [this] { Pump(); },
                  .first =
                      [this](const internal::LiveChannel& channel) {
                        return channel.id == rows_channel ? history->Tail() : std::string();
                      }});
  }

  void RequestStop() {
    if (run.panel) run.panel->stop = true;
    if (!is_there) stop = true;
  }

  const Options options;
  Run run;
  std::atomic<bool> stop{false};
  bool is_there = false;  // the arm
  std::atomic<std::int64_t> time_ns{0}, late{0};

  RowRing ring{kRingCells};
  internal::RosLog::Options messages_options;
  std::optional<internal::RosLog> messages;
  std::shared_ptr<SharedRows> rows;
  int shown = 0;  // the stream whose rows the page shows

  struct Change {  // of a tunable value, with its stream in the log
    const internal::Value* value;
    std::vector<double> numbers;
    int in_log = -1;
    bool to_set = false, to_record = false;
  };
  std::vector<Change> changes;
  bool unrecorded = false;  // some of them

  std::optional<internal::LiveHistory> history;
  internal::LiveChannels channels;
  std::optional<internal::LiveCommands> commands;
  std::uint16_t rows_channel = 0, run_channel = 0;
  WallClock::time_point rows_told, report_told;
  std::int64_t time_told = 0, dropped = 0;
  bool ended = false;
  std::string reason;

  internal::LiveServer server;  // the last: its thread uses the others
};

LiveView::LiveView(const Options& o) : state_{std::make_unique<State>(o)} {}

LiveView::~LiveView() = default;

std::string LiveView::url() const { return state_->server.url(); }

Scenario LiveView::Pushable(Scenario scenario) const {
  if (!IsHardware(scenario) && state_->options.control)
    scenario.environment.emplace_back(LivePush::Options{});
  return scenario;
}

std::shared_ptr<RecordSink> LiveView::Sink(const Scenario& scenario,
                                           std::shared_ptr<RecordSink> log) {
  State& state = *state_;
  state.messages_options = MessagesOf(scenario);
  state.messages.emplace(state.messages_options);
  state.rows = std::make_shared<SharedRows>(std::move(log), *state.messages, state.ring);
  return state.rows;
}

void LiveView::Begin(const Run& run) { state_->Begin(run); }

const std::atomic<bool>& LiveView::stop() const { return state_->stop; }
void LiveView::RequestStop() { state_->RequestStop(); }

std::function<void(Simulator&, const RunReport&)> LiveView::BeforeTick() {
  return [state = state_.get()](Simulator& sim, const RunReport& report) {
    state->BeforeTick(sim, report);
  };
}

void LiveView::End(const std::string& reason) {
  State& state = *state_;
  state.server.End([&] {
    while (state.ring.Front()) state.Pump();
    state.ended = true;
    state.reason = reason;
    state.rows_told = {};
    state.Pump();
    state.TellHowItGoes(WallClock::now());
  });
}

}  // namespace pliant
