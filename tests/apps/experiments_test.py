#!/usr/bin/env python3
"""The experiments on the papers, and the table of what they measured in docs/experiments.md.

    experiments_test.py PLIANT ROOT NAME …             runs them and holds the verdicts against the table
    experiments_test.py PLIANT ROOT --write [NAME …]   writes the table; none: of all
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

HEAD = "| claim | paper | measured | verdict |\n|---|---|---|---|\n"


def run(pliant, name):
    """What came out of an experiment: its claims and its tables."""
    with tempfile.TemporaryDirectory() as out:
        ended = subprocess.run([pliant, "experiment", "run", name, "--out", out, "--jobs", "2", "--force"],
                               capture_output=True, text=True)
        if ended.returncode != 0:
            sys.exit(f"{name}: exit code {ended.returncode}\n{ended.stderr}")
        return json.loads((pathlib.Path(out) / "verdict.json").read_text())


def row(cells):
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |\n"


def row_of_claim(claim):
    return row([claim["id"], f'{claim["paper"]} ({claim["source"]})', claim["measured"],
                "holds" if claim["holds"] else "**fails**"])


def table(of):
    head = row([of["title"], *of["columns"][1:]]) + "|" + "---|" * len(of["columns"]) + "\n"
    caption = of["caption"].strip()
    return "\n" + head + "".join(map(row, of["rows"])) + (f"\n{caption}\n" if caption else "")


def section(text, name):
    """Where the table of an experiment begins and ends."""
    begin = text.find(f"<!-- measured: {name} -->\n")
    if begin < 0:
        sys.exit(f"docs/experiments.md: there is no <!-- measured: {name} -->")
    begin = text.index("\n", begin) + 1
    return begin, text.index("<!-- end -->", begin)


def main(pliant, root, *words):
    write = "--write" in words
    document = pathlib.Path(root) / "docs" / "experiments.md"
    text = document.read_text()
    named = re.findall(r"<!-- measured: (.*) -->", text)
    files = sorted(p.stem for p in (pathlib.Path(root) / "experiments").glob("*.yaml"))
    missing = [name for name in files if name not in named]
    if missing:
        sys.exit(f"docs/experiments.md lacks {', '.join(missing)}")
    names = [w for w in words if w != "--write"] or named
    wrong = []
    for name in names:
        verdict = run(pliant, name)
        claims = verdict["claims"]
        begin, end = section(text, name)
        if write:
            text = text[:begin] + "\n" + HEAD + "".join(map(row_of_claim, claims)) + \
                "".join(map(table, verdict["tables"])) + "\n" + text[end:]
            continue
        stated = {}
        for line in text[begin:end].strip().split("\n\n")[0].splitlines():  # the claims come first
            cells = [cell.strip() for cell in line.strip("|").split(" | ")]
            if len(cells) == 4 and cells[0] not in ("claim", "---|---|---|---"):
                stated[cells[0]] = cells[3] == "holds"
        found = {claim["id"]: claim["holds"] for claim in claims}
        if stated != found:
            wrong.append(f"{name}: docs/experiments.md says {stated}, measured {found}")
        else:
            print(f"{name}: {len(found)} claims as the table says")
    if write:
        document.write_text(text)
    if wrong:
        sys.exit("\n".join(wrong))


main(*sys.argv[1:])
