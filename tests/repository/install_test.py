"""Installs the build into a folder of its own and builds examples/ with it, as a user would.

    install_test.py ROOT BUILD COMPILER [FLAG…]

What is installed are the Debian packages, if the build makes them and has no flags: unpacked, so that
nobody has to be root. Then every example runs, in an environment without paths of this build, and ends
with 0; and so do the commands of the documents that are run as a whole, see documents_test.py, with the
installation in ~/pliant.
"""

import os
import re
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


def fields(package):
    shown = subprocess.run(["dpkg-deb", "--field", package], check=True, stdout=subprocess.PIPE, text=True)
    return dict(re.findall(r"^([\w-]+): (.*)$", shown.stdout, re.M))


def unpack_packages(folder, prefix):
    """Makes the packages, and puts what they have in /usr into the prefix."""
    made, unpacked = folder / "packages", folder / "root"
    run("cpack", "--config", Path(build) / "CPackConfig.cmake", "-B", made, stdout=subprocess.DEVNULL)
    packages = {fields(package)["Package"]: package for package in made.glob("*.deb")}
    version = re.search(r"project\(pliant VERSION (\S+)", (Path(root) / "CMakeLists.txt").read_text())[1]
    python = "python" in subprocess.run(["grep", "CPACK_COMPONENTS_ALL", Path(build) / "CPackConfig.cmake"],
                                        check=True, stdout=subprocess.PIPE, text=True).stdout
    assert packages.keys() == {"libpliant", "libpliant-dev"} | ({"python3-pliant"} if python else set())
    for name, package in packages.items():
        told = fields(package)
        assert told["Version"] == version, told
        wanted = {"libpliant": "libsimbody3.7", "libpliant-dev": "libeigen3-dev", "python3-pliant": "python3-numpy"}
        assert wanted[name] in told["Depends"], told
        assert name == "libpliant" or f"libpliant (= {version})" in told["Depends"], told
        run("dpkg-deb", "-x", package, unpacked)
        for document in ("changelog.gz", "copyright"):
            assert (unpacked / "usr/share/doc" / name / document).stat().st_size > 1000
    changes = subprocess.run(["dpkg-parsechangelog", "-l", unpacked / "usr/share/doc/libpliant/changelog.gz"],
                             check=True, capture_output=True, text=True)
    assert f"Version: {version}\n" in changes.stdout and not changes.stderr, changes
    (unpacked / "usr").rename(prefix)


with tempfile.TemporaryDirectory() as folder:
    prefix, consumer, out = (Path(folder) / name for name in ("pliant", "consumer", "build"))
    if not flags and shutil.which("dpkg-deb") and (Path(build) / "CPackConfig.cmake").exists():
        unpack_packages(Path(folder), prefix)
    else:
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
        run(command, "run", Path(root) / "examples/pushed_arm.yaml", "--check")
        # Its own experiments, also where the libraries are found by a link. The message names the file.
        link = Path(folder) / "a" / "lib"
        link.parent.mkdir()
        link.symlink_to(prefix / "lib")
        too_short = ("experiment", "run", "null-space-compliance", "--set", "duration_s=1", "--out", "none")
        told = subprocess.run([command, *too_short], env={"LD_LIBRARY_PATH": str(link)}, stderr=subprocess.PIPE,
                              text=True).stderr
        assert f"{prefix.resolve()}/share/pliant/experiments/null-space-compliance.yaml" in told, told
    if not flags and (prefix / "lib/python3/dist-packages").exists():
        run("/usr/bin/python3", "-c", "import pliant; s = pliant.Simulation(pliant.Scenario.read("
            f"'{root}/examples/pushed_arm.yaml', set={{'duration_s': 0.01}})); s.run(); print(s.log())", cwd=folder,
            env={"PYTHONPATH": str(prefix / "lib/python3/dist-packages")})

    os.chdir(root)
    environment = {**os.environ, "HOME": folder, "CXX": compiler, "CXXFLAGS": " ".join(flags),
                   "CMAKE_GENERATOR": "Ninja"}
    for document, project, blocks in documents_test.sessions():
        copy = Path(folder) / document.stem
        shutil.copytree(project, copy)
        follow(document, copy, blocks, environment)
