"""Reads logs of pliant with the libraries that others read MCAP with.

    mcap_test.py SAMPLE FOLDER

SAMPLE is the program that writes the logs; everything is made in FOLDER, where npm installs the
libraries once.
"""

import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sample, folder = sys.argv[1], Path(sys.argv[2])


def run(*command, **options):
    print("$", *command, flush=True)
    return subprocess.run(command, cwd=folder, **options)


folder.mkdir(parents=True, exist_ok=True)
lock = (HERE / "package-lock.json").read_bytes()
installed = folder / "installed.json"  # the lock file that node_modules is of
for name in ("package.json", "package-lock.json", "read.mjs"):
    shutil.copy(HERE / name, folder)
if not installed.exists() or installed.read_bytes() != lock:
    run("npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", check=True)
    installed.write_bytes(lock)

run(sample, "whole.mcap", "expected.json", check=True)
run("node", "read.mjs", "whole.mcap", "expected.json", check=True)
if run(sample, "--killed", "killed.mcap").returncode != -9:
    sys.exit("the sample was not killed")
run("node", "read.mjs", "--killed", "killed.mcap", check=True)
