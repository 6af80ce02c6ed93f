// What a tick on an arm costs: the compliance controller of Celerier et al. 2025 (EC) with all it
// has, the supervisor, and the messages of Kinova's protocol; without the network, and over the
// loopback at 1 kHz.
//
//   hardware_bench --benchmark_filter=Paced --benchmark_format=console

#include <BaseCyclic.pb.h>
#include <benchmark/benchmark.h>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "pliant/plants/kortex_cyclic.h"
#include "pliant/plants/kortex_frame.h"
#include "pliant/systems/real_time_runner.h"
#include "pliant/tests/support/hardware_scene.h"

namespace pliant {
namespace {

/// Frames are written and read, and go nowhere: the arm sways, whatever it is told.
class NoNetwork final : public Gen3Link {
 public:
  NoNetwork() {
    for (std::size_t k = 0; k < answers_.size(); ++k) {
      Kinova::Api::BaseCyclic::Feedback feedback;
      feedback.mutable_base()->set_arm_voltage(24);
      for (int j = 0; j < kGen3Joints; ++j) {
        auto& a = *feedback.add_actuators();
        const double phase = 2 * std::numbers::pi * static_cast<double>(k) / 1000 + j;
        a.set_position(static_cast<float>(kHome[static_cast<std::size_t>(j)] + std::sin(phase)));
        a.set_velocity(static_cast<float>(2 * std::numbers::pi * std::cos(phase)));
        a.set_torque(static_cast<float>(0.1 * std::sin(31 * phase)));
      }
      const std::string payload = feedback.SerializeAsString();
      answers_[k].resize(payload.size() + kortex::kEnvelope);
      answers_[k].resize(kortex::WriteFrame(
          {.type = kortex::FrameType::Response, .function = kortex::Function::Refresh},
          std::as_bytes(std::span(payload)), answers_[k]));
    }
  }
  void ClearFaults() override {}
  std::uint32_t ArmState() override { return 7; }
  int ActuatorCount() override { return kGen3Joints; }
  Gen3Servoing Servoing() override { return Gen3Servoing::LowLevel; }
  void SetServoing(Gen3Servoing) override {}
  Gen3Mode Mode(int) override { return Gen3Mode::Position; }
  void SetMode(int, Gen3Mode) override {}
  Gen3Feedback Read() override {
    Gen3Feedback feedback;
    Receive(feedback, {});
    return feedback;
  }
  int Send(const Gen3Command& command) noexcept override {
    ++id_;
    const auto payload = cyclic_.Write(id_, command);
    benchmark::DoNotOptimize(
        kortex::WriteFrame({.id = id_, .function = kortex::Function::Refresh}, payload, out_));
    waits_ = true;
    return id_;
  }
  bool Receive(Gen3Feedback& feedback, std::chrono::nanoseconds) noexcept override {
    if (!waits_) return false;
    waits_ = false;
    const auto frame = kortex::ReadFrame(answers_[id_ % answers_.size()]);
    feedback.answers = id_;
    return frame && cyclic_.Read(frame->payload, feedback);
  }
  Gen3Traffic traffic() const noexcept override { return {}; }

 private:
  static constexpr std::array<double, kGen3Joints> kHome{0, 15, 180, 230, 0, 55, 90};  // [°]
  std::array<std::vector<std::byte>, 1000> answers_;
  std::array<std::byte, 1024> out_;
  kortex::Cyclic cyclic_;
  std::uint16_t id_ = 0;
  bool waits_ = true;
};

void Show(benchmark::State& state, const RunReport& report) {
  const auto us = [](double s) { return 1e6 * s; };
  state.counters["median_us"] = us(report.compute.Quantile(0.5));
  state.counters["p99_us"] = us(report.compute.Quantile(0.99));
  state.counters["p999_us"] = us(report.compute.Quantile(0.999));
  state.counters["worst_us"] = us(report.compute.worst());
  if (report.lateness.count() == 0) return;
  state.counters["late_median_us"] = us(report.lateness.Quantile(0.5));
  state.counters["late_p999_us"] = us(report.lateness.Quantile(0.999));
  state.counters["missed"] = static_cast<double>(report.missed);
}

RunReport Run(std::shared_ptr<Gen3Arm> arm, const RealTimeRunner::Options& options, double until) {
  Scenario scenario = EcOnAnArm();
  std::get<Gen3Station>(scenario.station).position = arm->start().position;
  ScenarioDiagram scene(scenario, std::make_shared<Rows>(), {.arm = arm});
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram);
  RealTimeRunner(sim, {.paced = options.paced}).Run(2);  // until the controller has the arm
  RealTimeRunner runner(sim, options);
  return runner.Run(until);
}

/// Execution alone: no socket, no sleep.
void Tick(benchmark::State& state) {
  for (auto _ : state) {
    const SimulatedArm::Options known = StationOf(EcOnAnArm());
    const auto arm = std::make_shared<Gen3Arm>(Gen3Arm::Options{
        .link = std::make_shared<NoNetwork>(),
        .model = known.model,
        .current_limit = FiguresOf(known.actuators.joint, &ActuatorParameters::current_limit),
        .torque_per_ampere = known.actuators.torque_per_ampere(),
        .frozen_after = 0,
        .lock_step = std::chrono::seconds(1)});
    Show(state,
         Run(arm, {.paced = false, .permissions = {.priority = 80, .lock_memory = true}}, 32));
  }
}
BENCHMARK(Tick)->Name("HardwareTick/NoNetwork")->Iterations(1)->Unit(benchmark::kMillisecond);

/// At 1 kHz against an emulated arm in this process, with the exchange over the loopback.
void Paced(benchmark::State& state) {
  for (auto _ : state) {
    const EmulatedArm emulated(false);
    Show(state, Run(emulated.Connect(EcOnAnArm()),
                    {.permissions = {.priority = 80, .lock_memory = true}}, 12));
  }
}
BENCHMARK(Paced)->Name("HardwareTick/Paced")->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pliant
