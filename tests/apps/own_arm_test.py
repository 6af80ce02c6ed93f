"""Arms that do not come with pliant, as a user meets them."""

import re

from command import ROOT, InFolder, main

SHORT = ["--set", "duration_s=0.1", "--set", "environment=[]"]


class OwnArm(InFolder):
    def setUp(self):
        super().setUp()
        self.urdf = (ROOT / "examples/own_arm.urdf").read_text()
        self.own = (ROOT / "examples/own_arm.yaml").read_text()
        self.write("in/own_arm.urdf", self.urdf)
        self.write("in/own.yaml", self.own)
        self.actuators = re.sub(r"(?s)\njoints:.*", "\njoints: {turn: large, shoulder: large, elbow: small}\n",
                                (ROOT / "models/gen3/actuators.yaml").read_text())
        self.write("in/drives.yaml", self.actuators)
        self.driven = self.own.replace("engine: recursive", "engine: recursive, actuators: drives.yaml")

    def refuses_file(self, text, message):
        self.write("in/own.yaml", text)
        self.refuses(message, "run", "in/own.yaml", "--check")

    def test_a_log_needs_no_other_file(self):
        self.write("in/own.yaml", self.driven)
        self.ends(0, "run", "in/own.yaml", *SHORT, "--out", "out")
        for file in ("own_arm.urdf", "own.yaml", "drives.yaml"):
            (self.folder / "in" / file).unlink()
        self.assertIn("identical", self.ends(0, "replay", "out/logs/run.mcap"))
        self.ends(0, "report", "out/logs/run.mcap", "--out", "again")
        self.assertIn("<b>qp</b>", self.ends(0, "graph", "out/logs/run.mcap"))

    def test_is_ideal_without_actuators(self):
        self.assertNotIn("ElasticTransmission", self.ends(0, "graph", "in/own.yaml"))
        self.write("in/own.yaml", self.driven)
        self.assertIn("ElasticTransmission", self.ends(0, "graph", "in/own.yaml"))

    def test_starts_at_zero_or_at_the_nearest_limit(self):
        self.write("in/own.yaml", self.own.replace("position: [0, 0.5, 1.2], ", ""))
        self.ends(0, "run", "in/own.yaml", *SHORT, "--out", "out")
        self.ends(0, "export", "out/logs/run.mcap", "out.csv", "--signal", "arm.position")
        first = (self.folder / "out.csv").read_text().splitlines()[1]
        self.assertEqual([float(x) for x in first.split(",")], [0, 0, 0, 0.2])

    def test_keeps_links_apart_that_no_joint_connects(self):
        self.write("in/own.yaml", self.own.replace("posture: {compliance: 1}", "collisions: {}"))
        self.ends(0, "run", "in/own.yaml", *SHORT, "--out", "out")
        info = self.ends(0, "log", "info", "out/logs/run.mcap")
        self.assertIn("/control/distance", info)

    def test_set_names_a_file_from_here(self):
        self.ends(0, "run", "in/own.yaml", "--check", "--set", "robot=in/own_arm.urdf")
        self.assertTrue(
            self.ends(2, "run", "in/own.yaml", "--check", "--set", "robot=own_arm.urdf").startswith(
                "pliant: --set robot=own_arm.urdf: own_arm.urdf: cannot read this file; expected a URDF file"))

    def test_what_is_wrong_is_shown_with_its_place(self):
        self.write("in/own.yaml", self.own.replace("own_arm.urdf", "none.urdf"))
        self.assertTrue(self.ends(2, "run", "in/own.yaml", "--check").startswith(
            "pliant: in/own.yaml:4:8: in/none.urdf: cannot read this file; expected a URDF file"))
        self.refuses_file(self.own.replace("own_arm.urdf", "gen4"),
                          "in/own.yaml: run 'run': there is no robot 'gen4'; did you mean 'gen3'?\n"
                          "  known: gen3, gen3_bota, lwr, or a file that ends in .urdf")
        self.write("in/drives.yaml", self.actuators.replace("elbow: small", "elbw: small"))
        self.write("in/own.yaml", self.driven)
        error = self.ends(2, "run", "in/own.yaml", "--check")
        self.assertRegex(error, r"^pliant: in/own\.yaml:5:\d+: in/drives\.yaml:\d+:\d+: there is no 'elbw' here; "
                                r"did you mean 'elbow'\?")
        self.write("in/own_arm.urdf", self.urdf.replace('<child link="forearm"/>', '<child link="fore"/>'))
        self.write("in/own.yaml", self.own)
        self.assertRegex(self.ends(2, "run", "in/own.yaml", "--check"),
                         r"^pliant: in/own\.yaml:4:8: in/own_arm\.urdf:\d+")


if __name__ == "__main__":
    main()
