"""make_stub.py FOLDER: the types of the package as stubs, FOLDER/__init__.pyi and FOLDER/dask.pyi, made of the package itself:
of the tables of its commands, and of the annotations of all else."""

import inspect
import os
import sys
import typing

import fettle
import fettle.dask
from fettle._commands import type_of

HEAD = '''# Made by python/stub/make_stub.py of the tables of the commands.
import os
from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple

import numpy
from numpy.typing import ArrayLike, DTypeLike

__version__: str
'''
HEAD_OF_DASK = '''# Made by python/stub/make_stub.py of the tables of the commands.
import os
from collections.abc import Sequence
from typing import Any, Literal

from numpy.typing import ArrayLike
'''


def typed(name, kind, default):
    text = f"{name}: {kind}"
    if default is inspect.Parameter.empty:
        return text
    if default is None and not kind.endswith("None"):
        text += " | None"
    return f"{text} = {default!r}"


def of_command(name, function):
    command = function._command
    rows = dict(command.rows, **{row["name"].lstrip("-").replace("-", "_"): row for row in command.first})
    parts = []
    keywords = False
    for each in inspect.signature(function).parameters.values():
        if each.kind is inspect.Parameter.KEYWORD_ONLY and not keywords:
            keywords = True
            parts.append("*")
        if each.name == "self":
            parts.append("self")
        elif each.name == "progress":
            parts.append(typed("progress", "Callable[[str, float], object]", None))
        else:
            kind = type_of(rows[each.name]) if each.annotation is inspect.Parameter.empty else each.annotation
            parts.append(typed(each.name, kind, each.default))
    return lines_of(name, parts, function._returns)


def of_function(name, function):
    parts = []
    keywords = False
    for each in inspect.signature(function).parameters.values():
        if each.kind is inspect.Parameter.KEYWORD_ONLY and not keywords:
            keywords = True
            parts.append("*")
        known = each.annotation is not inspect.Parameter.empty
        parts.append(typed(each.name, shown(each.annotation), each.default) if known else each.name)
    return lines_of(name, parts, shown(inspect.signature(function).return_annotation))


def shown(kind):
    if isinstance(kind, typing.ForwardRef):  # of a NamedTuple whose annotations are texts
        return kind.__forward_arg__
    return kind if isinstance(kind, str) else inspect.formatannotation(kind)


def lines_of(name, parts, returns):
    one = f"def {name}({', '.join(parts)}) -> {returns}: ..."
    if len(one) < 100:
        return [one]
    return [f"def {name}(", *(f"    {part}," for part in parts), f") -> {returns}: ..."]


def of_class(kind):
    bases = [base.__name__ for base in kind.__bases__ if base is not object]
    if hasattr(kind, "_fields"):
        fields = [f"    {name}: {shown(of)}" for name, of in kind.__annotations__.items()]
        return [f"class {kind.__name__}(NamedTuple):", *fields]
    out = [f"class {kind.__name__}{'(' + ', '.join(bases) + ')' if bases else ''}:"]
    body = [f"{name}: str" for name in ("what", "where", "remedy") if kind is fettle.Error]
    body += ["name: str", "report: dict"] if kind is fettle.Field else []
    body += ["id: int", "closed: bool"] if kind is fettle.Line else []
    for name, member in vars(kind).items():
        if name.startswith("_") and name not in ("__init__", "__array__", "__copy__", "__deepcopy__", "__len__", "_repr_png_"):
            continue
        if isinstance(member, property):
            body += ["@property", *of_function(name, member.fget)]
        elif isinstance(member, classmethod):
            body += ["@classmethod", *of_function(name, member.__func__)]
        elif hasattr(member, "_command"):
            body += of_command(name, member)
        elif inspect.isfunction(member):
            body += of_function(name, member)
    return out + ["    " + line for line in body or ["..."]]


def stub():
    text = HEAD
    for name in fettle.__all__:
        member = getattr(fettle, name)
        if inspect.isclass(member):
            lines = of_class(member)
        else:
            lines = of_command(name, member) if hasattr(member, "_command") else of_function(name, member)
        text += "\n" + "\n".join(lines) + "\n"
    return text


def stub_of_dask():
    functions = [of_function(name, getattr(fettle.dask, name)) for name in fettle.dask.__all__]
    return HEAD_OF_DASK + "".join("\n" + "\n".join(lines) + "\n" for lines in functions)


if __name__ == "__main__":
    for name, text in (("__init__.pyi", stub()), ("dask.pyi", stub_of_dask())):
        with open(os.path.join(sys.argv[1], name), "w", encoding="utf-8") as file:
            file.write(text)
