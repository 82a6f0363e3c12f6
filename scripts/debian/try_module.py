"""try_module.py VERSION FOLDER: filters a small field with the module fettle that lies below FOLDER, and fails where the
module is another one than that, or the filter leaves the noise as it was."""

import sys

import numpy as np

import fettle

version, folder = sys.argv[1:]
assert fettle.__version__ == version, f"version {fettle.__version__} instead of {version}"
assert fettle.__file__.startswith(folder.rstrip("/") + "/"), f"{fettle.__file__} is not below {folder}"
noise = np.random.default_rng(1).normal(size=(64, 96)).astype(np.float32)
scan = fettle.Field(noise, spacing=0.1, unit="mm", height_unit="um")
clean = np.asarray(scan.filter("median", window=5))
assert clean.shape == noise.shape and clean.dtype == np.float32, f"{clean.dtype} {clean.shape}"
assert clean.std() < 0.5 * noise.std(), f"noise of {noise.std()} is {clean.std()} after the filter"
print(f"fettle {fettle.__version__} filters {noise.shape[1]} x {noise.shape[0]} samples: {noise.std():.3f} um to {clean.std():.3f} um")
