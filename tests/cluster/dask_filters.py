"""The bits of one run over a whole array, whatever the chunks, on workers in processes of their own."""

import unittest

import dask.array as da
import numpy as np
from dask.distributed import Client, LocalCluster

import fettle
import fettle.dask

# A number for each filter that can be divided.
OPTIONS = {
    "box": {"window": 7},
    "gaussian": {"window": 9, "sigma": 1.5, "passes": 3},
    "median": {"window": 5},
    "bilateral": {"window": 5},
    "tv": {"window": 7},
    "tgv": {},
    "planes": {},
    "areal-gaussian": {"cutoff": "3000um"},
    "opening": {"radius": "0.5"},
    "closing": {"radius": "0.5"},
}


class Dask(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
        cls.client = Client(cls.cluster)
        cls.field = fettle.synth(size=(330, 400), part="steps", seed=3)
        cls.heights = np.asarray(cls.field)

    @classmethod
    def tearDownClass(cls):
        cls.client.close()
        cls.cluster.close()

    def one_run(self, name, options):
        field = fettle.Field(self.heights, spacing=self.field.spacing, unit="mm", height_unit="mm")
        return np.asarray(field.filter(name, compute="cpu", **options))

    def test_every_filter_that_can_be_divided_has_the_bits_of_one_run(self):
        for name, options in OPTIONS.items():
            whole = self.one_run(name, options)
            for chunks in ((400, 330), (100, 133)):
                array = da.from_array(self.heights, chunks=chunks)
                made = fettle.dask.filter(array, name, spacing=self.field.spacing, **options).compute()
                self.assertEqual(made.tobytes(), whole.tobytes(), f"{name} in chunks of {chunks}")

    def test_noise_is_that_of_the_whole(self):
        info = self.field.info()
        for chunks in ((400, 330), (50, 130)):
            self.assertEqual(fettle.dask.noise(da.from_array(self.heights, chunks=chunks)), info["noise_finest"])

    def test_filters_of_the_whole_field_are_refused(self):
        array = da.from_array(self.heights, chunks=(200, 200))
        for name in ("spline", "robust-spline", "robust-gaussian"):
            with self.assertRaises(fettle.InputError):
                fettle.dask.filter(array, name, cutoff="3")
        with self.assertRaises(fettle.InputError):
            fettle.dask.filter(array, "median", keep=self.field)

    def test_what_is_no_filter_or_no_option_is_refused_before_anything_is_computed(self):
        array = da.from_array(self.heights, chunks=(200, 200))
        for name, options, error, text in (
            ("medan", {}, fettle.InputError, "no filter 'medan'"),
            ("median", {"windw": 3}, TypeError, "'windw'.*window"),
            ("areal-gaussian", {"cutoff": "3parsec"}, fettle.InputError, "unknown unit parsec"),
        ):
            with self.assertRaisesRegex(error, text):
                fettle.dask.filter(array, name, **options)


if __name__ == "__main__":
    unittest.main()
