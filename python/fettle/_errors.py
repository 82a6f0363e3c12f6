"""Exceptions and warnings of fettle."""


class Error(Exception):
    """Something outside the program failed: a file, a disk, memory, a graphics device.

    Attributes:
        what: what went wrong.
        where: the file or parameter concerned; may be empty.
        remedy: what to do about it; may be empty.
    """

    def __init__(self, what: str, where: str = "", remedy: str = "") -> None:
        super().__init__(what, where, remedy)
        self.what = what
        self.where = where
        self.remedy = remedy

    def __str__(self) -> str:
        return ", ".join(text for text in (self.what, self.where, self.remedy) if text)


class InputError(Error, ValueError):
    """What was given is wrong: a value, a file that cannot be read, a path that cannot be written."""


class FettleWarning(UserWarning):
    """What was guessed, converted or lost, such as a unit that a file does not state."""
