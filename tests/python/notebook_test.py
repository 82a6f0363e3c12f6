"""The notebook of the guide, executed as a reader would, from a scan to a cleaned part."""

import importlib.util
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

NEEDED = ("nbconvert", "ipykernel", "matplotlib")
MISSING = [name for name in NEEDED if importlib.util.find_spec(name) is None]


class Notebook(unittest.TestCase):
    @unittest.skipIf(MISSING, f"python3-{', python3-'.join(MISSING)} not installed")
    def test_runs_from_a_scan_to_a_cleaned_part_with_its_pictures(self):
        source = pathlib.Path(os.environ["FETTLE_SOURCE"], "docs", "guide", "clean-a-part.ipynb")
        with tempfile.TemporaryDirectory() as folder:
            notebook = pathlib.Path(folder, source.name)
            shutil.copy(source, notebook)
            command = [sys.executable, "-m", "nbconvert", "--to", "notebook", "--inplace", "--execute", str(notebook)]
            environment = dict(os.environ, HOME=folder, PYDEVD_DISABLE_FILE_VALIDATION="1")
            done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr[-3000:])
            cells = [cell for cell in json.loads(notebook.read_text())["cells"] if cell["cell_type"] == "code"]
            self.assertTrue(pathlib.Path(folder, "clean.fettle").exists())
        pictures = [
            output for cell in cells for output in cell["outputs"] if "image/png" in output.get("data", {})
        ]
        # The scan, the result, the errors and the section.
        self.assertEqual(len(pictures), 4)
        for picture in pictures:
            self.assertGreater(len(picture["data"]["image/png"]), 10_000)
        # As it is stored the notebook has no results, which would differ by the version that made them.
        for cell in json.loads(source.read_text())["cells"]:
            self.assertFalse(cell.get("outputs"))


if __name__ == "__main__":
    unittest.main()
