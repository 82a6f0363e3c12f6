"""Fields as arrays: what goes in comes out, and what cannot go in is refused with its reason."""

import copy
import multiprocessing
import os
import pickle
import tempfile
import unittest
import warnings

import numpy as np

import fettle
import fettle.dask


def hash_of(field):
    return field.hash


def wave(rows=70, columns=131):
    """Heights with holes, not a multiple of a tile in either direction."""
    y, x = np.mgrid[0:rows, 0:columns]
    heights = (np.sin(x / 9.0) + 0.1 * y).astype(np.float32)
    heights[3:5, 60:70] = np.nan
    heights[rows - 1, columns - 1] = np.nan
    return heights


class Arrays(unittest.TestCase):
    def test_heights_come_out_as_they_went_in(self):
        heights = wave()
        np.testing.assert_array_equal(np.asarray(fettle.Field(heights)), heights)

    def test_every_small_size_comes_out_as_it_went_in(self):
        for rows in (1, 2, 63, 64, 65):
            for columns in (1, 2, 63, 64, 65, 129):
                heights = np.arange(rows * columns, dtype=np.float32).reshape(rows, columns)
                np.testing.assert_array_equal(np.asarray(fettle.Field(heights)), heights)

    def test_views_of_any_strides_are_taken_as_numpy_sees_them(self):
        heights = wave()
        for view in (heights[::-1], heights[:, ::-1], heights[::2, ::3], heights.T, np.asfortranarray(heights)):
            np.testing.assert_array_equal(np.asarray(fettle.Field(view)), view)

    def test_other_types_become_float32(self):
        for kind in (np.uint16, np.int32, np.float64, bool):
            heights = np.array([[0, 1, 1], [1, 0, 1]], dtype=kind)
            out = np.asarray(fettle.Field(heights))
            self.assertEqual(out.dtype, np.float32)
            np.testing.assert_array_equal(out, heights.astype(np.float32))

    def test_top_down_turns_rows_over_on_the_way_in_and_out(self):
        heights = wave()
        field = fettle.Field(heights, top_down=True)
        np.testing.assert_array_equal(np.asarray(field), heights[::-1])
        np.testing.assert_array_equal(field.array(top_down=True), heights)

    def test_masked_samples_are_holes(self):
        heights = np.ma.masked_array([[1.0, 2.0], [3.0, 4.0]], mask=[[False, True], [False, False]])
        field = fettle.Field(heights)
        self.assertEqual(field.holes, 1)
        np.testing.assert_array_equal(field.masked().mask, heights.mask)

    def test_an_infinity_becomes_a_hole_with_a_warning(self):
        with self.assertWarnsRegex(fettle.FettleWarning, "1 infinite"):
            field = fettle.Field([[1.0, np.inf]])
        self.assertEqual(field.holes, 1)

    def test_holes_are_counted_without_the_borders_of_tiles(self):
        heights = wave()
        self.assertEqual(fettle.Field(heights).holes, int(np.isnan(heights).sum()))

    def test_arrays_that_come_out_are_copies(self):
        field = fettle.Field(wave())
        before = field.hash
        np.asarray(field)[:] = 0.0
        field.marks[:] = True
        self.assertEqual(field.hash, before)

    def test_what_is_no_height_field_is_refused(self):
        for heights in (np.zeros(3), np.zeros((2, 2, 2)), np.zeros((0, 4))):
            with self.assertRaises(fettle.InputError):
                fettle.Field(heights)
        for wrong in ({"spacing": 0.0}, {"spacing": np.nan}, {"unit": "furlong"}, {"origin": (np.nan, 0.0)}):
            with self.assertRaises(fettle.InputError, msg=str(wrong)) as refused:
                fettle.Field([[1.0]], **wrong)
            self.assertIsInstance(refused.exception, ValueError)
            self.assertTrue(refused.exception.remedy)

    def test_place_and_units_are_kept(self):
        field = fettle.Field(wave(), (0.5, 0.25), "um", height_unit="nm", origin=(5e6, -2.0))
        self.assertEqual(field.spacing, (0.5, 0.25))
        self.assertEqual(field.origin, (5e6, -2.0))
        self.assertEqual((field.unit, field.height_unit, field.crs), ("um", "nm", None))
        self.assertEqual(field.x[1] - field.x[0], 0.5)
        self.assertEqual(field.y[-1], -2.0 + 0.25 * 69)
        self.assertEqual(field.transform, (0.5, 0.0, 5e6 - 0.25, 0.0, -0.25, -2.0 + 0.25 * 69 + 0.125))


class Marks(unittest.TestCase):
    def test_marks_come_out_as_they_went_in(self):
        field = fettle.Field(wave())
        mask = np.random.default_rng(1).random(field.shape) < 0.3
        np.testing.assert_array_equal(field.with_marks(mask).marks, mask)
        np.testing.assert_array_equal(field.with_marks(mask[::-1], top_down=True).marks, mask)
        np.testing.assert_array_equal(field.with_marks(field.with_marks(mask)).marks, mask)
        self.assertFalse(field.marks.any())

    def test_marks_of_another_shape_are_refused(self):
        with self.assertRaises(fettle.InputError):
            fettle.Field(wave()).with_marks([[True]])

    def test_a_filter_leaves_marked_samples_as_they_are(self):
        field = fettle.Field(wave())
        mask = np.zeros(field.shape, dtype=bool)
        mask[:, :60] = True
        for made in (field.with_marks(mask).filter("median", window=5), field.filter("median", window=5, keep=mask)):
            np.testing.assert_array_equal(np.asarray(made)[mask], np.asarray(field)[mask])
            self.assertGreater(made.report["changed"], 0)
        only = field.filter("median", window=5, only=mask)
        np.testing.assert_array_equal(np.asarray(only)[~mask], np.asarray(field)[~mask])


class Lines(unittest.TestCase):
    def test_lines_come_out_as_they_went_in_with_points_between(self):
        field = fettle.Field(wave()).with_lines([[[3.0, 4.0], [9.0, 4.0]], fettle.Line([[1.5, 1.5]], id=8)])
        first, second = field.lines
        np.testing.assert_array_equal(first.points, [[3 + k, 4] for k in range(7)])
        np.testing.assert_array_equal(second.points, [[1.5, 1.5]])
        self.assertEqual((first.id, second.id), (0, 8))
        again = field.with_lines(field.lines)
        np.testing.assert_array_equal(again.lines[0].points, first.points)
        self.assertEqual(field.with_lines([]).lines, [])

    def test_lines_far_from_the_field_or_without_numbers_are_refused(self):
        for points in ([[1e7, 0.0]], [[np.nan, 0.0]]):
            with self.assertRaises(fettle.InputError):
                fettle.Field(wave()).with_lines([points])
        with self.assertRaises(ValueError):
            fettle.Line([1.0, 2.0])


class Calls(unittest.TestCase):
    def test_a_misspelt_parameter_is_a_type_error_with_a_suggestion(self):
        with self.assertRaisesRegex(TypeError, "window"):
            fettle.Field(wave()).filter("median", windows=5)

    def test_a_value_out_of_range_is_an_input_error(self):
        with self.assertRaisesRegex(fettle.InputError, "1 to 1001"):
            fettle.Field(wave()).filter("median", window=5000)
        with self.assertRaisesRegex(fettle.InputError, "median"):
            fettle.Field(wave()).filter("medain")

    def test_errors_have_what_where_and_remedy(self):
        with self.assertRaises(fettle.InputError) as refused:
            fettle.read("/there/is/no.tif")
        self.assertEqual(refused.exception.where, "/there/is/no.tif")
        self.assertIn(refused.exception.what, str(refused.exception))

    def test_errors_name_parameters_as_python_does(self):
        field = fettle.Field(wave())
        for call, where in (
            (lambda: field.filter("areal-gaussian", cutoff="x3"), "cutoff"),
            (lambda: field.suggest(), "tolerance"),
            (lambda: field.filter("box", max_change="-1"), "max_change"),
        ):
            with self.assertRaises(fettle.InputError) as refused:
                call()
            self.assertEqual(refused.exception.where, where)
            self.assertNotIn("--", str(refused.exception))

    def test_a_path_that_looks_like_something_else_is_a_path(self):
        for name in ("-x", "<field>", "--help"):
            with self.assertRaises(fettle.InputError) as refused:
                fettle.read(name)
            self.assertEqual(refused.exception.where, "./" + name)

    def test_names_of_files_that_are_not_utf_8_are_read_written_and_named(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(os.fsencode(folder), b"sc\xe4n.tif")
            fettle.Field(wave()).write(path)
            self.assertEqual(fettle.read(path).hash, fettle.Field(wave()).hash)
            self.assertTrue(os.path.exists(path))
            missing = os.path.join(os.fsencode(folder), b"m\xe4.tif")
            with self.assertRaises(fettle.InputError) as refused:
                fettle.read(missing)
            self.assertEqual(os.fsencode(refused.exception.where), missing)

    def test_what_a_file_does_not_state_is_a_warning(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "plain.xyz")
            with open(path, "w", encoding="ascii") as file:
                file.writelines(f"{x} {y} {x * y}\n" for y in range(4) for x in range(5))
            with self.assertWarns(fettle.FettleWarning) as told:
                field = fettle.read(path)
            self.assertEqual(field.shape, (4, 5))
            self.assertEqual(field.name, "plain.xyz")
            self.assertEqual(told.filename, __file__)
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                fettle.read(path, unit="mm", spacing=(1.0, 1.0))

    def test_limits_of_change_are_relative_to_the_field_as_it_was_read(self):
        field = fettle.Field(wave() + np.random.default_rng(2).normal(0.0, 0.3, (70, 131)))
        made = field.filter("median", window=7).filter("gaussian", window=9, max_change=0.05)
        change = np.nanmax(np.abs(np.asarray(made) - np.asarray(field)))
        self.assertLessEqual(change, np.float32(0.05) + 1e-6)
        np.testing.assert_array_equal(np.asarray(made.original), np.asarray(field))

    def test_inverting_twice_is_the_same(self):
        field = fettle.Field(wave())
        self.assertEqual(field.inverted().inverted().hash, field.hash)
        np.testing.assert_array_equal(np.asarray(field.inverted()), -np.asarray(field))


class Rasterio(unittest.TestCase):
    def test_a_band_is_read_as_the_program_reads_its_file(self):
        try:
            import rasterio
        except ImportError:
            self.skipTest("python3-rasterio is not installed")
        with tempfile.TemporaryDirectory() as folder:
            path, back = os.path.join(folder, "scan.tif"), os.path.join(folder, "back.tif")
            field = fettle.Field(wave(), (0.5, 0.25), "m", origin=(5e5, 4e6), crs=rasterio.crs.CRS.from_epsg(32633).to_wkt())
            field.write(path)
            with rasterio.open(path) as dataset:
                made = fettle.Field.from_rasterio(dataset)
                profile = dataset.profile
                self.assertEqual(tuple(dataset.transform)[:6], made.transform)
            read = fettle.read(path)
            self.assertEqual(made.hash, read.hash)
            self.assertEqual((made.spacing, made.origin, made.unit), (read.spacing, read.origin, read.unit))
            profile.update(transform=rasterio.Affine(*read.transform), crs=read.crs)
            with rasterio.open(back, "w", **profile) as dataset:
                dataset.write(read.array(top_down=True), 1)
            again = fettle.read(back)
            self.assertEqual(again.hash, field.hash)
            self.assertEqual((again.spacing, again.origin), (field.spacing, field.origin))


    def test_heights_that_count_are_those_of_the_program(self):
        try:
            import rasterio
        except ImportError:
            self.skipTest("python3-rasterio is not installed")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "counts.tif")
            counts = np.arange(12, dtype=np.int16).reshape(3, 4)
            with rasterio.open(path, "w", driver="GTiff", width=4, height=3, count=1, dtype="int16", nodata=5,
                               crs=rasterio.crs.CRS.from_epsg(28992), transform=rasterio.Affine(2, 0, 10, 0, -2, 20)) as dataset:
                dataset.write(counts, 1)
                dataset.scales, dataset.offsets = (0.5,), (10.0,)
            with rasterio.open(path) as dataset:
                made = fettle.Field.from_rasterio(dataset)
            self.assertEqual(made.hash, fettle.read(path).hash)
            self.assertEqual(np.nanmax(np.asarray(made)), 15.5)
            self.assertEqual(made.holes, 1)
            # Without a place, the reader is told.
            with rasterio.open(path, "w", driver="GTiff", width=4, height=3, count=1, dtype="int16") as dataset:
                dataset.write(counts, 1)
            with rasterio.open(path) as dataset, self.assertWarnsRegex(fettle.FettleWarning, "no place"):
                fettle.Field.from_rasterio(dataset)


class Crs(unittest.TestCase):
    def test_a_code_becomes_wkt_and_nonsense_is_refused(self):
        field = fettle.Field(wave(), 0.5, "m", crs="EPSG:28992")
        self.assertIn("Amersfoort / RD New", field.crs)
        self.assertEqual(fettle.Field(wave(), 0.5, "m", crs=field.crs).crs, field.crs)
        for wrong in ("blah", "EPSG:1", "/etc/passwd", "PROJCS[", "http://example.org/crs"):
            with self.assertRaisesRegex(fettle.InputError, "names no coordinate system"):
                fettle.Field(wave(), crs=wrong)


class Heights(unittest.TestCase):
    def test_what_is_no_real_number_is_refused(self):
        for wrong in (np.ones((2, 2), dtype=complex), [[None, 1.0]], [["a", "b"]]):
            with self.assertRaisesRegex(fettle.InputError, "holds no heights"):
                fettle.Field(wrong)

    def test_a_path_with_a_null_character_is_refused(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(fettle.InputError):
            fettle.Field(wave()).write(os.path.join(folder, "a\0b.tif"))


class Xarray(unittest.TestCase):
    def setUp(self):
        try:
            import xarray
        except ImportError:
            self.skipTest("python3-xarray is not installed")
        self.xarray = xarray

    def test_the_coordinate_system_comes_back(self):
        field = fettle.Field(wave(), (0.5, 0.25), "m", crs="EPSG:32633", origin=(5e5, 4e6))
        self.assertEqual(fettle.Field.from_xarray(field.to_xarray()).crs, field.crs)

    def test_an_array_as_rioxarray_gives_it(self):
        # One band before y and x, the coordinate system in a coordinate of its own, holes as the fill value of an attribute.
        field = fettle.Field(wave(), (0.5, 0.25), "m", crs="EPSG:32633", origin=(5e5, 4e6))
        plain = field.to_xarray()
        filled = np.where(np.isnan(plain.values), -9999.0, plain.values)
        given = self.xarray.DataArray(
            filled[None, ::-1],
            dims=("band", "y", "x"),
            coords={"band": [1], "y": field.y[::-1], "x": field.x,
                    "spatial_ref": ((), 0, {"crs_wkt": field.crs})},
            attrs={"_FillValue": -9999.0, "scale_factor": 1.0, "add_offset": 0.0},
        )
        for array in (given, given.squeeze(drop=True), given[0].T):
            back = fettle.Field.from_xarray(array)
            self.assertEqual((back.hash, back.unit, back.height_unit), (field.hash, "m", "m"))
        self.assertEqual(fettle.Field.from_xarray(given).crs, field.crs)
        counts = given.copy(data=given.values * 4.0)
        counts.attrs.update({"_FillValue": -39996.0, "scale_factor": 0.25})
        self.assertEqual(fettle.Field.from_xarray(counts).hash, field.hash)

    def test_what_has_no_lengths_is_refused_or_said(self):
        degrees = self.xarray.DataArray(wave(), dims=("lat", "lon"), coords={"lat": np.arange(wave().shape[0]), "lon": np.arange(wave().shape[1])})
        degrees.lon.attrs["units"] = "degrees_east"
        with self.assertRaisesRegex(fettle.InputError, "degrees_east"):
            fettle.Field.from_xarray(degrees)
        volts = self.xarray.DataArray(wave(), dims=("y", "x"), attrs={"units": "V"})
        with self.assertWarnsRegex(fettle.FettleWarning, "heights in V"):
            fettle.Field.from_xarray(volts)
        for wrong in (wave(), self.xarray.Dataset({"z": (("y", "x"), wave())}), degrees.expand_dims(t=[0, 1])):
            with self.assertRaises(fettle.InputError):
                fettle.Field.from_xarray(wrong)

    def test_a_data_array_comes_back_the_same(self):
        field = fettle.Field(wave(), (0.5, 0.25), "um", height_unit="nm", origin=(3.0, 4.0))
        array = field.to_xarray()
        for turned in (array, array[::-1], array[:, ::-1]):
            back = fettle.Field.from_xarray(turned)
            self.assertEqual(back.hash, field.hash)
            self.assertEqual((back.unit, back.height_unit, back.origin), ("um", "nm", (3.0, 4.0)))
            np.testing.assert_allclose(back.spacing, field.spacing, rtol=1e-12)


class Flags(unittest.TestCase):
    def test_a_flag_is_what_its_value_is(self):
        field = fettle.Field(np.arange(12.0).reshape(3, 4), spacing=1.0, unit="mm")
        for yes in (True, 1, np.True_):
            self.assertTrue(field.measure(robust=yes)["robust"])
        for no in (False, 0, np.False_, None):
            self.assertFalse(field.measure(robust=no)["robust"])
        for neither in ("no", "", [], 2, 0.0):
            with self.assertRaises(TypeError):
                field.measure(robust=neither)


class Level(unittest.TestCase):
    def test_filled_samples_stay_known_where_a_field_is_turned(self):
        heights = np.add.outer(np.arange(60.0) * 0.5, np.arange(70.0) * 0.25)
        heights[20:26, 30:40] = np.nan
        full = fettle.Field(heights).fill()
        self.assertFalse(np.isnan(np.asarray(full)).any())
        self.assertAlmostEqual(float(np.asarray(full)[22, 35]), 22 * 0.5 + 35 * 0.25, places=4)
        turned = full.transformed(turn=90)
        self.assertEqual(np.asarray(turned).shape, (70, 60))
        for field in (full, turned):
            self.assertEqual(field.measure(only=["hybrid"])["filled"], 60)
            self.assertEqual(field.measure(only=["hybrid"], region="measured")["samples"], 60 * 70 - 60)
        # Millimetres from the lower left sample, with the samples on the sides.
        self.assertEqual(full.measure(only=["height"], region="rectangle 10,0,20,5")["samples"], 11 * 6)
        self.assertEqual(full.compare(turned.transformed(turn=270), region="polygon 0.5,0.5 9.5,0.5 9.5,4.5 0.5,4.5")["samples"], 9 * 4)
        with self.assertRaises(fettle.InputError):
            full.measure(region="rectangle 100,0,200,5")
        self.assertEqual(full.measure(only=["height"], region="rectangle 1cm,0,20000um,5mm")["samples"], 11 * 6)
        asked = full.measure(ratios=(5, 90), height_between=(10, 60), prune=12, noise_trials=0)
        np.testing.assert_allclose(asked["volume_ratios"], (0.05, 0.9))
        np.testing.assert_allclose(asked["sdc"]["ratios"], (0.1, 0.6))
        self.assertAlmostEqual(asked["prune"], 0.12)

    def test_changes_are_limited_from_the_levelled_heights(self):
        scan = fettle.synth(part="steps", size=(96, 80))
        levelled = scan.level()
        self.assertEqual(levelled.original.hash, levelled.hash)
        limited = levelled.filter("median", max_change="10um")
        self.assertLessEqual(levelled.compare(limited)["max_abs"], 0.0100001)


    def test_a_form_lies_over_a_field_and_goes_again(self):
        scan = fettle.synth(part="steps", size=(96, 80))
        formed = scan.level(layer="put", form="poly2")
        # What is seen is what level takes the form out of; the samples are the scan's.
        np.testing.assert_array_equal(np.asarray(formed), np.asarray(scan.level(form="poly2")))
        self.assertEqual(formed.hash, scan.hash)
        self.assertEqual(formed.info()["form"], "poly2")
        again = formed.level(layer="remove")
        self.assertEqual(again.hash, scan.hash)
        np.testing.assert_array_equal(np.asarray(again), np.asarray(scan))
        # Samples that a filter does not change keep their bits.
        marks = np.zeros(scan.shape, bool)
        marks[20:40] = True
        filtered = formed.with_marks(marks).filter("gaussian", sigma=2.0)
        back = filtered.level(layer="remove")
        np.testing.assert_array_equal(np.asarray(back)[20:40], np.asarray(scan)[20:40])
        self.assertFalse(np.array_equal(np.asarray(back), np.asarray(scan), equal_nan=True))
        for field in (filtered, filtered.inverted()):
            other = pickle.loads(pickle.dumps(field))
            self.assertEqual(other.hash, field.hash)
            self.assertEqual(other.original.hash, field.original.hash)
            np.testing.assert_array_equal(np.asarray(other.original), np.asarray(field.original))
            self.assertEqual(other.level(layer="remove").hash, field.level(layer="remove").hash)
            self.assertEqual(other.info()["form"], "poly2")
        with self.assertRaisesRegex(fettle.InputError, "no form lies over"):
            scan.level(layer="remove")

    def test_a_ball_is_seen_without_its_sphere_and_comes_back(self):
        y, x = np.mgrid[0:80, 0:96] * 0.1
        ball = fettle.Field(np.sqrt(400.0 - (x - 4.0) ** 2 - (y - 5.0) ** 2), spacing=0.1, unit="mm")
        formed = ball.level(layer="put", form="sphere")
        self.assertAlmostEqual(formed.report["radius_mm"], 20.0, places=3)
        self.assertLess(float(np.abs(np.asarray(formed)).max()), 1e-5)
        self.assertEqual(formed.hash, ball.hash)
        for field in (formed, formed.inverted()):
            other = pickle.loads(pickle.dumps(field))
            np.testing.assert_array_equal(np.asarray(other), np.asarray(field))
            self.assertEqual(other.info()["form"], "sphere")
            self.assertEqual(other.level(layer="remove").hash, field.level(layer="remove").hash)
        # The sphere goes along, and says what it is at any time.
        turned = formed.transformed(turn=90)
        np.testing.assert_allclose(np.asarray(turned), np.rot90(np.asarray(formed), -1), atol=2e-6)
        self.assertEqual(turned.level(layer="remove").hash, ball.transformed(turn=90).hash)
        coarse = formed.transformed(to_spacing=0.3)
        self.assertLess(float(np.abs(np.asarray(coarse)).max()), 1e-5)
        for field in (formed, turned, coarse):
            self.assertAlmostEqual(field.info()["form_figures"]["radius_mm"], 20.0, places=3)
        np.testing.assert_array_equal(np.asarray(formed.level(layer="bake")), np.asarray(ball.level(form="sphere")))
        with self.assertRaisesRegex(fettle.InputError, "do not determine a sphere"):
            fettle.Field(np.zeros((50, 60)), spacing=0.1, unit="mm").level(form="sphere")


class ElsewhereAndBack(unittest.TestCase):
    def test_a_field_goes_through_pickle_as_it_is(self):
        field = fettle.synth(size=(96, 64), seed=7).mark(edges=True, lines_out=True).filter("median")
        field.name = "part"
        for again in (pickle.loads(pickle.dumps(field)), copy.deepcopy(field), copy.copy(field)):
            self.assertEqual(again.hash, field.hash)
            self.assertEqual(again.original.hash, field.original.hash)
            self.assertNotEqual(again.original.hash, again.hash)
            np.testing.assert_array_equal(again.marks, field.marks)
            self.assertGreater(len(field.lines), 0)
            self.assertEqual(len(again.lines), len(field.lines))
            for name in ("spacing", "origin", "unit", "height_unit", "crs", "name", "report"):
                self.assertEqual(getattr(again, name), getattr(field, name))
            ways = [each.filter("box", window=9, max_change="10um").hash for each in (field, again)]
            self.assertEqual(ways[0], ways[1])

    def test_another_process_gets_the_field(self):
        field = fettle.Field(wave(), spacing=0.5, unit="um")
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            self.assertEqual(pool.map(hash_of, [field, field.inverted()]), [field.hash, field.inverted().hash])

    def test_standard_input_and_output_are_those_of_the_program(self):
        for call in (lambda: fettle.read("-"), lambda: fettle.Field(wave()).write("-")):
            with self.assertRaisesRegex(fettle.InputError, "of the program fettle"):
                call()


class Suggested(unittest.TestCase):
    def test_what_misses_the_tolerance_is_not_applied_without_a_word(self):
        found = fettle.synth(size=(128, 128)).suggest("0.01um")
        self.assertFalse(found["met"])
        with self.assertWarns(fettle.FettleWarning):
            found.apply()


class Chunks(unittest.TestCase):
    def test_begin_at_multiples_and_none_is_smaller_than_what_lies_around(self):
        for chunks, multiple, least, expected in (
            ((1024, 1024, 100), 256, 512, (1024, 1124)),
            ((100,), 256, 512, (100,)),
            ((300, 300, 300), 256, 512, (900,)),
            ((1000, 1000), 256, 256, (1024, 976)),
            ((5, 5, 1), 1, 1, (5, 5, 1)),
        ):
            self.assertEqual(fettle.dask._aligned(chunks, multiple, least), expected)


if __name__ == "__main__":
    unittest.main()
