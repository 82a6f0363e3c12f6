"""The stubs say what the package is: to a reader of their text, to stubtest and to mypy."""

import ast
import collections.abc
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

    # Only the stubs, as a package of their own: stubtest would have the sources beside them checked, too.
    @unittest.skipIf(shutil.which("stubtest") is None, "mypy is not installed")
    def test_stubtest_finds_the_module_as_the_stubs_say(self):
        of_package = os.path.dirname(os.path.abspath(fettle.__file__))
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, "fettle"))
            for name in ("__init__.pyi", "dask.pyi", "py.typed"):
                shutil.copy(os.path.join(of_package, name), os.path.join(folder, "fettle"))
            done = subprocess.run(
                ["stubtest", "fettle"],
                env=dict(os.environ, MYPYPATH=folder, PYTHONPATH=os.path.dirname(of_package)),
                cwd=folder,
                capture_output=True,
                text=True,
                check=False,
            )
        self.assertRegex(done.stdout, r"^Success: no issues found in \d+ modules", done.stdout + done.stderr)

    @unittest.skipIf(shutil.which("mypy") is None, "mypy is not installed")
    def test_mypy_takes_right_calls_and_refuses_wrong_ones(self):
        right = """
            import fettle
            import fettle.dask
            import numpy as np
            scan = fettle.read("scan.tif")
            clean: fettle.Field = scan.mark(edges=True).filter("tgv", max_change="50um").level(form="poly2", layer="put")
            part: fettle.Field = clean.fill(max_extent=0.5).transformed(crop=(0, 0, 1, 1), to_spacing=0.02, turn=90)
            figures: dict = part.measure(only=["height", "hybrid"], at_height=[0, "-0.5um"])
            cut: dict = part.section(line=[(0, 0), (1, 1)], probe=(0.5, 0.5), compare=scan)
            picture: np.ndarray = scan.align(clean, moves="level").render(size=(640, 400))
            page: bytes = clean.page(original=scan)
            number: int = fettle.Session("work.fettle").steps[0].number
            noise: float = fettle.dask.noise(picture)
            parts = fettle.dask.filter(picture, "areal-gaussian", cutoff="0.8mm", spacing=(0.1, 0.2))
            """
        wrong = {
            'fettle.read("scan.tif").filter("tgb")': "arg-type",
            'fettle.read("scan.tif").level(frm="poly2")': "call-arg",
            'fettle.read("scan.tif").transformed(turn="45")': "arg-type",
            "fettle.Session(3)": "arg-type",
            'fettle.dask.filter(picture, "median", keep=True)': "call-arg",
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


if __name__ == "__main__":
    unittest.main()
