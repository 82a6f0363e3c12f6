"""Height fields."""

from __future__ import annotations

import os
import struct
import warnings
import zlib
from collections.abc import Callable, Sequence
from typing import Any

import numpy
import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from . import _exchange, _fettle, _lines
from ._commands import PATH, READING, SELF, TABLES, WRITING, Command, documented, identifier, parameter, path_word
from ._errors import Error, FettleWarning, InputError
from ._lines import Line

_FILTER = Command(
    "filter",
    "filter",
    first=("filter",),
    hidden=("suggest", "out-dir", "to", "force", "estimate", "resume", "resume-every", "shard", "shards-in-turn", "memory"),
    hides=(READING, WRITING, "Suggesting a filter"),
)
_SUGGEST = Command(
    "suggest",
    "filter",
    first=("tolerance",),
    groups=("Suggesting a filter",),
    also=("keep", "threads"),
    hidden=("suggest", "estimate"),
    fixed=("--suggest",),
    summary="Which filter is good enough for a tolerance, and why",
)
_MARK = Command("mark", "mark", hidden=("estimate",), hides=(READING,))
_MEASURE_LINES = Command("measure_lines", "lines", hides=(READING,))
_INFO = Command("info", "info", hides=(READING,))
_COMPARE = Command(
    "compare",
    "compare",
    hidden=("to", "force", "estimate", "shard", "shard-dir"),
    hides=(READING,),
    summary="How another scan deviates from this one; against a truth, the errors of the other and where they are",
)
_RENDER = Command("render", "render", hides=(READING,))
_APPLY = Command("apply", "apply", hidden=("out-dir", "to", "force", "estimate", "resume", "resume-every"), hides=(READING, WRITING))
_REPLAY = Command("replay", "replay", hidden=("to", "force"), hides=(READING,))
_WRITE = Command(
    "write",
    "convert",
    hidden=("out-dir", "to", "estimate", "shard", "shards-in-turn", "memory"),
    hides=(READING,),
    summary="Write the field to a file; its extension names the format",
)

_FIELD = "Field: the result. Its `report` holds the figures that the command prints with --json."


def field_of(scan, name="", report=None):
    """A Field of a compiled Scan."""
    field = object.__new__(Field)
    field._scan = scan
    field.name = name
    field.report = report if report is not None else {}
    return field


def _restored(heights, spacing, origin, unit, height_unit, crs, marks, lines, name, report, original, form=b""):
    """A Field from what Field.__reduce__ kept."""
    scan = _fettle.Scan(heights, spacing, origin, unit, height_unit, crs)
    if marks is not None:
        scan = scan.with_marks(marks)
    if lines:
        scan = scan.with_lines(lines)
    scan = scan.under_form(form)
    return field_of(scan.with_original(scan if original is None else original._scan), name, report)


def _pair(value, what):
    """One number, or two: x, y."""
    if np.isscalar(value):
        return float(value), float(value)
    pair = tuple(float(each) for each in value)
    if len(pair) != 2:
        raise ValueError(f"{what} is one number, or two: x, y")
    return pair


def _value(written):
    """What a command left in memory, as users of the package see it."""
    if isinstance(written, _fettle.Scan):
        return field_of(written)
    return _lines.lines_of(written) if isinstance(written, list) else written


class Field:
    """A height field: rows x columns of heights, with holes, marks and edge lines. It is never changed: methods return new
    fields, which share what is the same in both.

    Parameters:
        heights: array, rows x columns, of numbers; kept as float32. NaN is a hole, and so is what a masked array masks.
            Row 0 is the row with the LOWEST y, as in a plot, unlike in a picture.
        spacing: distance between samples, one number or (x, y), in `unit`.
        unit: of spacing and origin, and of the heights unless `height_unit` says otherwise: nm, um, mm, cm, m, km, in, ft,
            ftUS.
        height_unit: of the heights.
        origin: (x, y) of the sample in column 0 of the lowest row, in `unit`.
        crs: coordinate reference system as WKT, or a code as EPSG:28992; empty: none.
        marks: bool array of the same shape: samples that filters leave as they are.
        lines: edge lines: Line objects, or arrays n x 2 of column and row.
        top_down: the first row of `heights` and `marks` is the one with the highest y, as in pictures and in rasterio.
        name: shown in pictures.

    >>> import numpy as np, fettle
    >>> f = Field([[0.0, 1.0, 2.0], [0.5, np.nan, 2.5]], spacing=0.1, unit="mm")
    >>> f
    <fettle.Field 3 x 2 samples, spacing 0.1 x 0.1 mm, heights in mm, 1 hole>
    >>> np.asarray(f)
    array([[0. , 1. , 2. ],
           [0.5, nan, 2.5]], dtype=float32)
    >>> f.shape, f.spacing, f.unit
    ((2, 3), (0.1, 0.1), 'mm')
    """

    __slots__ = ("_scan", "name", "report")

    def __init__(
        self,
        heights: ArrayLike,
        spacing: float | tuple[float, float] = 1.0,
        unit: str = "mm",
        *,
        height_unit: str | None = None,
        origin: tuple[float, float] = (0.0, 0.0),
        crs: str = "",
        marks: ArrayLike | Field | None = None,
        lines: Sequence[Line | ArrayLike] | None = None,
        top_down: bool = False,
        name: str = "",
    ) -> None:
        if np.ma.isMaskedArray(heights):
            heights = heights.astype(np.float32).filled(np.nan)
        heights = np.asarray(heights)
        if heights.dtype.kind not in "biuf":
            raise InputError(f"an array of {heights.dtype} holds no heights", "heights", "give real numbers")
        heights = heights.astype(np.float32, copy=False)
        if top_down:
            heights = heights[::-1]
        if heights.ndim == 2 and heights.shape[1] > 1 and heights.strides[1] != heights.itemsize:
            heights = np.ascontiguousarray(heights)
        self._scan = _fettle.Scan(
            heights, _pair(spacing, "spacing"), _pair(origin, "origin"), unit, height_unit or unit, crs or ""
        )
        for text in self._scan.warnings:
            warnings.warn(text, FettleWarning, stacklevel=2)
        self.name = name
        self.report = {}
        if marks is not None:
            self._scan = self.with_marks(marks, top_down=top_down)._scan
        if lines is not None:
            self._scan = self.with_lines(lines)._scan

    def _made(self, scan, report=None):
        return field_of(scan, self.name, report)

    # What it holds.

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns)."""
        return (self._scan.rows, self._scan.columns)

    @property
    def size(self) -> int:
        """Number of samples, holes included."""
        return self._scan.rows * self._scan.columns

    @property
    def spacing(self) -> tuple[float, float]:
        """(x, y) between neighbouring samples, in `unit`."""
        return self._scan.spacing

    @property
    def origin(self) -> tuple[float, float]:
        """(x, y) of the sample in column 0 of row 0, in `unit`."""
        return self._scan.origin

    @property
    def unit(self) -> str:
        """Unit of spacing and origin."""
        return self._scan.unit

    @property
    def height_unit(self) -> str:
        """Unit of the heights."""
        return self._scan.height_unit

    @property
    def crs(self) -> str | None:
        """Coordinate reference system as WKT; None: none."""
        return self._scan.crs or None

    @property
    def x(self) -> numpy.ndarray:
        """float64 array, columns: x of each column, in `unit`."""
        return self.origin[0] + self.spacing[0] * np.arange(self._scan.columns)

    @property
    def y(self) -> numpy.ndarray:
        """float64 array, rows: y of each row, in `unit`; rises with the row."""
        return self.origin[1] + self.spacing[1] * np.arange(self._scan.rows)

    @property
    def transform(self) -> tuple[float, float, float, float, float, float]:
        """(a, b, c, d, e, f) of rasterio's Affine for `array(top_down=True)`: x = a column + b row + c, y = d column +
        e row + f, of the upper left corner of a pixel."""
        (sx, sy), (x, y) = self.spacing, self.origin
        top = y + sy * (self._scan.rows - 1)
        return (sx, 0.0, x - 0.5 * sx, 0.0, -sy, top + 0.5 * sy)

    @property
    def holes(self) -> int:
        """Number of samples without a height."""
        return self._scan.holes()

    @property
    def hash(self) -> str:
        """Hash over size, heights and marks, as 16 hexadecimal digits: what the commands report as `hash`."""
        return self._scan.hash()

    @property
    def original(self) -> Field:
        """The field as it was read, before any step: what `max_change` limits changes relative to, and what a session
        begins with."""
        return field_of(self._scan.original(), self.name)

    @property
    def format(self) -> str:
        """The format it was read from; empty where there was none."""
        return self._scan.format

    @property
    def gridding(self) -> dict | None:
        """Of a point cloud, how it became a grid, as a dict; else None."""
        return self._scan.gridding

    def array(self, top_down: bool = False) -> numpy.ndarray:
        """The heights as a new float32 array, rows x columns, NaN where there is a hole, in `height_unit`. Row 0 is the
        lowest one, with `top_down` the highest one."""
        heights = self._scan.heights()
        return heights[::-1] if top_down else heights

    def __array__(self, dtype: DTypeLike = None, copy: bool | None = None) -> numpy.ndarray:
        if copy is False:
            raise ValueError("the heights of a field lie in tiles: an array of them is a copy")
        heights = self._scan.heights()
        return heights if dtype is None else heights.astype(dtype, copy=False)

    def masked(self) -> numpy.ma.MaskedArray:
        """The heights as a masked array, holes masked."""
        return np.ma.masked_invalid(self._scan.heights(), copy=False)

    @property
    def marks(self) -> numpy.ndarray:
        """bool array in the field's shape: samples that filters leave as they are. Row 0 is the lowest one."""
        return self._scan.marks()

    def with_marks(self, marks: ArrayLike | Field, *, top_down: bool = False) -> Field:
        """The field with exactly these marks: bool array of its shape, or another Field whose marks are taken.

        >>> f = Field([[0.0, 1.0], [2.0, 3.0]]).with_marks([[True, False], [False, False]])
        >>> f.marks
        array([[ True, False],
               [False, False]])
        """
        marks = marks.marks if isinstance(marks, Field) else np.asarray(marks) != 0
        return self._made(self._scan.with_marks(marks[::-1] if top_down else marks))

    @property
    def lines(self) -> list[Line]:
        """The edge lines, a list of Line."""
        return _lines.lines_of(self._scan.lines())

    def with_lines(self, lines: Sequence[Line | ArrayLike]) -> Field:
        """The field with exactly these edge lines: Line objects, or arrays n x 2 of column and row [samples]. Where points
        are more than two samples apart, others are inserted between them. An empty list leaves none."""
        return self._made(self._scan.with_lines(_lines.rows_of(lines)))

    def with_heights(self, heights: ArrayLike, *, top_down: bool = False) -> Field:
        """A field at the same place with other heights, an array of its shape, and the same marks.

        >>> f = Field([[1.0, 2.0]], spacing=0.5, unit="um")
        >>> f.with_heights(np.asarray(f) - 1.0)
        <fettle.Field 2 x 1 samples, spacing 0.5 x 0.5 um, heights in um, no holes>
        """
        if np.shape(heights) != self.shape:
            raise ValueError(f"the heights have the shape {np.shape(heights)}, the field {self.shape}")
        marks = self.marks
        made = Field(
            heights,
            self.spacing,
            self.unit,
            height_unit=self.height_unit,
            origin=self.origin,
            crs=self.crs,
            marks=None,
            top_down=top_down,
            name=self.name,
        )
        return made.with_marks(marks) if marks.any() else made

    def inverted(self) -> Field:
        """The field upside down: heights change their signs."""
        return self._made(self._scan.inverted())

    def __repr__(self) -> str:
        (sx, sy), holes = self.spacing, self.holes
        hole = "no holes" if holes == 0 else "1 hole" if holes == 1 else f"{holes} holes"
        return (
            f"<fettle.Field {self._scan.columns} x {self._scan.rows} samples, spacing {sx:.6g} x {sy:.6g} {self.unit}, "
            f"heights in {self.height_unit}, {hole}>"
        )

    def __copy__(self) -> Field:
        return self

    def __deepcopy__(self, memo: dict) -> Field:
        return self

    # A field goes to another process, or into a file of pickle, as its arrays, with the form that lies over it beside them; its
    # original as another field.
    def __reduce__(self):
        original = self._scan.original()
        state = (
            self._scan.samples().heights(), self.spacing, self.origin, self.unit, self.height_unit, self.crs or "",
            self.marks if self._scan.has_marks() else None, self._scan.lines(), self.name, self.report,
            None if original.hash() == self._scan.hash() else field_of(original, self.name),
            self._scan.form(),
        )
        return _restored, state

    # What is done with it: commands.

    def _run(self, command, values, *, before=(), after=(), out=None, progress=None):
        """Runs a command on this field. `before`, `after`: positional arguments around it; `out`: the name under which it
        writes its result, or None. Returns its report, and the result."""
        call = command.begin()
        made = command.options(call, values, like=self)
        call.arguments += before
        call.arguments.append(call.scan(self, "field"))
        call.source = "<field>"
        call.arguments += [word(call) if callable(word) else word for word in after]
        if out is not None:
            call.arguments.append(call.result(out))
        report, written = call.run(f"see help(fettle.Field.{command.function})", progress, 3)
        for name, place in made.items():
            report[name] = _value(written[place])
        return report, None if out is None else written[f"<{out}>"]

    @documented(_FILTER, _FIELD, before=(SELF,), example='''
        >>> f = fettle.synth(size=(96, 64), seed=7)
        >>> g = f.filter("median", window=5).filter("tgv", max_change="50um")
        >>> g.report["filter"], g.shape
        ('tgv', (64, 96))
    ''')
    def filter(self, filter, *, progress=None, **options):
        report, made = self._run(
            _FILTER, {"filter": filter, **options}, out="result", progress=progress
        )
        return self._made(made, report)

    @documented(
        _SUGGEST,
        "Suggestion: a dict of what was found: `why` as a sentence, `pick`, `candidates`, `noise`. `apply()` returns "
        "the field after what was picked.",
        before=(SELF,),
        example='''
        >>> f = fettle.synth(size=(96, 64), seed=7)
        >>> found = f.suggest("30um")
        >>> sorted(found["pick"])[:3]
        ['around_edges', 'error_edge', 'error_flat']
        >>> g = found.apply()
    ''',
    )
    def suggest(self, tolerance=None, *, progress=None, **options):
        report, _ = self._run(_SUGGEST, {"tolerance": tolerance, **options}, progress=progress)
        return Suggestion(self, report, {name: options[name] for name in ("keep", "threads") if name in options})

    @documented(_MARK, "Field: the field with the marks, and with the lines of `lines_out=True`.", before=(SELF,), example='''
        >>> f = fettle.synth(size=(128, 96), seed=7)
        >>> g = f.mark(edges=True, lines_out=True)
        >>> bool(g.marks.any()), len(g.lines) > 0
        (True, True)
    ''')
    def mark(self, *, progress=None, **options):
        report, made = self._run(_MARK, options, out="marks", progress=progress)
        field = self._made(made, report)
        if options.get("lines_out") is True:
            field = field.with_lines(report.pop("lines_out"))
            field.report = report
        return field

    @documented(
        _MEASURE_LINES,
        "dict: for each line its length, step and angle with their standard deviations, in `lines`.",
        before=(SELF, parameter("lines", "list[Line] | Field | str | os.PathLike | None", None)),
    )
    def measure_lines(self, lines=None, *, progress=None, **options):
        after = [] if lines is None else [lambda call: call.lines(lines, "lines")]
        report, _ = self._run(_MEASURE_LINES, options, after=after, progress=progress)
        return report

    @documented(_INFO, "dict: the properties, as `fettle info --json` prints them.", before=(SELF,), example='''
        >>> f = Field([[0.0, 1.0], [2.0, 3.0]], spacing=0.5)
        >>> info = f.info()
        >>> info["width"], info["spacing_x"], info["mean"]
        (2, 0.5, 1.5)
    ''')
    def info(self, *, progress=None, **options):
        report, _ = self._run(_INFO, options, progress=progress)
        return report

    @documented(
        _COMPARE,
        "dict: the figures, lengths in this field's height unit.",
        before=(SELF, parameter("other", "Field | str | os.PathLike")),
        example='''
        >>> f = Field([[0.0, 1.0], [2.0, 3.0]])
        >>> f.compare(f.with_heights(np.asarray(f) + 1))["mean"]
        1.0
    ''',
    )
    def compare(self, other, *, progress=None, **options):
        report, _ = self._run(
            _COMPARE, options, after=[lambda call: call.scan(other, "other")], progress=progress
        )
        return report

    @documented(
        _RENDER,
        "numpy.ndarray: uint8, height x width x 4: red, green, blue and opacity, row 0 at the TOP, as pictures are.",
        before=(SELF,),
    )
    def render(self, *, progress=None, **options):
        options.setdefault("title", self.name or "field")
        if isinstance(options.get("compare"), Field):
            options.setdefault("compare_title", options["compare"].name or "other")
        _, picture = self._run(_RENDER, options, out="picture", progress=progress)
        return picture

    @documented(_APPLY, _FIELD, before=(SELF, parameter("recipe", PATH)))
    def apply(self, recipe, *, progress=None, **options):
        report, made = self._run(_APPLY, options, before=[path_word(recipe)], out="result", progress=progress)
        return self._made(made, report)

    @documented(_REPLAY, _FIELD, before=(SELF, parameter("strokes", PATH)))
    def replay(self, strokes, *, progress=None, **options):
        report, made = self._run(
            _REPLAY, options, after=[path_word(strokes)], out="result", progress=progress
        )
        return self._made(made, report)

    @documented(_WRITE, "Field: this one, so that calls chain.", before=(SELF, parameter("path", PATH)), example='''
        >>> import os, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = os.path.join(folder, "ramp.tif")
        ...     _ = Field([[0.0, 1.0], [2.0, 3.0]], spacing=0.5).write(path, compress="zstd")
        ...     np.asarray(fettle.read(path))
        array([[0., 1.],
               [2., 3.]], dtype=float32)
    ''')
    def write(self, path, *, progress=None, **options):
        self._run(_WRITE, options, after=[path_word(path)], progress=progress)
        return self

    def _repr_png_(self) -> bytes | None:
        """The shaded picture, for notebooks; where no device can draw, None and a warning that says why."""
        try:
            return png_of(self.render(size=(640, 400)))
        except Error as error:
            warnings.warn(f"no picture: {error}", FettleWarning, stacklevel=2)
            return None

    # Beside other packages.

    @classmethod
    def from_rasterio(cls, dataset: Any, band: int = 1) -> Field:
        """A band of an open rasterio dataset, with its place, scale and offset. What its mask hides is a hole. Its transform
        must have no rotation. Heights count as in the unit of the coordinate system unless the band names another."""
        return cls(**_exchange.from_rasterio(dataset, band))

    @classmethod
    def from_xarray(cls, array: Any, unit: str | None = None) -> Field:
        """A DataArray with evenly spaced coordinates, of y and x; other dimensions have one place. Also as
        `rioxarray.open_rasterio` gives it. The coordinate system is the attribute `crs` or that of the coordinate `spatial_ref`.
        The unit is that of the attribute `units` of x, else of the coordinate system, else `unit`, else mm; that of the
        heights is the attribute `units` of the array, else the same. `_FillValue`, `scale_factor` and `add_offset`
        count where xarray has left them among the attributes."""
        return cls(**_exchange.from_xarray(array, unit))

    def to_xarray(self) -> Any:
        """A DataArray with the dimensions y, x, their coordinates in `unit`, marks as the coordinate `marks`. Row 0 has the
        lowest y."""
        import xarray

        return xarray.DataArray(
            self.array(),
            dims=("y", "x"),
            coords={
                "y": ("y", self.y, {"units": self.unit}),
                "x": ("x", self.x, {"units": self.unit}),
                "marks": (("y", "x"), self.marks),
            },
            name=self.name or "height",
            attrs={"units": self.height_unit, **({"crs": self.crs} if self.crs else {})},
        )


def method_of(name):
    """The method for a command that has no function of its own: the field is its first scan. It returns a Field where the
    command writes a scan, else what the command reports."""
    parameters = TABLES[name]["parameters"]
    batch = any(row["name"] == "--out-dir" for row in parameters)
    hidden = ("out-dir", "to", "force", "estimate", "shard", "shard-dir")
    command = Command(name, name, hidden=hidden, hides=(READING, WRITING) if batch else (READING,))
    scan, *others = command.positional
    out = batch or (others and others[-1]["kind"] == "output")
    if out and not batch:
        others.pop()
    before = [SELF]
    for row in others:
        before.append(parameter(identifier(row), "Field | " + PATH, *(() if row["required"] else (None,))))

    def method(self, *given, progress=None, **options):
        words = []
        for row, value in zip(others, given):
            words.append(lambda call, row=row, value=value: call.scan(value, identifier(row)))
        report, made = self._run(command, options, after=words, out="result" if out else None, progress=progress)
        return self._made(made, report) if isinstance(made, _fettle.Scan) else report if made is None else made

    assert scan["kind"] == "input", name
    python_name = command.function = RENAMED.get(name, name)
    returns, example = SHOWN.get(python_name, (_FIELD if out else "dict: what the command prints with --json.", ""))
    function = documented(command, returns, before=tuple(before), example=example)(method)
    function.__name__ = python_name
    return function


#: Commands with functions of their own.
OWN = {"filter", "mark", "lines", "info", "compare", "render", "apply", "replay", "convert", "synth", "recipe", "journal", "mosaic"}
#: Methods that have another name than their command: `report` is what the last command said, and `transform` the affine
#: transform of the samples.
RENAMED = {"report": "page", "transform": "transformed"}
#: What such methods return, and examples.
SHOWN = {
    "level": (
        "Field: rows x columns as before, without the form; `report` has its figures, heights in the field's unit.",
        """
        >>> y, x = np.mgrid[0:40, 0:50]
        >>> tilted = Field(0.5 * x + 0.25 * y, spacing=0.5, unit="mm")
        >>> level = tilted.level()
        >>> bool(np.abs(np.asarray(level)).max() < 1e-5), round(level.report["tilt_x"], 3)   # degrees
        (True, 45.0)
        >>> three = tilted.level(through=[(1, 1), (23, 2), (12, 18)], probe=1.0)   # mm: the plane through three means
        >>> round(three.report["tilt_x"], 3), three.report["through"][0]["samples"]
        (45.0, 13)
        >>> formed = tilted.level(layer="put")                # the samples stay as they are under the form
        >>> np.array_equal(np.asarray(formed.level(layer="remove")), np.asarray(tilted))
        True
        """,
    ),
    "fill": (
        "Field: rows x columns as before; samples with a height keep every bit. `report` counts holes and samples.",
        """
        >>> heights = np.ones((20, 30))
        >>> heights[5:8, 4:9] = np.nan                        # 5 x 3 samples
        >>> f = Field(heights, spacing=0.1, unit="mm")
        >>> full = f.fill(method="membrane", max_extent="1mm")
        >>> full.holes, full.report["filled"], float(np.asarray(full)[6, 6])
        (0, 15, 1.0)
        >>> full.measure(region="measured", only="height")["samples"]   # what is no measurement stays known
        585
        """,
    ),
    "remove": (
        "Field: rows x columns as before, with NaN in place of what is removed. `report` counts it.",
        """
        >>> heights = np.arange(12.0).reshape(3, 4)
        >>> f = Field(heights, spacing=0.1, unit="mm")
        >>> part = f.remove(below=3, above="10mm")
        >>> part.holes, part.report["removed"]
        (4, 4)
        """,
    ),
    "transformed": (
        "Field: of another shape; `report` has its size in samples and its spacing and origin, in `unit`.",
        """
        >>> f = Field(np.arange(12.0).reshape(3, 4), spacing=0.5, unit="mm")
        >>> turned = f.transformed(turn=90)                   # counter-clockwise, as seen from above
        >>> turned.shape, float(np.asarray(turned)[0, 2])
        ((4, 3), 0.0)
        >>> f.transformed(crop=(0.5, 0, 1.5, 0.5)).shape      # mm: two corners
        (2, 3)
        >>> f.transformed(to_spacing=1.0).spacing
        (1.0, 1.0)
        """,
    ),
    "measure": (
        "dict: the parameters as `fettle measure --json` prints them: `sa`, `sq` ... in the field's height unit, ratios "
        "as shares of 1.",
        """
        >>> x = np.arange(200) * 2 * np.pi / 50
        >>> wave = Field(np.tile(np.sin(x), (100, 1)), spacing=0.1, unit="mm", height_unit="um")
        >>> figures = wave.measure(form="mean", only="height")
        >>> figures["unit"], round(figures["sq"], 4)          # of a sine of amplitude 1: 1 / sqrt(2)
        ('um', 0.7071)
        """,
    ),
    "section": (
        "dict: `sections`, a dict for each line: lengths and heights in mm, each figure beside its standard error.",
        """
        >>> heights = np.zeros((40, 60))
        >>> heights[:, 30:] = 0.2
        >>> f = Field(heights, spacing=0.1, unit="mm")
        >>> cut = f.section(start=(0.5, 2), end=(5.5, 2), step="auto")["sections"][0]
        >>> round(cut["step"]["step_mm"], 6)
        0.2
        >>> len(f.section(line=[(0, 0), (2, 1), (5, 1)])["sections"])   # a polyline, mm
        1
        """,
    ),
    "align": (
        "Field: the scan B on the samples of this one, rows x columns as here; `report` has the motion: shifts and height "
        "in mm, angles in degrees, each with its standard error.",
        """
        >>> f = fettle.synth(size=(200, 160), seed=3)
        >>> moved = f.with_heights(np.asarray(f) + 0.25)
        >>> found = f.align(moved, moves="level")
        >>> found.shape, bool(f.compare(found)["max_abs"] < 0.001)
        ((160, 200), True)
        """,
    ),
    "page": ("bytes: the page, HTML in UTF-8 or a PDF, by `type`.", ""),
}
for _name in TABLES:
    if _name not in OWN:
        _method = method_of(_name)
        assert not hasattr(Field, _method.__name__), _method.__name__
        setattr(Field, _method.__name__, _method)


class Suggestion(dict):
    """What `Field.suggest` found, as a dict."""

    def __init__(self, field: Field, report: dict, options: dict) -> None:
        super().__init__(report)
        self._field = field
        self._options = options

    def apply(self, *, progress: Callable[[str, float], object] | None = None) -> Field:
        """The field after the filter that was picked, around marked edges where that was picked, too. The same field
        where no filter is needed. Warns where no filter stays within the tolerance."""
        pick = self.get("pick")
        if pick is None:
            raise InputError("no filter was suggested, only places", "tolerance", "give a tolerance")
        if not self["met"]:
            warnings.warn(self["why"], FettleWarning, stacklevel=2)
        if pick["filter"] is None:
            return self._field
        field, options = self._field, dict(self._options)
        if pick["around_edges"]:
            keep = options.pop("keep", None)
            field = field.mark(edges=True, thickness=pick["thickness"], add=keep, progress=progress)
        for name in ("window", "passes", "range_sigma"):
            options[name] = pick[name]
        return field.filter(pick["filter"], progress=progress, **options)


def png_of(picture):
    """A picture, uint8, height x width x 4, as bytes of a PNG."""
    height, width, channels = picture.shape
    rows = np.zeros((height, 1 + channels * width), dtype=np.uint8)  # a row begins with its filter: 0, none
    rows[:, 1:] = picture.reshape(height, -1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6))
        + chunk(b"IEND", b"")
    )
