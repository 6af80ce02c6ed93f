"""Checks how the files of the repository are written.

    style_test.py ROOT

Sources are laid out as .clang-format says; text is UTF-8 without tabs, trailing blanks or a missing
last newline; headers begin with #pragma once; scripts can be run; nothing names a place outside the
repository or promises what is not there. A source of more than 600 lines is only a warning: one
file, one idea.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import tree

TEXT = (".h", ".cc", ".py", ".cmake", ".in", ".md", ".txt", ".json", ".yaml", ".yml", ".tsv", ".js",
        ".mjs", ".css", ".html", ".sh", ".gp")
SCRIPTS = ("setup", "demo", "check", ".ci/run", "bench/run", "tests/fuzz/run",
           "tests/long/nightly")

# Directories of one person's machine, and promises. Split so that this file passes its own check.
OUTSIDE = re.compile(r"(?<![\w.${}<-])/(?:home|root|work|Users|mnt|media)/\w|\.\./shared\b")
PROMISE = re.compile(r"\b(?:TO" r"DO|FIX" r"ME|XX" r"X|HA" r"CK)\b|DISABLED" r"_|GTEST" r"_SKIP")


def layout(sources):
    if not sources:
        return []
    done = subprocess.run(["clang-format", "--dry-run", *sources], capture_output=True, text=True)
    lines = [line for line in done.stderr.splitlines() if ": warning: " in line or ": error: " in line]
    faults = {}
    for line in lines:
        path, number = line.split(":")[:2]
        faults.setdefault(path, number)
    if done.returncode and not faults:
        return [f"clang-format: {done.stderr.strip()}"]
    return [f"{path}:{number}: not laid out as .clang-format says; run clang-format -i {path}"
            for path, number in faults.items()]


def text_problems(path):
    data = path.read_bytes()
    try:
        text = data.decode()
    except UnicodeDecodeError as error:
        yield f"{path}: not UTF-8: {error}"
        return
    if text and not text.endswith("\n"):
        yield f"{path}: the last line has no end"
    if path.suffix == ".h" and not text.startswith("#pragma once\n"):
        yield f"{path}:1: a header begins with #pragma once"
    lines = text.split("\n")
    for number, line in enumerate(lines, 1):
        where = f"{path}:{number}"
        if "\r" in line:
            yield f"{where}: carriage return"
        if line != line.rstrip():
            yield f"{where}: blanks at the end of the line"
        if "\t" in line and path.suffix != ".tsv":
            yield f"{where}: a tab"
        if match := OUTSIDE.search(line):
            yield f"{where}: a place outside the repository: {match[0]}…"
        if match := PROMISE.search(line):
            yield f"{where}: a promise, not a feature: {match[0]}"
    if path.suffix in (".h", ".cc", ".js", ".mjs", ".py") and len(lines) > 601:
        print(f"warning: {path} has {len(lines) - 1} lines")


def main():
    os.chdir(sys.argv[1])
    root = Path(".")
    # Models of others stay as they were published, and what a bundler made as it made it.
    texts = [f for f in tree.files(root, *TEXT)
             if f.parts[0] != "models" and f.parts[:2] != ("web", "dist")]
    scripts = [root / name for name in SCRIPTS]
    problems = layout([str(f) for f in texts if f.suffix in (".h", ".cc")])
    for path in texts + scripts:
        problems += text_problems(path)
    for script in scripts:
        if not os.access(script, os.X_OK):
            problems.append(f"{script}: has no run bit")
        if script.read_text().startswith("#!/usr/bin/env bash"):
            done = subprocess.run(["bash", "-n", script], capture_output=True, text=True)
            problems += done.stderr.splitlines()
    tree.finish(problems, len(texts))


main()
