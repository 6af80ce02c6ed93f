"""Reads every #include and fails on a step to the right in

    systems <- plants <- estimators, controllers <- diagrams <- analysis <- apps, python

and on a public header (one that its folder's CMakeLists.txt names) that shows anything but the
standard library, Eigen and public headers of pliant.

    layers_test.py ROOT
"""

import re
import sys
import tempfile
from pathlib import Path

import tree

RANK = {"systems": 0, "plants": 1, "estimators": 2, "controllers": 2, "diagrams": 3, "analysis": 4,
        "apps": 5, "python": 5}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
STANDARD = re.compile(r"[a-z0-9_]+")


def is_public(root, header):
    lists = header.parent / "CMakeLists.txt"
    return lists.is_file() and re.search(rf"(?<![\w/.]){re.escape(header.name)}\b", lists.read_text())


def problems_of(root, source):
    folder = source.relative_to(root).parts[0]
    public = source.suffix == ".h" and folder in RANK and is_public(root, source)
    for number, line in enumerate(source.read_text().splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        quoted, name = match[1] == '"', match[2]
        where = f"{source.relative_to(root)}:{number}: {name}"
        parts = name.split("/")
        if parts[0] != "pliant":
            beside = folder == "examples" and (source.parent / name).is_file()  # a project of its own
            if quoted and not beside:
                yield f'{where}: an include names the folder: "pliant/FOLDER/FILE.h"'
            elif public and not (parts[0] == "Eigen" or STANDARD.fullmatch(name)):
                yield f"{where}: public headers show the standard library, Eigen and pliant only"
            continue
        included = root.joinpath(*parts[1:])
        if not quoted or len(parts) < 3:
            yield f'{where}: an include of ours reads "pliant/FOLDER/FILE.h"'
        elif not included.is_file():
            yield f"{where}: there is no such file"
        elif folder in RANK:
            other = parts[1]
            if other != folder and not RANK.get(other, 9) < RANK[folder]:
                yield f"{where}: {folder} may not include {other}"
            elif other in RANK and not is_public(root, included) and (public or other != folder):
                yield (f"{where}: a private header; {other}/CMakeLists.txt does not name it among "
                       f"its HEADERS")


def problems(root):
    sources = [f for f in tree.files(root, ".h", ".cc") if len(f.relative_to(root).parts) > 1]
    return [p for f in sources for p in problems_of(root, f)], len(sources)


def self_test():
    """Each of these includes is a fault, and no other is."""
    faults = {
        "plants/a.h": ['"pliant/controllers/law.h"', '"pliant/systems/inner.h"', "<Simbody.h>",
                       '"arm.h"', '"pliant/systems/none.h"', "<sys/mman.h>"],
        "estimators/a.cc": ['"pliant/controllers/law.h"', '"pliant/systems/inner.h"'],
    }
    fine = {
        "plants/a.h": ["<vector>", "<Eigen/Core>", '"pliant/systems/block.h"'],
        "controllers/law.h": ['"pliant/plants/a.h"'],
        "systems/block.cc": ['"pliant/systems/inner.h"', "<arkode/arkode_erkstep.h>"],
        "tests/systems/block_test.cc": ['"pliant/systems/inner.h"', "<gtest/gtest.h>"],
        "systems/block.h": [], "systems/inner.h": [],
    }
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for path in faults.keys() | fine.keys():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            lines = faults.get(path, []) + fine.get(path, [])
            (root / path).write_text("".join(f"#include {i}\n" for i in lines))
        for name, headers in {"systems": "block.h", "plants": "a.h", "controllers": "law.h"}.items():
            (root / name / "CMakeLists.txt").write_text(f"pliant_library({name} HEADERS {headers})\n")
        found, _ = problems(root)
        expected = sorted(f"{path}:{n}: {i.strip('<>').replace(chr(34), '')}"
                          for path, list_ in faults.items() for n, i in enumerate(list_, 1))
        places = sorted(": ".join(problem.split(": ")[:2]) for problem in found)
        assert places == expected, "\n".join(found)


if __name__ == "__main__":
    self_test()
    tree.finish(*problems(Path(sys.argv[1])))
