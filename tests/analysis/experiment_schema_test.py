"""The schema of experiment files, held against a validator and the files themselves."""

import copy
import json
import re
import subprocess
import sys
import unittest
from pathlib import Path

import jsonschema
import yaml

SOURCES, SAMPLE = Path(sys.argv[1]), sys.argv[2]
del sys.argv[1:]


class Loader(yaml.SafeLoader):
    """Maps any tag to the value behind it, and takes 1e-6 for a number, as YAML 1.2 does."""


def plain(loader, _, node):
    if isinstance(node, yaml.MappingNode):
        return loader.construct_mapping(node, deep=True)
    if isinstance(node, yaml.SequenceNode):
        return loader.construct_sequence(node, deep=True)
    return loader.construct_scalar(node) or None


Loader.add_multi_constructor("!", plain)
Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"[-+]?[0-9.]+e[-+]?[0-9]+$"),
                             list("-+.0123456789"))


def read(text):
    return yaml.load(text, Loader)


def keys(value):
    if isinstance(value, dict):
        return set(value) | set().union(*map(keys, value.values()), set())
    return set().union(*map(keys, value), set()) if isinstance(value, list) else set()


class Schema(unittest.TestCase):
    def setUp(self):
        self.schema = json.loads(subprocess.check_output([SAMPLE, "schema"], text=True))
        self.validator = jsonschema.Draft7Validator(self.schema)
        self.files = sorted((SOURCES / "experiments").glob("*.yaml"))
        self.compliance = SOURCES / "experiments" / "null-space-compliance.yaml"

    def refuses(self, change):
        value = copy.deepcopy(read(self.compliance.read_text()))
        change(value)
        self.assertFalse(self.validator.is_valid(value))

    def test_is_a_schema_of_draft_7(self):
        self.assertEqual(self.schema["$schema"], "http://json-schema.org/draft-07/schema#")
        jsonschema.Draft7Validator.check_schema(self.schema)

    def test_takes_every_experiment_and_its_effective_text(self):
        self.assertGreater(len(self.files), 0)
        for file in self.files:
            self.validator.validate(read(file.read_text()))
            text = subprocess.check_output([SAMPLE, "text", str(file)], text=True)
            self.validator.validate(read(text))

    def test_names_every_key_of_a_text(self):
        named = set()

        def collect(schema):
            if isinstance(schema, dict):
                named.update(schema.get("properties", {}))
                for inner in schema.values():
                    collect(inner)
            elif isinstance(schema, list):
                for inner in schema:
                    collect(inner)

        collect(self.schema)
        for file in self.files:
            value = read(subprocess.check_output([SAMPLE, "text", str(file)], text=True))
            for run in value["runs"]:
                del run["set"]
            self.assertEqual(keys(value) - named - {"set"}, set())

    def test_refuses_misspelt_keys(self):
        self.refuses(lambda e: e.update(durations=1))
        self.refuses(lambda e: e["station"].update(ideals=True))
        self.refuses(lambda e: e["claims"][0].update(pape="x"))

    def test_refuses_missing_keys(self):
        for key in ("title", "robot", "duration_s"):
            self.refuses(lambda e: e.pop(key))
        self.refuses(lambda e: e["environment"][0].pop("link"))
        self.refuses(lambda e: e["runs"][0].pop("name"))

    def test_refuses_wrong_types(self):
        self.refuses(lambda e: e.update(duration_s=[1]))
        self.refuses(lambda e: e.update(seed=1.5))
        self.refuses(lambda e: e["station"].update(ideal=3))
        self.refuses(lambda e: e["integrator"].update(method="euler"))
        self.refuses(lambda e: e["environment"][0].update(force=[1, 2]))

    def test_refuses_values_out_of_range(self):
        self.refuses(lambda e: e.update(duration_s=0))
        self.refuses(lambda e: e.update(seed=-1))
        self.refuses(lambda e: e["controller"].update(observer_gain=0))

    def test_takes_units_and_words_for_numbers(self):
        value = copy.deepcopy(read(self.compliance.read_text()))
        value.update(duration_s="500 ms", log_period="100 Hz")
        value["controller"]["estimate"] = True  # `estimate: true`, as YAML reads it
        self.validator.validate(value)


if __name__ == "__main__":
    unittest.main()
