"""What the identification of dynamics says of a log, what it writes, and what it refuses."""

import math

from command import InFolder, main

NAMES = ["--time", "t", "--position", "q{}", "--velocity", "v{}", "--torque", "tau{}"]
GEN3 = ["--robot", "gen3"]


class IdentifyDynamics(InFolder):
    def setUp(self):
        super().setUp()
        # One hinge about y that swings a rod of 2 kg, its centre 0.5 m out along x.
        self.write("rod.urdf", """<robot name="rod"><link name="base"/>
          <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
            <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
          <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/>
            <axis xyz="0 1 0"/></joint></robot>""")
        self.swing("log.csv")

    def swing(self, name, payload=0.5, columns="t,q1,v1,tau1", amplitude=1.0, seconds=20):
        """The rod with a ball of that mass 1 m out, which turns by amplitude sin 3 t."""
        lines = [columns]
        for k in range(seconds * 200):
            t = 0.005 * k
            q, v, a = amplitude * math.sin(3 * t), 3 * amplitude * math.cos(3 * t), -9 * amplitude * math.sin(3 * t)
            tau = (0.1 + 2 * 0.25 + payload) * a - 9.80665 * (2 * 0.5 + payload) * math.cos(q) + 0.3
            lines.append(f"{t:.4f},{q:.9f},{v:.9f},{tau:.9f}")
        self.write(name, "\n".join(lines) + "\n")

    def identify(self, *more):
        return ["identify", "dynamics", "log.csv", "--urdf", "rod.urdf", *NAMES, *more]

    def test_finds_a_payload_and_writes_it_for_a_scenario(self):
        told = self.ends(0, *self.identify("--payload", "arm", "--out", "tool.yaml"))
        self.assertIn("payload on link arm", told)
        self.assertIn("without effect: payload.m,", told)
        text = (self.folder / "tool.yaml").read_text()
        self.assertIn("payload:\n  link: arm\n  mass: ", text)
        self.assertIn("#   <inertial>\n", text)

    def test_writes_a_urdf_that_explains_the_log(self):
        self.ends(0, *self.identify("--out", "rod_with_ball.urdf"))
        again = ["identify", "dynamics", "log.csv", "--urdf", "rod_with_ball.urdf", *NAMES]
        told = self.ends(0, *again)
        model = next(line for line in told.splitlines() if "model + joint terms" in line)
        self.assertLess(float(model.split()[-1]), 0.01)  # of 15 N·m; it was 5 before

    def test_holds_the_result_against_another_log(self):
        self.swing("other.csv", amplitude=0.6)
        told = self.ends(0, *self.identify("--validate", "other.csv"))
        self.assertIn("of the log that was validated", told)

    def test_refuses_what_it_cannot_use(self):
        self.refuses("expected the robot of the log: either --robot or --urdf",
                     "identify", "dynamics", "log.csv", *NAMES)
        self.refuses("out.txt: expected a file that ends in .yaml or .urdf", *self.identify("--out", "out.txt"))
        self.refuses("out.yaml: a .yaml holds a payload; for the figures of links expected a file that ends in "
                     ".urdf, or --payload", *self.identify("--out", "out.yaml"))
        self.refuses('log.csv: expected 7 joints, those of robot "gen3_7dof", found 1; name them with --joints, in the '
                     "robot's order", "identify", "dynamics", "log.csv", *GEN3, *NAMES)
        self.swing("still.csv", amplitude=0.001)
        self.assertIn("the arm does not move", self.ends(2, "identify", "dynamics", "still.csv", "--urdf",
                                                         "rod.urdf", *NAMES))
        self.swing("short.csv", seconds=1)
        self.assertIn("too few points: expected at least 130", self.ends(
            2, "identify", "dynamics", "short.csv", "--urdf", "rod.urdf", *NAMES))
        self.assertIn("tau1", self.ends(2, "identify", "dynamics", "log.csv", "--urdf", "rod.urdf", "--time", "t",
                                        "--position", "q{}", "--velocity", "v{}", "--torque", "effort{}"))
        # A log that names its joints is one of that robot.
        self.swing("named.csv", columns="t,q[elbow],v[elbow],tau[elbow]")
        named = ["identify", "dynamics", "named.csv", "--urdf", "rod.urdf", "--time", "t", "--position", "q",
                 "--velocity", "v", "--torque", "tau"]
        self.refuses("named.csv: expected joint 'hinge' of robot \"rod\", found 'elbow'; give the robot of the log, or "
                     "with --joints those joints of the log that are the robot's, in its order", *named)
        self.ends(0, *named, "--joints", "elbow")
        self.write("there.urdf", "")
        self.refuses("there.urdf exists; give --force to write over it, or another place",
                     *self.identify("--out", "there.urdf"))

    def test_refuses_before_it_reads(self):
        """A log that is not there is not missed where an option is wrong."""
        lost = ["identify", "dynamics", "lost.csv", "--urdf", "rod.urdf", *NAMES]
        for option in "--prior-deviation", "--window", "--step":
            self.assertIn(f"{option}: Value 0 not in range", self.ends(2, *lost, option, "0"))
        self.assertIn("--step: Value 1e-6 not in range", self.ends(2, *lost, "--step", "1e-6"))
        self.write("there/verdict.json", "mine")
        self.refuses("there/verdict.json exists; give --force to write over it, or another --report",
                     *lost, "--report", "there")
        self.refuses("--report wants a folder, and log.csv is none", *lost, "--report", "log.csv")
        done = self.pliant(*lost, "--report", "new", env={"PATH": ""})
        self.assertEqual((done.returncode, "gnuplot" in done.stderr), (3, True), done.stderr)

    def test_options_with_lists_leave_the_logs_alone(self):
        self.swing("other.csv", amplitude=0.6)
        for option, value in [("--torque", "tau{}"), ("--joints", "1"), ("--links", "arm"), ("--validate", "other.csv"),
                              ("--without", "coulomb,viscous")]:
            names = [name for name in NAMES if name not in (option, value)]
            self.ends(0, "identify", "dynamics", "--urdf", "rod.urdf", *names, option, value, "log.csv", "other.csv")


if __name__ == "__main__":
    main()
