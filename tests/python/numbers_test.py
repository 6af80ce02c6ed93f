"""Models, estimators, quadratic programs, state feedback and friction on arrays.

    numbers_test.py PLIANT
"""

import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import pliant

ROOT = Path(__file__).resolve().parents[2]
rng = np.random.default_rng(7)


class Test(unittest.TestCase):
    def says(self, message, error, act, *arguments, **named):
        with self.assertRaises(error) as caught:
            act(*arguments, **named)
        self.assertIs(type(caught.exception), error)
        self.assertEqual(caught.exception.args[0], message)


class Models(Test):
    gen3 = pliant.RobotModel.named("gen3")

    def states(self):
        for _ in range(20):
            yield rng.uniform(-3, 3, 7), rng.uniform(-2, 2, 7), rng.uniform(-5, 5, 7)

    def test_mass_is_symmetric_and_positive_definite(self):
        for q, _, _ in self.states():
            M = self.gen3.mass_matrix(q)
            np.testing.assert_allclose(M, M.T, atol=1e-15)
            self.assertGreater(np.linalg.eigvalsh(M).min(), 0)

    def test_forward_undoes_inverse_dynamics(self):
        for q, v, a in self.states():
            tau = self.gen3.inverse_dynamics(q, v, a)
            np.testing.assert_allclose(
                tau, self.gen3.mass_matrix(q) @ a + self.gen3.coriolis(q, v) + self.gen3.gravity(q), rtol=1e-11)
            external = rng.uniform(-1, 1, 7)
            np.testing.assert_allclose(self.gen3.forward_dynamics(q, v, tau - external, external), a,
                                       atol=1e-9)  # condition of M times round-off

    def test_the_rate_of_the_mass_is_c_and_its_transpose(self):
        h = 1e-6
        for q, v, _ in self.states():
            rate = (self.gen3.mass_matrix(q + h * v) - self.gen3.mass_matrix(q - h * v)) / (2 * h)
            np.testing.assert_allclose(
                rate @ v, self.gen3.coriolis(q, v) + self.gen3.coriolis_transposed(q, v), atol=1e-8)

    def test_the_jacobian_is_how_the_pose_changes(self):
        h, point = 1e-6, [0.1, -0.2, 0.3]
        at = np.append(point, 1)
        for q, v, _ in self.states():
            J = self.gen3.jacobian(q, "tool_frame", point)
            self.assertEqual(J.shape, (6, 7))
            X = [self.gen3.pose(q + s * h * v, "tool_frame") for s in (-1, 1)]
            np.testing.assert_allclose((X[1] - X[0]) @ at / (2 * h), np.append(J[3:] @ v, 0), atol=1e-8)
            spin = (X[1] - X[0])[:3, :3] / (2 * h) @ self.gen3.pose(q, "tool_frame")[:3, :3].T
            np.testing.assert_allclose([spin[2, 1], spin[0, 2], spin[1, 0]], J[:3] @ v, atol=1e-8)
            rate = [self.gen3.jacobian(q + s * h * v, "tool_frame", point) @ v for s in (-1, 1)]
            np.testing.assert_allclose(self.gen3.jacobian_rate(q, v, "tool_frame", point),
                                       (rate[1] - rate[0]) / (2 * h), atol=1e-7)

    def test_a_model_is_read_from_a_file_and_from_a_text(self):
        file = ROOT / "examples/own_arm.urdf"
        arm, again = pliant.RobotModel.read(file), pliant.RobotModel.parse(file.read_text())
        self.assertEqual((arm.name, arm.joints, arm.links), (again.name, again.joints, again.links))
        self.assertTrue((arm.lower < arm.upper).all())
        self.assertTrue((arm.effort_limit > 0).all() and (arm.velocity_limit > 0).all() and arm.mass > 0)

    def test_what_is_wrong_is_said(self):
        n7 = "q: expected 7 finite numbers, got "
        self.says(n7 + "shape (3,)", pliant.Error, self.gen3.gravity, np.zeros(3))
        self.says(n7 + "shape (7, 1)", pliant.Error, self.gen3.gravity, np.zeros((7, 1)))
        self.says(n7 + "NoneType None", pliant.Error, self.gen3.gravity, None)
        self.says(n7 + "nan at index 2", pliant.Error, self.gen3.gravity, [0, 0, np.nan, 0, 0, 0, 0])
        self.says(n7 + "str 'zero'", pliant.Error, self.gen3.gravity, "zero")
        self.says(n7 + "an array of dtype object", pliant.Error, self.gen3.gravity, np.array([None] * 7))
        self.says(n7 + "an array of dtype complex128", pliant.Error, self.gen3.gravity, np.zeros(7) * 1j)
        with self.assertRaisesRegex(KeyError, "did you mean .tool_frame"):
            self.gen3.pose(np.zeros(7), "tool_fram")
        with self.assertRaisesRegex(KeyError, "there is no robot 'gen4'; did you mean 'gen3'"):
            pliant.RobotModel.named("gen4")
        with self.assertRaisesRegex(pliant.Error, "none.urdf"):
            pliant.RobotModel.read("none.urdf")


class Estimators(Test):
    gen3 = pliant.RobotModel.named("gen3")

    def test_the_observer_comes_to_a_constant_torque_at_its_rate(self):
        """At rest: r_k = (1 − e^(−K h k)) τ_e."""
        q, external = rng.uniform(-1, 1, 7), rng.uniform(-5, 5, 7)
        K, h = np.linspace(10, 40, 7), 1e-3
        observer = pliant.MomentumObserver(self.gen3, gain=K, period=h)
        for k in range(50):
            r = observer.update(q, np.zeros(7), self.gen3.gravity(q) - external)
            np.testing.assert_allclose(r, (1 - np.exp(-K * h * k)) * external, atol=1e-11)

    def test_the_fusion_has_joints(self):
        for joints in (-1, 0, 2**31 - 1):
            with self.assertRaisesRegex(pliant.Error, "joints must be 1 to "):
                pliant.ComplementaryFusion(joints, gain=1.0, period=1e-3)

    def test_the_fusion_is_exact_where_the_sensor_is(self):
        """Of τ_s = τ_e that changes evenly over each sample, by the observer's own recursion."""
        K, h, a = 15.0, 1e-3, np.exp(-15e-3)
        fusion = pliant.ComplementaryFusion(2, gain=K, period=h)
        truth = np.cumsum(rng.uniform(-1, 1, (40, 2)), axis=0)
        r = np.zeros(2)
        before = np.zeros(2)
        for k, now in enumerate(truth):
            r = a * r + (1 - a) * (now + before) / 2 if k else np.zeros(2)
            fused = fusion.update(r, now)
            if k == 0:
                offset = fused - now
            np.testing.assert_allclose(fused - now, offset * a**k, atol=1e-12)
            before = now
        np.testing.assert_array_equal(fusion.update(r, truth[-1], valid=False), r)

    def test_what_is_wrong_is_said(self):
        self.says("gain: expected 7 finite numbers, got shape (2,)", pliant.Error,
                  pliant.MomentumObserver, self.gen3, gain=[1, 2], period=1e-3)
        with self.assertRaisesRegex(pliant.Error, "gain"):
            pliant.MomentumObserver(self.gen3, gain=-1, period=1e-3)
        for period in (0, 1e300, np.nan):
            self.says(f"period must be 1e-9 s to 1e9 s, got {period}", pliant.Error,
                      pliant.MomentumObserver, self.gen3, gain=1, period=period)
        observer = pliant.MomentumObserver(self.gen3, gain=np.float32(1), period=1e-3)
        self.says("torque: expected 7 finite numbers, got inf at index 0", pliant.Error,
                  observer.update, np.zeros(7), np.zeros(7), [np.inf] * 7)


class QuadraticPrograms(Test):
    def test_solutions_satisfy_the_conditions_of_optimality(self):
        for _ in range(50):
            n, m = rng.integers(1, 12), rng.integers(1, 12)
            L = rng.normal(size=(n, n))
            H, g, A = L @ L.T + np.eye(n), 5 * rng.normal(size=n), rng.normal(size=(m, n))
            lower, upper = -rng.uniform(0, 1, m), rng.uniform(0, 1, m)
            x_lower, x_upper = np.full(n, -np.inf), rng.uniform(0, 1, n)
            s = pliant.solve_qp(H, g, A, lower, upper, x_lower=x_lower, x_upper=x_upper)
            self.assertTrue(s)
            self.assertEqual(s.status, "solved")
            near = {"atol": 1e-8}  # of numbers near 10, conditions near 100
            np.testing.assert_allclose(H @ s.x + g, A.T @ s.row_multipliers + s.bound_multipliers, **near)
            for value, multiplier, low, high in ((A @ s.x, s.row_multipliers, lower, upper),
                                                 (s.x, s.bound_multipliers, x_lower, x_upper)):
                self.assertTrue((value > low - 1e-8).all() and (value < high + 1e-8).all())
                slack = np.where(multiplier > 0, value - low, np.where(multiplier < 0, high - value, 0))
                np.testing.assert_allclose(slack, 0, **near)

    def test_an_infeasible_one_is_proved_to_be(self):
        s = pliant.solve_qp(np.eye(2), [0, 0], [[1, 1], [-1, -1]], [1, 1])
        self.assertFalse(s)
        self.assertEqual(s.status, "infeasible")
        np.testing.assert_allclose(np.array([[1, 1], [-1, -1]]).T @ s.row_multipliers, 0, atol=1e-15)
        self.assertGreater(s.row_multipliers @ [1, 1], 0)

    def test_without_limits_it_is_a_linear_system(self):
        np.testing.assert_allclose(pliant.solve_qp([[2, 0], [0, 4]], [2, -4]).x, [-1, 1], atol=1e-15)
        self.assertEqual(pliant.solve_qp([[0]], [1]).status, "not_convex")

    def test_what_is_wrong_is_said(self):
        qp = pliant.solve_qp
        self.says("H: expected a matrix of 2 by 2 finite numbers, got shape (3, 3)", pliant.Error, qp,
                  np.eye(3), [0, 0])
        self.says("A: expected a matrix of any number by 2 finite numbers, got shape (2,)", pliant.Error, qp,
                  np.eye(2), [0, 0], [1, 1])
        self.says("lower: expected 1 numbers, which may be infinite, got nan at index 0", pliant.Error, qp,
                  np.eye(2), [0, 0], [[1, 1]], [np.nan])
        self.says("lower and upper are of the rows of A, and there is no A; for x give x_lower, x_upper",
                  pliant.Error, qp, np.eye(2), [0, 0], lower=[0, 0])
        self.says("H must be symmetric; its largest difference from the transpose, got 1", pliant.Error, qp,
                  [[2, 1], [0, 2]], [1, 1])
        self.says("g: expected 1 to 64 numbers, got 65", pliant.Error, qp, np.eye(65), np.zeros(65))
        self.says("A: expected at most 128 rows, got 129", pliant.Error, qp, np.eye(1), [0], np.ones((129, 1)))


class Feedback(Test):
    def system(self):
        n, m = 4, 2
        return rng.normal(size=(n, n)), rng.normal(size=(n, m)), np.eye(n), np.diag([1.0, 2.0])

    def test_the_continuous_gain_solves_the_riccati_equation(self):
        A, B, Q, R = self.system()
        l = pliant.lqr(A, B, Q, R)
        np.testing.assert_allclose(A.T @ l.S + l.S @ A - l.S @ B @ np.linalg.solve(R, B.T @ l.S) + Q, 0,
                                   atol=1e-9 * np.linalg.norm(l.S))
        np.testing.assert_allclose(l.K, np.linalg.solve(R, B.T @ l.S), rtol=1e-9)
        self.assertLess(l.modes.real.max(), 0)
        np.testing.assert_allclose(np.sort_complex(l.modes), np.sort_complex(np.linalg.eigvals(A - B @ l.K)),
                                   atol=1e-9)

    def test_the_discrete_gain_solves_its_own(self):
        A, B, Q, R = self.system()
        l = pliant.dlqr(A, B, Q, R)
        np.testing.assert_allclose(A.T @ l.S @ A - l.S - A.T @ l.S @ B @ l.K + Q, 0,
                                   atol=1e-9 * np.linalg.norm(l.S))
        self.assertLess(np.abs(l.modes).max(), 1)

    def test_a_mode_that_no_input_moves_is_named(self):
        with self.assertRaisesRegex(pliant.Error, "height"):
            pliant.lqr(np.diag([1.0, -1.0]), [[0], [1]], np.eye(2), [[1]], names=["height", "speed"])
        self.says("A: expected as many columns as rows, 2, got 3", pliant.Error, pliant.lqr,
                  np.zeros((2, 3)), np.zeros((2, 1)), np.eye(2), [[1]])
        self.says("names: expected one for each of the 2 states, got 1", pliant.Error, pliant.lqr,
                  np.eye(2), np.eye(2), np.eye(2), np.eye(2), ["x"])


class Friction(Test):
    def samples(self):
        w = np.concatenate([np.full(400, speed) for speed in np.linspace(-1, 1, 21) if abs(speed) > 0.05])
        return w, 3 * np.sign(w) + 1.5 * w + 0.4 + 0.1 * rng.normal(size=w.size)

    def test_known_parameters_are_found_within_their_intervals(self):
        w, y = self.samples()
        fit = pliant.fit_friction(w, y, model="coulomb_viscous")
        self.assertEqual(fit.model, "coulomb_viscous")
        for name, truth in {"coulomb": 3, "viscous": 1.5, "offset": 0.4}.items():
            e = fit.estimates[name]
            self.assertLess(e.low, e.value)
            self.assertLess(abs(e.value - truth), 4 * e.deviation)  # 1 in 10 000 misses, the seed is fixed
            self.assertLess(e.deviation, 0.02)  # 0.1 over the root of thousands of samples
        np.testing.assert_allclose(np.sqrt(np.diag(fit.covariance)),
                                   [e.deviation for e in fit.estimates.values()], rtol=1e-9)
        np.testing.assert_allclose(fit.curve([-1.0, 1.0]), [-4.5, 4.5], atol=0.05)
        self.assertAlmostEqual(fit.rms, 0.1, delta=0.005)  # of as many samples
        self.assertEqual((fit.samples, fit.lacks_fit), (w.size, False))

    def test_the_model_of_least_bic_is_taken(self):
        fit = pliant.fit_friction(*self.samples())
        self.assertEqual(fit.model, "coulomb_viscous")

    def test_what_a_log_tests_is_identified(self):
        """The station's own friction, known, from noise-free samples of one joint."""
        with tempfile.TemporaryDirectory() as folder:
            scenario = pliant.Scenario.read(
                ROOT / "examples/gen3_friction.yaml",
                set={"station": "!SimulatedArm {position: [0, 0, 0, 0, 0, 0, 0], engine: recursive, friction: ["
                                "{joint: joint_7, coulomb: 0.8, viscous: 0.9}]}",
                     "controller.joints": ["joint_7"], "safety": None})
            sim = pliant.Simulation(scenario)
            sim.run()
            log = Path(folder) / "run.mcap"
            sim.write_log(log)
            fits = pliant.identify_friction(log, model="coulomb_viscous")
            self.assertEqual(list(fits), ["joint_7"])
            e = fits["joint_7"].estimates
            for name, truth in {"coulomb": 0.8, "viscous": 0.9}.items():
                self.assertLess(abs(e[name].value - truth), 4 * e[name].deviation + 0.01)
                self.assertTrue(e[name].low < e[name].value < e[name].high)

    def test_what_is_wrong_is_said(self):
        w, y = self.samples()
        self.says("torque: expected 8000 finite numbers, got shape (3,)", pliant.Error, pliant.fit_friction, w,
                  [1, 2, 3])
        self.says("model: 'auto', or: expected one of 'coulomb_viscous', 'stribeck', 'lugre_static', got 'strieck'; "
                  "did you mean 'stribeck'?", pliant.Error, pliant.fit_friction, w, y, model="strieck")
        with self.assertRaisesRegex(pliant.Error, "^loss: expected one of 'none', 'huber', 'cauchy', got 'l1'"):
            pliant.fit_friction(w, y, loss="l1")
        with self.assertRaises(pliant.Error):
            pliant.fit_friction([1.0], [1.0])
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "run.mcap"
            sim = pliant.Simulation(pliant.Scenario.read(ROOT / "examples/pushed_arm.yaml"))
            sim.write_log(log)
            with self.assertRaisesRegex(pliant.Error, "it is no log of a !FrictionExperiment"):
                pliant.identify_friction(log)


if __name__ == "__main__":
    sys.argv.pop()
    unittest.main()
