"""Turns signs around, one at a time, and expects a test to fail.

    mutate.py ROOT TREE [--every N] [--from K]   each N-th mutation, in the copy TREE of the tree ROOT
    mutate.py ROOT --check                       only whether each of them can be made

mutations.tsv says what stands where, what to put in its place, and which tests are to fail. TREE is made
and built if it is not there; in one that is, build/release is taken as it is. Ends with 1 if no test of a
mutation fails, or if the text of one stands in its file other than once.
"""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path


def table(root):
    lines = (root / "tests/long/mutations.tsv").read_text().splitlines()[1:]
    return [line.split("\t") for line in lines]


def problems(root, mutations):
    for number, mutation in enumerate(mutations, 1):
        where = f"mutations.tsv:{number + 1}"
        if len(mutation) != 4:
            yield f"{where}: expected file, text, mutation and tests, got {len(mutation)} columns"
            continue
        file, text, instead, tests = mutation
        source = root / file
        count = source.read_text().count(text) if source.is_file() else 0
        if count != 1:
            yield f"{where}: {file} has {count} times '{text}', expected once"
        if text == instead:
            yield f"{where}: '{text}' would stay what it is"
        for test in tests.split(","):
            if not (root / "tests" / f"{test}_test.cc").is_file():
                yield f"{where}: there is no test {test}"


def targets(tests):
    return [test.replace("/", "_") + "_test" for test in tests]


def run(tree, *command):
    return subprocess.run(command, cwd=tree, capture_output=True, text=True)


def build(tree, tests):
    return run(tree, "ninja", "-C", "build/release", "-j2", *targets(tests))


def failing(tree, tests):
    """The first of the tests that fails, and again: some keep an eye on the clock; none if they pass."""
    for name, target in zip(tests, targets(tests)):
        if all(fails(tree, target) for _ in range(2)):
            return name
    return None


def fails(tree, target):
    try:
        return subprocess.run([f"build/release/tests/{target}"], cwd=tree, timeout=300, capture_output=True).returncode
    except subprocess.TimeoutExpired:
        return True


def prepare(root, tree):
    for name in run(root, "git", "ls-files").stdout.splitlines():
        if not (tree / name).is_file() or (tree / name).read_bytes() != (root / name).read_bytes():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, tree / name)
            os.utime(tree / name)  # newer than what was made of the one before
    if not (tree / "build/release/build.ninja").is_file():
        done = run(tree, "cmake", "--preset", "release", "-DPLIANT_BUILD_BENCH=OFF")
        if done.returncode:
            sys.exit(done.stderr)


def main():
    root = Path(sys.argv[1]).resolve()
    mutations = table(root)
    wrong = list(problems(root, mutations))
    if wrong:
        sys.exit("\n".join(wrong))
    if sys.argv[2] == "--check":
        print(f"{len(mutations)} mutations can be made")
        return
    tree = Path(sys.argv[2]).resolve()
    options = dict(zip(sys.argv[3::2], map(int, sys.argv[4::2])))
    chosen = range(options.get("--from", 1), len(mutations) + 1, options.get("--every", 1))
    prepare(root, tree)
    all_tests = sorted({test for k in chosen for test in mutations[k - 1][3].split(",")})
    done = build(tree, all_tests)
    if done.returncode:
        sys.exit(done.stdout[-3000:])
    if broken := failing(tree, all_tests):
        sys.exit(f"{broken} fails without a mutation")

    survivors = []
    for number in chosen:
        file, text, instead, tests = mutations[number - 1]
        source, tests = tree / file, tests.split(",")
        before, start = source.read_text(), time.monotonic()
        try:
            source.write_text(before.replace(text, instead))
            done = build(tree, tests)
            killer = failing(tree, tests) if done.returncode == 0 else None
        finally:
            source.write_text(before)
        verdict = f"killed by {killer}" if killer else "SURVIVES" if done.returncode == 0 else "DOES NOT COMPILE"
        print(f"{number:3d} {verdict}, {time.monotonic() - start:.0f} s: {file}: {text} -> {instead}", flush=True)
        if not killer:
            survivors.append(number)
    print(f"{len(chosen)} mutations, {len(chosen) - len(survivors)} killed, survivors: {survivors or 'none'}")
    sys.exit(bool(survivors))


if __name__ == "__main__":
    main()
