"""A scenario on an emulated arm, as processes on a network: started, stopped, killed."""

import re
import signal
import time

from command import InFolder, main

# The machine may be busy: its own lateness is not what these are about.
ARM = """\
title: A held arm
summary: Of a test.
robot: gen3
station: !SimulatedArm {engine: recursive}
controller: !Compliance {tool: tool_frame}
safety: {stale_after: 2000, most_missed: 100000, engage_s: 60}
duration_s: 60
"""


class ArmRun(InFolder):
    def setUp(self):
        super().setUp()
        self.write("held.yaml", ARM)

    def emulator(self, *options):
        """An arm, and its address."""
        process = self.start("emulate", "gen3", "--port", "0", "--udp-port", "0", *options)
        line = process.stdout.readline()
        found = re.fullmatch(r"listening on ([\d.]+):(\d+), UDP (\d+)\n", line)
        self.assertTrue(found, line)
        return process, f"{found[1]}:{found[2]},{found[3]}"

    def run_on(self, address, *options):
        return self.start("run", "held.yaml", "--arm", address, "--out", "out", *options)

    def wait_for(self, process, word):
        """Reads the standard error up to a line with that word."""
        told = []
        for line in process.stderr:
            told.append(line)
            if word in line:
                return "".join(told)
        self.fail(f"no line with {word!r}:\n{''.join(told)}")

    def state(self, address):
        """What the arm is found in by who comes next, and is brought back from."""
        return self.ends(0, "recover", "gen3", "--arm", address).splitlines()

    def is_handed_back(self, address):
        """One whose frames ended before it was handed back may have a fault of its own."""
        return self.state(address)[0].endswith(", SINGLE_LEVEL_SERVOING")

    def test_is_stopped_by_ctrl_c_and_hands_the_arm_back(self):
        _, address = self.emulator()
        run = self.run_on(address)
        self.wait_for(run, "running")
        run.send_signal(signal.SIGINT)
        told, said = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 0, said + told)
        self.assertIn("damped: asked to stop\n", said)
        self.assertIn("ended: stopped\n", told)
        self.assertIn("log: out/logs/run.mcap\n", told)
        self.assertEqual(self.state(address)[0],
                         "found: ARMSTATE_SERVOING_READY, SINGLE_LEVEL_SERVOING")
        self.ends(0, "log", "info", "out/logs/run.mcap")

    def test_a_second_ctrl_c_does_not_leave_the_arm_alone(self):
        _, address = self.emulator()
        run = self.run_on(address)
        self.wait_for(run, "running")
        run.send_signal(signal.SIGINT)
        self.wait_for(run, "damped")
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=60)
        deadline = time.monotonic() + 30
        while not self.is_handed_back(address):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.2)

    def test_a_guard_hands_the_arm_back_when_the_run_is_killed(self):
        _, address = self.emulator()
        run = self.run_on(address)
        self.wait_for(run, "running")
        time.sleep(1)  # rows that are on the disk
        run.kill()
        said = run.stderr.read()  # until the guard has ended too
        self.assertRegex(said, r"pliant: the process that ran the arm at 127\.0\.0\.1:\d+ is gone; "
                               r"the arm was set to single-level servoing\n")
        self.assertTrue(self.is_handed_back(address))
        self.ends(0, "log", "repair", "out/logs/run.mcap", "whole.mcap")
        self.assertIn("/safety/report ", self.ends(0, "log", "info", "whole.mcap"))

    def test_a_run_without_a_fault_is_whole_in_lock_step(self):
        _, address = self.emulator("--lock-step")
        station = f"station: !Gen3 {{address: '{address}', lock_step: true}}"
        self.write("held.yaml", ARM.replace("station: !SimulatedArm {engine: recursive}", station)
                   .replace("duration_s: 60", "duration_s: 0.5"))
        told = self.ends(0, "run", "held.yaml", "--out", "out")
        self.assertIn("ended: stopped\n", told)
        for part in ("control", "safety"):
            self.assertIn("identical", self.ends(0, "replay", "out/logs/run.mcap", "--part", part))
        self.assertIn("all blocks: ", self.ends(0, "graph", "out/logs/run.mcap"))  # what they cost
        self.assertTrue(self.is_handed_back(address))

    def test_ends_with_code_3_after_a_fault(self):
        _, address = self.emulator("--fault", "emergency_stop@1+1")
        run = self.run_on(address)
        told, said = run.communicate(timeout=120)
        self.assertEqual(run.returncode, 3, said + told)
        self.assertRegex(told, "ended: stopped, because of (arm_fault|joint_fault|not_connected)")

    def test_says_that_there_is_no_arm(self):
        emulator, address = self.emulator()
        emulator.send_signal(signal.SIGINT)
        emulator.communicate(timeout=30)
        told = self.ends(3, "run", "held.yaml", "--arm", address, "--out", "out")
        self.assertRegex(told, r"pliant: cannot reach an arm at 127\.0\.0\.1:\d+: ")

    def test_refuses_what_is_no_address(self):
        self.refuses("an arm's address is such as 192.168.1.10 or 192.168.1.10:10000, got 'a:b'",
                     "run", "held.yaml", "--arm", "a:b", "--out", "out")

    def test_recovers_an_arm_that_is_in_fault(self):
        _, address = self.emulator("--fault", "actuator_fault@0.5+0.1:3")
        run = self.run_on(address)
        run.communicate(timeout=120)
        self.assertEqual(run.returncode, 3)
        told = self.ends(0, "recover", "gen3", "--clear-faults", "--arm", address)
        self.assertIn("MOTOR_DRIVER_FAULT", told)
        self.assertTrue(told.endswith("now: ARMSTATE_SERVOING_READY, SINGLE_LEVEL_SERVOING\n"), told)


if __name__ == "__main__":
    main()
