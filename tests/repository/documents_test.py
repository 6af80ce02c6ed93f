"""Checks that what the documents show is so.

    documents_test.py ROOT [--write] [--run BIN]

Every ```cpp block stands word for word in a file of examples/ or tests/, every ```yaml block in one
of examples/ or experiments/. Below a line <!-- example: FILE --> stands the part of FILE between the
lines "// shown: begin" and "// shown: end", or all of a file without them; <!-- example: FILE#NAME -->
takes the parts between "// shown: begin NAME" and "// shown: end NAME". --write puts them there.

Every line of an ```sh block is a script of the repository, CMake's own, or stands in commands.txt
beside this file; --run runs those, in order, in one folder that has the repository's examples/ and
experiments/ and nothing else, with BIN in front of the PATH. Of a document with a line
<!-- run in: FOLDER --> all ```sh blocks are run by install_test.py, in a copy of that folder, and a
```text block is a part of what the block above it prints. Links to files and headings lead
somewhere.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import tree

COMMANDS = Path(__file__).with_name("commands.txt")
SCRIPT = re.compile(r"(?:\./setup|\./demo|\./check|\.ci/run|bench/run|cmake|ctest|git|cd|clang-format|python3|cpack|sudo apt-get)\b")
MARKED = re.compile(r"<!-- example: ([^\s#]+)(?:#(\w+))? -->\n\s*```(\w+)\n(.*?)```", re.S)
RUN_IN = re.compile(r"^<!-- run in: (\S+) -->$", re.M)
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.S | re.M)
LINK = re.compile(r"\]\(([^)#:\s]*)(?:#([^):\s]+))?\)|(?:src|href)=\"([^\"#:]+)\"")
HEADING = re.compile(r"^#+ (.*)$", re.M)


def shown(source, part):
    text = source.read_text()
    name = f" {part}" if part else ""
    marks = rf"^ *// shown: begin{name}\n(.*?)^ *// shown: end{name}\n"
    parts = re.findall(marks, text, re.S | re.M)
    if part and not parts:
        sys.exit(f'{source}: no lines "// shown: begin{name}" and "// shown: end{name}"')
    return "\n".join(lines.strip("\n") + "\n" for lines in parts) or text.removeprefix("#pragma once\n\n")


def commands():
    lines = [line.strip() for line in COMMANDS.read_text().splitlines()]
    return [line for line in lines if line and not line.startswith("#")]


def slug(heading):
    """A heading's anchor, as GitHub makes it: lower case, blanks to hyphens, nothing else but words."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def anchors(document):
    return {slug(heading) for heading in HEADING.findall(BLOCK.sub("", document.read_text()))}


def problems_of(document, code):
    text = document.read_text()
    marked = set()
    for match in MARKED.finditer(text):
        marked.add(match[4])
        if match[4] != shown(Path(match[1]), match[2]):
            yield f"{document}: the example is not that of {match[1]}; run {__file__} . --write"
    for match in BLOCK.finditer(text):
        where = f"{document}:{text.count(chr(10), 0, match.start()) + 1}"
        if match[1] in ("cpp", "yaml", "cmake", "xml") and match[2] not in marked and \
                not any(match[2] in other for other in code):
            yield f"{where}: this stands in no file that a test compiles or runs"
        if match[1] in ("sh", "bash", "console") and not RUN_IN.search(text):
            for line in match[2].replace("\\\n", " ").splitlines():
                command = re.sub(r"\s+", " ", line.split(" #")[0]).strip()
                if command and not SCRIPT.match(command) and command not in commands():
                    yield f"{where}: a command that no test runs: {command}"
    for match in LINK.finditer(text):
        target = document.parent / (match[1] or match[3]) if match[1] or match[3] else document
        if not target.exists():
            yield f"{document}: leads nowhere: {target}"
        elif match[2] and target.suffix == ".md" and match[2] not in anchors(target):
            yield f"{document}: there is no heading #{match[2]} in {target}"


def sessions():
    """Of each document that is run as a whole: its name, its folder, its ```sh blocks, each with the
    ```text blocks below it."""
    for document in tree.files(Path("."), ".md"):
        text = document.read_text()
        if folder := RUN_IN.search(text):
            blocks = []
            for match in BLOCK.finditer(text):
                if match[1] == "sh":
                    blocks.append((match[2], []))
                elif match[1] == "text":
                    blocks[-1][1].append(match[2])
            yield document, Path(folder[1]), blocks


def write(document):
    def fill(match):
        name = match[1] + (f"#{match[2]}" if match[2] else "")
        return f"<!-- example: {name} -->\n\n```{match[3]}\n{shown(Path(match[1]), match[2])}```"

    document.write_text(MARKED.sub(fill, document.read_text()))


def run(binaries):
    environment = {**os.environ, "PATH": f"{binaries}:{os.environ['PATH']}"}
    with tempfile.TemporaryDirectory() as folder:
        for name in ("examples", "experiments"):
            os.symlink(Path(name).resolve(), Path(folder) / name)
        for command in commands():
            print(f"$ {command}", flush=True)
            if subprocess.run(command, shell=True, cwd=folder, env=environment).returncode:
                return [f"failed: {command}"]
    return []


def main():
    os.chdir(sys.argv[1])
    documents = tree.files(Path("."), ".md")
    if "--run" in sys.argv:
        return tree.finish(run(Path(sys.argv[-1]).resolve()), 1 + len(commands()))
    if "--write" in sys.argv:
        for document in documents:
            write(document)
    sources = tree.files(Path("examples"), ".cc", ".h") + tree.files(Path("tests"), ".cc", ".h")
    sources += tree.files(Path("examples"), ".yaml", ".txt", ".urdf") + tree.files(Path("experiments"), ".yaml")
    code = [f.read_text() for f in sources]
    everything = "".join(document.read_text() for document in documents)
    problems = [p for document in documents for p in problems_of(document, code)]
    problems += [f"{COMMANDS.name}: no document shows {command}"
                 for command in commands() if command not in everything]
    tree.finish(problems, len(documents))


if __name__ == "__main__":
    main()
