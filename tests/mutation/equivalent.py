"""The plants that no test can notice, each with its argument: equivalent.txt."""

from __future__ import annotations

import pathlib

import places

PATH = pathlib.Path(__file__).resolve().parent / "equivalent.txt"


def key(place: places.Place) -> tuple[str, str, str]:
    """The file, the line's text and the change: what stays where lines move."""
    root = PATH.parent.parent.parent
    line = (root / place.file).read_text().splitlines()[place.line - 1]
    return place.file, " ".join(line.split()), place.words()


def read() -> dict[tuple[str, str, str], str]:
    """Blocks with an empty line between them: file, line, change, and the argument in as many lines as it takes."""
    known = {}
    for block in PATH.read_text().split("\n\n"):
        lines = [line.strip() for line in block.splitlines() if line.strip() and not line.startswith("#")]
        if lines:
            file, line, change, *why = lines
            known[file, line, change] = " ".join(why)
    return known
