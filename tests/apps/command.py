"""What the tests of the command share: running it, and a folder with a small scenario."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples/pushed_arm.yaml"
FOREIGN = ROOT / "tests/analysis/data"

# A tenth of a second in which the arm is pushed as well.
SHORT = ["--set", "duration_s=0.1", "--set", "environment.0.start_s=0.01",
         "--set", "environment.0.edge_s=0.02", "--set", "environment.0.duration_s=0.05"]

pliant_file = ""


class InFolder(unittest.TestCase):
    """A test in an empty folder but for the example, as arm.yaml."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name).resolve()
        self.scenario = EXAMPLE.read_text()
        self.write("arm.yaml", self.scenario)

    def write(self, name, text):
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / name).write_text(text)

    def pliant(self, *arguments, **options):
        options = {"capture_output": True, "text": True, "cwd": self.folder, "timeout": 300} | options
        return subprocess.run([pliant_file, *map(str, arguments)], **options)

    def start(self, *arguments, **options):
        """A run that does not end by itself."""
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True} | options
        process = subprocess.Popen([pliant_file, *arguments], cwd=self.folder, **options)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def run_short(self, out="out", *more):
        """The log of a run of a tenth of a second."""
        self.ends(0, "run", "arm.yaml", *SHORT, "--out", out, *more)
        return self.folder / out / "logs/run.mcap"

    def ends(self, code, *arguments, **options):
        """What a command printed, which has to end with that code."""
        done = self.pliant(*arguments, **options)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}{done.stderr}")
        self.assertNotIn("filesystem error", done.stderr)  # the words of a library, not ours
        return done.stdout if code == 0 else done.stderr

    def refuses(self, message, *arguments, **options):
        """Wrong use or input: it says so, and does nothing."""
        before = self.files()
        self.assertEqual(self.ends(2, *arguments, **options), f"pliant: {message}\n")
        self.assertEqual(self.files(), before)

    def files(self):
        return {path: path.is_file() and path.stat().st_mtime_ns for path in self.folder.rglob("*")}


def main():
    global pliant_file
    pliant_file = str(Path(sys.argv.pop()).resolve())
    os.environ.pop("PLIANT_SHARE", None)
    unittest.main(module="__main__")
