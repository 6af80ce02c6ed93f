"""Checks that what the documents show is so.

    documents_test.py ROOT [--write] [--run BIN]

Every ```cpp block stands word for word in a file of examples/ or tests/, every ```yaml block in one
of examples/ or experiments/; one with a line <!-- example: FILE --> above it is the whole of a YAML
FILE, of others the part between the lines "// shown: begin" and "// shown: end", and --write puts it
there. Every line of an ```sh block is a script of the repository, CMake's own, or stands in
commands.txt beside this file; --run runs those, in order, in one folder that has the repository's
examples/ and experiments/ and nothing else, with BIN in front of the PATH. Links to files lead
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
SCRIPT = re.compile(r"(?:\./setup|\./demo|\./check|\.ci/run|bench/run|cmake|ctest|git|cd|clang-format|python3)\b")
MARKED = re.compile(r"<!-- example: (\S+) -->\n\s*```(cpp|yaml)\n(.*?)```", re.S)
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.S | re.M)
LINK = re.compile(r"\]\(([^)#:\s]+)[^):\s]*\)|(?:src|href)=\"([^\"#:]+)\"")


def shown(source):
    if source.suffix == ".yaml":
        return source.read_text()
    match = re.search(r"^ *// shown: begin\n(.*?)^ *// shown: end\n", source.read_text(), re.S | re.M)
    if not match:
        sys.exit(f'{source}: no lines "// shown: begin" and "// shown: end"')
    return match[1].strip("\n") + "\n"


def commands():
    lines = [line.strip() for line in COMMANDS.read_text().splitlines()]
    return [line for line in lines if line and not line.startswith("#")]


def problems_of(document, code):
    text = document.read_text()
    for match in MARKED.finditer(text):
        if match[3] != shown(Path(match[1])):
            yield f"{document}: the example is not that of {match[1]}; run {__file__} . --write"
    for match in BLOCK.finditer(text):
        where = f"{document}:{text.count(chr(10), 0, match.start()) + 1}"
        if match[1] in ("cpp", "yaml") and not any(match[2] in other for other in code):
            yield f"{where}: this stands in no file that a test compiles or runs"
        if match[1] in ("sh", "bash", "console"):
            for line in match[2].replace("\\\n", " ").splitlines():
                command = re.sub(r"\s+", " ", line.split(" #")[0]).strip()
                if command and not SCRIPT.match(command) and command not in commands():
                    yield f"{where}: a command that no test runs: {command}"
    for match in LINK.finditer(text):
        target = match[1] or match[2]
        if not (document.parent / target).exists():
            yield f"{document}: leads nowhere: {target}"


def write(document):
    def fill(match):
        return f"<!-- example: {match[1]} -->\n\n```{match[2]}\n{shown(Path(match[1]))}```"

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
    sources += tree.files(Path("examples"), ".yaml") + tree.files(Path("experiments"), ".yaml")
    code = [f.read_text() for f in sources]
    everything = "".join(document.read_text() for document in documents)
    problems = [p for document in documents for p in problems_of(document, code)]
    problems += [f"{COMMANDS.name}: no document shows {command}"
                 for command in commands() if command not in everything]
    tree.finish(problems, len(documents))


if __name__ == "__main__":
    main()
