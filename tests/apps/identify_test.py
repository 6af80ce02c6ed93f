"""`pliant identify friction` as a user meets it.

    identify_test.py PLIANT
"""

import math
import random
import re

from command import InFolder, main

# Friction of the joints that write_log makes: c, d, s, ω_s.
LAWS = [(3.0, 2.4, 4.5, 0.1), (1.25, 1.1, 1.25, 0.1)]
KAPPA = 11.0


def friction(law, v):
    c, d, s, w = law
    return math.copysign(c + (s - c) * math.exp(-(v / w) ** 2), v) + d * v


class Identify(InFolder):
    WHERE = ["--time", "t", "--velocity", "v{}", "--current", "i{}", "--torque", "tau{}",
             "--torque-per-ampere", KAPPA]

    def refuses_with(self, part, *arguments):
        """The message is longer than its beginning."""
        before = self.files()
        self.assertIn(part, self.ends(2, *arguments))
        self.assertEqual(self.files(), before)

    def write_log(self, name="log.csv", noise=0.05, unit=1.0, laws=LAWS):
        """Steps of the current, 0.4 s each, whose velocity settles within 0.05 s."""
        chance = random.Random(5)
        steps = [sign * 0.02 * 1.35 ** k for k in range(14) for sign in (1, -1)]
        rows = ["t," + ",".join(f"v{j},i{j},tau{j}" for j in range(1, len(laws) + 1))]
        last = 0.0
        for n, level in enumerate(steps):
            for k in range(400):
                t = 0.4 * n + 0.001 * k
                v = level + (last - level) * math.exp(-k / 10)
                cells = []
                for law in laws:
                    current = friction(law, level) / KAPPA
                    tau = KAPPA * current - friction(law, v) if v != 0 else 0
                    cells.append(f"{v * unit:.7g},{current:.7g},{tau + chance.gauss(0, noise):.7g}")
                rows.append(f"{t:.4f}," + ",".join(cells))
            last = level
        self.write(name, "\n".join(rows) + "\n")

    def test_finds_the_friction_of_each_joint(self):
        self.write_log()
        said = self.ends(0, "identify", "friction", "log.csv", *self.WHERE, "--out", "friction.yaml")
        self.assertIn("read: 11200 rows", said)
        self.assertRegex(said, r"joint_1: stribeck, \d+ samples")
        self.assertRegex(said, r"joint_2: coulomb_viscous, \d+ samples")
        text = (self.folder / "friction.yaml").read_text()
        numbers = [float(n) for n in re.findall(r"^    coulomb: (\S+)", text, re.M)]
        self.assertEqual(len(numbers), 2)
        self.assertAlmostEqual(numbers[0], 3.0, delta=0.03)
        self.assertAlmostEqual(numbers[1], 1.25, delta=0.03)

    def test_takes_units_joints_and_a_model(self):
        self.write_log(unit=180 / math.pi)
        self.ends(0, "identify", "friction", "log.csv", *self.WHERE, "--velocity-unit", "deg/s",
                  "--joints", "2", "--model", "coulomb_viscous", "--loss", "huber", "--directions",
                  "separate", "--out", "friction.yaml")
        text = (self.folder / "friction.yaml").read_text()
        self.assertIn('joint: "joint_2"', text)
        self.assertNotIn("joint_1", text)
        self.assertIn("coulomb_negative", text)

    def test_asks_about_units_that_look_wrong(self):
        self.write_log(unit=180 / math.pi)
        done = self.pliant("identify", "friction", "log.csv", *self.WHERE, "--out", "friction.yaml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("joint_1: it turns at up to", done.stderr)
        self.assertIn("is the velocity in deg/s? Then give --velocity-unit deg/s", done.stderr)

    def test_asks_about_a_sign_that_looks_wrong(self):
        self.write_log()
        done = self.pliant("identify", "friction", "log.csv", *self.WHERE, "--torque-unit=-Nm",
                           "--current-unit=-A", "--out", "friction.yaml")
        self.assertIn("has the torque the sign of the current?", done.stderr)

    def test_pools_joints_of_one_size(self):
        self.write_log(laws=[LAWS[0], LAWS[0]])
        said = self.ends(0, "identify", "friction", "log.csv", *self.WHERE, "--pool", "--out", "f.yaml")
        self.assertIn("joint_1, joint_2: stribeck", said)
        text = (self.folder / "f.yaml").read_text()
        numbers = re.findall(r"^    coulomb: (\S+)", text, re.M)
        self.assertEqual(len(numbers), 2)
        self.assertEqual(numbers[0], numbers[1])

    def test_writes_a_report(self):
        self.write_log()
        said = self.ends(0, "identify", "friction", "log.csv", *self.WHERE, "--out", "f.yaml",
                         "--report", "report")
        self.assertIn("report: ", said)
        page = (self.folder / "report/report.html").read_text()
        self.assertIn("Identified friction", page)
        self.assertTrue((self.folder / "report/figures/friction_joint_1.svg").exists())

    def test_refuses_what_is_wrong(self):
        self.write_log()
        out = ["--out", "f.yaml"]
        log = ["identify", "friction", "log.csv"]
        self.refuses_with("Give --robot gen3, or --torque-per-ampere", *log, "--time", "t", *out)
        self.refuses_with("there is no column 'w1' for the velocity; did you mean 'v1'?", *log, "--velocity",
                     "w{}", *self.WHERE[:2], *self.WHERE[4:], *out)
        self.refuses_with("the robot 'gen3' has no joint 'joint_9'", *log, "--robot", "gen3", "--joints", "9",
                     "--time", "t", "--velocity", "v{-8}", "--current", "i{-8}", "--torque", "tau{-8}",
                     *out)
        self.refuses_with("'km/h' is no unit of a velocity", *log, *self.WHERE, "--velocity-unit", "km/h",
                     *out)
        self.refuses_with("--torque-per-ampere wants one number, or one for each of the 2 joints, got 3",
                     *log, *self.WHERE[:-1], "11,11,11", *out)
        self.write("short.csv", "t,v1,i1,tau1\n0,1,1,1\n1,1,1,1\n2,1,1,1\n")
        self.refuses_with("joint_1: a fit of 4 parameters needs at least 40 samples", "identify", "friction",
                     "short.csv", *self.WHERE, *out)
        self.refuses_with("cannot read none.csv: No such file or directory", "identify", "friction",
                     "none.csv", *self.WHERE, *out)
        self.assertFalse((self.folder / "f.yaml").exists())

    def test_one_direction_after_a_noisy_rest_has_the_whole_coulomb(self):
        chance = random.Random(7)
        rows = ["t,v1,i1,tau1"]
        for k in range(5000):
            v = 0 if k < 1000 else 0.6 - 0.55 * math.cos(2 * math.pi * 1e-3 * (k - 1000))
            y = 0 if v == 0 else 3 + 2 * v
            rows.append(f"{0.001 * k:.4f},{v + chance.gauss(0, 0.01):.7g},{y / KAPPA:.7g},"
                        f"{chance.gauss(0, 0.05):.7g}")
        self.write("log.csv", "\n".join(rows) + "\n")
        self.ends(0, "identify", "friction", "log.csv", *self.WHERE, "--out", "f.yaml")
        text = (self.folder / "f.yaml").read_text()
        self.assertNotIn("offset", text)
        self.assertAlmostEqual(float(re.search(r"^    coulomb: (\S+)", text, re.M)[1]), 3.0, delta=0.05)

    def test_a_joint_that_stands_still_ends_nothing(self):
        self.write_log()
        rows = (self.folder / "log.csv").read_text().splitlines()
        still = [rows[0]] + [",".join(row.split(",")[:4] + ["0", "0", "0"]) for row in rows[1:]]
        self.write("log.csv", "\n".join(still) + "\n")
        done = self.pliant("identify", "friction", "log.csv", *self.WHERE, "--out", "f.yaml",
                           "--report", "report")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("friction is not identified: a fit of 4 parameters needs", done.stdout)
        self.assertIn("joint_2: a fit of 4 parameters needs", done.stderr)
        text = (self.folder / "f.yaml").read_text()
        self.assertIn("joint_1", text)
        self.assertNotIn("joint_2", text)
        self.assertTrue((self.folder / "report/figures/friction_joint_2.svg").exists())

    def test_writes_the_model_that_was_fitted(self):
        self.write_log()
        self.ends(0, "identify", "friction", "log.csv", *self.WHERE, "--out", "f.yaml")
        self.assertIn('model: "joint_1: stribeck, joint_2: coulomb_viscous"',
                      (self.folder / "f.yaml").read_text())
        self.ends(0, "identify", "friction", "log.csv", *self.WHERE, "--joints", "1", "--out", "g.yaml")
        self.assertIn('model: "stribeck"', (self.folder / "g.yaml").read_text())

    def test_refuses_drives_that_are_none(self):
        self.write_log()
        log = ["identify", "friction", "log.csv", *self.WHERE[:-2], "--out", "f.yaml"]
        for kappa in ("-11", "nan", "0", "inf"):
            self.refuses_with("--torque-per-ampere must be > 0 N·m/A", *log, "--torque-per-ampere", kappa)
        for inertia in ("-0.4", "nan"):
            self.refuses_with("--reflected-inertia must be ≥ 0 kg·m²", *log, "--torque-per-ampere", "11",
                              f"--reflected-inertia={inertia}")

    def test_writes_no_joint_of_which_nothing_is_left(self):
        self.write_log()
        self.refuses_with("nothing was identified, so nothing was written", "identify", "friction",
                          "log.csv", *self.WHERE, "--torque-unit=-Nm", "--current-unit=-A",
                          "--model", "coulomb_viscous", "--out", "f.yaml")

    def test_writes_over_nothing_without_force(self):
        self.write_log()
        self.write("f.yaml", "mine")
        self.refuses_with("f.yaml", "identify", "friction", "log.csv", *self.WHERE, "--out", "f.yaml")
        self.assertEqual((self.folder / "f.yaml").read_text(), "mine")
        self.ends(0, "identify", "friction", "log.csv", *self.WHERE, "--out", "f.yaml", "--force")
        self.assertIn("joints:", (self.folder / "f.yaml").read_text())


class OwnLog(InFolder):
    """The command on a log of a friction test: a simulated Gen3, joint 5 alone."""

    def test_finds_the_friction_of_the_joints_that_were_tested_and_of_no_other(self):
        self.write("test.yaml", """title: t
summary: s
robot: gen3
station: !SimulatedArm {position: [0, 0, 0, 0, 0, 0, 0], engine: recursive}
controller: !FrictionExperiment
  {joints: [joint_5], speeds: 3, settle_s: 0.3, dwell_s: 0.3, ramp_s: 1, break_aways: 2}
integrator: {method: dormand_prince}
duration_s: 30
""")
        self.ends(0, "run", "test.yaml", "--out", "out")
        told = self.ends(0, "identify", "friction", "out/logs/run.mcap", "--model", "coulomb_viscous", "--out", "f.yaml")
        self.assertIn("rows of a friction test, its steady samples and break-aways", told)
        self.assertNotIn("joint_1", told)
        found = {line.split()[0]: float(line.split()[1]) for line in told.splitlines()
                 if line.startswith(("  coulomb ", "  viscous "))}
        # Half a second at each of six speeds with 0.1 N·m of noise and a drift of the sensor of 0.04 N·m.
        self.assertAlmostEqual(found["coulomb"], 1.25, delta=0.05)
        self.assertAlmostEqual(found["viscous"], 1.1, delta=0.05)
        self.assertIn("the logs test no joint 'joint_6'",
                      self.ends(2, "identify", "friction", "out/logs/run.mcap", "--joints", "joint_6", "--out", "g.yaml"))


if __name__ == "__main__":
    main()
