"""fettle: clean up large scanned height fields.

>>> import numpy as np, fettle
>>> scan = fettle.synth(size=(128, 96), seed=1)         # or fettle.read("scan.tif")
>>> clean = scan.mark(edges=True).filter("tgv")
>>> round(clean.compare(scan)["rms"], 4) > 0
True
>>> np.asarray(clean).dtype, clean.shape
(dtype('float32'), (96, 128))

A Field is never changed: its methods return new ones. Row 0 is the row with the lowest y. Long work runs without the
GIL and ends with Ctrl-C. What a file does not state, or a format cannot store, is a FettleWarning; failures are
fettle.InputError and fettle.Error.
"""

import os as _os

from . import _commands, _fettle, _field
from ._commands import PATH, READING, WRITING, Command, documented, parameter, path_word
from ._errors import Error, FettleWarning, InputError
from ._field import Field, Suggestion
from ._lines import Line
from ._session import Session, Step

__version__ = _fettle.version
__all__ = [
    "Error",
    "FettleWarning",
    "Field",
    "InputError",
    "Line",
    "Session",
    "Step",
    "Suggestion",
    "formats",
    "mosaic",
    "read",
    "replay",
    "synth",
]

_READ = Command(
    "read", "convert", groups=(READING,), hidden=("from", "store"),
    summary="Read a scan of any format: rasters, point clouds, meshes, files of instruments, sessions",
)
_SYNTH = Command("synth", "synth", hidden=("to", "force"))
_MOSAIC = Command("mosaic", "mosaic", hidden=("to", "force", "estimate", "from", "store"), hides=(WRITING,))
_REPLAY = Command("replay", "replay", hidden=("to", "force"), hides=(READING,))


@documented(_READ, "Field: of a session its present state, marks and edge lines included.", before=(parameter("path", PATH),),)
def read(path, *, progress=None, **options):
    call = _READ.begin()
    call.arguments.append(path_word(path))
    call.arguments.append(call.result("field"))
    _READ.options(call, options)
    _, written = call.run("see help(fettle.read)", progress, 2)
    return _field.field_of(written["<field>"], _os.path.basename(_os.fsdecode(path)))


@documented(
    _SYNTH,
    "Field: the scan. With `truth=True` its `report` holds the true surface, a Field, under `truth`; with `edges=True` a Field "
    "with its true edges as marks, under `edges`.",
    example='''
    >>> scan = fettle.synth(part="bracket", size=(96, 64), seed=7, truth=True)
    >>> scan.compare(scan.report["truth"])["samples"] > 0
    True
''',
)
def synth(*, progress=None, **options):
    call = _SYNTH.begin()
    call.arguments.append(call.result("field"))
    made = _SYNTH.options(call, options)
    report, written = call.run("see help(fettle.synth)", progress, 2)
    for name, place in made.items():
        report[name] = _field._value(written[place])
    return _field.field_of(written["<field>"], str(options.get("part") or report["part"]), report)


@documented(
    _MOSAIC,
    "Field: all scans on the samples of the first, continued; `report` has the places of the scans and how they differ where "
    "they overlap, lengths in mm, angles in degrees.",
    before=(parameter("scans", f"Sequence[Field | {PATH}]"),),
    example='''
    >>> part = fettle.synth(part="bracket", size=(128, 96), seed=5)
    >>> west = part.transformed(crop_samples=(0, 0, 96, 80))
    >>> east = part.transformed(crop_samples=(0, 48, 96, 80))
    >>> both = fettle.mosaic([west, east], moves="shift")
    >>> both.shape, both.report["pairs"]
    ((96, 128), 1)
''',
)
def mosaic(scans, *, progress=None, **options):
    call = _MOSAIC.begin()
    for number, scan in enumerate(scans):
        call.arguments.append(call.scan(scan, f"scan {number + 1}"))
    call.arguments.append(call.result("field"))
    _MOSAIC.options(call, options)
    report, written = call.run("see help(fettle.mosaic)", progress, 2)
    return _field.field_of(written["<field>"], "mosaic", report)


@documented(
    _REPLAY,
    "Field: the scan after the strokes; of a session alone what its journal leads to.",
    before=(parameter("scan", "Field | str | os.PathLike"), parameter("strokes", "str | os.PathLike | None", None)),
)
def replay(scan, strokes=None, *, progress=None, **options):
    if strokes is None:
        return Session(scan).replay(progress=progress)
    return (scan if isinstance(scan, Field) else read(scan)).replay(strokes, progress=progress, **options)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def formats() -> list[tuple[str, str, list[str], bool, bool]]:
    """list of tuples: name, description, extensions, whether it can be read and whether it can be written.

    >>> [name for name, _, extensions, _, writes in fettle.formats() if ".tif" in extensions]
    ['GTiff']
    """
    return [tuple(row) for row in _fettle.formats()]
