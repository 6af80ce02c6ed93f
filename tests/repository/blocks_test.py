"""Checks that docs/blocks.md has every general block, and nothing that is not there.

    blocks_test.py ROOT

Every class of a header in systems/ that is a Block stands in the first column of a table, and every
name there is declared in a public header.
"""

import os
import re
import sys
from pathlib import Path

import tree

BLOCK = re.compile(r"^(?:class|struct) (\w+)(?: final)? : public Block\b", re.M)
NAMED = re.compile(r"`(\w+)(?:<[^`]*>)?`")


def main(root):
    os.chdir(root)
    document = Path("docs/blocks.md")
    cells = [line.split("|")[1] for line in document.read_text().splitlines() if line.startswith("| `")]
    named = [name for cell in cells for name in NAMED.findall(cell)]
    problems = [f"{document}: '{name}' stands there twice" for name in {n for n in named if named.count(n) > 1}]
    headers = [p for p in tree.files(".", ".h") if p.parts[0] not in ("tests", "apps", "bench", "python")]
    text = "\n".join(p.read_text() for p in headers)
    for name in named:
        if not re.search(rf"^(?:class|struct) {name}\b[^;]*$|^[\w:<>& ]+ {name}\(", text, re.M):
            problems.append(f"{document}: no public header declares '{name}'")
    for header in headers:
        if header.parts[0] == "systems":
            for block in BLOCK.findall(header.read_text()):
                if block not in named:
                    problems.append(f"{header}: the block '{block}' is not in {document}")
    tree.finish(problems, len(named))


if __name__ == "__main__":
    main(sys.argv[1])
