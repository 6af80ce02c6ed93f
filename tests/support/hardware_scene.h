#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pliant/diagrams/gen3_emulator.h"
#include "pliant/diagrams/scenario.h"
#include "pliant/plants/gen3_wire.h"
#include "pliant/plants/parameter_file.h"

namespace pliant {

/// All the compliance controller of Celerier et al. 2025 (EC) has, on an arm that is there.
inline Scenario EcOnAnArm() {
  Scenario scenario;
  ParameterFile::ReadText(R"(
robot: gen3
station: !Gen3 {}
controller: !Compliance
  tool: tool_frame
  pose: {compliance: 0.5}
  posture: {compliance: 1}
  collisions: {}
  speed_limit: {frame: tool_frame, linear: 0.5}
  workspace: [{frame: tool_frame, planes: [{normal: [0, 0, 1], point: [0, 0, 0.05]}]}]
safety: {stale_after: 100000, most_missed: 100000}
duration_s: 100000
)",
                          "scenario")
      .Fill(scenario);
  return scenario;
}

/// Takes rows, as a log does that has room.
class Rows final : public RecordSink {
 public:
  int Open(std::vector<RecordedValue> values) override {
    std::size_t n = 0;
    for (const RecordedValue& value : values) n += value.elements.size();
    row_.resize(n);
    return 0;
  }
  std::span<double> Begin(int, std::int64_t) noexcept override { return row_; }
  void Commit() noexcept override { ++rows; }

  int rows = 0;

 private:
  std::vector<double> row_;
};

/// An emulated arm on the loopback, and the way to it.
struct EmulatedArm {
  explicit EmulatedArm(bool waits)
      : lock_step{waits},
        emulator{{.arm = {.station = {.engine = SimbodyPlant::Engine::Recursive}},
                  .lock_step = waits}} {}

  std::shared_ptr<Gen3Arm> Connect(const Scenario& scenario) const {
    const SimulatedArm::Options known = StationOf(scenario);
    return std::make_shared<Gen3Arm>(Gen3Arm::Options{
        .link = ConnectGen3(
            {.host = "127.0.0.1", .tcp_port = emulator.port(), .udp_port = emulator.udp_port()}),
        .model = known.model,
        .current_limit = FiguresOf(known.actuators.joint, &ActuatorParameters::current_limit),
        .torque_per_ampere = known.actuators.torque_per_ampere(),
        .lock_step = lock_step ? std::chrono::seconds(2) : std::chrono::nanoseconds(0)});
  }

  bool lock_step;
  Gen3Emulator emulator;
};

}  // namespace pliant
