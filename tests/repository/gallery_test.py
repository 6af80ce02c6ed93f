"""docs/gallery.md: a picture and the verdict of every experiment.

    gallery_test.py PLIANT ROOT                                      checks it
    gallery_test.py PLIANT ROOT --write [--reports FOLDER] [NAME …]  renews it

Checked: every experiment of `pliant experiment list` is there with the verdict that docs/experiments.md
has; pictures have at most 640 by 1000 pixels and 40 kB, and one that is missing is said to be. --write runs the experiments that are named,
all without names, one after the other, and draws their pictures; with --reports it takes what
`pliant experiment run NAME --out FOLDER/NAME` left. An experiment whose verdict is no longer that of
docs/experiments.md is refused: renew that first, see tests/apps/experiments_test.py.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import documents_test
import small_png
import tree

WIDTH, HEIGHT, BYTES = 640, 1000, 40_000
HEAD = """# Gallery

A picture and the verdict of every experiment that comes with pliant. All is simulated; [experiments.md](experiments.md) has
each claim with its numbers, `pliant experiment run NAME --out out` repeats it. One command renews this page:

```sh
python3 tests/repository/gallery_test.py build/release/bin/pliant . --write
```
"""

# Of experiments with several figures the one that says most; of others the only one.
FIGURES = {
    "cf-a": "contact", "cf-d": "norm", "cf-limits": "joint-limit", "ec-door": "door", "ec-fig2": "phase",
    "ec-scaling": "path", "ns-a": "path", "ns-b": "path", "null-space-compliance": "velocities",
    "integrators": "work-full", "rss-friction": "friction", "rss-torque-dynamic": "torque-error", "rss-torque-static": "torque-error",
}
TERMINAL = re.compile(r"^if \(!exists\('pdf'\)\) set terminal svg size (\d+),(\d+).*$", re.M)


def experiments(pliant):
    """Name and title of each, as the command lists them."""
    listed = subprocess.run([pliant, "experiment", "list"], check=True, capture_output=True, text=True)
    return dict(line.split(None, 1) for line in listed.stdout.splitlines())


def stated(text):
    """Of each experiment of docs/experiments.md: the heading above it, and its claims, which hold or
    do not."""
    found, heading = {}, ""
    for line in text.splitlines():
        if match := re.match(r"##+ (.*)", line):
            heading = match[1]
        elif match := re.match(r"<!-- measured: (.*) -->", line):
            claims = found.setdefault(match[1], (heading, {}))[1]
        elif line.startswith("| ") and line.endswith(("| holds |", "| **fails** |")):
            claims[line.split(" | ")[0].strip("| ")] = line.endswith("| holds |")
    return found


def verdict(claims):
    fails = [name for name, holds in claims.items() if not holds]
    if not fails:
        held = {1: "Its claim holds.", 2: "Both claims hold."}
        return held.get(len(claims), f"All {len(claims)} claims hold.")
    return f"**{len(claims) - len(fails)} of {len(claims)} claims hold**; not: {', '.join(fails)}."


def page(titles, facts):
    """In the order of docs/experiments.md; what has no claims comes last."""
    claims = [holds for _, of_one in facts.values() for holds in of_one.values()]
    text = HEAD + f"\n{sum(claims)} of {len(claims)} claims hold.\n"
    for name in sorted(titles, key=lambda name: list(facts).index(name) if name in facts else len(facts)):
        drawn = Path(f"docs/gallery/{name}.png").exists()
        picture = f"\n![{titles[name]}](gallery/{name}.png)\n" if drawn else "\nNo picture: it runs for many minutes.\n"
        if name in facts:
            heading, claims = facts[name]
            link = f"experiments.md#{documents_test.slug(heading)}"
            text += f"\n## {titles[name]}\n\n`{name}`: {verdict(claims)} [Numbers]({link})\n{picture}"
        else:
            text += f"\n## {name.capitalize()}\n\n`{name}`: {titles[name]}. It claims nothing. [Numbers]({name}.md)\n{picture}"
    return text


def draw(name, figures):
    """The picture of an experiment, from what its report was drawn from."""
    script = figures / f"{FIGURES.get(name, '')}.gp"
    if name not in FIGURES:
        (script,) = figures.glob("*.gp")
    text = script.read_text()
    width, height = map(int, TERMINAL.search(text).groups())
    scale = min(WIDTH / width, HEIGHT / height)
    terminal = (f"set terminal pngcairo size {round(scale * width)},{round(scale * height)} noenhanced "
                f"font 'sans-serif,{9.9 * scale:.2f}' linewidth {1.15 * scale:.2f} background rgb 'white'")
    text = TERMINAL.sub(terminal, re.sub(r"^.*set terminal pdfcairo.*\n", "", text, flags=re.M))
    drawn = subprocess.run(["gnuplot"], input=text.encode(), cwd=figures, check=True, capture_output=True)
    Path("docs/gallery").mkdir(exist_ok=True)
    Path(f"docs/gallery/{name}.png").write_bytes(small_png.reduced(drawn.stdout))


def renew(pliant, name, reports, facts):
    with tempfile.TemporaryDirectory() as folder:
        out = Path(reports) / name if reports else Path(folder)
        if not reports:
            subprocess.run([pliant, "experiment", "run", name, "--out", out, "--force"], check=True)
        claims = json.loads((out / "verdict.json").read_text())["claims"]
        found = {claim["id"]: claim["holds"] for claim in claims}
        if found != facts.get(name, ("", {}))[1]:
            sys.exit(f"{name}: docs/experiments.md has another verdict; renew it first")
        draw(name, out / "figures")


def problems(titles, facts):
    if Path("docs/gallery.md").read_text() != page(titles, facts):
        yield (f"docs/gallery.md is not what docs/experiments.md and `pliant experiment list` say; "
               f"run {sys.argv[0]} {sys.argv[1]} . --write")
    for picture in Path("docs/gallery").glob("*.png"):
        if picture.stem not in titles:
            yield f"{picture}: there is no such experiment"
        data = picture.read_bytes()
        width, height = small_png.size(data)
        if width > WIDTH or height > HEIGHT or len(data) > BYTES:
            yield f"{picture}: {width} by {height} pixels and {len(data)} bytes, allowed {WIDTH}, {HEIGHT} and {BYTES}"


def main():
    words = argparse.ArgumentParser()
    words.add_argument("pliant", type=lambda path: Path(path).resolve())
    words.add_argument("root")
    words.add_argument("--write", action="store_true")
    words.add_argument("--reports", type=lambda path: Path(path).resolve())
    words.add_argument("names", nargs="*")
    asked = words.parse_intermixed_args()
    os.chdir(asked.root)
    titles, facts = experiments(asked.pliant), stated(Path("docs/experiments.md").read_text())
    if asked.write:
        for name in asked.names or titles:
            print(name, flush=True)
            renew(asked.pliant, name, asked.reports, facts)
        Path("docs/gallery.md").write_text(page(titles, facts))
    tree.finish(list(problems(titles, facts)), len(titles))


if __name__ == "__main__":
    main()
