"""What help() and the stub say is true: examples run, and every row of every command is a parameter."""

import ast
import collections.abc
import doctest
import inspect
import os
import re
import shutil
import subprocess
import tempfile
import textwrap
import typing
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
            if function._command.table["name"] in ("level", "fill", "transform", "measure", "section", "align"):
                self.assertIn(">>> ", function.__doc__, function.__name__)
                self.assertNotIn("what the command prints", function.__doc__, function.__name__)


class Stub(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(os.path.dirname(fettle.__file__), "__init__.pyi"), encoding="utf-8") as file:
            cls.tree = ast.parse(file.read())
        cls.members = {node.name: node for node in cls.tree.body if hasattr(node, "name")}

    def test_it_has_every_name_of_the_package(self):
        self.assertEqual(set(self.members), set(fettle.__all__))

    def test_its_parameters_are_those_of_the_functions(self):
        checked = 0
        for name, node in self.members.items():
            each = {name: getattr(fettle, name)} if isinstance(node, ast.FunctionDef) else vars(getattr(fettle, name))
            nodes = [node] if isinstance(node, ast.FunctionDef) else node.body
            for function in nodes:
                member = each.get(getattr(function, "name", ""))
                if not inspect.isfunction(member):
                    continue
                args = function.args
                stated = [arg.arg for arg in args.args + args.kwonlyargs]
                self.assertEqual(stated, list(inspect.signature(member).parameters), function.name)
                checked += 1
        self.assertGreater(checked, 20)

    def test_its_annotations_are_types(self):
        names = {"Callable": collections.abc.Callable, "Sequence": collections.abc.Sequence, "numpy": np, "os": os}
        names.update({name: getattr(typing, name) for name in ("Any", "Literal", "NamedTuple")})
        names.update({name: object for name in ("ArrayLike", "DTypeLike")}, **vars(fettle))
        checked = 0
        for node in ast.walk(self.tree):
            for part in (getattr(node, "annotation", None), getattr(node, "returns", None)):
                if part is not None:
                    eval(compile(ast.Expression(part), "stub", "eval"), dict(names))  # pylint: disable=eval-used
                    checked += 1
        self.assertGreater(checked, 200)

    def test_words_that_are_numbers_are_taken_as_numbers(self):
        with open(os.path.join(os.path.dirname(fettle.__file__), "__init__.pyi"), encoding="utf-8") as file:
            self.assertIn("turn: Literal['90', '180', '270', 90, 180, 270]", file.read())
        self.assertEqual(fettle.synth(size=(40, 30)).transformed(turn=90).shape, (40, 30))

    def test_dir_names_what_the_package_offers(self):
        self.assertEqual(sorted(dir(fettle)), sorted([*fettle.__all__, "__version__"]))

    @unittest.skipIf(shutil.which("mypy") is None, "mypy is not installed")
    def test_mypy_takes_right_calls_and_refuses_wrong_ones(self):
        right = """
            import fettle
            import numpy as np
            scan = fettle.read("scan.tif")
            clean: fettle.Field = scan.mark(edges=True).filter("tgv", max_change="50um").level(form="poly2", layer="put")
            part: fettle.Field = clean.fill(max_extent=0.5).transformed(crop=(0, 0, 1, 1), to_spacing=0.02, turn=90)
            figures: dict = part.measure(only=["height", "hybrid"], at_height=[0, "-0.5um"])
            cut: dict = part.section(line=[(0, 0), (1, 1)], probe=(0.5, 0.5), compare=scan)
            picture: np.ndarray = scan.align(clean, moves="level").render(size=(640, 400))
            page: bytes = clean.page(original=scan)
            number: int = fettle.Session("work.fettle").steps[0].number
            """
        wrong = {
            'fettle.read("scan.tif").filter("tgb")': "arg-type",
            'fettle.read("scan.tif").level(frm="poly2")': "call-arg",
            'fettle.read("scan.tif").transformed(turn="45")': "arg-type",
            "fettle.Session(3)": "arg-type",
        }
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "calls.py")
            lines = textwrap.dedent(right).strip().split("\n")
            with open(path, "w", encoding="utf-8") as file:
                file.write("\n".join([*lines, *wrong]) + "\n")
            done = subprocess.run(
                ["mypy", "--no-error-summary", "--cache-dir", folder, path],
                env=dict(os.environ, MYPYPATH=os.path.dirname(os.path.dirname(fettle.__file__))),
                capture_output=True,
                text=True,
                check=False,
            )
        found = re.findall(r"calls\.py:(\d+): error: .*\[([a-z-]+)\]", done.stdout)
        expected = [(str(len(lines) + 1 + k), kind) for k, kind in enumerate(wrong.values())]
        self.assertEqual(found, expected, done.stdout)
        self.assertNotRegex(done.stdout, r"pyi:\d+: error")

    def test_it_has_every_public_member_of_a_class(self):
        for name, node in self.members.items():
            if isinstance(node, ast.ClassDef) and not hasattr(getattr(fettle, name), "_fields"):
                public = {each for each in vars(getattr(fettle, name)) if not each.startswith("_")}
                stated = {each.name for each in node.body if isinstance(each, ast.FunctionDef)}
                stated |= {each.target.id for each in node.body if isinstance(each, ast.AnnAssign)}
                self.assertLessEqual(public, stated)


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
