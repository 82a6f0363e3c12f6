"""Filters over arrays of Dask, with the bits of one run over the whole array.

>>> import dask.array as da, numpy as np, fettle, fettle.dask      # doctest: +SKIP
>>> heights = da.from_zarr("scan.zarr")                            # doctest: +SKIP
>>> clean = fettle.dask.filter(heights, "median", window=5)        # doctest: +SKIP

Dask is imported when a function is called, not before.
"""

from __future__ import annotations

import inspect
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _fettle, _field
from ._commands import parameter, type_of
from ._errors import InputError

__all__ = ["filter", "noise"]

#: Options that are of a whole field, or of a process.
_REFUSED = ("keep", "only", "lines", "residual", "original", "suggest", "max_change")
_OPTIONS = {name: row for name, row in _field._FILTER.rows.items() if name not in _REFUSED}
_DIGITS = 16
_SIGMA_OF_MEDIAN = 1.482602218505602
_SIGMA_OF_MASK = 6.0


def _spacing(spacing):
    pair = (spacing, spacing) if np.isscalar(spacing) else tuple(spacing)
    return float(pair[0]), float(pair[-1])


def _detail(block):
    """The magnitudes of which noise is the middle one (engine/inspect/noise.h), of all samples of a block but its rim."""
    z = block.astype(np.float64)
    across = z[:, :-2] - 2.0 * z[:, 1:-1] + z[:, 2:]
    return np.abs(across[:-2] - 2.0 * across[1:-1] + across[2:])


def _counts(block, shift, prefix):
    """How many values have each of the 16 bits at `shift`, of those whose bits above are `prefix`."""
    values = _detail(block)
    bits = values[~np.isnan(values)].view(np.uint64)
    if shift + _DIGITS < 64:
        above = np.uint64(shift + _DIGITS)
        bits = bits[(bits >> above) == (np.uint64(prefix) >> above)]
    digits = (bits >> np.uint64(shift)) & np.uint64((1 << _DIGITS) - 1)
    return np.bincount(digits.astype(np.int64), minlength=1 << _DIGITS)[None, None, :]


def noise(array: ArrayLike) -> float:
    """float: the noise of an array, exactly the `noise_finest` of `fettle info` for the whole of it. Reads it four times.

    array: rows x columns of Dask, heights; NaN: a hole.
    """
    import dask.array as da

    array = da.asarray(array).astype(np.float32)
    edged = da.overlap.overlap(array, depth=1, boundary=np.nan)
    prefix, rank = 0, None
    for shift in range(64 - _DIGITS, -1, -_DIGITS):
        counts = edged.map_blocks(
            _counts, shift, prefix, dtype=np.int64, new_axis=2, chunks=((1,) * edged.numblocks[0], (1,) * edged.numblocks[1], (1 << _DIGITS,)),
        ).sum(axis=(0, 1)).compute()
        if rank is None:
            total = int(counts.sum())
            if total == 0:
                return math.nan
            rank = (total - 1) // 2
        below = np.cumsum(counts)
        digit = int(np.searchsorted(below, rank, side="right"))
        rank -= int(below[digit - 1]) if digit else 0
        prefix |= digit << shift
    return _SIGMA_OF_MEDIAN * float(np.array([prefix], np.uint64).view(np.float64)[0]) / _SIGMA_OF_MASK


def _aligned(chunks, multiple, least):
    """Sides of chunks of about the same size that begin at multiples, none smaller than `least`, a multiple, but an only one."""
    size = max(multiple, least, -(-max(chunks) // multiple) * multiple)
    total = sum(chunks)
    starts = list(range(0, total, size))
    # Dask would move samples into a last chunk that is smaller, which then began elsewhere.
    if len(starts) > 1 and total - starts[-1] < least:
        starts.pop()
    return tuple(end - start for start, end in zip(starts, [*starts[1:], total]))


def _options(command):
    """A decorator: gives the function the options of the command's table in the place of **options."""

    def decorate(function):
        known = list(inspect.signature(function).parameters.values())[:-1]
        known[1] = parameter("filter", type_of(command.first[0]))
        known += [each.replace(annotation=type_of(_OPTIONS[each.name])) for each in command.signature().parameters.values() if each.name in _OPTIONS]
        function.__signature__ = inspect.Signature(known, return_annotation="Any")
        return function

    return decorate


def _word(value):
    return value if isinstance(value, str) else "" if value is None else repr(float(value))


@_options(_field._FILTER)
def filter(
    array: ArrayLike,
    filter: str,
    *,
    spacing: float | tuple[float, float] = 1.0,
    unit: str = "mm",
    height_unit: str | None = None,
    **options: Any,
) -> Any:
    """dask.array.Array: the filtered heights, float32, rows x columns as before; nothing is computed yet but the noise.

    array: rows x columns of Dask, heights in `height_unit`; NaN: a hole. Row 0 is the row with the lowest y.
    filter, options: as of `fettle.Field.filter`; without `range_sigma` a filter that has one gets that of the noise of the
        whole array, which is measured now.
    spacing: of samples, or the pair of x and y, in `unit`.

    Each chunk is read with the samples around it on which its results depend, and chunks are cut anew where a filter works in
    squares, so that the bits are those of one run over the whole array, whatever the chunks. InputError: an unknown filter, one
    whose results depend on the whole field, and options that are of one.
    """
    import dask.array as da

    for name in _REFUSED:
        if options.get(name) is not None:
            raise InputError(f"{name} is of a whole field", name, "leave it out, or use fettle filter --shard")
    for name in options:
        if name not in (*_OPTIONS, *_REFUSED):
            raise TypeError(f"filter() got an unexpected keyword argument {name!r}; it has {', '.join(_OPTIONS)}")
    words = [each["word"] for each in _field._FILTER.first[0]["words"]]
    if filter not in words:
        raise InputError(f"there is no filter {filter!r}", "filter", f"take one of {', '.join(words)}")
    array = da.asarray(array).astype(np.float32)
    if array.ndim != 2:
        raise InputError(f"an array of {array.ndim} axes is not a field", "array", "give rows x columns")
    x, y = _spacing(spacing)
    options.setdefault("compute", "cpu")
    reach, grid, range_noises = _fettle.reach(
        filter,
        float(options.get("window") or 0),
        float(options.get("passes") or 1),
        *(_word(options.get(name)) for name in ("cutoff", "radius")),
        *(x, y, unit),
        *array.shape[::-1],
    )
    if reach < 0:
        raise InputError(f"a result of {filter} depends on the whole field", "filter", "filter it in one piece")
    if range_noises and options.get("range_sigma") is None:
        sigma = noise(array)
        if not sigma > 0.0:
            raise InputError("no noise can be seen that a range sigma could follow", "range_sigma", "give one")
        options["range_sigma"] = repr(sigma * range_noises)
    around = -(-reach // grid) * grid
    # Along an axis that is no longer than what lies around a chunk there is one chunk.
    depth = {axis: 0 if around >= side else around for axis, side in enumerate(array.shape)}
    chunks = tuple(_aligned(array.chunks[axis], grid, depth[axis]) if depth[axis] else (array.shape[axis],) for axis in (0, 1))
    array = array.rechunk(chunks)

    def one(block):
        if block.size == 0:
            return block
        field = _field.Field(block, spacing=(x, y), unit=unit, height_unit=height_unit or unit)
        return np.asarray(field.filter(filter, **options))

    return da.overlap.map_overlap(
        one, array, depth=depth, boundary="none", dtype=np.float32, meta=np.empty((0, 0), np.float32), allow_rechunk=False
    )
