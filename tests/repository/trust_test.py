"""Every test that docs/trust.md names is one that CTest runs, and every file is there.

    trust_test.py ROOT BUILD
"""

import json
import re
import subprocess
import sys
from pathlib import Path

import tree


def problems_of(text, tests, root):
    """The names between backticks that begin as tests or files of tests do and are none."""
    suites = {name.split("/")[0] for name in tests}
    named = [name for name in re.findall(r"`([a-z]\w*/[\w/-]+)`", text) if name.split("/")[0] in suites]
    files = re.findall(r"`(tests/[\w./-]+)[ \w]*`", text)
    problems = [f"docs/trust.md: no test is called {name}" for name in named if name not in tests]
    problems += [f"docs/trust.md: there is no {name}" for name in files if not (root / name).exists()]
    return problems, len(named) + len(files)


def main(root, build):
    listed = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], check=True, text=True,
                            stdout=subprocess.PIPE).stdout
    tests = {test["name"] for test in json.loads(listed)["tests"]}
    # It finds what it is to find.
    found, _ = problems_of("`systems/none_such` `systems/allocation` `tests/none`", {"systems/allocation"}, Path(root))
    assert len(found) == 2, "it does not find what it looks for"
    tree.finish(*problems_of((Path(root) / "docs/trust.md").read_text(), tests, Path(root)))


main(*sys.argv[1:])
