"""The examples that run an arm, on an emulated one, and what docs/hardware.md says of them."""

import re
import subprocess

import command
from command import InFolder, main
from emulated import Emulated

UPRIGHT = ("--position", *"0000000")
PLACE = r"127\.0\.0\.1:\d+"


class Hardware(InFolder):
    def on_arm(self, code, example, *more, options=()):
        """What a run of an example says: on the standard output and error."""
        with Emulated(command.pliant_file, *options) as arm:
            done = self.pliant("run", command.ROOT / f"examples/{example}.yaml", "--arm", arm.address,
                               "--set", "station.lock_step=true", "--out", example, *more)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout, done.stderr

    def test_an_arm_holds_in_its_own_position_mode(self):
        told, said = self.on_arm(0, "gen3_hold")
        self.assertRegex(told, r"^ended: stopped\n")
        # An arm that stands still holds for a moment, which need not be seen.
        self.assertRegex(said, "running\n(holding: its time is over\n)?stopped: its time is over\n")
        self.assertIn("identical", self.ends(0, "replay", "gen3_hold/logs/run.mcap"))

    def test_an_arm_is_compliant_in_every_mode_that_takes_torques(self):
        for mode in ("torque_high_velocity", "torque", "current"):
            told, _ = self.on_arm(0, "gen3_compliance", "--set", f"schedule=[{{at_s: 0, mode: {mode}}}]", "--force")
            self.assertRegex(told, r"^ended: stopped\n", mode)

    def test_friction_is_identified_from_the_log_of_an_arm(self):
        self.on_arm(0, "gen3_friction", options=UPRIGHT)
        said = self.ends(0, "identify", "friction", "gen3_friction/logs/run.mcap", "--robot", "gen3",
                         "--out", "friction.yaml")
        # models/gen3/actuators.yaml: a small one. 2 %: the elasto-plastic law is not quite Coulomb's
        # at these speeds, beside the intervals that are printed, of 0.7 %.
        for term, value in (("coulomb", 1.25), ("viscous", 1.1)):
            found = float(re.search(rf"{term} +([\d.]+)  from", said)[1])
            self.assertLess(abs(found - value), 0.02 * value, term)
        self.ends(0, "run", command.ROOT / "examples/gen3_compliance.yaml",
                  "--set", f"station.friction={self.folder}/friction.yaml", "--check")
        with Emulated(command.pliant_file) as arm:
            self.ends(0, "run", command.ROOT / "examples/gen3_compliance.yaml", "--arm", arm.address, "--check",
                      "--set", f"station.friction={self.folder}/friction.yaml")

    def test_a_fault_is_told_with_its_unit_and_what_to_do(self):
        told, said = self.on_arm(3, "gen3_compliance", options=("--fault", "torque_jump@1+0.1:2"))
        self.assertRegex(said, r"holding: torque_jump at joint 2: [\d.]+ N·m, allowed 19 N·m in a tick\n")
        self.assertIn("what to do: did it hit something?", told)
        told, said = self.on_arm(3, "gen3_compliance", "--force", options=("--fault", "actuator_fault@1+0.1:3"))
        self.assertIn("joint 3 reports MOTOR_DRIVER_FAULT\n", told)
        self.assertRegex(told, rf"pliant recover gen3 --arm {PLACE},\d+ --clear-faults\n")
        self.assertIn("not done: the mode of joint 1: ", told)

    def test_an_arm_that_is_not_there_or_lets_nobody_in_ends_with_3(self):
        self.assertRegex(self.ends(3, "run", "arm.yaml", "--set", "environment=[]", "--set", "station.frozen_after=0",
                                   "--arm", "127.0.0.1:9", "--out", "out"),
                         r"cannot reach an arm at 127\.0\.0\.1:9: Connection refused")
        example = command.ROOT / "examples/gen3_hold.yaml"
        with Emulated(command.pliant_file, "--user", "eve", "--password", "pear") as arm:
            self.assertIn("user and password are those of the arm's web page: --user and --password",
                          self.ends(3, "run", example, "--arm", arm.address, "--out", "a"))
            self.ends(0, "run", example, "--arm", arm.address, "--user", "eve", "--password", "pear",
                      "--set", "station.lock_step=true", "--set", "duration_s=0.1", "--out", "b")
        server = subprocess.Popen(["python3", "-uc", "import socket; s = socket.socket(); s.bind(('127.0.0.1', 0));"
                                   "s.listen(); print(s.getsockname()[1]); c, _ = s.accept(); c.recv(99);"
                                   "c.sendall(b'HTTP/1.0 400\\r\\n' * 9); c.recv(99)"], stdout=subprocess.PIPE, text=True)
        self.addCleanup(server.communicate)
        self.addCleanup(server.kill)
        self.assertIn("is this the port of a Kinova Gen3's services? It is 10000 from the factory",
                      self.ends(3, "run", example, "--arm", f"127.0.0.1:{server.stdout.readline().strip()}",
                                "--out", "c"))

    def test_what_an_arm_cannot_be_told_is_refused_before_it_is_reached(self):
        example = command.ROOT / "examples/gen3_hold.yaml"
        for message, *words in [
                ("an arm's address is such as 192.168.1.10 or 192.168.1.10:10000, got '1.2.3.4:x'",
                 "--arm", "1.2.3.4:x"),
                ("there is no run 'rn'; did you mean 'run'?", "--arm", "127.0.0.1:9", "--run", "rn"),
                ("there is no 'ideal' here", "--arm", "127.0.0.1:9", "--set", "station.ideal=true"),
                ("there is no 'adress' here; did you mean 'address'?", "--set", "station=!Gen3 {adress: a}"),
                ("there is no !Gen4 here; did you mean 'Gen3'?", "--set", "station=!Gen4 {}"),
                ("there is no !Botta here; did you mean 'Bota'?", "--set", "station=!Gen3 {wrist: !Botta {device: x}}"),
                ("'device' is missing", "--set", "station=!Gen3 {wrist: !Bota {}}"),
                ("'host' is missing", "--set", "station=!Gen3 {wrist: !Rdt {}}"),
                ("port must be from 1 to 65535, got 0", "--set", "station=!Gen3 {wrist: !Rdt {host: a, port: 0}}"),
                ("counts_per_newton must be > 0 1/N, got 0",
                 "--set", "station=!Gen3 {wrist: !Rdt {host: a, counts_per_newton: 0}}"),
                ("frozen_after must be from 0 to 1000000, got -1", "--set", "station=!Gen3 {frozen_after: -1}"),
                ("expected true or false, got '5'", "--set", "station=!Gen3 {lock_step: 5}"),
                ("there is no 'torque_lmit' here; did you mean 'torque_limit'?", "--set", "safety.torque_lmit=1"),
                ("stale_after must be from 1 to 1000000, got 0", "--set", "safety.stale_after=0"),
                ("torque_jump must be > 0, got -1", "--set", "safety.torque_jump=-1"),
                ("expected a number [°C], got 'hot'", "--set", "safety.temperature=hot"),
                ("engage_s must be > 0 s, got 0", "--set", "safety.engage_s=0"),
                ("damping", "--set", "safety.damping=[1, 2]"),
                ("expected robot gen3 or gen3_bota, got 'lwr'", "--arm", "127.0.0.1:9", "--set", "robot=lwr",
                 "--set", "controller.tool=end_effector_link"),
                ("leave payload out", "--arm", "127.0.0.1:9", "--set", "payload={link: tool_frame, mass: 1}"),
                ("leave position_scatter out", "--arm", "127.0.0.1:9", "--set", "position_scatter=0.1"),
                ("log_period must be the controller's period", "--arm", "127.0.0.1:9", "--set", "log_period=2 ms"),
                ("an arm does one run at a time", "--arm", "127.0.0.1:9", "--repeat", "2")]:
            with self.subTest(message):
                self.assertIn(message, self.ends(2, "run", example, *words, "--out", "out"))
        self.assertNotEqual(self.ends(2, "run", example, "--arm", "", "--out", "out"), "")


if __name__ == "__main__":
    main()
