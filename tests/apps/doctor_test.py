"""`pliant doctor` on the machine that runs the tests, which need not be one for an arm."""

import os
import re
import socket

from command import InFolder, main


class Doctor(InFolder):
    def test_writes_a_line_for_each_check_and_finds_nothing_missing(self):
        told = self.ends(0, "doctor")
        lines = told.splitlines()
        subjects = [line[9:27].strip() for line in lines]
        self.assertEqual(subjects, ["gnuplot", "dot", "models", "experiments", "page of a report", "output",
                                    "SCHED_FIFO", "locked memory", "waking", "kernel", "frequency",
                                    "processors", "clock", "arm"])
        for line in lines:
            self.assertRegex(line, r"^(ok      |note    ) ")
        self.assertRegex(told, r"waking +late by \d+ us in the middle, \d+ us at worst, of 500 times")
        self.assertEqual([f.name for f in self.files()], ["arm.yaml"])

    def missing(self, subject, *words, **options):
        done = self.pliant("doctor", *words, **options)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        found = re.search(rf"^missing  {subject} +(.*)$", done.stdout, re.M)
        self.assertTrue(found, done.stdout)
        return found[1]

    def test_misses_what_simulation_needs(self):
        self.assertIn("install the Debian package gnuplot-nox", self.missing("gnuplot", env={"PATH": ""}))
        self.assertIn("install the Debian package graphviz", self.missing("dot", env={"PATH": ""}))
        environment = {**os.environ, "PLIANT_SHARE": "/none"}
        for subject in ("models", "experiments", "page of a report"):
            self.assertIn("set PLIANT_SHARE", self.missing(subject, env=environment))
        self.assertTrue(self.missing("output", "--out", "arm.yaml/x").startswith(
            f"{self.folder}/arm.yaml/x cannot be written to: Not a directory; "))
        self.assertIn("cannot be written to: File name too long; ", self.missing("output", "--out", "x" * 300))
        for option in ("--out", "--arm"):
            self.assertEqual(self.pliant("doctor", option, "").returncode, 2)

    def test_tries_an_arm_that_is_named(self):
        with socket.create_server(("127.0.0.1", 0)) as arm:
            address = f"127.0.0.1:{arm.getsockname()[1]}"
            told = self.pliant("doctor", "--arm", address).stdout
            self.assertRegex(told, rf"\nok       arm +{address} answered in \d+ us by TCP\n")
            self.assertRegex(told, rf"\nmissing  arm session +{address} did not answer CreateSession for user 'admin' "
                                   "within 2 s; ")
        self.assertIn(f"{address}: Connection refused; ", self.missing("arm", "--arm", address))
        self.refuses("--arm: an arm's address is such as 192.168.1.10 or 192.168.1.10:10000, got 'a:b'",
                     "doctor", "--arm", "a:b")


if __name__ == "__main__":
    main()
