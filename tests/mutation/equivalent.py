"""The plants that no test can notice, each with its argument: equivalent.txt."""

from __future__ import annotations

import pathlib

import places

PATH = pathlib.Path(__file__).resolve().parent / "equivalent.txt"


ROOT = PATH.parent.parent.parent


def key(place: places.Place) -> tuple[str, str, str]:
    """The file, the line's text and the change: what stays where lines move. Where what is changed stands more than once in the
    line, the change says which of them it is: "1 -> 1 + 1 (2 of 3)"."""
    text = (ROOT / place.file).read_bytes()
    begin = text.rfind(b"\n", 0, place.begin) + 1
    line = text[begin:].split(b"\n", 1)[0].decode()
    first = place.right.split("\n", 1)[0]
    count, before = line.count(first), text[begin : place.begin].decode().count(first)
    which = f" ({before + 1} of {count})" if count > 1 else ""
    return place.file, " ".join(line.split()), place.words() + which


def read() -> dict[tuple[str, str, str], str]:
    """Blocks with an empty line between them: file, line, change, and the argument in as many lines as it takes."""
    known = {}
    for block in PATH.read_text().split("\n\n"):
        lines = [line.strip() for line in block.splitlines() if line.strip() and not line.startswith("#")]
        if lines:
            file, line, change, *why = lines
            known[file, line, change] = " ".join(why)
            if not any(" ".join(text.split()) == line for text in (ROOT / file).read_text().splitlines()):
                raise SystemExit(f"fettle: error: {PATH.name}: {file} has no such line any more: {line}")
    return known
