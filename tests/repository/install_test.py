"""Installs the build into a folder of its own and builds examples/ with it, as a user would.

    install_test.py ROOT BUILD COMPILER [FLAG…]

Then every example runs, in an environment without paths of this build, and ends with 0; and so do the
commands of the documents that are run as a whole, see documents_test.py, with the installation in
~/pliant.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import documents_test

root, build, compiler, *flags = sys.argv[1:]


def run(*command, **options):
    print("$", *command, flush=True)
    subprocess.run(command, check=True, **options)


def follow(document, folder, blocks, environment):
    """Runs the blocks of a document in a folder, one after the other in one shell, and looks for what
    it says that they print."""
    end = "end of a block"
    script = "set -euo pipefail\n" + "".join(f"{lines}echo {end}\n" for lines, _ in blocks)
    print(f"{document}:\n{script}", end="", flush=True)
    done = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, stdout=subprocess.PIPE,
                          text=True, timeout=1200)
    print(done.stdout, flush=True)
    printed = done.stdout.split(end)
    if done.returncode:
        sys.exit(f"{document}: exit code {done.returncode} of\n{blocks[len(printed) - 1][0]}")
    for (lines, expected), out in zip(blocks, printed):
        for text in expected:
            if text not in out:
                sys.exit(f"{document}:\n{lines}do not print\n{text}")


with tempfile.TemporaryDirectory() as folder:
    prefix, consumer, out = (Path(folder) / name for name in ("pliant", "consumer", "build"))
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

    os.chdir(root)
    environment = {**os.environ, "HOME": folder, "CXX": compiler, "CXXFLAGS": " ".join(flags),
                   "CMAKE_GENERATOR": "Ninja"}
    for document, project, blocks in documents_test.sessions():
        copy = Path(folder) / document.stem
        shutil.copytree(project, copy)
        follow(document, copy, blocks, environment)
