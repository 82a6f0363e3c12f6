"""What help() says is true: examples run, and every row of every command is a parameter."""

import doctest
import inspect
import os
import re
import tempfile
import textwrap
import unittest

import numpy as np

import fettle
import fettle._commands
import fettle._field
import fettle._lines
import fettle._session
from fettle._commands import READING, REPORTS, TABLES, WRITING, identifier

SOURCE = os.environ["FETTLE_SOURCE"]

# Rows without a meaning in Python: standard input and output have no format to be named, a method has one scan, and fields
# of a whole process are stored where its first one says.
NOT_HERE = {"shard", "shard-dir", "shards-in-turn", "memory", "from", "to", "out-dir", "force", "store", "suggest", "estimate", "resume", "resume-every"}
FUNCTIONS = [fettle.read, fettle.synth, fettle.mosaic, fettle.replay]
FUNCTIONS += [member for member in vars(fettle.Field).values() if hasattr(member, "_command")]


def parameters_of(command):
    return {
        name
        for function in FUNCTIONS
        if function._command.table["name"] == command
        for name in inspect.signature(function).parameters
    }


class Examples(unittest.TestCase):
    def run_examples(self, module, least):
        found = doctest.DocTestFinder(exclude_empty=True).find(module, extraglobs={"fettle": fettle, "np": np})
        runner = doctest.DocTestRunner()
        for example in found:
            runner.run(example)
        done = runner.summarize(verbose=False)
        self.assertEqual(done.failed, 0)
        self.assertGreaterEqual(done.attempted, least)

    def test_of_the_package(self):
        self.run_examples(fettle, 5)

    def test_of_the_field(self):
        self.run_examples(fettle._field, 50)

    def test_of_lines(self):
        self.run_examples(fettle._lines, 3)

    def test_of_the_session(self):
        self.run_examples(fettle._session, 4)


class Tables(unittest.TestCase):
    def test_every_command_is_a_function_or_a_property(self):
        for name in TABLES:
            self.assertTrue(parameters_of(name) or name in ("recipe", "journal"), name)

    def test_every_row_is_a_parameter(self):
        for name, table in TABLES.items():
            if name in ("recipe", "journal"):  # of Session, without parameters
                continue
            known = parameters_of(name)
            for row in table["parameters"]:
                # fettle.read reads, Field.write writes; other methods have a field and give one.
                if row["group"] in (READING, WRITING) and name != "convert":
                    continue
                if row["group"] == REPORTS or row["positional"] or row["name"].lstrip("-") in NOT_HERE:
                    continue
                self.assertIn(identifier(row), known, f"{name} {row['name']}")

    def test_documentation_names_every_parameter_with_its_range_and_unit(self):
        for function in FUNCTIONS:
            for name, row in function._command.rows.items():
                entry = re.search(rf"^    {name} \((?s:.)*?\.\n(?!        )", function.__doc__, re.MULTILINE)
                self.assertIsNotNone(entry, f"{function.__name__} {name}")
                told = " ".join(entry.group().split())
                if row["unit"]:
                    self.assertIn(row["unit"], told)
                for bound in row["range"] or []:
                    if bound is not None:
                        self.assertIn(f"{bound:.10g}", told)

    def test_a_command_without_a_function_of_its_own_gets_a_method(self):
        field = fettle.synth(size=(64, 64), seed=3)
        method = fettle._field.method_of
        self.assertEqual(method("mark")(field, edges=True).hash, field.mark(edges=True).hash)
        self.assertEqual(method("filter")(field, filter="median").hash, field.filter("median").hash)
        self.assertEqual(method("info")(field), field.info())
        self.assertEqual(method("compare")(field, field.filter("box")), field.compare(field.filter("box")))
        self.assertEqual(list(inspect.signature(method("compare")).parameters)[:2], ["self", "b"])


    def test_a_method_has_an_example_and_says_what_it_returns(self):
        for function in FUNCTIONS:
            if function._command.table["name"] in ("level", "fill", "remove", "transform", "measure", "section", "align"):
                self.assertIn(">>> ", function.__doc__, function.__name__)
                self.assertNotIn("what the command prints", function.__doc__, function.__name__)


class Pages(unittest.TestCase):
    """The blocks of Python in README and in the guide, in the order of their page, in a folder with a scan of theirs."""

    def run_blocks(self, path):
        with open(os.path.join(SOURCE, path), encoding="utf-8") as file:
            blocks = re.findall(r"^( *)```python\n(.*?)^\1```$", file.read(), re.MULTILINE | re.DOTALL)
        names = {}
        for _, block in blocks:
            exec(compile(textwrap.dedent(block), path, "exec"), names)  # pylint: disable=exec-used
        return len(blocks), names

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        fettle.synth(size=(192, 128), seed=1).write("scan.tif")

    def test_the_guide_for_python_runs(self):
        blocks, names = self.run_blocks("docs/guide/python.md")
        self.assertGreaterEqual(blocks, 6)
        self.assertIsInstance(names["clean"], fettle.Field)

    def test_readme_runs(self):
        blocks, _ = self.run_blocks("README.md")
        self.assertGreaterEqual(blocks, 1)


if __name__ == "__main__":
    unittest.main()
