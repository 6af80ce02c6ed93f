"""Torque control of robot arms: scenarios, simulations, logs, models and identification.

    scenario = pliant.Scenario.read("pushed_arm.yaml", set={"duration_s": 2})
    with pliant.Simulation(scenario) as sim:
        sim.run()
        log = sim.log()
    position = log["arm.position"]
    plt.plot(position.times, position["joint_2"])

Numbers are in SI, arrays are copies, and help() of a class gives equations and shapes.
"""

from ._pliant import (ComplementaryFusion, Claim, Error, Estimate, FailedRun, FrictionFit, Linearization,
                      Log, Lqr, MomentumObserver, Port, QpSolution, Report, RobotModel, Scenario, Signal,
                      Simulation, SweepResults, Table, __version__, dlqr, experiments, fit_friction,
                      identify_friction, lqr, read_log, read_sweep, report, run, solve_qp, sweep)

__all__ = [name for name in dir() if not name.startswith("_")] + ["__version__"]
for _name in __all__[:-1]:
    globals()[_name].__module__ = __name__
