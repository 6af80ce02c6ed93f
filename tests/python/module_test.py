"""Scenarios, simulations, logs and reports in Python.

    module_test.py PLIANT
"""

import _thread
import gc
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import weakref
from pathlib import Path

import numpy as np

import pliant

ROOT = Path(__file__).resolve().parents[2]
PUSHED = ROOT / "examples/pushed_arm.yaml"
SHORT = {"duration_s": 0.05, "environment.0.start_s": 0.01, "environment.0.edge_s": 0.01,
         "environment.0.duration_s": 0.03}
ENDLESS = {"duration_s": 1e5, "environment": []}


def short(**more):
    return pliant.Scenario.read(PUSHED, set=SHORT | more)


def endless():
    """A run that is over when somebody ends it; its log grows by a row a minute."""
    return pliant.Scenario.read(PUSHED, set=ENDLESS | {"log_period": "60 s"})


class Test(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def says(self, message, error, act, *arguments, **named):
        with self.assertRaises(error) as caught:
            act(*arguments, **named)
        self.assertIs(type(caught.exception), error)
        self.assertEqual(caught.exception.args[0], message)

    def same(self, a, b):
        """Logs with the same signals, bit for bit."""
        self.assertEqual(a.keys(), b.keys())
        for path in a:
            self.assertEqual((a[path].type, a[path].elements, a[path].units),
                             (b[path].type, b[path].elements, b[path].units))
            np.testing.assert_array_equal(a[path].times, b[path].times)
            np.testing.assert_array_equal(a[path].numbers, b[path].numbers)


class Scenarios(Test):
    def test_a_text_is_read_as_its_file_is(self):
        self.assertEqual(pliant.Scenario.parse(PUSHED.read_text()).text,
                         pliant.Scenario.read(str(PUSHED)).text)

    def test_text_numbers_lists_and_arrays_go_before_what_the_file_says(self):
        at = [0.1, 0.2, 0.3, -1, 0, 0.5, 0]
        for values in ({"station.position": at}, {"station.position": np.array(at)},
                       {"station.position": str(at)}):
            scenario = pliant.Scenario.read(
                PUSHED, set=values | {"duration_s": "500 ms", "seed": np.int64(7), "station.ideal": True})
            sim = pliant.Simulation(scenario)
            np.testing.assert_array_equal(sim["arm.position"], at)
            self.assertEqual(sim.duration, 0.5)
            self.assertIn("seed: 7", scenario.text)

    def test_what_is_wrong_has_its_place(self):
        text = PUSHED.read_text().replace("posture:", "postur:")
        line = next(n for n, l in enumerate(text.splitlines(), 1) if "postur:" in l)
        with self.assertRaisesRegex(pliant.Error, rf"^scenario:{line}:\d+: .*did you mean 'posture'"):
            pliant.Scenario.parse(text)
        (self.folder / "arm.yaml").write_text(text)
        with self.assertRaisesRegex(ValueError, rf"^{self.folder}/arm.yaml:{line}:\d+: "):
            pliant.Scenario.read(self.folder / "arm.yaml")
        with self.assertRaisesRegex(pliant.Error, "duration_s.*-1"):
            pliant.Scenario.read(PUSHED, set={"duration_s": -1})
        with self.assertRaisesRegex(pliant.Error, r"there/is/none\.yaml"):
            pliant.Scenario.read("there/is/none.yaml")
        with self.assertRaisesRegex(TypeError, "set: expected text, numbers, lists or dicts, got object"):
            pliant.Scenario.read(PUSHED, set={"duration_s": object()})

    def test_experiments_have_names(self):
        self.assertEqual(pliant.Scenario.named("ec-aniso").title, pliant.experiments()["ec-aniso"])
        with self.assertRaisesRegex(KeyError, "did you mean 'ec-aniso'"):
            pliant.Scenario.named("ec-anis")


class Simulations(Test):
    def test_a_run_is_that_of_the_command(self):
        report = pliant.run(short(), self.folder / "out")
        with pliant.Simulation(short()) as sim:
            sim.run()
            self.assertEqual((sim.time, sim.ended), (0.05, ""))
            self.same(sim.log(), pliant.read_log(report.logs[0]))

    def test_a_run_in_parts_is_the_same_run(self):
        whole, parts = pliant.Simulation(short()), pliant.Simulation(short())
        whole.advance_to(0.05)
        for t in (0.0003, 0.01, 0.0417, 0.05):
            parts.advance_to(t)
            self.assertEqual(parts.time, t)
        self.same(whole.log(), parts.log())

    def test_time_has_nanoseconds(self):
        sim = pliant.Simulation(short())
        for t, reached in ((1e-300, 0), (0.003 + 4e-10, 0.003), (0.01 + 0.02, 0.03), (1 / 30, 0.033333333)):
            sim.advance_to(t)
            self.assertEqual(sim.time, reached)
        sim.advance_to(0.07)
        sim.run()
        self.assertEqual(sim.time, 0.07)

    def test_a_log_is_written_that_the_command_replays_with_what_was_set(self):
        sim = pliant.Simulation(short())
        sim.advance_to(0.02)
        sim["control.posture.compliance"] = 0.5 * np.eye(7)
        sim.run()
        file = self.folder / "run.mcap"
        sim.write_log(file)
        self.same(sim.log(), pliant.read_log(file))
        np.testing.assert_array_equal(sim.log()["control.posture.compliance"].times, [0.02])
        done = subprocess.run([command, "replay", file, "--part", "control"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("identical", done.stdout)
        self.assertTrue(pliant.report([file]).holds)

        before = file.read_bytes()
        self.says(f"{file} exists; ", pliant.Error, lambda: self.cut(sim.write_log, file))
        self.assertEqual(file.read_bytes(), before)
        sim.write_log(file, force=True)

    @staticmethod
    def cut(act, *arguments):
        """The message up to what depends on who asks."""
        try:
            act(*arguments)
        except pliant.Error as error:
            raise pliant.Error(str(error).split("give")[0]) from None

    def test_values_are_numbers_flags_words_vectors_and_matrices_and_are_copies(self):
        sim = pliant.Simulation(short())
        self.assertIs(type(sim["arm.energy"]), float)
        self.assertIs(sim["arm.wrench_valid"], False)
        self.assertEqual(sim["schedule.mode"], "torque")
        self.assertEqual(sim["control.posture.compliance"].shape, (7, 7))
        position = sim["arm.position"]
        position[:] = 9
        self.assertNotEqual(sim["arm.position"][0], 9)
        self.assertEqual(sim.ports["arm.position"].units, ["rad"] * 7)
        self.assertEqual(sim.ports["arm.position"].elements[0], "[joint_1]")
        for path in sim.ports:
            sim[path]

    def test_what_is_set_is_checked(self):
        sim = pliant.Simulation(short())
        matrix = "control.posture.compliance: expected a matrix of 7 by 7 finite numbers, got "
        set_ = sim.__setitem__
        self.says(matrix + "shape (3, 3)", pliant.Error, set_, "control.posture.compliance", np.eye(3))
        self.says(matrix + "shape (7,)", pliant.Error, set_, "control.posture.compliance", [1] * 7)
        self.says(matrix + "NoneType None", pliant.Error, set_, "control.posture.compliance", None)
        self.says(matrix + "nan at index 0", pliant.Error, set_, "control.posture.compliance",
                  np.full((7, 7), np.nan))
        self.says(matrix + "an array of dtype complex128", pliant.Error, set_,
                  "control.posture.compliance", 1j * np.eye(7))
        self.says("the diagram has no value 'arm.positio'; did you mean 'arm.position'?", KeyError,
                  sim.__getitem__, "arm.positio")
        with self.assertRaisesRegex(pliant.Error, "^arm.position cannot be set: it follows from others"):
            sim["arm.position"] = np.zeros(7)
        which, before = "control.low_level.whole.value", sim["control.low_level.whole.value"]
        for value in (-1, 1e30):
            self.says(f"{which}: expected a whole number of its type, got {value}", pliant.Error, set_, which, value)
            self.assertEqual(sim[which], before)

    def test_runs_are_chosen_by_name_or_index(self):
        scenario = pliant.Scenario.named("ec-aniso")
        self.assertGreater(len(scenario.runs), 1)
        with self.assertRaisesRegex(pliant.Error, "^run: the scenario has .*, expected one of "):
            pliant.Simulation(scenario)
        for beyond in (99, -1, 10**30):
            with self.assertRaisesRegex(IndexError, f"^run: the scenario has .* runs, got the index {beyond}"):
                pliant.Simulation(scenario, beyond)
        self.assertEqual(pliant.Simulation(scenario, np.int64(1)).duration, pliant.Simulation(scenario, 1).duration)
        with self.assertRaisesRegex(KeyError, "did you mean"):
            pliant.Simulation(scenario, scenario.runs[0][:-1])
        with self.assertRaisesRegex(TypeError, "^run: expected a name or an index"):
            pliant.Simulation(scenario, 0.5)
        self.assertEqual(pliant.Simulation(scenario, scenario.runs[1]).duration,
                         pliant.Simulation(scenario, 1).duration)

    def test_an_arm_that_is_there_is_not_simulated(self):
        with self.assertRaisesRegex(pliant.Error, "an arm that is there"):
            pliant.Simulation(pliant.Scenario.read(ROOT / "examples/gen3_hold.yaml",
                                                   set={"station": "!Gen3 {}"}))

    def test_a_run_that_ends_itself_says_why(self):
        sim = pliant.Simulation(short(stop_when=[{"number": "arm.energy", "above": -1e9}]))
        sim.run()
        self.assertEqual(sim.time, 0)
        self.assertIn("stop_when_1 ended the run at t = 0 s", sim.ended)

    def test_time_does_not_go_back(self):
        sim = pliant.Simulation(short())
        sim.advance_to(0.01)
        with self.assertRaisesRegex(pliant.Error, "t must not lie before the time reached, 0.01 s"):
            sim.advance_to(0.005)

    def test_of_two_values_for_one_tick_the_log_has_the_last(self):
        sim = pliant.Simulation(short())
        sim.advance_to(0.01)
        sim["control.posture.compliance"] = np.eye(7)
        sim["control.posture.compliance"] = 0.5 * np.eye(7)
        changes = sim.log()["control.posture.compliance"]
        np.testing.assert_array_equal(changes.numbers, 0.5 * np.eye(7).reshape(1, -1))

    def test_time_is_true_after_a_law_has_raised(self):
        def control(t, q, v, tau):
            if t > 0.0075:
                raise ZeroDivisionError
            return np.zeros(7)

        sim = pliant.Simulation(short(), control=control)
        with self.assertRaises(ZeroDivisionError):
            sim.run()
        self.assertGreaterEqual(sim.time, 0.007)

    def test_a_message_survives_what_is_no_utf_8(self):
        with self.assertRaisesRegex(pliant.Error, "ü"):
            pliant.RobotModel.named("gen3").gravity("ü" * 60)
        with self.assertRaisesRegex(pliant.Error, "/none/"):
            pliant.read_log(os.fsdecode(b"/none/\xff.mcap"))

    def test_time_is_a_number(self):
        sim = pliant.Simulation(short())
        for t in (np.nan, np.inf):
            with self.assertRaisesRegex(pliant.Error, f"t must be finite .s., got {t}"):
                sim.advance_to(t)

    def test_a_closed_simulation_says_so(self):
        sim = pliant.Simulation(short())
        sim.close()
        sim.close()
        for use in (lambda: sim.time, lambda: sim["arm.position"], sim.run, sim.log, lambda: sim.ports,
                    lambda: sim.advance_to(1), sim.stop):
            self.says("the simulation is closed", RuntimeError, use)


class Laws(Test):
    gen3 = pliant.RobotModel.named("gen3")

    def test_gravity_alone_keeps_an_arm_at_rest(self):
        seen = []

        def control(t, q, v, tau):
            seen.append(t)
            self.assertEqual((q.shape, v.shape, tau.shape), ((7,), (7,), (7,)))
            return self.gen3.gravity(q)

        sim = pliant.Simulation(short(environment=[]), control=control)
        start = sim["arm.position"]
        sim.run()
        np.testing.assert_allclose(seen, np.arange(51) * 1e-3, atol=1e-15)
        np.testing.assert_allclose(sim["arm.position"], start, atol=1e-9)  # tolerances of the integrator
        np.testing.assert_allclose(sim.log()["control.torque"].numbers[-1], self.gen3.gravity(start),
                                   atol=1e-6)

    def test_the_environment_pushes_as_it_does_beside_any_controller(self):
        sim = pliant.Simulation(short(), control=lambda t, q, v, tau: self.gen3.gravity(q))
        sim.run()
        self.assertGreater(np.abs(sim.log()["true_torque.torque"].numbers).max(), 1)

    def test_a_load_moves_links_and_rotors(self):
        """v̇ = (M + diag(B))⁻¹ τ: what is left of the inverse without M is diagonal, and B > 0."""
        sim = pliant.Simulation(short(environment=[]), control=lambda t, q, v, tau: self.gen3.gravity(q))
        l = sim.linearize(inputs=["load.value"], outputs=["arm.position", "arm.velocity"])
        self.assertEqual(l.inputs, [f"load.value[joint_{j}]" for j in range(1, 8)])
        self.assertEqual(l.states, [f"arm.plant.{x}[joint_{j}]" for x in "qv" for j in range(1, 8)])
        q, v = slice(0, 7), slice(7, 14)
        np.testing.assert_array_equal(l.A[q, q], 0)
        near = {"atol": 1e-7}  # of central differences
        np.testing.assert_allclose(l.A[q, v], np.eye(7), **near)
        np.testing.assert_allclose(l.C, np.eye(14), **near)
        np.testing.assert_array_equal(l.D, 0)
        rotors = np.linalg.inv(l.B[v]) - self.gen3.mass_matrix(sim["arm.position"])
        self.assertGreater(np.diag(rotors).min(), 0)
        np.testing.assert_allclose(rotors, np.diag(np.diag(rotors)), **near)
        sim["load.value"] = load = 0.1 * np.arange(7)
        sim.advance_to(1e-4)  # nothing has moved far
        np.testing.assert_allclose(sim["arm.velocity"], 1e-4 * l.B[v] @ load, rtol=0.01)

    def test_an_exception_comes_out_as_itself(self):
        class Mine(Exception):
            pass

        mine = Mine("at 0.02")

        def control(t, q, v, tau):
            if t > 0.0199:
                raise mine
            return 0 * q

        sim = pliant.Simulation(short(), control=control)
        with self.assertRaises(Mine) as caught:
            sim.run()
        self.assertIs(caught.exception, mine)
        self.assertAlmostEqual(sim.time, 0.02, delta=1e-9)
        self.assertEqual(sim.log()["control.torque"].numbers.shape, (20, 7))

    def test_what_a_law_returns_is_checked(self):
        expected = "the torque of control at t = 0 s: expected 7 finite numbers, got "
        for value, found in ((None, "NoneType None"), (np.zeros(6), "shape (6,)"), (1.0, "shape ()"),
                             (np.full(7, np.nan), "nan at index 0"), ("no", "str 'no'"),
                             ([np.inf] * 7, "inf at index 0")):
            sim = pliant.Simulation(short(), control=lambda t, q, v, tau, value=value: value)
            self.says(expected + found, pliant.FailedRun, sim.run)
        self.says("control: expected a function of t, position, velocity, torque", TypeError,
                  pliant.Simulation, short(), control=3)

    def test_a_law_does_not_ask_the_simulation_that_calls_it(self):
        def control(t, q, v, tau):
            return sim["arm.position"]

        sim = pliant.Simulation(short(), control=control)
        with self.assertRaisesRegex(RuntimeError, "^the simulation is being advanced"):
            sim.run()

    def test_a_log_of_a_law_does_not_promise_a_replay(self):
        sim = pliant.Simulation(short(), control=lambda t, q, v, tau: 0 * q)
        sim.run()
        sim.write_log(self.folder / "law.mcap")
        log = pliant.read_log(self.folder / "law.mcap")
        self.same(sim.log(), log)
        self.assertNotIn("pliant", log.metadata)
        with self.assertRaisesRegex(pliant.Error, "it has no record 'pliant'"):
            pliant.report([self.folder / "law.mcap"])


class Threads(Test):
    def test_two_simulations_advance_at_once_while_python_runs(self):
        """Neither run ends by itself. If one kept the interpreter, neither the other run nor this
        thread, which ends both, would get on."""
        sims = [pliant.Simulation(endless()) for _ in range(2)]
        threads = [threading.Thread(target=sim.advance_to, args=(1e5,), daemon=True) for sim in sims]
        for thread in threads:
            thread.start()
        before = [0.0, 0.0]
        for _ in range(3):
            while not all(sim.time > t for sim, t in zip(sims, before)):
                time.sleep(0.001)
            before = [sim.time for sim in sims]
        self.assertTrue(all(thread.is_alive() for thread in threads))
        self.says("the simulation is being advanced: wait for advance_to to return; meanwhile there "
                  "are only time and stop()", RuntimeError, sims[0].log)
        for sim, thread in zip(sims, threads):
            sim.stop()
            thread.join(60)
            self.assertFalse(thread.is_alive())
            self.assertLess(sim.time, 1e5)

    def test_two_laws_meet_at_every_tick(self):
        """Each waits in its law for the other: two runs in one thread would wait for ever."""
        both = threading.Barrier(2, timeout=60)
        met = []

        def control(t, q, v, tau):
            both.wait()
            met.append(t)
            return 0 * q

        sims = [pliant.Simulation(short(), control=control) for _ in range(2)]
        threads = [threading.Thread(target=sim.run) for sim in sims]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
        self.assertEqual(len(met), 2 * 51)

    def interrupt(self, act):
        timer = threading.Timer(0.3, _thread.interrupt_main)
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            act()
        timer.join()

    def test_ctrl_c_ends_a_run(self):
        sim = pliant.Simulation(endless())
        self.interrupt(sim.run)
        self.assertLess(0, sim.time)
        self.assertLess(sim.time, 1e5)
        sim.advance_to(sim.time + 1)  # it can go on

    def test_ctrl_c_ends_an_experiment_and_its_logs_are_whole(self):
        self.interrupt(lambda: pliant.run(endless(), self.folder))
        log = pliant.read_log(self.folder / "logs/run.mcap")
        self.assertEqual(log.metadata["pliant.run"]["whole"], "0")


class Logs(Test):
    def test_a_log_is_like_a_dict(self):
        sim = pliant.Simulation(short())
        self.assertEqual(len(sim.log()["arm.position"]), 0)
        sim.run()
        log = sim.log()
        self.assertEqual(list(log), log.keys())
        self.assertIn("arm.position", log)
        self.assertNotIn("arm", log)
        self.assertEqual(len(log), len(log.keys()))
        position = log["arm.position"]
        self.assertEqual(position.elements, [f"joint_{j}" for j in range(1, 8)])
        self.assertEqual((position.type, position.units), ("joint position", ["rad"] * 7))
        np.testing.assert_allclose(position.times, np.arange(51) * 1e-3, atol=1e-15)
        np.testing.assert_array_equal(position["joint_2"], np.asarray(position)[:, 1])
        self.assertEqual(np.asarray(position, dtype=np.float32).dtype, np.float32)
        self.assertEqual(log["arm.energy"].elements, [""])
        self.says("the recording has no signal 'arm.positon'; did you mean 'arm.position'?", KeyError,
                  log.__getitem__, "arm.positon")
        self.says("arm.position has no element 'joint_9'; did you mean '[joint_1]'?", KeyError,
                  position.__getitem__, "joint_9")

    def test_arrays_outlive_what_they_were_read_from(self):
        sim = pliant.Simulation(short())
        sim.advance_to(0.01)
        log = sim.log()
        signal = log["arm.position"]
        numbers, column, copy = signal.numbers, signal["joint_2"], signal.numbers.copy()
        gone = weakref.ref(log) if hasattr(type(log), "__weakref__") else None
        sim.run()  # the rows in memory grow and move
        del log
        gc.collect()
        if gone:
            self.assertIsNone(gone())
        np.testing.assert_array_equal(signal.numbers, copy)  # the log lives while a signal does
        sim.close()
        del signal, sim
        gc.collect()
        np.testing.assert_array_equal(numbers, copy)
        np.testing.assert_array_equal(column, copy[:, 1])

    def test_a_law_is_let_go_with_its_simulation(self):
        class Law:
            def __call__(self, t, q, v, tau):
                return 0 * q

        law = Law()
        gone = weakref.ref(law)
        sim = pliant.Simulation(short(), control=law)
        sim.run()
        del law
        gc.collect()
        self.assertIsNotNone(gone())
        del sim
        gc.collect()
        self.assertIsNone(gone())

    def test_damage_has_its_place(self):
        sim = pliant.Simulation(short())
        sim.run()
        file = self.folder / "run.mcap"
        sim.write_log(file)
        file.write_bytes(file.read_bytes()[:-200])
        with self.assertRaisesRegex(pliant.Error, str(file)):
            pliant.read_log(file)
        with self.assertRaisesRegex(pliant.Error, "none.mcap"):
            pliant.read_log(self.folder / "none.mcap")
        with self.assertRaises(TypeError):
            pliant.read_log(None)


class Reports(Test):
    def test_an_experiment_has_claims_and_a_verdict(self):
        scenario = pliant.Scenario.named("null-space-compliance")
        report = pliant.run(scenario, self.folder / "out", jobs=2)
        self.assertEqual([Path(log).stem for log in report.logs], scenario.runs)
        self.assertEqual(report.title, scenario.title)
        self.assertEqual(report.holds, all(report.claims))
        claim = report[report.claims[0].id]
        del report
        gc.collect()
        self.assertTrue(claim.measured and claim.source and claim.criterion)
        with self.assertRaisesRegex(pliant.Error, "exists"):
            pliant.run(scenario, self.folder / "out")
        again = pliant.report(sorted((self.folder / "out/logs").glob("*.mcap")))
        with self.assertRaisesRegex(KeyError, "the report has no claim"):
            again["no such claim"]
        again.write(self.folder / "report")
        verdict = json.loads((self.folder / "report/verdict.json").read_text())
        self.assertEqual([c["holds"] for c in verdict["claims"]], [c.holds for c in again.claims])

    def test_a_run_that_cannot_go_on_is_a_failed_run(self):
        os.mkdir(self.folder / "logs")
        os.symlink("/dev/full", self.folder / "logs/run.mcap")
        with self.assertRaises(pliant.FailedRun):
            pliant.run(short(), self.folder, force=True)


class Sweeps(Test):
    def swept(self, **more):
        return pliant.Scenario.read(ROOT / "examples/swept_arm.yaml", set=more)

    def test_a_grid_has_a_run_for_each_cell_and_its_numbers_are_those_of_the_run(self):
        forces = [[0, 10, 0], [0, 30, 0]]
        path, of = "environment.0.force", "controller.posture.compliance"
        results = pliant.sweep(self.swept(), {path: forces, of: np.array([0.5, 1])}, jobs=2)
        self.assertEqual((len(results), results.runs, results.whole), (4, 4, True))
        np.testing.assert_array_equal(results.index, range(4))
        np.testing.assert_array_equal(results.values[of], [0.5, 1, 0.5, 1])
        self.assertEqual(len(set(results.values[path])), 2)
        self.assertEqual(results.numbers.shape, (4, len(results.names)))
        self.assertEqual(results.causes, [""] * 4)
        for i, (force, compliance) in enumerate((f, c) for f in forces for c in (0.5, 1)):
            sim = pliant.Simulation(self.swept(**{path: force, of: compliance}))
            sim.run()
            speed = np.linalg.norm(sim.log()["arm.velocity"].numbers, axis=1).max()
            self.assertAlmostEqual(results["fastest"][i], speed, delta=1e-14)  # round-off of a norm
        np.testing.assert_array_equal(results[of], results.values[of])
        self.assertEqual((results["ended"], len(set(results["seed"]))), ([""] * 4, 4))
        self.says("the sweep has no column 'fastes'; did you mean 'fastest'?", KeyError,
                  results.__getitem__, "fastes")

    def test_random_values_are_drawn_and_what_was_made_is_read_again(self):
        over = {"environment.0.force.1": "uniform(10,30)"}
        out = self.folder / "out"
        results = pliant.sweep(self.swept(), over, runs=6, out=out)
        drawn = results.values["environment.0.force.1"]
        self.assertTrue((10 < drawn).all() and (drawn < 30).all() and len(set(drawn)) == 6)
        again = pliant.read_sweep(out)
        np.testing.assert_array_equal(again.numbers, results.numbers)
        results.write(self.folder)
        self.assertEqual(len((self.folder / "results.csv").read_text().splitlines()), 7)

    def test_what_cannot_be_swept_is_said(self):
        with self.assertRaisesRegex(pliant.Error, "duration"):
            pliant.sweep(self.swept(), {"duration": [1, 2]})
        with self.assertRaisesRegex(pliant.Error, "numbers"):
            pliant.sweep(pliant.Scenario.read(PUSHED), {"duration_s": [1, 2]})
        self.says("jobs must be >= 1, got 0", pliant.Error, pliant.sweep, self.swept(), {"seed": [1]}, jobs=0)
        with self.assertRaises(pliant.Error):
            pliant.read_sweep([self.folder])
        path = "environment.0.force.1"
        for values in (20.0, None, b"12", {1: 2}):
            self.says(f"{path}: expected a list of values, or text such as '0:1:3', got {values!r}", TypeError,
                      pliant.sweep, self.swept(), {path: values})
        self.says("a sweep has at most 1000000000 runs, got 18446744073709551615", pliant.Error,
                  pliant.sweep, self.swept(), {}, runs=2**64 - 1)
        with self.assertRaisesRegex(pliant.Error, "expected no 'repeat', and as many runs as are wanted, got 5"):
            pliant.sweep(self.swept(repeat=5), {})
        for word in ("0:1:3", "uniform(0,1)", "a,b"):  # in a list each is one word
            with self.assertRaisesRegex(pliant.Error, "has no link \"" + re.escape(word)):
                pliant.sweep(self.swept(), {"controller.tool": [word]})
        self.says("the scenario has no run 'stif'; did you mean 'run'?", KeyError,
                  pliant.sweep, self.swept(), {"seed": [1]}, run="stif")

    def test_a_part_that_is_damaged_is_a_warning_and_its_runs_are_made_again(self):
        out = self.folder / "out"
        whole = pliant.sweep(self.swept(), {"seed": [1, 2]}, out=out)
        part = out / "part-1-of-1"
        part.write_bytes(part.read_bytes()[:-1])
        with self.assertWarnsRegex(RuntimeWarning, "its end, are no row$"):
            self.assertEqual(len(pliant.read_sweep([out])), 1)
        with self.assertWarnsRegex(RuntimeWarning, "its end, are no row; the runs it lacks are made again$"):
            again = pliant.sweep(self.swept(), {"seed": [1, 2]}, out=out)
        np.testing.assert_array_equal(again.numbers, whole.numbers)

    def test_ctrl_c_keeps_what_is_made(self):
        Threads.interrupt(self, lambda: pliant.sweep(
            self.swept(), {"environment.0.force.1": "uniform(10,30)"}, runs=100_000, out=self.folder))
        kept = pliant.read_sweep([self.folder])
        self.assertFalse(kept.whole)
        self.assertGreater(len(kept), 0)


if __name__ == "__main__":
    command = sys.argv.pop()
    unittest.main()
