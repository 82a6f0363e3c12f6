"""Edge lines: where two surfaces of a part meet."""

from __future__ import annotations

import numpy
import numpy as np
from numpy.typing import ArrayLike


class Line:
    """An edge line of a field.

    Attributes:
        id (int): its number.
        closed (bool): whether its last point is joined to the first.
        points: float64 array, n x 2: column and row of each point [samples], row 0 lowest. "Left" below is left going
            along the points, with columns to the right and rows up.
        located: bool array, n: whether the field shows an edge there. If not, the point is where the hand drew it, and
            the values below are 0.
        crease: bool array, n: whether the slope changes there more than the height does.
        deviation: float64 array, n: standard deviation of the position across the line [samples].
        step, step_deviation: float64 arrays, n: height of the left surface minus that of the right one, and its
            standard deviation [height unit].
        slope_change, slope_deviation: float64 arrays, n: the same of the slope across the line, towards the left
            [height unit per sample].

    >>> import numpy as np
    >>> line = Line(np.array([[0.0, 2.0], [5.0, 2.0]]))
    >>> line
    <Line 0: 2 points>
    """

    __slots__ = ("id", "closed", "_rows")

    def __init__(self, points: ArrayLike, *, id: int = 0, closed: bool = False) -> None:
        rows = np.array(points, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] not in (2, 9):
            raise ValueError("the points of a line are rows of column and row: give an array of n x 2")
        rows.setflags(write=False)
        self.id = int(id)
        self.closed = bool(closed)
        self._rows = rows

    def _column(self, k):
        return self._rows[:, k] if self._rows.shape[1] > k else np.zeros(len(self._rows))

    @property
    def points(self) -> numpy.ndarray:
        return self._rows[:, :2]

    @property
    def located(self) -> numpy.ndarray:
        return self._column(2) != 0 if self._rows.shape[1] > 2 else np.ones(len(self._rows), dtype=bool)

    @property
    def crease(self) -> numpy.ndarray:
        return self._column(3) != 0

    @property
    def deviation(self) -> numpy.ndarray:
        return self._column(4)

    @property
    def step(self) -> numpy.ndarray:
        return self._column(5)

    @property
    def step_deviation(self) -> numpy.ndarray:
        return self._column(6)

    @property
    def slope_change(self) -> numpy.ndarray:
        return self._column(7)

    @property
    def slope_deviation(self) -> numpy.ndarray:
        return self._column(8)

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return f"<Line {self.id}: {len(self)} points{', closed' if self.closed else ''}>"


def lines_of(rows):
    return [Line(points, id=number, closed=closed) for number, closed, points in rows]


def rows_of(lines):
    """Lines, or arrays of points, as the compiled module takes them; numbers that repeat are replaced."""
    lines = [line if isinstance(line, Line) else Line(line, id=k) for k, line in enumerate(lines)]
    numbers = [line.id for line in lines]
    if len(set(numbers)) < len(numbers):
        numbers = range(len(lines))
    return [(number, line.closed, line._rows) for number, line in zip(numbers, lines)]
