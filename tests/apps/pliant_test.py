"""The command `pliant` as a user meets it: exit codes, messages, what it leaves behind."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PLIANT = sys.argv.pop()


def pliant(*arguments, cwd=None, env=None):
    return subprocess.run([PLIANT, *arguments], cwd=cwd, env=env, capture_output=True, text=True)


class Command(unittest.TestCase):
    def test_helps_and_lists(self):
        self.assertIn("Example: pliant experiment run", pliant("--help").stdout)
        self.assertIn("null-space-compliance", pliant("experiment", "list").stdout)
        self.assertRegex(pliant("--version").stdout, r"^\d+\.\d+\.\d+\n$")

    def test_wrong_use_ends_with_2(self):
        for arguments in ([], ["experiment"], ["experiment", "run"], ["experiment", "run", "x", "--y"]):
            self.assertEqual(pliant(*arguments).returncode, 2, arguments)

    def test_a_misspelt_experiment_ends_with_2_and_the_nearest_name(self):
        with tempfile.TemporaryDirectory() as folder:
            done = pliant("experiment", "run", "nul-space-compliance", cwd=folder)
            self.assertEqual(done.returncode, 2)
            self.assertIn("did you mean 'null-space-compliance'?", done.stderr)
            self.assertEqual(list(Path(folder).iterdir()), [])

    def test_a_folder_that_cannot_be_made_ends_with_2(self):
        done = pliant("experiment", "run", "null-space-compliance", "--out", "/proc/none")
        self.assertEqual(done.returncode, 2)
        self.assertIn("/proc/none", done.stderr)

    def test_a_run_that_cannot_go_on_ends_with_3_and_says_why(self):
        with tempfile.TemporaryDirectory() as folder:
            done = pliant("experiment", "run", "null-space-compliance", cwd=folder, env={"PATH": ""})
            self.assertEqual(done.returncode, 3)
            self.assertIn("gnuplot", done.stderr)
            done = pliant("experiment", "run", "null-space-compliance", cwd=folder,
                          env={"PATH": "/usr/bin", "PLIANT_MODELS": "/none"})
            self.assertEqual(done.returncode, 3)
            self.assertIn("/none/gen3/gen3_7dof.urdf", done.stderr)

    def test_a_run_leaves_a_report_whose_claims_hold(self):
        with tempfile.TemporaryDirectory() as folder:
            done = pliant("experiment", "run", "null-space-compliance", "--ideal", "--out", "a/b",
                          "--strict", cwd=folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stdout.splitlines()[-1],
                             f"report: {Path(folder).resolve()}/a/b/report.html")
            verdict = json.loads((Path(folder) / "a/b/verdict.json").read_text())
            self.assertEqual([c["holds"] for c in verdict["claims"]], [True] * 5)
            page = (Path(folder) / "a/b/report.html").read_text()
            for claim in verdict["claims"]:
                self.assertIn(claim["id"], page)


if __name__ == "__main__":
    unittest.main()
