// Simbody's libSimTKmath exports functions of an old SUNDIALS. A program with both must find each
// its own: here SUNDIALS, linked by the program itself, integrates accelerations that Simbody
// computes.

#include <arkode/arkode_erkstep.h>
#include <gtest/gtest.h>
#include <nvector/nvector_serial.h>

#include "pliant/plants/simbody_arm.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

struct Fall {
  SimbodyArm arm;
  SimbodyArm::Workspace workspace;
};

int Rate(double, N_Vector y, N_Vector rate, void* user) {
  auto& [arm, workspace] = *static_cast<Fall*>(user);
  const int n = arm.model().size();
  const JointPosition q = Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(y), n);
  const JointVelocity v = Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(y) + n, n);
  const JointTorque none = JointTorque::Zero(arm.model().joints());
  Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(rate), n) = v;
  Eigen::Map<Eigen::VectorXd>(N_VGetArrayPointer(rate) + n, n) =
      arm.ForwardDynamics(q, v, none, {}, {}, workspace);
  return 0;
}

TEST(SimbodyAndSundials, WorkInOneProcess) {
  const RobotModel model = Gen3();
  const int n = model.size();
  Fall fall{SimbodyArm(model), {}};
  Eigen::VectorXd state = Eigen::VectorXd::Zero(2 * n);
  state(1) = 0.5;

  SUNContext context = nullptr;
  ASSERT_EQ(SUNContext_Create(nullptr, &context), 0);
  N_Vector y = N_VMake_Serial(2 * n, state.data(), context);
  void* solver = ERKStepCreate(&Rate, 0, y, context);
  ASSERT_NE(solver, nullptr);
  ASSERT_EQ(ERKStepSetUserData(solver, &fall), 0);
  ASSERT_EQ(ERKStepSStolerances(solver, 1e-10, 1e-10), 0);
  RobotDynamics d(model);
  ComputeDynamics(model, state.head(n), state.tail(n), d);
  const double energy = PotentialEnergy(model, d);
  double t = 0;
  ASSERT_EQ(ERKStepEvolve(solver, 0.2, y, &t, ARK_NORMAL), ARK_SUCCESS);
  EXPECT_EQ(t, 0.2);

  ComputeDynamics(model, state.head(n), state.tail(n), d);
  EXPECT_GT(KineticEnergy(d), 0.1);  // [J]
  EXPECT_NEAR(KineticEnergy(d) + PotentialEnergy(model, d), energy,
              1e-6);  // tolerance, 0.2 s, 20 J

  N_VDestroy(y);
  ERKStepFree(&solver);
  SUNContext_Free(&context);
}

}  // namespace
}  // namespace pliant
