"""Sessions: a scan, what was done to it, and the journal of that."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import NamedTuple

from . import _fettle
from ._commands import _Call, path_word
from ._field import Field, field_of


class Step(NamedTuple):
    """A step of a session: it led to the state `number`."""

    number: int
    name: str
    #: stroke, filter, mark, invert, import, lines, form
    kind: str
    #: UTC, ISO 8601
    time: str


class Session:
    """A session file, NAME.fettle, as it is now; the file is not changed.

    Parameters:
        path: of the session.
        scan: path of the scan, where the session refers to one that was moved.
        progress: as in every method of Field.

    >>> import os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "work.fettle")
    ...     _ = fettle.synth(size=(64, 64)).filter("median").write(path)
    ...     session = Session(path)
    >>> [step.kind for step in session.steps]
    ['import']
    >>> session.field.shape
    (64, 64)
    """

    def __init__(
        self,
        path: str | os.PathLike,
        *,
        scan: str | os.PathLike | None = None,
        progress: Callable[[str, float], object] | None = None,
    ) -> None:
        self._path = os.fspath(path)
        self._name = os.path.basename(os.fsdecode(path))
        scan = b"" if scan is None else os.fsencode(scan)
        self._session = _fettle.SessionReader(os.fsencode(path), scan, progress)

    @property
    def path(self) -> str:
        return self._path

    @property
    def scan(self) -> str:
        """Path of the scan that it began with; empty for one that never had a file."""
        return self._session.scan_path

    @property
    def state(self) -> int:
        """Number of the present state; 0 is the original scan, each step leads to the next one."""
        return self._session.state

    @property
    def states(self) -> range:
        """range of the states that are held."""
        return range(self._session.first, self._session.last + 1)

    @property
    def steps(self) -> list[Step]:
        """list of Step: those that are held, undone ones at the end included."""
        return [Step(*step) for step in self._session.steps()]

    def at(self, state: int) -> Field:
        """Field: the field in one of `states`."""
        return field_of(self._session.field(state), self._name)

    @property
    def field(self) -> Field:
        """Field: the present state."""
        return self.at(self.state)

    @property
    def original(self) -> Field:
        """Field: the scan that it began with."""
        return field_of(self._session.original(), self._name)

    def _call(self, command, after=(), out=None, progress=None):
        call = _Call(command)
        call.arguments += [path_word(self._path), *after]
        if out is not None:
            call.arguments.append(call.result(out))
        report, written = call.run(f"see `fettle {command} --help`", progress, 3)
        return report, None if out is None else written[f"<{out}>"]

    @property
    def journal(self) -> list[dict]:
        """list of dict: every action, undo and redo included: entry, time, state, action."""
        return self._call("journal")[0]["entries"]

    def replay(self, *, progress: Callable[[str, float], object] | None = None) -> Field:
        """Field: the field computed again from the original scan by the journal. Bit-identical to the present state, else
        fettle.Error is raised. A session without a journal cannot be replayed: fettle.InputError."""
        report, made = self._call("replay", out="result", progress=progress)
        return field_of(made, self._name, report)

    def recipe(self) -> str:
        """str: its filters and marks as a recipe (TOML), to be applied to another scan with Field.apply."""
        return self._call("recipe")[0]["recipe"]

    def __repr__(self) -> str:
        return f"<fettle.Session {self._name}: state {self.state} of {self._session.last}>"
