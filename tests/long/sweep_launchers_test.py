"""Shares a sweep between processes in every way there is a launcher for, kills some, and compares the tables.

    sweep_launchers_test.py PLIANT [RUNS]

Open MPI with a process that is killed and started again, GNU parallel, and a Slurm of one machine, which it starts
on loopback and ends again: needs root, and Debian's openmpi-bin, parallel, slurmctld, slurmd, slurm-client and
munge. No test runs it by itself.
"""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PLIANT, RUNS = str(Path(sys.argv[1]).resolve()), (sys.argv[2:] or ["2000"])[0]
SCENARIO = Path(__file__).resolve().parents[2] / "examples/swept_arm.yaml"
SWEEP = [PLIANT, "sweep", str(SCENARIO), "--set", "duration_s=0.1", "--set", "environment.0.start_s=0.01",
         "--set", "environment.0.duration_s=0.05", "--set", "environment.0.edge_s=0.02",
         "--over", "controller.posture.compliance=0:1:11", "--over", "environment.0.force.1=normal(30,10)",
         "--runs", RUNS]
MPI = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

CONFIGURATION = """ClusterName=sweep
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def run(words, **options):
    started = time.monotonic()
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=1200, **options)
    if done.returncode:
        sys.exit(f"{words} ended with {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout, time.monotonic() - started


def merged(folder):
    run([PLIANT, "merge", folder])
    return (folder / "results.csv").read_bytes()


def wait_for(condition, what, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"{what} did not come")
        time.sleep(0.05)


def size(file):
    return file.stat().st_size if file.exists() else 0


def mpirun_with_a_killed_process(out):
    words = ["mpirun", "-np", "2", "--oversubscribe", *SWEEP, "--out", out]
    process = subprocess.Popen(words, env=MPI, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    part = out / "part-2-of-2"
    wait_for(lambda: size(part) > 8000, part)
    # The process that has this part open.
    for held in Path("/proc").glob("[0-9]*/fd/*"):
        with contextlib.suppress(OSError):
            if os.readlink(held) == str(part):
                os.kill(int(held.parts[2]), signal.SIGKILL)
    if process.wait(timeout=600) == 0:
        sys.exit("mpirun has not noticed that a process was killed")
    with open(part, "ab") as torn:
        torn.write(part.read_bytes()[-37:])
    run(words, env=MPI)


def parallel(out):
    run(["parallel", "--will-cite", "--quote", "--jobs", "2", *SWEEP, "--out", out, "--shard", "{}/5", ":::",
         *range(1, 6)])


class Slurm:
    """One machine's, as long as this lives."""

    def __init__(self, folder):
        self.folder = folder
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
        for name in ("state", "spool"):
            (folder / name).mkdir()
        (folder / "slurm.conf").write_text(
            CONFIGURATION.format(host=socket.gethostname(), folder=folder, cpus=os.cpu_count()))
        (folder / "munge.key").write_bytes(os.urandom(128))
        (folder / "munge.key").chmod(0o400)
        self.daemons = []

    def start(self, *words):
        log = open(self.folder / f"{Path(words[0]).name}.out", "w")
        self.daemons.append(subprocess.Popen([str(word) for word in words], env=self.environment, stdout=log,
                                             stderr=subprocess.STDOUT))

    def __enter__(self):
        at = self.folder
        self.start("munged", "--force", "--foreground", f"--socket={at}/munge.socket", f"--key-file={at}/munge.key",
                   f"--pid-file={at}/munge.pid", f"--log-file={at}/munge.log", f"--seed-file={at}/munge.seed")
        wait_for(lambda: (at / "munge.socket").exists(), "munge")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        idle = ["sinfo", "--noheader", "--format=%t"]
        wait_for(lambda: "idle" in subprocess.run(idle, env=self.environment, capture_output=True, text=True).stdout,
                 "a node of Slurm")
        return self

    def __exit__(self, *_):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            daemon.wait(timeout=60)

    def batch(self, *words):
        run(["sbatch", "--wait", f"--output={self.folder}/%A_%a.txt", *words], env=self.environment)


def slurm(folder, out_of_array, out_of_steps):
    with Slurm(folder) as one:
        sweep = " ".join(f"'{word}'" for word in SWEEP)
        one.batch("--array=0-3", "--ntasks=1", f"--wrap={sweep} --out {out_of_array}")
        # Each task of the array starts two processes.
        one.batch("--array=1-2", "--ntasks=2", f"--wrap=srun {sweep} --out {out_of_steps}")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _, alone = run([*SWEEP, "--out", folder / "one"])
        table = (folder / "one/results.csv").read_bytes()
        print(f"{table.count(10) - 1} runs in {alone:.1f} s by one process", flush=True)
        _, two = run([*SWEEP, "--jobs", "2", "--out", folder / "jobs"])
        print(f"{alone / two:.2f} times as fast with --jobs 2", flush=True)
        mpirun_with_a_killed_process(folder / "mpi")
        parallel(folder / "parallel")
        (folder / "slurm").mkdir()
        slurm(folder / "slurm", folder / "array", folder / "steps")
        for way, parts in (("jobs", 1), ("mpi", 2), ("parallel", 5), ("array", 4), ("steps", 4)):
            if merged(folder / way) != table:
                sys.exit(f"{way}: another table")
            found = len(list((folder / way).glob("part-*")))
            if found != parts:
                sys.exit(f"{way}: {found} parts, expected {parts}")
            print(f"{way}: {found} parts, the same table", flush=True)


main()
