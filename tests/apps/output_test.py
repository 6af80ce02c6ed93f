"""Where logs and reports go: nothing is lost, and strange places are told or served."""

import os
import resource
import subprocess

import command
from command import SHORT, InFolder, main

RUN = ["run", "arm.yaml", *SHORT, "--out"]


class Output(InFolder):
    def test_that_is_there_stays_unless_told(self):
        self.run_short()
        self.refuses("out/report.html exists; give --force to write over it, or another --out", *RUN, "out")
        self.refuses("out/report.html exists; give --force to write over it, or another --out",
                     "report", "out/logs/run.mcap", "--out", "out")
        (self.folder / "out/report.html").unlink()
        self.refuses("out/verdict.json exists; give --force to write over it, or another --out", *RUN, "out")
        (self.folder / "out/verdict.json").unlink()
        self.refuses("out/logs/run.mcap exists; give --force to write over it, or another --out", *RUN, "out")
        self.ends(0, *RUN, "out", "--force")
        self.assertEqual(sorted(str(f.relative_to(self.folder)) for f in self.files()),
                         ["arm.yaml", "out", "out/logs", "out/logs/run.mcap", "out/report.html",
                          "out/verdict.json"])

    def test_goes_wherever_a_path_leads(self):
        (self.folder / "real").mkdir()
        os.symlink("real", self.folder / "link")
        for place in ("a b", "ö/ü", "c/../d", "link", ".", str(self.folder / "abs"), "--x"):
            out = [f"--out={place}"] if place.startswith("-") else ["--out", place]
            told = self.ends(0, *RUN[:-1], *out)
            self.assertEqual(told, f"report: {os.path.normpath(self.folder / place)}/report.html\n")
            self.assertTrue((self.folder / place / "logs/run.mcap").exists(), place)
        self.assertTrue((self.folder / "link").is_symlink())

    def test_that_cannot_be_is_told_before_anything_runs(self):
        self.write("file", "")
        os.symlink("nowhere", self.folder / "dangling")
        long = "x" * 300
        for place, reason in [("file", "Not a directory"), ("file/a", "Not a directory"),
                              ("dangling", "File exists"), (long, "File name too long"),
                              ("/proc/x", "No such file or directory"), ("/dev/null", "Not a directory")]:
            self.refuses(f"cannot make the directory {place}/logs: {reason}", *RUN, place)

    def test_that_a_log_cannot_be_written_to_ends_with_3(self):
        (self.folder / "out/logs/run.mcap").mkdir(parents=True)
        said = self.ends(3, *RUN, "out", "--force")
        self.assertRegex(said, r"pliant: out/logs/run.mcap: cannot write .*/out/logs/run.mcap: Is a directory\n$")

    def test_writes_over_the_log_that_a_link_leads_to(self):
        (self.folder / "out/logs").mkdir(parents=True)
        self.write("kept.mcap", "old")
        os.symlink("../../kept.mcap", self.folder / "out/logs/run.mcap")
        self.ends(0, *RUN, "out", "--force")
        self.assertTrue((self.folder / "out/logs/run.mcap").is_symlink())
        self.ends(0, "log", "info", "kept.mcap")

    def test_of_a_pad_stays_until_the_new_recording_is_whole(self):
        self.write("pad.yaml", "events: []  # mine\n")
        pad = ["pad", "--seconds", "0.05", "--record", "pad.yaml"]
        self.refuses("pad.yaml exists; give --force to write over it, or another place", *pad)
        half = 5  # bytes of each file
        half_fits = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (half, half))}
        self.assertIn("pliant: cannot write pad.yaml: File too large",
                      self.ends(3, *pad, "--force", **half_fits))
        self.assertEqual((self.folder / "pad.yaml").read_text(), "events: []  # mine\n")
        self.ends(0, *pad, "--force")
        self.assertEqual((self.folder / "pad.yaml").read_text(), "events: []\n")
        self.assertFalse((self.folder / "pad.yaml.part").exists())

    def test_of_two_at_once_is_that_of_one(self):
        both = [self.start(*RUN, "out") for _ in range(2)]
        said = [process.communicate(timeout=30) for process in both]
        codes = sorted(process.returncode for process in both)
        self.assertIn(codes, ([0, 2], [0, 3]), said)
        self.assertIn("exists; give --force to write over it, or another", said[0][1] + said[1][1])
        self.ends(0, "log", "info", "out/logs/run.mcap")

    def test_of_one_log_in_two_reports_is_the_same(self):
        self.run_short()
        for name in ("one", "two"):
            self.ends(0, "report", "out/logs/run.mcap", "--out", name)
        self.assertEqual((self.folder / "one/report.html").read_bytes(),
                         (self.folder / "two/report.html").read_bytes())

    def test_of_a_report_that_cannot_be_is_told(self):
        self.run_short()
        for place, reason in [("arm.yaml", "Not a directory"), ("/proc/x", "No such file or directory")]:
            self.refuses(f"cannot make the directory {place}: {reason}",
                         "report", "out/logs/run.mcap", "--out", place)

    def test_of_two_experiments_is_no_report(self):
        self.run_short("one")
        self.ends(0, *RUN, "two", "--set", "controller.observer_gain=60")
        self.refuses("two/logs/run.mcap: the log is of another experiment than one/logs/run.mcap",
                     "report", "one/logs/run.mcap", "two/logs/run.mcap", "--out", "report")
        self.refuses("repetition 0 has 2 logs of run 'run'; a report needs one of each run",
                     "report", "one/logs/run.mcap", "one/logs/run.mcap", "--out", "report")

    def test_that_may_not_be_written_is_told(self):
        self.folder.chmod(0o500)
        self.addCleanup(self.folder.chmod, 0o700)
        # Who is root may do everything, unless told otherwise.
        held = ["setpriv", "--bounding-set=-dac_override"] if os.geteuid() == 0 else []
        done = subprocess.run([*held, command.pliant_file, *RUN, "out"], cwd=self.folder,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr, "pliant: cannot make the directory out/logs: Permission denied\n")

    def test_with_few_open_files_is_still_written(self):
        self.ends(0, *RUN, "out", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (16, 16)))


if __name__ == "__main__":
    main()
