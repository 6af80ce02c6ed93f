"""Installs the build into a folder of its own and builds examples/ with it, as a user would.

    install_test.py ROOT BUILD COMPILER [FLAG…]

Then every example runs, in an environment without paths of this build, and ends with 0.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

root, build, compiler, *flags = sys.argv[1:]


def run(*command, **options):
    print("$", *command, flush=True)
    subprocess.run(command, check=True, **options)


with tempfile.TemporaryDirectory() as folder:
    prefix, consumer, out = (Path(folder) / name for name in ("prefix", "consumer", "build"))
    run("cmake", "--install", build, "--prefix", prefix, stdout=subprocess.DEVNULL)
    for path in prefix.rglob("*.cmake"):
        if str(Path(root).resolve()) in path.read_text():
            sys.exit(f"{path.relative_to(prefix)} names {root}")

    shutil.copytree(Path(root) / "examples", consumer)
    run("cmake", "-S", consumer, "-B", out, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
        f"-DCMAKE_CXX_COMPILER={compiler}", f"-DCMAKE_CXX_FLAGS={' '.join(flags)}",
        "-DCMAKE_BUILD_TYPE=Debug")
    run("cmake", "--build", out)

    programs = [p for p in sorted(out.iterdir()) if p.is_file() and os.access(p, os.X_OK)]
    if not programs:
        sys.exit("examples/ made no program")
    for program in programs:
        run(program, cwd=folder, timeout=60)
    command = prefix / "bin" / "pliant"
    if command.exists():
        run(command, "--help", stdout=subprocess.DEVNULL)
