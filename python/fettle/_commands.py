"""Python functions made of the tables that `fettle --help` is made of.

Every command has a table of its parameters: name, kind, range, unit, words, default, text. A function of this package
takes its signature, its documentation and its checks from that table, so a command that gets a row has a new
parameter here, and a new command a new function.
"""

import collections
import inspect
import json
import operator
import os
import re
import textwrap
import warnings

import numpy as np

from . import _fettle
from ._errors import Error, FettleWarning

PROGRESS = """    progress (Callable[[str, float], object]): Called about ten times a second with what is being
        done, and how much of that is done, 0 to 1. An exception in it ends the work, and is raised.
"""
# Of parameters that functions handle themselves.
PARAMETERS = {
    "path": "The file",
    "scan": "The scan to touch, a Field or a file; or a session, NAME.fettle",
    "other": "The scan to compare with this one",
    "recipe": "The recipe, a TOML file",
    "scans": "Overlapping scans, two or more; the first stays where it is",
    "lines": "Edge lines; without them those of the field",
}
REPORTS = "Report and help"
READING = "Reading the scan"
WRITING = "Writing"

_NEW = {"new_scan", "new_marks", "new_lines"}
_TYPES = {
    "flag": "bool",
    "text": "str",
    "whole": "int",
    "number": "float",
    "length": "float | str",
    "size": "tuple[int, int]",
    "format": "str",
    "input": "Field | str | os.PathLike",
    "file": "str | os.PathLike",
    "marks": "bool | numpy.ndarray | Field | str | os.PathLike",
    "lines": "list[Line] | Field | str | os.PathLike",
    "output": "bool | str | os.PathLike",
    "new_file": "str | os.PathLike",
    "new_scan": "bool | str | os.PathLike",
    "new_marks": "bool | str | os.PathLike",
    "new_lines": "bool | str | os.PathLike",
    "folder": "str | os.PathLike",
}


def _tables():
    program = json.loads(_fettle.tables())["program"]
    return {command["name"]: command for command in program["commands"]}


TABLES = _tables()


def identifier(row):
    """The Python name of a row: "--max-change" is max_change, "STROKES" is strokes."""
    name = row["name"].lstrip("-").replace("-", "_").lower()
    return name + "_" if name in ("from", "in", "lambda", "global") else name


def in_python(text):
    """A text of the table with the names that parameters have here: --max-change is `max_change`."""
    return re.sub(r"(?<![\w-])--([a-z][a-z-]*)", lambda m: f"`{identifier({'name': m.group(1)})}`", text)


#: Parameters whose value is a list of points: as a word X,Y:X,Y.
POLYLINES = {"--line", "--through"}


def is_places(row):
    """Whether a row takes points, each of which is one word: X,Y."""
    several = row["values"] == "any" or row["name"] in POLYLINES
    return row["kind"] == "text" and several and not row["between"] and not row["positional"]


def _places(row, value):
    """Points as typed, one word or several: (x, y) and "x,y" are one point, a list of these are several; of a polyline
    a list of points is one, and a list of such lists are several."""

    def is_point(each):
        return not isinstance(each, str) and all(isinstance(part, (int, float, np.number)) for part in each)

    def shown(part):
        return str(int(part)) if part == int(part) else repr(float(part))

    def point(each):
        return each if isinstance(each, str) else ",".join(map(shown, each))

    if isinstance(value, str):
        return [value]
    value = list(value)
    if row["name"] not in POLYLINES:
        return [point(value)] if is_point(value) else [point(each) for each in value]
    if not all(isinstance(each, str) for each in value) and all(is_point(each) for each in value):
        value = [value]
    return [each if isinstance(each, str) else ":".join(point(part) for part in each) for each in value]


def type_of(row):
    """The type of a row's values, as it stands in a stub."""
    if is_places(row):
        one = "Sequence[Sequence[float]]" if row["name"] in POLYLINES else "Sequence[float]"
        return f"str | {one}" if row["values"] == 1 else f"str | {one} | Sequence[str | {one}]"
    if row["kind"] == "text" and row["values"] == "any":
        return "str | float | Sequence[str | float]"
    if row["kind"] == "word":
        words = [word["word"] for word in row["words"]]
        numbers = [word for word in words if all(each.isdigit() for each in words)]
        one = "Literal[" + ", ".join([*map(repr, words), *numbers]) + "]"
    else:
        one = _TYPES[row["kind"]]
    if row["values"] == 1:
        return one
    return f"{one} | Sequence[{one}]" if row["values"] == "any" else f"Sequence[{one}]"


def default_of(row):
    """The default as a Python value; None where nothing stands for it."""
    if row["kind"] == "flag":
        return False
    value = row["default"]
    if value is None or value == "":
        return None
    if row["values"] != 1:
        return None
    if row["kind"] == "size":
        return tuple(int(side) for side in value.split("x"))
    if row["kind"] == "whole":
        return int(value)
    return value


class _Call:
    """One call of a command: its arguments, and what stands in memory."""

    def __init__(self, command):
        self.arguments = [command]
        self.options = []  # after the scans, of which an option with several values would take the first for one of them
        self.given = {}
        self.made = []
        self.source = ""

    def scan(self, value, name):
        """The word for a scan: a place in memory for a Field, else a path."""
        from ._field import Field

        if isinstance(value, Field):
            place = f"<{name}>"
            self.given[place] = value._scan
            self.source = self.source or place
            return place
        return path_word(value)

    def marks(self, value, name, like):
        from ._field import Field

        if value is True:
            value = like
        if isinstance(value, Field):
            return self.scan(value, name)
        if isinstance(value, (str, os.PathLike)):
            return path_word(value)
        if like is None:
            raise TypeError(f"{name}: give a Field or a path")
        place = f"<{name}>"
        self.given[place] = like.with_marks(value)._scan
        return place

    def lines(self, value, name):
        from . import _lines
        from ._field import Field

        if isinstance(value, (str, os.PathLike)):
            return path_word(value)
        if isinstance(value, Field):
            value = value.lines
        place = f"<{name}>"
        self.given[place] = _lines.rows_of(value)
        return place

    def result(self, name):
        place = f"<{name}>"
        self.made.append(place)
        return place

    def run(self, help_text, progress, stacklevel):
        words = [os.fsencode(each) for each in self.arguments + self.options]
        try:
            report, written, told = _fettle.call(words, self.given, self.made, self.source, help_text, progress)
        except Error as error:
            if re.fullmatch(r"--[a-z][a-z-]*", error.where):
                error.where = identifier({"name": error.where})
            # What names a command of the program stays one.
            if "fettle " not in error.remedy:
                error.remedy = in_python(error.remedy)
            error.args = (error.what, error.where, error.remedy)
            raise
        for text in told:
            warnings.warn(text, FettleWarning, stacklevel=stacklevel + 1)
        # Where a command says which file it wrote, the name of a place in memory would say nothing.
        figures = {key: value for key, value in json.loads(report).items() if value not in self.made}
        return figures, written


def path_word(value):
    """A path as an argument. A name that would count as something else gets its folder."""
    try:
        path = os.fsdecode(value)
    except TypeError:
        raise TypeError(f"give a Field or a path, not a value of type {type(value).__name__}") from None
    if not path:
        from ._errors import InputError

        raise InputError("a path is empty", "", "name a file")
    if "\0" in path:
        from ._errors import InputError

        raise InputError("a path with a null character cannot be a file's", repr(path), "name a file")
    if path == "-":
        from ._errors import InputError

        raise InputError("standard input and output are those of the program fettle", "-", "name a file")
    return "./" + path if path[0] in "-<" else path


_MEANT = {"whole": "a whole number", "number": "a number", "length": "a number, or a text with a unit as '20um'", "size": "(width, height)"}


def _word(row, value):
    """One value as typed on the command line."""
    try:
        return _typed(row, value)
    except (TypeError, ValueError, IndexError) as error:
        if row["kind"] not in _MEANT:
            raise
        raise TypeError(f"{identifier(row)}: give {_MEANT[row['kind']]}, not {value!r}") from error


def _typed(row, value):
    kind = row["kind"]
    if kind == "whole":
        return str(operator.index(value))
    if kind == "number":
        return repr(float(value))
    if kind == "length":
        return value if isinstance(value, str) else repr(float(value))
    if kind == "size":
        return value if isinstance(value, str) else "{}x{}".format(*(operator.index(side) for side in value))
    if kind in ("file", "input", "output", "folder") or kind.startswith("new_"):
        return path_word(value)
    if isinstance(value, (tuple, list)):  # ROW,COLUMN
        return ",".join(str(part) for part in value)
    return str(value)


def _flag(function, name, value):
    """A flag by its value: True, False, and what numpy and numbers have for them."""
    if isinstance(value, (bool, np.bool_)) or (isinstance(value, (int, np.integer)) and value in (0, 1)):
        return bool(value)
    raise TypeError(f"{function}(): {name} is True or False, not {value!r}")


class Command:
    """A Python function that runs a command.

    name: of the function. command: the command's name. first: options that are positional parameters here.
    fixed: words that are always given. hidden: names of rows that have no meaning here. groups: only rows under these
    headings, and those in `also`; hides: none under these. summary: instead of the command's.
    """

    def __init__(self, name, command, *, first=(), fixed=(), hidden=(), hides=(), groups=None, also=(), summary=""):
        self.name = name
        self.function = name  # under which it is documented
        self.table = TABLES[command]
        self.fixed = list(fixed)
        self.summary = summary or self.table["summary"]
        rows = [row for row in self.table["parameters"] if row["group"] != REPORTS]
        self.positional = [row for row in rows if row["positional"]]
        self.rows = collections.OrderedDict()
        for row in rows:
            heading = row["group"] or "Options"
            named = row["name"].lstrip("-")
            if row["positional"] or named in hidden or named in first:
                continue
            if heading in hides or (groups is not None and heading not in groups and named not in also):
                continue
            self.rows[identifier(row)] = row
        self.texts = {identifier(row): in_python(row["text"]) for row in self.positional}
        self.texts.update(PARAMETERS)
        self.first = [next(row for row in rows if row["name"].lstrip("-") == name) for name in first]

    def signature(self, before=()):
        """`before`: parameters in front, those that the function handles itself."""
        parameters = list(before)
        kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
        for row in self.first:
            default = inspect.Parameter.empty if identifier(row) == "filter" else None
            parameters.append(inspect.Parameter(identifier(row), kind, default=default))
        kind = inspect.Parameter.KEYWORD_ONLY
        for name, row in self.rows.items():
            parameters.append(inspect.Parameter(name, kind, default=default_of(row)))
        parameters.append(inspect.Parameter("progress", kind, default=None))
        return inspect.Signature(parameters)

    def documentation(self, returns, example="", before=()):
        """The command's summary and a line for each parameter, with its range, unit and default."""
        text = textwrap.fill(self.summary + ".", width=96) + "\n"
        rows = [(identifier(row), row) for row in self.first] + list(self.rows.items())
        text += "\nParameters:\n"
        for each in before:
            if each.name in self.texts:
                entry = f"{each.name} ({each.annotation}): {self.texts[each.name]}."
                text += textwrap.fill(entry, 96, initial_indent="    ", subsequent_indent="        ") + "\n"
        for name, row in rows:
            entry = f"{name} ({type_of(row)}): {in_python(row['text'])}"
            facts = facts_of(row)
            text += textwrap.fill(
                entry + (f" ({facts})." if facts else "."),
                width=96,
                initial_indent="    ",
                subsequent_indent="        ",
                break_long_words=False,
                break_on_hyphens=False,
            )
            text += "\n"
            for word in row["words"]:
                if word["text"]:
                    text += textwrap.fill(
                        f"{word['word']}: {word['text']}.",
                        width=96,
                        initial_indent=" " * 8,
                        subsequent_indent=" " * 12,
                        break_on_hyphens=False,
                    )
                    text += "\n"
        text += PROGRESS
        text += f"\nReturns:\n{textwrap.indent(textwrap.fill(returns, width=92), '    ')}\n"
        if self.table["notes"]:
            text += "\nNotes:\n"
            for note in self.table["notes"].split("\n"):
                text += textwrap.fill(in_python(note), 96, initial_indent="    ", subsequent_indent="    ") + "\n"
        if example:
            text += "\n" + textwrap.dedent(example).strip() + "\n"
        return text

    def begin(self):
        return _Call(self.table["name"])

    def options(self, call, values, like=None):
        """Adds the arguments of `values`, by Python name. What has its default is not given. Returns what is made in
        memory: Python name -> place."""
        made = {}
        rows = dict(self.rows, **{identifier(row): row for row in self.first})
        for name, value in values.items():
            if name not in rows:
                meant = [each for each in rows if each.startswith(name[:3])]
                hint = f"; did you mean {', '.join(meant)}?" if meant else ""
                raise TypeError(f"{self.name}() got an unexpected keyword argument {name!r}{hint}")
            row = rows[name]
            option = row["name"]
            kind = row["kind"]
            if isinstance(value, np.bool_):
                value = bool(value)
            if value is None or value is False:
                continue
            if kind == "flag":
                if _flag(self.name, name, value):
                    call.options.append(option)
            elif (kind in _NEW or kind == "output") and value is True:
                made[name] = call.result(name)
                call.options += [option, made[name]]
            elif kind == "input":
                call.options += [option, call.scan(value, name)]
            elif kind == "marks":
                call.options += [option, call.marks(value, name, like)]
            elif kind == "lines":
                call.options += [option, call.lines(value, name)]
            elif is_places(row):
                call.options += [f"{option}={word}" for word in _places(row, value)]
            elif row["values"] == 1:
                call.options.append(f"{option}={_word(row, value)}")
            else:
                many = list(value) if isinstance(value, (list, tuple)) or hasattr(value, "__array__") else [value]
                words = [_word(row, each) for each in many]
                if row["between"]:
                    call.options.append(f"{option}={row['between'].join(words)}")
                else:
                    for word in words:
                        call.options.append(f"{option}={word}")
        call.options += self.fixed
        return made


def facts_of(row):
    """Words, range, unit and default of a row: "1 to 1001 samples; default 3"."""
    facts = []
    unit = f" {row['unit']}" if row["unit"] else ""
    if row["range"]:
        low, high = row["range"]
        if high is None:
            facts.append(f"at least {low:g}{unit}")
        elif low is None:
            facts.append(f"at most {high:g}{unit}")
        else:
            facts.append(f"{low:.10g} to {high:.10g}{unit}")
    elif unit:
        facts.append(f"in{unit}")
    if row["kind"] == "length":
        facts.append('or as "20um"' if unit else 'in the scan\'s unit, or as "20um"')
    if row["kind"] == "marks":
        facts.append("or a bool array, a Field, True for the field's own")
    if row["kind"] == "lines":
        facts.append("or a list of Line")
    if row["kind"] in _NEW or row["kind"] == "output":
        facts.append("True returns it in the report instead of writing a file")
    if row["otherwise"]:
        facts.append(f"without it: {in_python(row['otherwise'])}")
    elif default_of(row) not in (None, False):
        facts.append(f"default {default_of(row)!r}")
    excludes = [identifier({"name": name}) for name in row["excludes"]]
    if excludes:
        facts.append(f"not with {', '.join(excludes)}")
    return "; ".join(facts)


def documented(command, returns, *, before=(), example=""):
    """A decorator: gives a function the signature and documentation of a command. `returns` begins with the type."""

    def decorate(function):
        function.__signature__ = command.signature(before)
        function.__doc__ = command.documentation(returns, example, before)
        function.__name__ = command.name
        function._command = command
        function._before = before
        function._returns = returns.split(":")[0].split(",")[0].split(" ")[-1]
        return function

    return decorate


SELF = inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD)


def parameter(name, kind, default=inspect.Parameter.empty):
    """A parameter of the type `kind` that a function handles itself."""
    return inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=default, annotation=kind)


PATH = "str | os.PathLike"
