"""What the checks of the repository share: its files, and how a check ends."""

import os
import sys
from pathlib import Path

SKIPPED = {".git", "build", "out", "node_modules", "__pycache__", ".cache"}


def files(root, *suffixes):
    """The files of the tree with one of the suffixes (all files without), sorted by path."""
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = [f for f in folders if f not in SKIPPED]
        found += [Path(folder) / n for n in names if not suffixes or n.endswith(suffixes)]
    return sorted(found)


def finish(problems, checked):
    """Prints the problems, one a line, and leaves with 1 if there is one."""
    for problem in problems:
        print(problem)
    if not checked:
        sys.exit("nothing was checked")
    if problems:
        sys.exit(f"{len(problems)} problems")
    print(f"{checked} checked")
