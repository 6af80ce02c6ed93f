"""What a user reads: docs/python.md, the example, docstrings and stubs.

    documents_test.py PLIANT
"""

import ast
import inspect
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import pliant

ROOT = Path(__file__).resolve().parents[2]
STUB = ast.parse((Path(pliant.__file__).parent / "__init__.pyi").read_text())


def public(thing):
    """Names that a user may write, and operators that the module defines."""
    def own(name):
        if name == "__init__":  # pybind11 gives one to each
            return "->" in (thing.__init__.__doc__ or "")
        return name in ("__getitem__", "__setitem__", "__contains__", "__len__", "__iter__",
                        "__bool__", "__array__",
                        "__enter__", "__exit__")
    return {name for name in vars(thing) if not name.startswith("_") or own(name)}


def stub_signature(function):
    """[(name, has a default)], and how many of them may be given by position."""
    a = function.args
    plain = a.posonlyargs + a.args
    optional = [False] * (len(plain) - len(a.defaults)) + [True] * len(a.defaults)
    optional += [default is not None for default in a.kw_defaults]
    names = [argument.arg for argument in plain + a.kwonlyargs]
    return list(zip(names, optional)), len(plain)


def module_signature(function):
    """The same, from the first line of what pybind11 documents."""
    line = function.__doc__.splitlines()[0]
    signature = line[line.index("(") + 1:line.rindex(") ->")]
    depth, parts = 0, [""]
    for c in signature:
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    parts = [part.strip() for part in parts if part.strip()]
    plain = parts.index("*") if "*" in parts else len(parts)
    return [(p.split(":")[0].strip(), " = " in p) for p in parts if p != "*"], plain


class Stubs(unittest.TestCase):
    def functions(self, body):
        return {node.name: node for node in body if isinstance(node, ast.FunctionDef)}

    def agree(self, where, stub, function):
        if where.endswith("__exit__"):
            return  # takes any arguments
        expected, plain = stub_signature(stub)
        found, of_module = module_signature(function)
        # pybind11 calls the first argument self or, where it has no name, arg0.
        if not any(isinstance(d, ast.Name) and d.id == "staticmethod" for d in stub.decorator_list) \
                and "." in where:
            expected, found = expected[1:], found[1:]
            plain, of_module = plain - 1, of_module - 1
        self.assertEqual(([n for n, _ in expected], [o for _, o in expected], plain),
                         ([n for n, _ in found], [o for _, o in found], of_module), where)

    def test_they_have_every_public_name_and_signature(self):
        classes = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}
        functions = self.functions(STUB.body)
        self.assertEqual(set(pliant.__all__), classes.keys() | functions.keys() | {"__version__"})
        for name, node in functions.items():
            self.agree(name, node, getattr(pliant, name))
        for name, node in classes.items():
            real = getattr(pliant, name)
            self.assertEqual(real.__module__, "pliant")
            if issubclass(real, Exception):
                self.assertEqual([b.id for b in node.bases], [b.__name__ for b in real.__bases__])
                continue
            members = self.functions(node.body)
            self.assertEqual(members.keys(), public(real), name)
            for member, stub in members.items():
                value = inspect.getattr_static(real, member)
                decorators = [d.id for d in stub.decorator_list if isinstance(d, ast.Name)]
                self.assertEqual(isinstance(value, property), "property" in decorators, f"{name}.{member}")
                if isinstance(value, property):
                    self.assertIsNone(value.fset, f"{name}.{member} can be set, its stub cannot")
                else:
                    self.assertEqual(isinstance(value, staticmethod), "staticmethod" in decorators)
                    self.agree(f"{name}.{member}", stub, getattr(real, member))

    def test_everything_is_documented(self):
        for name in pliant.__all__:
            if name == "__version__":
                continue
            thing = getattr(pliant, name)
            self.assertTrue(thing.__doc__ and thing.__doc__.strip(), name)
            for member in public(thing) if inspect.isclass(thing) else ():
                if not member.startswith("_") and not issubclass(thing, Exception):
                    text = getattr(thing, member).__doc__ or ""
                    self.assertGreater(len(text.split("\n", 1)[-1].strip()), 2, f"{name}.{member}")

    def test_the_version_is_that_of_the_command(self):
        told = subprocess.run([command, "--version"], capture_output=True, text=True, check=True).stdout
        self.assertIn(pliant.__version__, told)


class Documents(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "examples").symlink_to(ROOT / "examples")

    def test_the_code_of_page_and_readme_runs(self):
        for page in ("docs/python.md", "README.md"):
            blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), re.S | re.M)
            self.assertTrue(blocks)
            (self.folder / "page.py").write_text("".join(blocks))
            done = subprocess.run([sys.executable, "page.py"], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), page)

    def test_the_example_draws_its_figure(self):
        figure = self.folder / "figure.png"
        example = ROOT / "examples/python/stiffness.py"
        done = subprocess.run([sys.executable, example, figure], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("slowest mode", done.stdout)
        self.assertEqual(figure.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(figure.stat().st_size, 20_000)  # lines, not an empty frame


if __name__ == "__main__":
    command = sys.argv.pop()
    unittest.main()
