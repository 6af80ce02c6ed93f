"""Scenario files, experiments and help, as a user meets them."""

import json
import os
import re
import subprocess
import time

import command
from command import SHORT, InFolder, main

KEYS = ("title, summary, robot, station, payload, model_error, assumed_friction, controller, schedule, safety, environment, "
        "integrator, duration_s, seed, position_scatter, log_period, stop_when, repeat, runs, claims, figures, tables, "
        "numbers")
CLAIM = """
claims:
  - !{tag} {{id: a, source: nobody, paper: nothing, run: {run}}}
"""


class Help(InFolder):
    COMMANDS = [["run"], ["experiment", "list"], ["experiment", "run"], ["report"], ["schema"], ["replay"],
                ["export"], ["graph"], ["log", "info"], ["log", "repair"], ["sweep"], ["merge"], ["rerun"],
                ["doctor"], ["pad"]]

    def examples(self):
        for words in [[], *self.COMMANDS]:
            text = self.ends(0, *words, "--help")
            found = re.search(r"^Example: (pliant .*)$", text, re.M)
            self.assertTrue(found, words)
            self.assertTrue(found[1].startswith(" ".join(["pliant", *words])), found[1])
            yield found[1]

    def test_has_an_example_of_every_command_that_runs(self):
        stiff = self.scenario.replace("duration_s: 1\n", "duration_s: 0.1\n")
        self.write("my_arm.yaml", stiff + "runs:\n  - {name: stiff, title: stiff}\n"
                   "numbers:\n  - {name: fastest, title: fastest, signal: arm.velocity}\n")
        os.symlink(command.pliant_file, self.folder / "pliant")
        environment = {**os.environ, "PATH": f"{self.folder}:{os.environ['PATH']}"}
        ran = 0
        for example in self.examples():
            # These two take long or ask for an arm; documents_test.py runs the first.
            if "null-space-compliance" in example or "--arm" in example:
                continue
            if " repair " in example:
                log = (self.folder / "out/logs/stiff.mcap").read_bytes()
                (self.folder / "cut.mcap").write_bytes(log[:-100])
            force = " --force" if example.startswith("pliant run") else ""
            done = subprocess.run(["bash", "-c", example + force], cwd=self.folder, env=environment,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, f"{example}\n{done.stderr}")
            ran += 1
        self.assertEqual(ran, 14)

    def test_says_the_version_and_the_exit_codes(self):
        self.assertRegex(self.ends(0, "--version"), r"^\d+\.\d+\.\d+\n$")
        self.assertIn("Exit codes: 0 it ran; 1 ", self.ends(0, "--help"))

    def test_wrong_use_ends_with_2(self):
        for words in ([], ["experiment"], ["run"], ["run", "arm.yaml", "--out", "x", "--none"], ["log"],
                      ["run", "arm.yaml", "--out", ""], ["run", "", "--out", "x"], ["report", "--out", "x"],
                      ["run", "arm.yaml", "--out", "x", "--jobs", "0"],
                      ["run", "arm.yaml", "--out", "x", "--repeat", "0"],
                      ["run", "arm.yaml", "--out", "x", "--repeat", "two"]):
            self.assertNotEqual(self.ends(2, *words), "", words)
        self.assertEqual(len(self.files()), 1)

    def test_a_command_that_is_not_there_is_named_with_the_nearest(self):
        for words, message in [(["rn"], "there is no command 'rn'; did you mean 'run'?"),
                               (["experiment", "lst"], "there is no command 'lst'; did you mean 'list'?"),
                               (["log", "inf", "x"], "there is no command 'inf'; did you mean 'info'?")]:
            self.refuses(message + "\n`pliant --help` names them", *words)

    def test_what_cannot_be_printed_ends_with_3(self):
        with open("/dev/full", "w") as full:
            done = self.pliant("schema", stdout=full, stderr=subprocess.PIPE, capture_output=False)
        self.assertEqual(done.returncode, 3)
        self.assertEqual(done.stderr, "pliant: cannot write to the standard output; "
                                      "is its disk full?\n")

    def test_the_schema_is_json_and_knows_the_keys(self):
        schema = json.loads(self.ends(0, "schema"))
        self.assertEqual(", ".join(schema["properties"]), KEYS)


class ScenarioFile(InFolder):
    def check(self, text, message):
        self.write("arm.yaml", text)
        self.refuses(message, "run", "arm.yaml", "--out", "out")

    def set(self, value, message):
        self.refuses(f"--set {value}: {message}", "run", "arm.yaml", "--out", "out", "--set", value)

    def test_a_wrong_key_is_shown_with_its_place_and_the_nearest(self):
        self.check(self.scenario.replace("summary", "sumary"),
                   f"arm.yaml:3:1: there is no 'sumary' here; did you mean 'summary'?\n  known: {KEYS}")

    def test_what_is_no_scenario_is_refused(self):
        for text in ("", "# nothing\n", "{}\n"):
            self.write("arm.yaml", text)
            self.assertIn("'title' is missing", self.ends(2, "run", "arm.yaml", "--out", "out"))
        self.refuses("none.yaml: cannot be read", "run", "none.yaml", "--out", "out")
        self.refuses(".: cannot be read", "run", ".", "--out", "out")
        (self.folder / "big.yaml").write_bytes(bytes(5 << 20))
        self.refuses("big.yaml: a file of parameters has at most 512 KiB", "run", "big.yaml", "--out", "out")

    def test_set_says_which_value_is_wrong(self):
        self.set("controler.tool=x", f"there is no 'controler' here; did you mean 'controller'?\n  known: {KEYS}")
        self.set("controller.pose.stiffness=soft", "expected a number [1/s²], got 'soft'")
        self.set("controller.pose.stiffness=-1", "stiffness must be >= 0 1/s², got -1")
        self.set("environment.5.link=x", "'5' is none of the 1 elements, which are numbered from 0")
        for duration in ("0", "1e9", ".nan", "-1", "1e-4"):
            shown = {".nan": "nan", "1e9": "1000000000", "1e-4": "0.0001"}.get(duration, duration)
            self.set(f"duration_s={duration}", f"duration_s must be from 0.001 to 1000000 s, got {shown}")
        self.set("seed=-1", "seed must be from 0 to 9.007199255e+15, got -1")
        self.set("seed=1152921504606846976", "seed must be from 0 to 9.007199255e+15, got 1.152921505e+18")
        self.set("log_period=0", "expected a time such as 1 ms or a rate such as 30 Hz, got '0'")
        for value in ("station.ideal", "=1"):
            self.refuses(f"--set wants path=value, such as station.ideal=true, got {value}",
                         "run", "arm.yaml", "--out", "out", "--set", value)

    def test_runs_and_claims_are_checked_before_anything_runs(self):
        self.check(self.scenario + CLAIM.format(tag="HoldsTool", run="rn"),
                   "arm.yaml: claim 'a': there is no run 'rn'; did you mean 'run'?")
        self.check(self.scenario + CLAIM.format(tag="HoldTool", run="run"),
                   "arm.yaml:12:5: there is no !HoldTool here; did you mean 'HoldsTool'?\n"
                   "  known: !StandsStill, !HoldsTool, !YieldsAsInertia, !KeepsLimits, !KeepsDamper, !MovesAlong, "
                   "!KeepsDoor, !FollowsAsWell, !ComesAsNear, !KeepsContactLimits, !Bound, !Least, "
                   "!Order, !Differs, !Equivalent, !FrictionIdentified, !Swings")
        for name in ("a/b", "..", "a b", "é"):
            self.check(f"{self.scenario}runs:\n  - {{name: {name}, title: t}}\n",
                       "arm.yaml: the name of a run, which names its log, has letters, digits, '_' and '-', "
                       f"got '{name}'")
        self.check(f"{self.scenario}runs:\n  - {{name: {'x' * 101}, title: t}}\n",
                   "arm.yaml: the name of a run has at most 100 letters, got 101")

    def test_check_runs_nothing(self):
        before = self.files()
        self.assertEqual(self.ends(0, "run", "arm.yaml", "--check"), "arm.yaml: 1 run, nothing is wrong\n")
        self.assertEqual(self.files(), before)
        self.refuses("--out is required: the folder of logs and report", "run", "arm.yaml")

    def test_a_misspelt_experiment_is_answered_with_the_nearest(self):
        self.assertIn("null-space-compliance    Null-space compliance\n", self.ends(0, "experiment", "list"))
        self.refuses("there is no experiment 'nul-space-compliance'; did you mean 'null-space-compliance'?\n"
                     "`pliant experiment list` names them",
                     "experiment", "run", "null-space-compliance", "nul-space-compliance", "--out", "out")

    def test_files_that_come_with_pliant_are_missed_with_the_way_out(self):
        self.refuses("there is no 'experiments'; looked for\n  /none/experiments\n"
                     "set PLIANT_SHARE to the folder that has pliant's models and experiments",
                     "experiment", "list", env={"PLIANT_SHARE": "/none"})


class Run(InFolder):
    def test_without_claims_leaves_a_log_and_a_report(self):
        told = self.ends(0, "run", "arm.yaml", "--out", "a/b")
        self.assertEqual(told, f"report: {self.folder}/a/b/report.html\n")
        self.assertEqual(json.loads((self.folder / "a/b/verdict.json").read_text()), {"claims": [], "tables": []})
        self.assertIn("A pushed arm", (self.folder / "a/b/report.html").read_text())
        self.assertEqual([f.name for f in (self.folder / "a/b/logs").iterdir()], ["run.mcap"])

    def test_ends_with_1_if_a_claim_fails_and_is_asked_to_hold(self):
        self.write("arm.yaml", self.scenario + CLAIM.format(tag="StandsStill", run="run"))
        told = self.ends(0, "run", "arm.yaml", *SHORT, "--out", "out")
        self.assertRegex(told, r"^FAILS    a: joints .*\nreport: .*\n$")
        self.ends(1, "run", "arm.yaml", *SHORT, "--out", "out", "--force", "--strict")
        self.ends(1, "report", "out/logs/run.mcap", "--out", "again", "--strict")

    def test_repeats_with_other_seeds_and_two_at_a_time(self):
        self.write("arm.yaml", self.scenario + "runs:\n  - {name: one, title: one}\n  - {name: two, title: two}\n")
        self.ends(0, "run", "arm.yaml", *SHORT, "--set", "seed=7", "--out", "out", "--repeat", "2", "--jobs", "2")
        logs = sorted(f.name for f in (self.folder / "out/logs").iterdir())
        self.assertEqual(logs, ["one-0.mcap", "one-1.mcap", "two-0.mcap", "two-1.mcap"])
        for log in logs:
            self.assertIn(f"seed: {8 if '-1' in log else 7}\n", self.ends(0, "log", "info", f"out/logs/{log}"))
        self.assertIn("repetition 1 has no log of run 'two'; a report needs one of each run",
                      self.ends(2, "report", *[f"out/logs/{f}" for f in logs[:3]], "--out", "r"))

    def test_repeats_as_often_as_the_file_says_unless_told_otherwise(self):
        self.write("arm.yaml", self.scenario + "repeat: 3\n")
        self.ends(0, "run", "arm.yaml", *SHORT, "--out", "out")
        self.assertEqual(len(list((self.folder / "out/logs").iterdir())), 3)
        self.ends(0, "run", "arm.yaml", *SHORT, "--out", "once", "--repeat", "1")
        self.assertEqual([f.name for f in (self.folder / "once/logs").iterdir()], ["run.mcap"])

    def test_refuses_fewer_repetitions_than_a_claim_needs(self):
        self.write("arm.yaml", self.scenario + "repeat: 5\nruns:\n  - {name: one, title: one}\n"
                   "  - {name: two, title: two, set: {controller.posture.compliance: 1}}\n"
                   "claims:\n  - !Differs {id: a, source: s, paper: p, run: one, than: two, signal: arm.energy}\n")
        self.ends(0, "run", "arm.yaml", *SHORT, "--check")
        self.refuses("arm.yaml: claim 'a': p of 3 repetitions is never below 0.1, and alpha is 0.05; "
                     "give --repeat 4 or more",
                     "run", "arm.yaml", *SHORT, "--check", "--repeat", "3")

    def test_gives_every_experiment_a_folder(self):
        share = self.folder / "share"
        for name in ("one", "two"):
            self.write(f"share/experiments/{name}.yaml", self.scenario)
        for name in ("models", "web"):
            os.symlink(command.ROOT / name, share / name)
        environment = {**os.environ, "PLIANT_SHARE": str(share)}
        self.assertIn("one                      A pushed arm\n",
                      self.ends(0, "experiment", "list", env=environment))
        self.ends(0, "experiment", "run", "one", "two", *SHORT, "--out", "out", env=environment)
        self.assertEqual(sorted(f.name for f in (self.folder / "out").iterdir()), ["one", "two"])

    def test_of_a_millisecond_or_half_a_period_more_has_the_rows_of_its_ticks(self):
        for duration, rows in (("0.001", 2), ("0.0105", 11), ("0.201", 202)):
            self.ends(0, "run", "arm.yaml", "--set", f"duration_s={duration}", "--out", duration)
            told = self.ends(0, "log", "info", f"{duration}/logs/run.mcap")
            self.assertIn(f"pliant.statistics rows: {rows}\n", told)
            self.assertIn(f"pliant.run  ticks: {rows}\n", told)
            self.assertIn("pliant.run  whole: 1\n", told)

    def test_says_what_of_it_cannot_be_drawn_before_it_runs(self):
        self.write("arm.yaml", self.scenario + "figures:\n  - !Limits {run: run}\n")
        before = self.files()
        self.assertIn("gnuplot", self.ends(3, "run", "arm.yaml", "--out", "out", env={"PATH": ""}))
        self.assertEqual(self.files(), before)

    def test_takes_its_options_in_any_order(self):
        self.ends(0, "run", *SHORT, "--set", "seed=3", "arm.yaml", "--out", "out")
        self.ends(0, "export", "--signal", "arm.position", "out/logs/run.mcap", "a.csv")

    def test_that_cannot_be_integrated_ends_with_3_and_leaves_what_it_has(self):
        said = self.ends(3, "run", "arm.yaml", "--out", "out", "--set", "environment.0.force=[0, 1e300, 0]")
        self.assertRegex(said, r"pliant: out/logs/run.mcap: cannot integrate past t = 0\.20\d+ s: ")
        told = self.ends(0, "log", "info", "out/logs/run.mcap")
        self.assertIn("pliant.run  whole: 0\n", told)
        self.assertRegex(told, r"statistics rows: 20\d\n")
        self.assertIn("identical: 13 signals", self.ends(0, "replay", "out/logs/run.mcap"))

    def test_is_replayed_bit_for_bit(self):
        self.run_short()
        self.assertEqual(self.ends(0, "replay", "out/logs/run.mcap"),
                         "identical: 13 signals over 101 rows, 0 s to 0.1 s\n")
        self.assertIn("identical: 2 signals over 101 rows",
                      self.ends(0, "replay", "out/logs/run.mcap", "--part", "control.estimate.observer"))
        self.refuses("out/logs/run.mcap: the diagram has no part 'contro'; did you mean 'control'?",
                     "replay", "out/logs/run.mcap", "--part", "contro")

    def test_differs_in_its_replay_if_its_log_tells_of_other_gains(self):
        log = self.run_short().read_bytes()
        at = log.index(b"scenario")
        at = log.index(b"stiffness: 400", at)
        # A repair copies what no checksum of its own guards, and gives the whole a right one.
        (self.folder / "told.mcap").write_bytes(log[:at] + b"stiffness: 401" + log[at + 14:])
        self.ends(1, "log", "info", "told.mcap")
        self.ends(0, "log", "repair", "told.mcap", "other.mcap")
        done = self.pliant("replay", "other.mcap")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"^different: \d of 13 signals over 101 rows, 0 s to 0.1 s\n")
        self.assertIn("control.torque[joint_1] (N·m)", done.stdout)

    def test_with_a_log_that_lacks_ticks_says_so_in_its_replay(self):
        self.run_short("fine", "--set", "log_period=0.5 ms")
        self.ends(0, "replay", "fine/logs/run.mcap")
        self.run_short("coarse", "--set", "log_period=3 ms")
        self.refuses("coarse/logs/run.mcap: the log has no row of arm.measured_position at t = 0.001 s, when control "
                     "ticks\n"
                     "record a row at each of its ticks, and drop none", "replay", "coarse/logs/run.mcap")


class Ended(InFolder):
    def test_is_said_with_who_ended_it_and_why(self):
        stop = 'stop_when=[{number: "arm.measured_position[joint_2]", below: 9}]'
        said = self.ends(0, "run", "arm.yaml", "--set", stop, "--verbose", "--out", "out")
        self.assertIn("run: stop_when_1 ended the run at t = 0 s: "
                      "arm.measured_position[joint_2] is below 9\n", said)
        self.assertIn("run: no step; 0 guards fired\n", said)
        self.assertIn("stop_when_1 ended the run", self.ends(0, "log", "info", "out/logs/run.mcap"))

    def test_is_not_said_of_a_run_that_comes_to_its_duration(self):
        said = self.ends(0, "run", "arm.yaml", "--verbose", "--set", "duration_s=0.1", "--out", "out")
        self.assertNotIn("ended", said)
        self.assertRegex(said, r"(?m)^run: \d+ steps of .* to .*, .* on average, \d+ rejected; "
                               r"\d+ derivative calls; \d+ guards fired$")


class Progress(InFolder):
    def test_is_a_line_at_the_end_for_a_file(self):
        done = self.pliant("run", "arm.yaml", "--out", "out")
        self.assertRegex(done.stderr, r"^A pushed arm +1\.000 of 1\.000 s, +[\d.]+ x real time\n$")

    def test_is_a_line_every_ten_seconds_for_a_file(self):
        begun = time.monotonic()
        process = self.start("run", "arm.yaml", "--set", "duration_s=1e5", "--set", "log_period=1 s", "--out", "out")
        line = process.stderr.readline()
        self.assertGreater(time.monotonic() - begun, 9)
        self.assertRegex(line, r"^A pushed arm +[\d.]+ of 100000\.0 s, +[\d.]+ x real time, \d+ s left\n$")


if __name__ == "__main__":
    main()
