"""`pliant graph` as a user meets it; what it writes is read by dot and by Python's json."""

import json
import os
import re
import subprocess

from command import ROOT, InFolder, main

KNOWN_KINDS = ".svg, .dot, .mmd or .json"


class Graph(InFolder):
    def graph(self, *words):
        return self.ends(0, "graph", "arm.yaml", *words)

    def drawn(self, dot):
        """Graphviz' words about a picture, which have to be none, and the SVG it makes."""
        done = subprocess.run(["dot", "-Tsvg"], input=dot, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def test_without_out_graphviz_text_goes_to_the_standard_output(self):
        dot = self.graph()
        self.assertTrue(dot.startswith("digraph diagram {\n"))
        self.assertIn("<b>qp</b>", dot)
        self.assertIn(">A pushed arm<", dot)
        self.assertIn("<svg", self.drawn(dot))
        self.graph("--out", "arm.dot")
        self.assertEqual((self.folder / "arm.dot").read_text(), dot)

    def test_dot_takes_every_example(self):
        for file in sorted((ROOT / "examples").glob("*.yaml")):
            run = re.search(r"(?m)^runs:\s*- \{?name: (\w+)", file.read_text())
            which = ["--run", run[1]] if run else []
            for words in ([], ["--depth", "1"], ["--all", "--inputs"]):
                self.assertIn("<svg", self.drawn(self.ends(0, "graph", file, *which, *words)))

    def test_the_svg_is_that_of_dot(self):
        self.graph("--depth", "2", "--out", "new/folder/arm.svg")
        self.assertEqual((self.folder / "new/folder/arm.svg").read_text(),
                         self.drawn(self.graph("--depth", "2")))

    def test_writes_the_same_twice(self):
        for kind in ("dot", "mmd", "json", "svg"):
            for name in ("one", "two"):
                self.graph("--out", f"{name}.{kind}")
            self.assertEqual((self.folder / f"one.{kind}").read_bytes(),
                             (self.folder / f"two.{kind}").read_bytes())

    def test_mermaid_has_the_blocks_of_the_diagram(self):
        self.graph("--out", "arm.mmd")
        text = (self.folder / "arm.mmd").read_text()
        self.assertTrue(text.startswith("flowchart LR\n"))
        self.assertIn('["qp<br/><small>ComplianceQp<br/>1 kHz z⁻¹</small>"]', text)
        lines = [line.strip() for line in text.splitlines()]
        self.assertEqual(sum(line.startswith("subgraph ") for line in lines), lines.count("end"))

    def test_json_has_everything_and_every_wire_has_its_ends(self):
        self.graph("--out", "arm.json")
        diagram = json.loads((self.folder / "arm.json").read_text())
        self.assertEqual(diagram["title"], "A pushed arm")
        blocks = {block["path"]: block for block in diagram["blocks"]}
        values = {value["path"]: value for value in diagram["values"]}
        self.assertEqual(len(blocks), len(diagram["blocks"]))
        self.assertEqual(blocks["control.qp"]["type"], "ComplianceQp")
        self.assertEqual(blocks["control.qp"]["rates"], ["1 kHz"])
        self.assertEqual(blocks["control.qp"]["periods_s"], [0.001])
        self.assertTrue(blocks["control"]["composite"])
        self.assertTrue(blocks["arm.plant"]["continuous_state"])
        self.assertIn("recorder", blocks)
        self.assertNotIn("cost_s", blocks["control.qp"])
        for path, block in blocks.items():
            if block["parent"] is not None:
                self.assertEqual(path.rsplit(".", 1)[0], block["parent"])
                self.assertTrue(blocks[block["parent"]]["composite"])
            self.assertLessEqual(set(block["free"]), set(values))
        self.assertGreater(len(diagram["wires"]), 50)
        for wire in diagram["wires"]:
            source, target = values[wire["from"]], values[wire["to"]]
            self.assertIn(source["kind"], ("output", "held output"))
            self.assertIn(target["kind"], ("input", "input list"))
            self.assertEqual((source["type"], source["unit"]), (wire["type"], wire["unit"]))
            if target["type"] != "any":
                self.assertEqual(target["type"], wire["type"])
        measured = values["arm.sensors.measured_position"]
        self.assertEqual((measured["type"], measured["unit"]), ("joint position", "rad"))

    def test_costs_are_measured_if_asked(self):
        self.graph("--time", "--out", "arm.json")
        blocks = {block["path"]: block
                  for block in json.loads((self.folder / "arm.json").read_text())["blocks"]}
        self.assertGreater(blocks["control.qp"]["cost_s"], 0)
        self.assertLess(blocks["control.qp"]["cost_s"], 0.1)
        self.assertIn("all blocks: ", self.graph("--time"))
        self.assertNotIn("all blocks: ", self.graph())

    def test_set_and_run_choose_what_is_drawn(self):
        self.assertIn("<b>safety</b>", self.graph("--set", "safety={}"))
        self.write("two.yaml", self.scenario + "runs:\n  - {name: stiff, title: Stiff}\n"
                                               "  - {name: soft, title: Soft, set: {safety: {}}}\n")
        self.assertIn("<b>safety</b>", self.ends(0, "graph", "two.yaml", "--run", "soft"))
        self.assertIn(">A pushed arm: Stiff<", self.ends(0, "graph", "two.yaml", "--run", "stiff"))
        self.refuses("the file has several runs; name one with --run: stiff, soft", "graph", "two.yaml")
        self.refuses("--run: there is no run 'sof'; did you mean 'soft'?\n  known: stiff, soft",
                     "graph", "two.yaml", "--run", "sof")

    def test_a_log_is_drawn_as_the_scenario_that_ran(self):
        log = self.run_short("out", "--set", "safety={}")
        done = self.pliant("graph", log)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("<b>safety</b>", done.stdout)
        self.assertEqual(done.stderr, f"{log}: it holds no costs of blocks, which runs on an arm "
                                      "estimate; --time measures them here\n")
        self.assertEqual(self.pliant("graph", log, "--time").stderr, "")
        message = "--set and --run are about a scenario file, and a log is what one run was"
        self.refuses(message, "graph", log, "--run", "run")
        self.refuses(message, "graph", log, "--set", "safety={}")

    def test_titles_may_have_any_letters(self):
        self.write("arm.yaml", self.scenario.replace("title: A pushed arm",
                                                     "title: '<b>\"50 %\" & \\n {|} ü</b>'"))
        self.assertIn("&lt;b&gt;", self.drawn(self.graph()))
        self.graph("--out", "arm.json")
        self.assertEqual(json.loads((self.folder / "arm.json").read_text())["title"],
                         '<b>"50 %" & \\n {|} ü</b>')

    def test_bad_use_is_refused(self):
        self.refuses(f"arm.png: expected a file that ends in {KNOWN_KINDS}",
                     "graph", "arm.yaml", "--out", "arm.png")
        for words in (["--depth", "2"], ["--inputs"], ["--all"]):
            self.refuses("--depth, --inputs and --all are of pictures; a .json has everything",
                         "graph", "arm.yaml", "--out", "arm.json", *words)
        self.write("arm.dot", "")
        self.refuses("arm.dot exists; give --force to write over it, or another place",
                     "graph", "arm.yaml", "--out", "arm.dot")
        self.graph("--out", "arm.dot", "--force")
        self.refuses("none.yaml: cannot be read", "graph", "none.yaml")
        self.refuses("--set wants path=value, such as station.ideal=true, got x",
                     "graph", "arm.yaml", "--set", "x")
        self.assertIn("--depth", self.ends(2, "graph", "arm.yaml", "--depth", "0"))
        self.write("no.mcap", "nothing")
        self.assertIn("no.mcap", self.ends(2, "graph", "no.mcap"))

    def test_without_dot_it_says_what_to_install(self):
        done = self.pliant("graph", "arm.yaml", "--out", "arm.svg", env={**os.environ, "PATH": ""})
        self.assertEqual(done.returncode, 3)
        self.assertEqual(done.stderr,
                         "pliant: cannot run dot, which draws diagrams: No such file or directory\n"
                         "install the Debian package graphviz, or put the directory of dot on PATH\n")
        self.assertFalse((self.folder / "arm.svg").exists())


if __name__ == "__main__":
    main()
