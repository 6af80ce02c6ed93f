#include "pliant/diagrams/simulated_arm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pliant/diagrams/stations.h"
#include "pliant/plants/link_force.h"
#include "pliant/systems/block_tester.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/integral.h"
#include "pliant/systems/simulator.h"
#include "pliant/systems/sine.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// Tick k: (k + 1) N·m on every joint.
class Counter final : public Block {
 public:
  explicit Counter(const Joints& joints) : torque{this, "torque", joints}, k_{this, "k", joints} {
    const PeriodicEvent tick = Every(1ms);
    tick.Compute(torque).From(k_).As(
        [](const JointTorque& k) { return JointTorque(k + PerJoint::Ones(k.size())); });
    tick.Update(k_).From(k_).As(
        [](const JointTorque& k) { return JointTorque(k + PerJoint::Ones(k.size())); });
  }
  Output<JointTorque> torque;

 private:
  Discrete<JointTorque> k_;
};

TEST(SimulatedArm, ShowsAtTickKWhatTheCommandOfTheTickBeforeDid) {
  const RobotModel m = Gen3().WithGravity({0, 0, 0});
  const PerJoint rotors = PerJoint::Constant(7, 1e3);
  DiagramBuilder b;
  auto& command = b.Add<Counter>("command", m.joints());
  auto& arm = b.Add<SimulatedArm>("arm", {.model = m,
                                          .position = JointPosition::Zero(m.joints()),
                                          .actuators = ArmActuators::Ideal(m.joints(), rotors),
                                          .engine = SimbodyPlant::Engine::Recursive});
  b.Connect(command.torque, arm.torque_command);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  RobotDynamics d(m);
  double v = 0;
  for (int k = 0; k < 20; ++k) {
    sim.AdvanceThroughTick();
    EXPECT_EQ(sim.Get(arm.measured_current), PerJoint::Constant(7, k)) << "u of tick k − 1 is k";
    EXPECT_EQ(sim.Get(command.torque), PerJoint::Constant(7, k + 1));
    // Joint 7 moves its link by k N·m for a millisecond: rotors outweigh the coupling 10⁵ times.
    const double inertia = d.M(6, 6) + 1e3;
    const double of_link = d.M.row(6).sum() * k / 1e3;  // all joints speed up by k/10³ rad/s²
    EXPECT_NEAR(sim.Get(arm.measured_torque)(6), of_link, 0.01 * of_link)
        << "a sensor between rotor and link";
    v += k * 1e-3 / inertia;
    EXPECT_NEAR(sim.Get(arm.measured_velocity)(6), v, 1e-3 * v + 1e-12) << k;
  }
}

TEST(SimulatedArm, AcceleratesByTheNewCommandFromItsTickOn) {
  const RobotModel m = Gen3();
  DiagramBuilder b;
  auto& command = b.Add<Counter>("command", m.joints());
  auto& arm = b.Add<SimulatedArm>("arm", {.model = m,
                                          .position = JointPosition::Zero(m.joints()),
                                          .engine = SimbodyPlant::Engine::Recursive});
  b.Connect(command.torque, arm.torque_command);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  for (int k = 0; k < 5; ++k) {
    sim.AdvanceThroughTick();
    RobotDynamics d(m);
    ComputeDynamics(m, sim.Get(arm.position), sim.Get(arm.velocity), d);
    const JointTorque acting = PerJoint::Constant(7, k + 1);
    EXPECT_LT(RelativeError(sim.Get(arm.acceleration),
                            ForwardDynamics(d, acting, JointTorque::Zero(m.joints()))),
              1e-12);
    EXPECT_EQ(sim.Get(arm.measured_position), sim.Get(arm.position));
  }
}

const JointPosition kHome{0, 0.2618, std::numbers::pi, -2.2689, 0, 0.9599, std::numbers::pi / 2};

const JointPosition kLwrStart{0, 0.698, 0, -1.571, 0, 0.873, 0};

/// A Gen3 station that is driven by currents, with an account of its energy.
struct Account {
  struct Drive final : Block {
    explicit Drive(const Joints& joints) : current{this, "current", joints} {
      Every(1ms).Compute(current).From(clock).As(&Drive::At);
    }
    Output<MotorCurrent> current;

   private:
    MotorCurrent At(double t) const {
      const PerJoint phase = PerJoint::LinSpaced(7, 0, 3);
      return (phase.array() + 7 * t).sin().matrix();
    }
  };

  static SimulatedArm::Options Options(Transmission transmission, FrictionLaw friction) {
    SimulatedArm::Options o =
        SimulatedGen3(Gen3(), {.position = kHome, .engine = SimbodyPlant::Engine::Recursive});
    o.actuators.transmission = transmission;
    o.actuators.friction = friction;
    o.firmware.mode = ControlMode::Current;
    return o;
  }

  explicit Account(const SimulatedArm::Options& o) {
    DiagramBuilder b;
    arm = &b.Add<SimulatedArm>("arm", o);
    auto& drive = b.Add<Drive>("drive", o.model.joints());
    auto& hand = b.Add<LinkForce>("hand", {.model = o.model, .link = "forearm_link"});
    auto& force = b.Add<Sine<Force>>("force", {.amplitude = {10, 20, -5}, .frequency_hz = 1});
    work = &b.Add<Integral<double>>("work", {});
    pushed = &b.Add<Integral<double>>("pushed", {});
    lost = &b.Add<Integral<double>>("lost", {});
    b.Connect(drive.current, arm->current_command);
    b.Connect(force.y, hand.force);
    b.Connect(hand.contact, arm->contacts);
    b.Connect(arm->motion, hand.motion);
    b.Connect(arm->power, work->u);
    b.Connect(hand.power, pushed->u);
    b.Connect(arm->dissipation, lost->u);
    diagram.emplace(b.Build());
  }

  SimulatedArm* arm;
  Integral<double>*work, *pushed, *lost;
  std::optional<Diagram> diagram;
};

TEST(SimulatedArm, KeepsAccountOfItsEnergy) {
  for (const Transmission transmission : {Transmission::Rigid, Transmission::Elastic})
    for (const FrictionLaw friction : {FrictionLaw::None, FrictionLaw::Stribeck, FrictionLaw::LuGre,
                                       FrictionLaw::ElastoPlastic}) {
      const Account run(Account::Options(transmission, friction));
      Simulator sim(*run.diagram, {.integrator = {.method = Method::kDormandPrince,
                                                  .relative_tolerance = 1e-7,
                                                  .absolute_tolerance = 1e-9}});
      const double start = sim.Get(run.arm->energy);
      sim.AdvanceTo(1);
      const double in = sim.Get(run.work->y) + sim.Get(run.pushed->y);
      const double change = sim.Get(run.arm->energy) - start, lost = sim.Get(run.lost->y);
      const double turned_over =
          std::abs(sim.Get(run.work->y)) + std::abs(sim.Get(run.pushed->y)) + lost;
      EXPECT_GT(turned_over, 1);
      EXPECT_NEAR(in, change + lost, 1e-5 * turned_over)
          << static_cast<int>(transmission) << ' ' << static_cast<int>(friction);
      EXPECT_GE(lost, friction == FrictionLaw::None ? 0 : 0.1);
    }
}

/// A station alone, its commands set by hand.
struct Station {
  explicit Station(const SimulatedArm::Options& o) {
    DiagramBuilder b;
    arm = &b.Add<SimulatedArm>("arm", o);
    diagram.emplace(b.Build());
    sim.emplace(*diagram, Simulator::Options{.integrator = {.method = Method::kDormandPrince}});
  }
  SimulatedArm* arm;
  std::optional<Diagram> diagram;
  std::optional<Simulator> sim;
};

TEST(SimulatedArm, StandsWhereItIsWhenItsBrakesLetGo) {
  for (const bool lwr : {false, true})
    for (const Transmission transmission : {Transmission::Rigid, Transmission::Elastic}) {
      const RobotModel m = lwr ? Lwr() : Gen3();
      const JointPosition start = lwr ? kLwrStart : kHome;
      const StationOptions where{.position = start, .engine = SimbodyPlant::Engine::Recursive};
      SimulatedArm::Options o = lwr ? SimulatedLwr(m, where) : SimulatedGen3(m, where);
      o.actuators.transmission = transmission;
      o.sensors = {};  // without bias
      o.firmware.mode = ControlMode::Position;
      Station run(o);
      run.sim->AdvanceTo(2);
      // The rotors carry the weight from the start; what is left is the settling of bristles, a
      // part of their half millirad.
      EXPECT_LT((run.sim->Get(run.arm->position) - start).cwiseAbs().maxCoeff(), 1e-5)
          << m.name() << static_cast<int>(transmission);
      EXPECT_EQ(run.sim->Get(run.arm->status).mode, ControlMode::Position);
    }
}

TEST(SimulatedArm, GoesWhereItIsTold) {
  const RobotModel m = Gen3();
  SimulatedArm::Options o =
      SimulatedGen3(m, {.position = kHome, .engine = SimbodyPlant::Engine::Recursive});
  o.firmware.mode = ControlMode::Position;
  Station run(o);
  const PerJoint step = PerJoint::Constant(7, 0.1);
  for (int k = 1; k <= 1000; ++k) {
    run.sim->AdvanceThroughTick();
    run.sim->Set(run.arm->position_command, kHome + step * (0.5 - 0.5 * std::cos(k * 3.1416e-3)));
  }
  run.sim->AdvanceTo(3);
  // The integral overcomes stiction but for the encoders' noise of 10⁻⁵ rad.
  EXPECT_LT((run.sim->Get(run.arm->position) - kHome - step).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(SimulatedArm, SettlesInPositionModeWithItsRatedPayload) {
  // Stretched out, where the inertia is largest, 4 kg at the tool.
  const RobotModel m = Gen3().WithPayload(
      "tool_frame", {4, Eigen::Vector3d::Zero(), 0.01 * Eigen::Matrix3d::Identity()});
  JointPosition stretched = JointPosition::Zero(m.joints());
  stretched(1) = std::numbers::pi / 2;
  SimulatedArm::Options o =
      SimulatedGen3(m, {.position = stretched, .engine = SimbodyPlant::Engine::Recursive});
  o.sensors = {};
  o.firmware.mode = ControlMode::Position;
  Station run(o);
  stretched(1) -= 0.02;
  run.sim->AdvanceThroughTick();
  run.sim->Set(run.arm->position_command, stretched);
  const auto fastest = [&](double from, double to) {
    double most = 0;
    for (run.sim->AdvanceTo(from); run.sim->time() < to; run.sim->AdvanceThroughTick())
      most = std::max(most, run.sim->Get(run.arm->velocity).cwiseAbs().maxCoeff());
    return most;
  };
  const double early = fastest(0.5, 1), late = fastest(2.5, 3);
  EXPECT_LT(late, 0.2 * early) << "rad/s: it comes to rest";
  EXPECT_LT(late, 5e-3) << "rad/s";
}

TEST(SimulatedArm, TellsThatTheFirmwareCutsATorque) {
  // The LWR's currents are at their limit where its torques are, so its drives never see more.
  Station run(
      SimulatedLwr(Lwr(), {.position = kLwrStart, .engine = SimbodyPlant::Engine::Recursive}));
  run.sim->Set(run.arm->torque_command, JointTorque{0, 0, 0, 1000, 0, 0, 500});
  run.sim->AdvanceTo(0.0101);
  EXPECT_EQ(run.sim->Get(run.arm->status).saturated, 8u + 64u);
}

TEST(SimulatedArm, OfKukaCarriesItsWeightUnderATorqueCommand) {
  const RobotModel m = Lwr();
  SimulatedArm::Options o =
      SimulatedLwr(m, {.position = kLwrStart, .engine = SimbodyPlant::Engine::Recursive});
  Station run(o);
  run.sim->Set(run.arm->torque_command, JointTorque{0, 0, 0, 5, 0, 0, 0});
  run.sim->AdvanceTo(0.3);
  const PerJoint moved = run.sim->Get(run.arm->position) - kLwrStart;
  EXPECT_GT(moved(3), 0.02) << "5 N·m against 0.3 N·m of friction";
  // Between two ticks of its interface nothing changes outside.
  const JointPosition shown = run.sim->Get(run.arm->measured_position);
  run.sim->AdvanceTo(0.3046);
  const JointPosition later = run.sim->Get(run.arm->measured_position);
  EXPECT_NE(later, shown) << "the tick at 0.3 s was not shown yet";
  run.sim->AdvanceTo(0.3049);
  EXPECT_EQ(run.sim->Get(run.arm->measured_position), later);
}

TEST(SimulatedArm, TellsWhatIsSaturatedAndStopped) {
  const RobotModel m = Gen3();
  JointPosition at_stop = kHome;
  at_stop(3) = -2.57;
  SimulatedArm::Options o =
      SimulatedGen3(m, {.position = at_stop, .engine = SimbodyPlant::Engine::Recursive});
  o.firmware.mode = ControlMode::Current;
  Station run(o);
  run.sim->Set(run.arm->current_command, MotorCurrent{0, 0, 0, -20, 0, 0, 0});
  run.sim->AdvanceTo(0.2);
  EXPECT_EQ(run.sim->Get(run.arm->status).saturated, 8u);
  EXPECT_EQ(run.sim->Get(run.arm->status).stopped, 1);
  EXPECT_LT(run.sim->Get(run.arm->measured_position)(3), -2.57);
  EXPECT_GT(run.sim->Get(run.arm->position)(3), -2.57 - 2 * (95 + 10) / 2e4)
      << "no deeper than a sudden load and the arm's weight press it";
  EXPECT_NEAR(run.sim->Get(run.arm->measured_current)(3), -8.64, 1e-6) << "amperes, clamped";
}

TEST(SimulatedArm, FeelsItsToolThroughTheWrist) {
  const RobotModel m = RobotModel::FromUrdf(kGen3BotaFile);
  SimulatedArm::Options o = SimulatedGen3(
      m, {.position = kHome, .ideal = true, .engine = SimbodyPlant::Engine::Recursive});
  Station run(o);
  RobotDynamics d(m, {"FT_sensor_wrench"});
  ComputeDynamics(m, kHome, JointVelocity::Zero(m.joints()), d);
  run.sim->Set(run.arm->torque_command, d.gravity);
  run.sim->AdvanceTo(0.0101);
  const Eigen::Vector3d weight = 0.081117 * (d.frame[0].pose.rotation.transpose() * m.gravity());
  EXPECT_LT((run.sim->Get(run.arm->wrench).tail<3>() - weight).norm(), 1e-9);
}

TEST(SimulatedArm, IsTheSameRunForTheSameSeed) {
  const auto run = [](std::uint64_t seed, bool interrupted) {
    SimulatedArm::Options o = SimulatedGen3(
        Gen3(), {.position = kHome, .seed = seed, .engine = SimbodyPlant::Engine::Recursive});
    o.firmware.mode = ControlMode::Position;
    Station station(o);
    station.sim->AdvanceTo(0.05);
    const Context snapshot = station.sim->Snapshot();
    station.sim->AdvanceTo(0.1);
    if (interrupted) {
      station.sim->Restore(snapshot);
      station.sim->AdvanceTo(0.1);
    }
    return JointPosition(station.sim->Get(station.arm->measured_position));
  };
  EXPECT_EQ(run(1, false), run(1, true));
  EXPECT_NE(run(1, false), run(2, false));
}

TEST(SimulatedArm, RefusesWhatIsNoStation) {
  const auto error = [](auto change) {
    SimulatedArm::Options o =
        SimulatedGen3(RobotModel::FromUrdf(kGen3BotaFile), {.position = kHome});
    change(o);
    return ErrorOf([&] { SimulatedArm arm(o); });
  };
  using O = SimulatedArm::Options;
  EXPECT_EQ(error([](O& o) { o.wrist->period = 500us; }),
            "wrist.period must be >= period = 1 ms, the rate of the arm, got 500 us");
  EXPECT_EQ(error([](O& o) { o.interface_period = 200us; }),
            "interface_period must be >= period = 1 ms, got 200 us");
  EXPECT_EQ(error([](O& o) { o.actuators.joint[2].torque_constant = 0; }),
            "actuators: joint_3: torque_constant must be > 0 N·m/A, got 0");
  EXPECT_EQ(error([](O& o) { o.actuators.joint.pop_back(); }),
            "actuators has an element for each of the 7 joints, got 6");
  EXPECT_EQ(error([](O& o) {
              o.position = {1, 2};
            }),
            "position has an element for each of the 7 joints, got 2");
  EXPECT_THAT(error([](O& o) { o.wrist->frame = "FT_sensor"; }),
              testing::HasSubstr("wrist: robot \"gen3_7dof_bota\" has no link \"FT_sensor\""));
}

}  // namespace
}  // namespace pliant
