"""The package computes what the program computes, bit by bit: every filter, every format, every other command.

Prints the table of hashes. With FETTLE_HASHES=FILE it is written there, too."""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy as np

import fettle
from fettle._commands import TABLES

from program import hash_of, run

FILTERS = [word["word"] for row in TABLES["filter"]["parameters"] if row["name"] == "--filter" for word in row["words"]]
WRITTEN = [(name, extensions[0]) for name, _, extensions, _, writes in fettle.formats() if writes]
READ = [(name, extensions) for name, _, extensions, reads, _ in fettle.formats() if reads]


class Hashes(unittest.TestCase):
    table = []

    @classmethod
    def setUpClass(cls):
        warnings.simplefilter("ignore", fettle.FettleWarning)
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.scan = os.path.join(cls.folder, "scan.tif")
        run("synth", cls.scan, "--size", "150x131", "--seed", "5", "--edges", cls.path("edges.png"))

    @classmethod
    def tearDownClass(cls):
        lines = ["what,program,package", *(",".join(row) for row in cls.table)]
        print("\n".join(lines))
        if os.environ.get("FETTLE_HASHES"):
            with open(os.environ["FETTLE_HASHES"], "w", encoding="ascii") as file:
                file.write("\n".join(lines) + "\n")

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def same(self, what, of_program, of_package):
        self.table.append((what, of_program, of_package))
        self.assertEqual(of_package, of_program, what)

    def test_every_filter(self):
        self.assertGreaterEqual(len(FILTERS), 7)
        field = fettle.read(self.scan)
        for name in FILTERS:
            # A cut-off or radius belongs to the question, and has no default.
            numbers = {}
            if name in ("areal-gaussian", "robust-gaussian", "spline", "robust-spline"):
                numbers = {"cutoff": "8mm"}
            elif name in ("opening", "closing"):
                numbers = {"radius": "3mm"}
            options = [text for key, value in numbers.items() for text in (f"--{key}", value)]
            done = run("filter", self.scan, self.path("out.tif"), "--filter", name, *options)
            self.same(" ".join(["filter", name, *options]), done["hash"], field.filter(name, **numbers).hash)

    def test_filters_with_every_kind_of_number_and_file(self):
        field = fettle.read(self.scan)
        marks = fettle.read(self.scan).mark(edges=True)
        np.testing.assert_array_equal(
            marks.marks, self.marks_of("mark", self.scan, self.path("marks.png"), "--edges")
        )
        keep = self.path("marks.png")
        for arguments, options in [
            (["--filter", "gaussian", "--window", "9", "--sigma", "1.3"], {"window": 9, "sigma": 1.3}),
            (["--filter", "median", "--window", "5", "--keep", keep], {"window": 5, "keep": marks.marks}),
            (["--filter", "median", "--window", "5", "--keep", keep], {"window": 5, "keep": keep}),
            (["--filter", "box", "--only", keep, "--passes", "3"], {"passes": 3, "only": marks}),
            (["--filter", "median", "--max-change", "7um"], {"max_change": "7um"}),
            (["--filter", "bilateral", "--range-sigma", "0.0213"], {"range_sigma": 0.0213}),
            (["--filter", "tgv", "--threads", "1"], {"threads": 1}),
            (["--filter", "closing", "--radius", "2", "--element", "disk"], {"radius": "2", "element": "disk"}),
        ]:
            done = run("filter", self.scan, self.path("out.tif"), *arguments)
            shown = " ".join(os.path.basename(word) for word in arguments[1:])
            self.same(f"filter {shown}", done["hash"], field.filter(arguments[1], **options).hash)

    def marks_of(self, *arguments):
        run(*arguments)
        return fettle.read(self.scan).filter("box", window=1, keep=arguments[2]).marks

    def test_every_format_is_written_and_read_alike(self):
        self.assertGreaterEqual(len(WRITTEN), 9)
        field = fettle.read(self.scan)
        for name, extension in WRITTEN:
            one, other = self.path("program" + extension), self.path("package" + extension)
            run("convert", self.scan, one)
            field.write(other)
            of_program = hash_of(one)
            self.same(f"read {name} {extension}", of_program, fettle.read(one).hash)
            self.same(f"write {name} {extension}", of_program, fettle.read(other).hash)
            if name != "Fettle":  # a session holds the time of its steps
                with open(one, "rb") as first, open(other, "rb") as second:
                    self.assertEqual(first.read(), second.read(), extension)

    def test_small_files_of_every_format_are_read_alike(self):
        folder = self.path("seeds")
        os.mkdir(folder)
        subprocess.run([os.environ["FETTLE_SEEDS"], folder], check=True, stdout=subprocess.DEVNULL)
        seen = set()
        for place, _, names in sorted(os.walk(folder)):
            for name in sorted(names):
                extension = "." + os.path.basename(place)
                path = os.path.join(place, name + extension)
                os.rename(os.path.join(place, name), path)
                try:
                    field = fettle.read(path)
                except fettle.InputError as refused:
                    with self.assertRaisesRegex(AssertionError, re.escape(json.dumps(refused.what)[1:-1])):
                        run("info", path)
                    continue
                seen.add(extension)
                self.same(f"read {name}{extension}", hash_of(path), field.hash)
        for name, extensions in READ:
            if name != "Fettle":  # a session is among the files that are written
                self.assertTrue(seen.intersection(extensions), name)

    def test_simulated_scans(self):
        parts = [word["word"] for row in TABLES["synth"]["parameters"] if row["name"] == "--part" for word in row["words"]]
        self.assertIn("bracket", parts)
        for part in parts:
            done = run("synth", self.path("synth.tif"), "--size", "96x64", "--seed", "9", "--part", part)
            self.same(f"synth {part}", done["hash"], fettle.synth(size=(96, 64), seed=9, part=part).hash)

    def test_marks_and_lines_of_suggested_edges(self):
        done = run("mark", self.scan, self.path("m.png"), "--edges", "--lines-out", self.path("lines.csv"))
        field = fettle.read(self.scan).mark(edges=True, lines_out=True)
        self.assertEqual(field.report["marked"], done["marked"])
        self.assertEqual(int(field.marks.sum()), done["marked"])
        self.assertEqual(sum(len(line) for line in field.lines), done["line_points"])
        filtered = run("filter", self.scan, self.path("o.tif"), "--filter", "tgv", "--lines", self.path("lines.csv"))
        plain = fettle.read(self.scan)
        self.same("filter tgv --lines", filtered["hash"], plain.filter("tgv", lines=field.lines).hash)
        self.same("filter tgv, lines of a file", filtered["hash"], plain.filter("tgv", lines=self.path("lines.csv")).hash)
        of_program = run("lines", self.scan, self.path("lines.csv"))["lines"]
        self.assertEqual(plain.measure_lines(field.lines)["lines"], of_program)
        self.assertEqual(plain.with_lines(field.lines).measure_lines()["lines"], of_program)

    def test_levelled_filled_and_transformed_scans(self):
        heights = np.asarray(fettle.read(self.scan)).copy()
        heights[20:25, 30:37] = np.nan
        holed = self.path("holed.tif")
        fettle.read(self.scan).with_heights(heights).write(holed)
        field = fettle.read(holed)
        for name, options in [
            ("level", {}),
            ("level", {"form": "poly3", "robust": True}),
            ("level", {"rows": "median", "scan_axis": "y"}),
            ("fill", {}),
            ("remove", {"between": ("0mm", "1mm")}),
            ("fill", {"method": "membrane", "max_extent": "20mm"}),
            ("transform", {"crop": (3, 2, 60, 70)}),
            ("transform", {"crop_samples": (1, 2, 90, 80), "mirror": "x"}),
            ("transform", {"turn": 270}),
            ("transform", {"angle": 12.5}),
            ("transform", {"to_spacing": 1.5}),
            ("transform", {"to_spacing": ("1.1mm", 0.7), "method": "cubic"}),
        ]:
            words = []  # before the scans, as many type them
            for key, value in options.items():
                text = ",".join(map(str, value)) if isinstance(value, tuple) else value
                words += ["--" + key.replace("_", "-"), *([] if value is True else [text])]
            done = run(name, *words, holed, self.path("out.tif"), "--force")
            method = field.transformed if name == "transform" else getattr(field, name)
            self.same(" ".join(map(str, [name, *words])), done["hash"], method(**options).hash)
        layer, put = self.path("layer.fettle"), self.path("put.fettle")
        field.write(layer)
        run("level", layer, put, "--layer", "put", "--form", "poly2")
        made = field.level(layer="put", form="poly2").filter("median")
        done = run("filter", put, self.path("seen.fettle"), "--filter", "median")
        self.same("level --layer put, filter median", done["hash"], made.hash)

    def test_measured_sectioned_and_aligned_scans(self):
        def figures(*arguments):
            report = run(*arguments)
            report.pop("warnings", None)
            return report

        a, other = fettle.read(self.scan), self.path("aligned.tif")
        a.filter("gaussian").transformed(crop_samples=(4, 3, 120, 140)).write(other)
        self.assertEqual(a.measure(), figures("measure", self.scan))
        words = ["--start", "1,20", "--end", "60,40", "--probe", "10,12"]
        self.assertEqual(a.section(start=(1, 20), end=(60, 40), probe=(10, 12)), figures("section", *words, self.scan))
        words = ["--line", "1,20:60,40:70,41"]
        self.assertEqual(a.section(line=[(1, 20), (60, 40), (70, 41)]), figures("section", *words, self.scan))
        done = run("align", self.scan, other, self.path("moved.tif"), "--moves", "shift")
        self.same("align --moves shift", done["hash"], a.align(fettle.read(other), moves="shift").hash)
        nominal = self.path("nominal.stl")
        run("convert", self.scan, nominal)
        words = ["--distance", "shortest", "--tolerance", "0.01"]
        self.assertEqual(a.compare(nominal, distance="shortest", tolerance=0.01), figures("compare", self.scan, nominal, *words))
        done = run("align", self.scan, nominal, self.path("moved.tif"), "--moves", "level")
        self.same("align to a mesh", done["hash"], a.align(nominal, moves="level").hash)

    def test_a_mosaic(self):
        scan = fettle.synth(part="bracket", size=(160, 120), seed=6)
        parts = [scan.transformed(crop_samples=(0, column, 120, 100)) for column in (0, 60)]
        paths = [self.path(f"part{number}.tif") for number in range(2)]
        for part, path in zip(parts, paths):
            part.write(path)
        done = run("mosaic", *paths, self.path("mosaic.tif"), "--moves", "shift", "--blend", "mean")
        made = fettle.mosaic(parts, moves="shift", blend="mean")
        self.same("mosaic", done["hash"], made.hash)
        # Of parts of a scan what they began with goes along.
        for part in parts:
            self.assertEqual(part.original.shape, part.shape)
        mirrored = scan.transformed(mirror="x")
        self.assertEqual(mirrored.original.hash, mirrored.hash)
        self.same("mosaic of files", done["hash"], fettle.mosaic(paths, moves="shift", blend="mean").hash)
        self.assertEqual(made.shape, scan.shape)
        self.assertLess(made.compare(scan)["max_abs"], 0.05)

    def test_a_recipe_with_every_step(self):
        recipe = self.path("every.toml")
        with open(recipe, "w", encoding="utf-8") as file:
            file.write(
                'recipe = 1\n[[step]]\ndo = "transform"\ncrop_samples = [2, 3, 100, 110]\nturn = 90\n'
                '[[step]]\ndo = "fill"\n[[step]]\ndo = "level"\nform = "poly2"\n[[step]]\ndo = "mark_edges"\n'
                '[[step]]\ndo = "filter"\nfilter = "median"\nwindow = 5\n'
            )
        done = run("apply", recipe, self.scan, self.path("applied.tif"))
        self.same("apply of a recipe", done["hash"], fettle.read(self.scan).apply(recipe).hash)

    def test_strokes(self):
        strokes = self.path("strokes.csv")
        middle = fettle.read(self.scan)
        x, y = (side * spacing / 2 for side, spacing in zip(middle.shape[::-1], middle.spacing))
        z = float(np.asarray(middle)[65, 75])
        with open(strokes, "w", encoding="ascii") as file:
            file.write("t,x,y,z,tool\n")
            for tick in range(400):
                file.write(f"{tick / 1000},{x + tick * 0.05},{y},{z + 5 - tick * 0.02},smooth\n")
        done = run("replay", self.scan, strokes, self.path("touched.tif"))
        made = middle.replay(strokes)
        self.assertGreater(made.report["contact_ticks"], 0)
        self.same("replay", done["hash"], made.hash)
        self.same("replay", done["hash"], fettle.replay(self.scan, strokes).hash)

    def test_figures(self):
        a, b = fettle.read(self.scan), fettle.read(self.scan).filter("median")
        b.write(self.path("b.tif"))
        self.assertEqual(a.compare(b), run("compare", self.scan, self.path("b.tif")))
        self.assertEqual(a.compare(self.path("b.tif")), run("compare", self.scan, self.path("b.tif")))
        of_program = run("info", self.scan)
        of_package = a.info()
        self.assertEqual({**of_package, "warnings": None}, {**of_program, "warnings": None})

    def test_sessions_continue_each_others_work(self):
        session = self.path("work.fettle")
        fettle.read(self.scan).filter("median", window=5).write(session)
        done = run("filter", session, self.path("more.fettle"), "--filter", "gaussian", "--max-change", "20um")
        made = fettle.read(session).filter("gaussian", max_change="20um")
        self.same("filter of a session", done["hash"], made.hash)
        self.assertEqual(made.original.hash, fettle.read(self.scan).hash)


if __name__ == "__main__":
    sys.path.insert(0, os.path.dirname(__file__))
    unittest.main()
