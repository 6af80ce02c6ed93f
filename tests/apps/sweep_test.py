"""Sweeps as a user meets them: shared, killed, gone on with, merged, and made again."""

import csv
import json
import os
import resource
import shutil
import signal
import subprocess
import time

import command
from command import InFolder, main

NUMBERS = """
numbers:
  - {name: farthest, title: farthest, signal: control.pose_error, elements: [x, y, z]}
  - {name: fastest, title: fastest, signal: arm.velocity}
"""
OVER = ["--over", "controller.posture.compliance=0:1:3", "--over", "environment.0.force.1=uniform(10,40)"]
SWEEP = ["sweep", "arm.yaml", *OVER, "--runs", 30]


class Sweeps(InFolder):
    def setUp(self):
        super().setUp()
        self.write("arm.yaml", self.scenario.replace("start_s: 0.2, duration_s: 0.5", "start_s: 0.01, duration_s: 0.05, edge_s: 0.02")
                   .replace("duration_s: 1\n", "duration_s: 0.1\n") + NUMBERS)

    def table(self, out):
        return (self.folder / out / "results.csv").read_bytes()

    def wait_for(self, file, size):
        end = time.monotonic() + 30
        while not file.exists() or file.stat().st_size < size:
            self.assertLess(time.monotonic(), end, "the part does not grow")
            time.sleep(0.005)

    def test_leaves_the_same_table_however_it_was_made(self):
        told = self.ends(0, *SWEEP, "--out", "one")
        self.assertTrue(told.startswith("30 runs\n"), told)
        one = self.table("one")
        rows = list(csv.DictReader(one.decode().splitlines()))
        self.assertEqual([int(row["run"]) for row in rows], list(range(30)))
        self.assertEqual(list(rows[0]), ["run", "controller.posture.compliance", "environment.0.force.1", "seed",
                                         "farthest (m)", "fastest (rad/s)", "ended", "failed"])
        self.assertEqual([row["controller.posture.compliance"] for row in rows[:4]], ["0", "0.5", "1", "0"])
        self.assertEqual({row["failed"] for row in rows}, {""})

        self.ends(0, *SWEEP, "--jobs", 2, "--out", "jobs")
        self.assertEqual(self.table("jobs"), one)

        for i in (3, 1, 2):
            self.ends(0, *SWEEP, "--shard", f"{i}/3", "--out", "shards")
        self.ends(0, "merge", "shards")
        self.assertEqual(self.table("shards"), one)

        # A process is killed, and the machine with it: what it wrote last is torn.
        part = self.folder / "killed/part-1-of-1"
        process = self.start(*map(str, SWEEP), "--out", "killed")
        self.wait_for(part, 4000)
        process.kill()
        process.wait()
        kept = part.read_bytes()
        part.write_bytes(kept + kept[-50:])
        said = self.pliant(*SWEEP, "--out", "killed").stderr
        self.assertIn(f"killed/part-1-of-1: bytes {len(kept)} to {len(kept) + 50}, its end, are no row; "
                      "the runs it lacks are made again\n", said)
        self.assertTrue(part.read_bytes().startswith(kept))
        self.assertEqual(self.table("killed"), one)

        for name, launch in (("mpirun", ["mpirun", "-np", "2", "--oversubscribe"]),
                             ("parallel", ["parallel", "--will-cite", "--quote", "--jobs", "2"])):
            self.assertTrue(shutil.which(name), f"no {name}: ./setup --test installs it")
            words = [str(word) for word in [command.pliant_file, *SWEEP, "--out", name]]
            shards = ["--shard", "{}/2", ":::", "1", "2"] if name == "parallel" else []
            done = subprocess.run(launch + words + shards, cwd=self.folder, capture_output=True, text=True, timeout=120,
                                  env={**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1",
                                       "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(sorted(path.name for path in (self.folder / name).iterdir()), ["part-1-of-2", "part-2-of-2"])
            self.ends(0, "merge", name)
            self.assertEqual(self.table(name), one)

    def test_says_if_every_run_failed(self):
        said = self.ends(3, "sweep", "arm.yaml", "--over", "duration_s=0.02,0.03", "--set",
                         "numbers.0.from_s=0.05", "--out", "out")
        self.assertIn("\nevery run failed; the first says: farthest: no row of control.pose_error lies between ", said)
        self.assertEqual(len(self.table("out").splitlines()), 3)
        self.assertIn("every run failed; ", self.ends(3, "merge", "out"))

    def test_stops_at_a_signal_and_goes_on(self):
        process = self.start(*map(str, SWEEP), "--out", "out")
        self.wait_for(self.folder / "out/part-1-of-1", 4000)
        process.send_signal(signal.SIGINT)
        told, said = process.communicate(timeout=10)
        self.assertEqual((process.returncode, told), (130, ""))
        self.assertRegex(said, r"stopped; \d+ of 30 runs are made and kept, and the same command goes on with the "
                               r"others\n$")
        self.assertEqual(os.listdir(self.folder / "out"), ["part-1-of-1"])
        self.ends(0, *SWEEP, "--out", "out")
        self.assertEqual(self.table("out").count(b"\n"), 31)

    def test_a_full_disk_ends_it_and_loses_nothing(self):
        self.ends(0, *SWEEP, "--shard", "1/30", "--out", "one_row")
        room = (self.folder / "one_row/part-1-of-30").stat().st_size + 200

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (room, resource.RLIM_INFINITY))

        said = self.ends(3, *SWEEP, "--out", "out", preexec_fn=limit)
        self.assertTrue(said.endswith("pliant: cannot write out/part-1-of-1: File too large\n"), said)
        kept = (self.folder / "out/part-1-of-1").read_bytes()
        self.assertGreater(len(kept), room - 200)
        self.ends(0, *SWEEP, "--out", "out")
        self.assertTrue((self.folder / "out/part-1-of-1").read_bytes().startswith(kept))

    def test_merge_says_what_is_missing_or_twice(self):
        self.ends(0, *SWEEP, "--shard", "1/3", "--out", "a")
        said = self.ends(3, "merge", "a", "--out", "merged")
        self.assertEqual(said, "20 of 30 runs are missing: 1-2, 4-5, 7-8, 10-11, 13-14, 16-17, 19-20, 22-23, 25-26, "
                               "28-29; `pliant sweep` makes them\n")
        self.assertEqual(self.table("merged").count(b"\n"), 11)
        self.refuses("merged/results.csv exists; give --force to write over it, or another --out",
                     "merge", "a", "--out", "merged")
        self.ends(0, *SWEEP, "--out", "b")
        said = self.ends(3, "merge", "a", "b", "--out", "merged", "--force")
        self.assertEqual(said, "10 runs are there more than once, the same each time; the first is run 0\n")
        self.assertEqual(self.table("merged"), self.table("b"))
        self.write("c/part-1-of-1", "no part")
        self.refuses("c/part-1-of-1: expected a part of a sweep, which begins with 'pliant sweep 1'; "
                     "take the file away", "merge", "c")
        self.refuses("cannot read the directory none: No such file or directory", "merge", "none")

    def test_makes_a_run_again_with_its_log(self):
        self.ends(0, *SWEEP, "--out", "out")
        told = self.ends(0, "rerun", "out", 7, "--out", "again")
        row = list(csv.DictReader(self.table("out").decode().splitlines()))[7]
        self.assertTrue(told.startswith(f"farthest: {row['farthest (m)']} m\nfastest: {row['fastest (rad/s)']} rad/s\n"))
        self.assertTrue(told.endswith("the same as in the part, bit for bit\n"), told)
        self.assertIn("seed: " + row["seed"], self.ends(0, "log", "info", "again/logs/run.mcap"))
        self.ends(0, "replay", "again/logs/run.mcap")
        self.refuses("again/report.html exists; give --force to write over it, or another --out",
                     "rerun", "out", 7, "--out", "again")
        self.refuses("the sweep has runs 0 to 29, got 30", "rerun", "out", 30, "--out", "x")

    def test_writes_a_report_and_a_file_that_h5py_reads(self):
        self.ends(0, *SWEEP, "--over", "environment.0.edge_s=0.01,0.02", "--out", "out")
        page = (self.folder / "out/report.html").read_text()
        self.assertIn("controller.posture.compliance", page)
        tables = json.loads((self.folder / "out/verdict.json").read_text())["tables"]
        self.assertEqual([table["title"] for table in tables], ["Numbers"])
        self.assertEqual([row[1] for row in tables[0]["rows"]], ["30", "30"])
        figures = sorted(path.stem for path in (self.folder / "out/figures").glob("*.svg"))
        self.assertEqual(figures, ["distributions", "map_farthest", "map_fastest"])
        read = ("import h5py, json; f = h5py.File('out/results.h5'); "
                "print(json.dumps([f['farthest'][:].tolist(), f['farthest'].attrs['unit'], "
                "f['controller.posture.compliance'][:4].tolist(), f['failed'][0].decode(), sorted(f)]))")
        done = subprocess.run(["/usr/bin/python3", "-c", read], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        farthest, unit, compliance, failed, names = json.loads(done.stdout)
        rows = list(csv.DictReader(self.table("out").decode().splitlines()))
        self.assertEqual(farthest, [float(row["farthest (m)"]) for row in rows])
        self.assertEqual((unit, compliance, failed), ("m", [0, 0, 0.5, 0.5], ""))
        self.assertEqual(names, ["controller.posture.compliance", "ended", "environment.0.edge_s",
                                 "environment.0.force.1", "failed", "farthest", "fastest", "run", "seed", "sweep"])

    def test_refuses_wrong_use(self):
        self.assertEqual(self.ends(0, *SWEEP, "--check"), "arm.yaml: 30 runs of 3 cells, nothing is wrong\n")
        self.refuses("--out is required: the folder of parts and results", *SWEEP)
        self.refuses("--set seed=2: --over sweeps it too, and would have its way",
                     *SWEEP, "--over", "seed=1,2", "--set", "seed=2", "--out", "x")
        self.refuses("--shard wants i/N with 1 <= i <= N <= 1000000, such as 2/8, got 3/2",
                     *SWEEP, "--shard", "3/2", "--out", "x")
        environment = {**os.environ, "OMPI_COMM_WORLD_RANK": "x", "OMPI_COMM_WORLD_SIZE": "2"}
        self.refuses("the launcher's OMPI_COMM_WORLD_RANK must be a whole number, got 'x'; --shard 1/1 does without it",
                     *SWEEP, "--out", "x", env=environment)


main()
