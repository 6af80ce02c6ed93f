"""What is left of a run that is stopped, killed, or whose disk is full."""

import re
import resource
import signal
import time

from command import InFolder, main

LONG = ["--set", "duration_s=1e5"]


class Interruption(InFolder):
    def grown(self, log, size=300000):
        """Waits until the file has that many bytes."""
        end = time.monotonic() + 30
        while not log.exists() or log.stat().st_size < size:
            self.assertLess(time.monotonic(), end, "the log does not grow")
            time.sleep(0.01)

    def last_time(self, log):
        """Log time of the last message [s]."""
        told = self.pliant("log", "info", log).stdout
        return float(re.search(r"messages from 0 s to ([\d.]+) s", told)[1])

    def stopped(self, by):
        """A run that was sent a signal: what it said, and its log."""
        process = self.start("run", "arm.yaml", *LONG, "--out", by.name)
        log = self.folder / by.name / "logs/run.mcap"
        self.grown(log)
        process.send_signal(by)
        told, said = process.communicate(timeout=10)
        self.assertEqual(told, "")
        return process.returncode, said, log

    def test_stops_at_a_signal_and_leaves_a_whole_log(self):
        for by in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(by.name):
                code, said, log = self.stopped(by)
                self.assertEqual(code, 130)
                self.assertEqual(said, f"stopped; what was logged:\n  {by.name}/logs/run.mcap\n")
                told = self.ends(0, "log", "info", log)
                self.assertIn("whole       yes\n", told)
                self.assertIn("pliant.run  whole: 0\n", told)
                rows = re.search(r"statistics rows: (\d+)\n", told)[1]
                self.assertIn(f"pliant.run  ticks: {rows}\n", told)
                self.assertIn("identical: 13 signals", self.ends(0, "replay", log))
                self.refuses(f"{log}: the run ended at {self.last_time(log):.10g} s of 100000 s; "
                             "a report needs whole runs", "report", log, "--out", "report")

    def test_stops_all_runs_that_are_under_way(self):
        self.write("arm.yaml", self.scenario + "runs:\n" +
                   "".join(f"  - {{name: {name}, title: {name}}}\n" for name in ("one", "two", "three")))
        process = self.start("run", "arm.yaml", *LONG, "--out", "out", "--jobs", "2")
        self.grown(self.folder / "out/logs/one.mcap")
        self.grown(self.folder / "out/logs/two.mcap")
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=10)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(said, "stopped; what was logged:\n  out/logs/one.mcap\n  out/logs/two.mcap\n")
        self.assertFalse((self.folder / "out/logs/three.mcap").exists())
        for name in ("one", "two"):
            self.ends(0, "log", "info", f"out/logs/{name}.mcap")

    def test_goes_on_at_a_hangup_if_that_is_ignored(self):
        process = self.start("run", "arm.yaml", *LONG, "--out", "out",
                             preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        log = self.folder / "out/logs/run.mcap"
        self.grown(log)
        process.send_signal(signal.SIGHUP)
        self.grown(log, log.stat().st_size + 1000000)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=10), 130)

    def test_loses_a_second_at_most_when_killed(self):
        process = self.start("run", "arm.yaml", *LONG, "--out", "out")
        log = self.folder / "out/logs/run.mcap"
        # The first line comes after 10 s.
        a_second_before = float(re.search(r"([\d.]+) of 100000", process.stderr.readline())[1])
        time.sleep(1)
        process.kill()
        process.communicate()
        self.assertGreater(a_second_before, 0)
        self.assertGreater(self.last_time(log), a_second_before)

        info = self.pliant("log", "info", log)
        self.assertEqual(info.returncode, 1)
        self.assertRegex(info.stdout, r"whole       no: .*: at byte \d+: .*\n\d+ messages, from 0 s to [\d.]+ s, "
                                      r"can be read before it; `pliant log repair .*` makes a whole log")
        self.assertIn("can be read before it", self.ends(2, "report", log, "--out", "report"))
        self.assertRegex(self.ends(0, "log", "repair", log, "whole.mcap"), r"^kept \d+ messages in \d+ chunks\n")
        self.assertIn("whole       yes\n", self.ends(0, "log", "info", "whole.mcap"))
        self.assertEqual(self.last_time("whole.mcap"), self.last_time(log))
        self.assertRegex(self.ends(0, "replay", "whole.mcap"), r"^identical: 13 signals over \d+ rows, 0 s to ")
        self.assertRegex(self.ends(2, "report", "whole.mcap", "--out", "report"),
                         r"^pliant: whole.mcap: the run ended at [\d.]+ s of 100000 s; a report needs whole runs\n$")

    def test_ends_with_3_when_the_disk_is_full_and_at_once(self):
        self.write("arm.yaml", self.scenario +
                   "runs:\n  - {name: short, title: s, set: {duration_s: 0.3}}\n"
                   "  - {name: long, title: l, set: {duration_s: 1e5}}\n")
        room = 2000000  # bytes, for each file
        done = self.pliant("run", "arm.yaml", "--out", "out", timeout=20,
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, r"\npliant: out/logs/long.mcap: cannot write out/logs/long.mcap: File too large\n"
                                      r"\d+ of \d+ rows are missing; those before them can be read\n$")
        self.ends(0, "log", "info", "out/logs/short.mcap")
        self.assertEqual(self.pliant("log", "info", "out/logs/long.mcap").returncode, 1)
        self.ends(0, "log", "repair", "out/logs/long.mcap", "whole.mcap")
        self.assertIn("identical: 13 signals", self.ends(0, "replay", "whole.mcap"))

    def test_ends_with_3_when_the_report_has_no_room(self):
        room = 400000  # bytes: for the log, not for the page
        done = self.pliant("run", "arm.yaml", "--set", "duration_s=0.2", "--out", "out",
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("\npliant: cannot write out/report.html: File too large\n", done.stderr)
        self.assertEqual([f.name for f in (self.folder / "out").iterdir()], ["logs"])
        self.ends(0, "report", "out/logs/run.mcap", "--out", "out")


if __name__ == "__main__":
    main()
