"""Height fields from and to rasterio and xarray."""

from __future__ import annotations

import os
import warnings
from typing import Any

import numpy as np

from . import _fettle
from ._errors import FettleWarning, InputError

_UNITS = ("nm", "um", "mm", "cm", "m", "km", "in", "ft", "ftUS")
_LONG = {
    "metre": "m",
    "meter": "m",
    "metres": "m",
    "meters": "m",
    "millimetre": "mm",
    "millimeter": "mm",
    "millimetres": "mm",
    "millimeters": "mm",
    "centimetre": "cm",
    "centimeter": "cm",
    "micrometre": "um",
    "micrometer": "um",
    "micrometres": "um",
    "micrometers": "um",
    "µm": "um",
    "μm": "um",
    "micron": "um",
    "microns": "um",
    "nanometre": "nm",
    "nanometer": "nm",
    "nanometres": "nm",
    "nanometers": "nm",
    "kilometre": "km",
    "kilometer": "km",
    "inch": "in",
    "foot": "ft",
    "us survey foot": "ftUS",
}
# Names of dimensions across the rows and along them, as packages give them.
_ACROSS = {"y", "row", "rows", "lat", "latitude", "northing"}
_ALONG = {"x", "col", "cols", "column", "columns", "lon", "longitude", "easting"}


def unit_named(name: Any) -> str | None:
    """The unit that a text names; None where it is none of lengths."""
    name = str(name or "").strip()
    short = _LONG.get(name.lower(), name)
    return short if short in _UNITS else None


def from_rasterio(dataset: Any, band: int) -> dict[str, Any]:
    """The arguments of a Field."""
    where = os.path.basename(dataset.name or "") or "the dataset"
    a, b, c, d, e, f = tuple(dataset.transform)[:6]
    if b != 0 or d != 0:
        raise InputError("the dataset is rotated", where, "warp it first")
    unit = None
    if dataset.crs:
        unit = None if dataset.crs.is_geographic else unit_named(dataset.crs.linear_units)
        if unit is None:
            raise InputError(
                "the dataset has no lengths in its coordinates", where, "warp it to metres, or read its file with fettle.read"
            )
    elif dataset.transform.is_identity:
        warnings.warn(f"{where} has no place and no unit here: samples 1 mm apart; fettle.read may find more in its file",
                      FettleWarning, stacklevel=3)
    heights = counted(dataset.read(band, masked=True), dataset.scales[band - 1], dataset.offsets[band - 1])
    if a < 0:
        heights, a, c = heights[:, ::-1], -a, c + a * heights.shape[1]
    low, down = (f + e * heights.shape[0], True) if e < 0 else (f, False)
    return {
        "heights": heights,
        "spacing": (a, abs(e)),
        "unit": unit or "mm",
        "height_unit": height_unit(dataset.units[band - 1], unit or "mm", where),
        "origin": (c + 0.5 * a, low + 0.5 * abs(e)),
        "crs": dataset.crs.to_wkt() if dataset.crs else "",
        "top_down": down,
        "name": os.path.basename(dataset.name or ""),
    }


def counted(heights: Any, scale: float, offset: float) -> Any:
    """Heights of numbers that count in `scale` from `offset`."""
    return heights if (scale, offset) == (1.0, 0.0) else heights.astype(np.float64) * scale + offset


def height_unit(name: Any, otherwise: str, where: str) -> str:
    unit = unit_named(name)
    if unit is None and str(name or "").strip():
        warnings.warn(f"{where}: heights in {name} are taken as {otherwise}", FettleWarning, stacklevel=4)
    return unit or otherwise


def from_xarray(array: Any, unit: str | None) -> dict[str, Any]:
    """The arguments of a Field."""
    if not all(hasattr(array, name) for name in ("dims", "coords", "attrs")) or not hasattr(array, "dtype"):
        raise InputError(f"a {type(array).__name__} is no DataArray", "array", "take one variable of a Dataset, or Field(array)")
    where = str(array.name or "the array")
    attributes = {**getattr(array, "encoding", {}), **array.attrs}
    reference = next((array.coords[n].attrs for n in ("spatial_ref", "crs") if n in array.coords), {})
    # One band, one time: not a dimension of the surface.
    lone = [name for name in array.dims if array.sizes[name] == 1 and str(name).lower() not in _ACROSS | _ALONG]
    if array.ndim > 2:
        array = array.squeeze(lone, drop=True)
    if array.ndim != 2:
        raise InputError(f"the array has the dimensions {', '.join(map(str, array.dims))}", where, "select y and x: array.isel(band=0)")
    first, second = (str(name).lower() for name in array.dims)
    if first in _ALONG or second in _ACROSS:
        array = array.transpose(*reversed(array.dims))
    rows, columns = (_axis(array, name, where) for name in array.dims)
    crs = attributes.get("crs") or reference.get("crs_wkt") or reference.get("spatial_ref") or ""
    crs = crs if isinstance(crs, str) else getattr(crs, "to_wkt", lambda: str(crs))()
    lateral = _lateral(array, crs, unit, where)
    heights = array.to_masked_array(copy=False)
    for name in ("_FillValue", "missing_value", "nodata"):
        value = array.attrs.get(name)
        if value is not None and np.isscalar(value) and value == value:
            heights = np.ma.masked_equal(heights, value, copy=False)
    heights = counted(heights, array.attrs.get("scale_factor", 1.0), array.attrs.get("add_offset", 0.0))
    if columns[1] < 0:
        heights = heights[:, ::-1]
    return {
        "heights": heights,
        "spacing": (abs(columns[1]), abs(rows[1])),
        "unit": lateral,
        "height_unit": height_unit(array.attrs.get("units", ""), lateral, where),
        "origin": (columns[0], rows[0]),
        "crs": crs,
        "top_down": rows[1] < 0,
        "name": str(array.name or ""),
    }


def _lateral(array: Any, crs: str, unit: str | None, where: str) -> str:
    """The unit of the coordinates: as they state it, as the coordinate system has it, as given, mm."""
    along = array.dims[1]
    stated = array.coords[along].attrs.get("units", "") if along in array.coords else ""
    found = unit_named(stated)
    if found is None and stated:
        raise InputError(f"the coordinates count in {stated}, which is no length", where, "reproject them to metres first")
    if found is None and crs:
        found = unit_named(_fettle.unit_of_crs(crs))
        if found is None:
            raise InputError("the coordinate system counts in no length", where, "reproject it to metres first")
    return found or unit or "mm"


def _axis(array: Any, name: Any, where: str) -> tuple[float, float]:
    """(lowest coordinate, step with its sign) of an evenly spaced axis; without coordinates, of its indices."""
    if name not in array.coords:
        return 0.0, 1.0
    values = np.asarray(array.coords[name], dtype=np.float64)
    if len(values) < 2:
        return float(values[0]), 1.0
    step = (values[-1] - values[0]) / (len(values) - 1)
    if step == 0 or np.max(np.abs(values - (values[0] + step * np.arange(len(values))))) > 0.01 * abs(step):
        raise InputError(f"the coordinates of {name} are not evenly spaced", where, "interpolate to an even grid first")
    return float(min(values[0], values[-1])), float(step)
