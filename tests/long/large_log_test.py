"""Identifies friction from a CSV file of 2 GB and says what memory that took.

    large_log_test.py PLIANT [GB]

Takes minutes and as much room in the temporary folder, so no test runs it by itself.
"""

import math
import random
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

MOST_MB = 600


def write(path, size):
    """Steps of the current of 7 joints, both ways, at 1 kHz; a block of noise over and over."""
    chance = random.Random(1)
    noise = [chance.gauss(0, 0.1) for _ in range(4096)]
    rows = 0
    with open(path, "w", buffering=1 << 20) as out:
        out.write("t," + ",".join(f"v{j},i{j},tau{j}" for j in range(1, 8)) + "\n")
        written = 0
        while written < size:
            level = 0.03 * 1.4 ** (rows // 5000 % 24 // 2) * (1 if rows // 5000 % 2 else -1)
            torque = math.copysign(3, level) + 2.4 * level
            block = []
            for k in range(5000):
                e = noise[(rows + k) * 7 % 4096]
                joint = f"{level + 0.01 * e:.6f},{torque / 11:.6f},{e:.6f}"
                block.append(f"{0.001 * (rows + k):.3f}," + ",".join([joint] * 7))
            text = "\n".join(block) + "\n"
            out.write(text)
            written += len(text)
            rows += 5000
    return rows


def main():
    size = float(sys.argv[2] if len(sys.argv) > 2 else 2) * 1e9
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "large.csv"
        rows = write(log, size)
        start = time.monotonic()
        done = subprocess.run(
            [sys.argv[1], "identify", "friction", log, "--time", "t", "--velocity", "v{}", "--current",
             "i{}", "--torque", "tau{}", "--torque-per-ampere", "11",
             "--reflected-inertia", "0.4", "--out", Path(folder) / "friction.yaml"],
            capture_output=True, text=True)
        wall = time.monotonic() - start
        text = (Path(folder) / "friction.yaml").read_text() if done.returncode == 0 else ""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(done.stdout.split("\n")[0])
    print(f"{size / 1e9:.1f} GB, {rows} rows: {usage.ru_maxrss / 1e3:.0f} MB at most, "
          f"{wall:.0f} s ({usage.ru_utime:.0f} s of the processor)")
    coulomb = [float(n) for n in re.findall(r"^    coulomb: (\S+)", text, re.M)]
    faults = []
    if done.returncode:
        faults.append(done.stderr)
    if usage.ru_maxrss > 1e3 * MOST_MB:
        faults.append(f"expected at most {MOST_MB} MB")
    if len(coulomb) != 7 or any(abs(c - 3) > 0.05 for c in coulomb):
        faults.append(f"expected 3 N·m for each of 7 joints, got {coulomb}")
    print("\n".join(faults) or "nothing is wrong")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
