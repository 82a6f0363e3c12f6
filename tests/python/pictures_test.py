"""Pictures of the package are those of the program."""

import os
import re
import struct
import tempfile
import unittest
import zlib

import numpy as np

import fettle

from program import run


def pixels_of(png):
    """height x width x channels of an 8-bit PNG without interlace."""
    at, data, header = 8, b"", None
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at : at + 8])
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", png[at + 8 : at + 21])
        if kind == b"IDAT":
            data += png[at + 8 : at + 8 + length]
        at += 12 + length
    width, height, bits, colours, _, _, interlace = header
    assert (bits, interlace) == (8, 0)
    channels = {2: 3, 6: 4}[colours]
    rows = np.frombuffer(zlib.decompress(data), dtype=np.uint8).reshape(height, 1 + channels * width)
    out = np.zeros((height, width * channels), dtype=np.uint8)
    for r in range(height):
        kind, line = rows[r, 0], rows[r, 1:].astype(int)
        above = out[r - 1].astype(int) if r else np.zeros(width * channels, dtype=int)
        if kind == 0:
            out[r] = line
        elif kind == 2:
            out[r] = (line + above) % 256
        else:
            done = np.zeros(width * channels, dtype=int)
            for i in range(width * channels):
                left = done[i - channels] if i >= channels else 0
                corner = above[i - channels] if i >= channels else 0
                if kind == 1:
                    guess = left
                elif kind == 3:
                    guess = (left + above[i]) // 2
                else:
                    p = left + above[i] - corner
                    guess = min((left, above[i], corner), key=lambda v: abs(p - v))
                done[i] = (line[i] + guess) % 256
            out[r] = done
    return out.reshape(height, width, channels)


class Pictures(unittest.TestCase):
    def test_a_picture_is_that_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            scan, other, png = (os.path.join(folder, name) for name in ("scan.tif", "b.tif", "picture.png"))
            run("synth", scan, "--size", "64x48")
            field = fettle.read(scan)
            clean = field.filter("median")
            clean.write(other)
            clean.name = "b.tif"
            run("render", scan, png, "--size", "240x160", "--compare", other, "--contours")
            made = field.render(size=(240, 160), compare=clean, contours=True)
            self.assertEqual((made.dtype, made.shape), (np.uint8, (160, 240, 4)))
            with open(png, "rb") as file:
                stored = pixels_of(file.read())
            np.testing.assert_array_equal(made[:, :, : stored.shape[2]], stored)
            self.assertGreater(len(np.unique(made.reshape(-1, 4), axis=0)), 100)

    def test_a_notebook_gets_a_png(self):
        field = fettle.synth(size=(64, 48))
        png = field._repr_png_()
        np.testing.assert_array_equal(pixels_of(png), field.render(size=(640, 400)))

    def test_marks_are_drawn_over_the_surface(self):
        field = fettle.synth(size=(64, 48))
        field = field.with_marks(np.arange(field.size).reshape(field.shape) % 7 < 3)
        plain, marked = field.render(size=(200, 120)), field.render(size=(200, 120), marks=True)
        self.assertFalse(np.array_equal(plain, marked))

    def test_a_size_that_cannot_be_drawn_is_refused(self):
        with self.assertRaises(fettle.InputError):
            fettle.synth(size=(64, 48)).render(size=(1, 1))


class Pages(unittest.TestCase):
    def test_a_page_is_that_of_the_program(self):
        field = fettle.synth(size=(96, 64), seed=3)
        clean = field.filter("median")
        with tempfile.TemporaryDirectory() as folder:
            scan, out = (os.path.join(folder, name) for name in ("scan.fettle", "page.html"))
            clean.write(scan)
            run("report", scan, out, "--title", "part")
            with open(out, encoding="utf-8") as file:
                written = file.read()
        page = clean.page(title="part").decode()
        # All but where it was read from, and the steps of the file.
        for piece in (clean.hash, field.hash, "<th class=n>Before</th>"):
            self.assertIn(piece, page)
            self.assertIn(piece, written)
        pictures = [re.findall(r"base64,([^\"]*)", text) for text in (page, written)]
        self.assertEqual(len(pictures[0]), 3)
        self.assertEqual(pictures[0], pictures[1])
        pdf = clean.page(title="part", type="pdf")
        self.assertTrue(pdf.startswith(b"%PDF-"))
        self.assertEqual(pdf, clean.page(title="part", type="pdf"))


if __name__ == "__main__":
    unittest.main()
