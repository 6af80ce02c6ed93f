"""How a Gen3 gives way to a push: the compliance of a scenario, and a state feedback of one's own.

Run it as a whole, python3 stiffness.py [FIGURE], or cell by cell in an editor that knows "# %%".
"""

# %% Three compliances of the null space
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import pliant

Array = NDArray[np.float64]
FILE = Path(__file__).resolve().parents[1] / "pushed_arm.yaml"

logs = {}
for compliance in (0, 0.5, 1):
    scenario = pliant.Scenario.read(FILE, set={"controller.posture.compliance": compliance})
    with pliant.Simulation(scenario) as sim:
        sim.run()
        logs[f"Γ = {compliance}"] = sim.log()

# %% The arm about its start, from the torques of the environment to its joints
arm = pliant.RobotModel.named("gen3")
with pliant.Simulation(scenario, control=lambda t, q, v, tau: arm.gravity(q)) as sim:
    q0 = sim["arm.position"]
    linear = sim.linearize(inputs=["load.value"], outputs=["arm.position"])

# %% A state feedback that weighs the joints' positions a hundred times as much as their speeds
n = len(arm.joints)
lqr = pliant.lqr(linear.A, linear.B, np.diag([100.0] * n + [1.0] * n), 0.01 * np.eye(n), linear.states)
print("slowest mode [1/s]:", lqr.modes.real.max().round(2))


def hold(t: float, q: Array, v: Array, tau: Array) -> Array:
    torque: Array = arm.gravity(q0) - lqr.K @ np.concatenate([q - q0, v])
    return torque


with pliant.Simulation(scenario, control=hold) as sim:
    sim.run()
    logs["LQR"] = sim.log()

# %% How far the elbow and the tool move
figure, axes = plt.subplots(1, 2, figsize=(9, 3.5), sharex=True, layout="constrained")
for axis, link in zip(axes, ("forearm_link", "tool_frame")):
    for name, log in logs.items():
        position = log["arm.position"]
        place = np.array([arm.pose(q, link)[:3, 3] for q in position.numbers])
        axis.plot(position.times, 1e3 * np.linalg.norm(place - place[0], axis=1), label=name)
    push = log["push_1.force"]
    axis.axvspan(*push.times[push["force.y"] > 1][[0, -1]], color="0.92", zorder=0)
    axis.set(title=link, xlabel="time [s]", ylabel="distance from its start [mm]", ylim=(0, None))
axes[0].legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "stiffness.png", dpi=150)
