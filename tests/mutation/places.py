"""Places of a source file where a wrong line can be planted, found in its syntax tree.

A place is a piece of the text with another piece that takes its place: a comparison with another bound, a sign, a
constant, a call left out. Only code that runs is changed, within the bodies of functions that are no templates;
what the compiler works out itself - bounds of arrays, cases, constexpr - is left alone.
"""

from __future__ import annotations

import dataclasses
import re

from clang import cindex

Kind = cindex.CursorKind

# Of each operator the one that is wrong most inconspicuously. Floating point numbers are hardly ever equal.
COMPARISONS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&"}
OF_FLOATS = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}
SIGNS = {"+": "-", "-": "+", "*": "/", "/": "*"}
ASSIGNMENTS = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
OPERATORS = COMPARISONS | SIGNS | ASSIGNMENTS

FUNCTIONS = {Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.CONSTRUCTOR, Kind.DESTRUCTOR, Kind.CONVERSION_FUNCTION}
# Below these nothing runs, or not as it stands there.
LEFT_ALONE = {Kind.STATIC_ASSERT, Kind.FUNCTION_TEMPLATE, Kind.CLASS_TEMPLATE, Kind.ENUM_DECL, Kind.TYPE_ALIAS_DECL}
Type = cindex.TypeKind
FLOAT = {Type.FLOAT, Type.DOUBLE, Type.LONGDOUBLE}
INTEGERS = range(Type.CHAR_U.value, Type.INT128.value + 1)
# Calls that only make room beforehand or give it back: without them everything is the same, with more copies.
OF_ROOM = {"reserve", "shrink_to_fit"}


@dataclasses.dataclass(frozen=True)
class Place:
    """The bytes begin .. end of a file, and what is planted for them; `{at}` stands for the choice."""

    file: str
    line: int
    begin: int
    end: int
    kind: str  # "comparison", "sign", "constant", "call"
    right: str
    wrong: str

    def planted(self, number: int) -> str:
        at = f"fettle_planted::at({number})"
        if self.kind == "call":
            return f"if (!{at}) {self.right}"
        return f"({at} ? ({self.wrong}) : ({self.right}))"

    def words(self) -> str:
        def short(text: str) -> str:
            text = " ".join(text.split())
            return text if len(text) <= 70 else text[:67] + "..."

        return f"{short(self.right)} left out" if self.kind == "call" else f"{short(self.right)} -> {short(self.wrong)}"


def is_number(kind: cindex.Type) -> bool:
    found = kind.get_canonical().kind
    return found in FLOAT or found == Type.BOOL or found.value in INTEGERS


class Finder:
    """Walks the tree of one file."""

    def __init__(self, path: str, name: str, arguments: list[str]):
        self.name = name
        self.path = path
        with open(path, "rb") as file:
            self.text = file.read()
        self.unit = cindex.Index.create().parse(path, args=arguments)
        self.places: list[Place] = []

    def find(self) -> list[Place]:
        for cursor in self.unit.cursor.get_children():
            self.declared(cursor)
        return self.places

    def here(self, cursor: cindex.Cursor) -> bool:
        """Whether it stands in this file: a file may be included amid a namespace."""
        file = cursor.extent.start.file
        return file is not None and file.name == self.path

    def declared(self, cursor: cindex.Cursor) -> None:
        if cursor.kind in LEFT_ALONE or not self.here(cursor):
            return
        for child in cursor.get_children():
            if cursor.kind in FUNCTIONS and child.kind == Kind.COMPOUND_STMT:
                self.runs(child)
            elif child.kind in FUNCTIONS or child.kind in (Kind.NAMESPACE, Kind.CLASS_DECL, Kind.STRUCT_DECL,
                                                           Kind.LINKAGE_SPEC, Kind.UNEXPOSED_DECL):
                self.declared(child)

    def slice(self, begin: int, end: int) -> str:
        return self.text[begin:end].decode()

    def of(self, cursor: cindex.Cursor) -> tuple[int, int]:
        return cursor.extent.start.offset, cursor.extent.end.offset

    def add(self, cursor: cindex.Cursor, kind: str, wrong: str) -> None:
        begin, end = self.of(cursor)
        if end > begin and "#" not in self.slice(begin, end):
            self.places.append(
                Place(self.name, cursor.extent.start.line, begin, end, kind, self.slice(begin, end), wrong))

    def runs(self, cursor: cindex.Cursor) -> None:
        children = list(cursor.get_children())
        if cursor.kind in LEFT_ALONE or not self.here(cursor):
            return
        if cursor.kind == Kind.DECL_STMT and re.match(r"(static\s+)?constexpr\b", self.slice(*self.of(cursor))):
            return
        if cursor.kind == Kind.CASE_STMT:
            children = children[1:]
        if cursor.kind == Kind.VAR_DECL and cursor.type.kind == Type.CONSTANTARRAY:
            children = [c for c in children if c.kind == Kind.INIT_LIST_EXPR]
        # A number of a vector's lanes: beyond the last one nothing is defined.
        if cursor.kind == Kind.ARRAY_SUBSCRIPT_EXPR and children[0].type.get_canonical().kind == Type.VECTOR:
            children = children[:1]
        if cursor.kind in (Kind.BINARY_OPERATOR, Kind.COMPOUND_ASSIGNMENT_OPERATOR) and len(children) == 2:
            self.binary(cursor, *children)
        elif cursor.kind == Kind.UNARY_OPERATOR:
            self.unary(cursor)
        elif cursor.kind in (Kind.INTEGER_LITERAL, Kind.FLOATING_LITERAL):
            self.constant(cursor)
        elif cursor.kind == Kind.CALL_EXPR and cursor.spelling in ("min", "max"):
            self.least(cursor)
        if cursor.kind == Kind.COMPOUND_STMT:
            for child in children:
                if child.kind == Kind.CALL_EXPR and child.type.kind == Type.VOID and child.spelling not in OF_ROOM:
                    self.add(child, "call", "")
        for child in children:
            self.runs(child)

    def binary(self, cursor: cindex.Cursor, left: cindex.Cursor, right: cindex.Cursor) -> None:
        (begin, _), (_, end) = self.of(cursor), self.of(cursor)
        between = self.slice(self.of(left)[1], self.of(right)[0])
        operator = re.sub(r"//[^\n]*|/\*.*?\*/", "", between, flags=re.S).strip()
        if operator not in OPERATORS or self.of(left)[0] != begin or self.of(right)[1] != end:
            return
        if not (is_number(left.type) and is_number(right.type)):
            return
        instead = OPERATORS[operator]
        if FLOAT & {left.type.get_canonical().kind, right.type.get_canonical().kind}:
            instead = OF_FLOATS.get(operator, instead)
        wrong = self.slice(begin, self.of(left)[1]) + f" {instead} " + self.slice(self.of(right)[0], end)
        self.add(cursor, "comparison" if operator in COMPARISONS else "sign", wrong)

    def unary(self, cursor: cindex.Cursor) -> None:
        text = self.slice(*self.of(cursor))
        if text[:1] in ("-", "!") and text[:2] not in ("--", "!!") and is_number(cursor.type):
            self.add(cursor, "sign", f"static_cast<bool>({text[1:]})" if text.startswith("!") else text[1:])

    def constant(self, cursor: cindex.Cursor) -> None:
        text = self.slice(*self.of(cursor))
        if not re.fullmatch(r"[0-9][0-9a-fA-Fx.'eE+-]*[uUlLfFzZ]*", text):
            return
        zero = re.fullmatch(r"0+\.?0*[uUlLfFzZ]*", text)
        if cursor.kind == Kind.FLOATING_LITERAL:
            factor = "1.25F" if text[-1] in "fF" else "1.25"
            self.add(cursor, "constant", f"{text} + 1" if zero else f"{text} * {factor}")
        else:
            self.add(cursor, "constant", f"{text} + 1")

    def least(self, cursor: cindex.Cursor) -> None:
        text = self.slice(*self.of(cursor))
        if text.startswith(("std::min(", "std::max(", "std::min<", "std::max<")):
            self.add(cursor, "comparison", ("std::max" if text[5:8] == "min" else "std::min") + text[8:])
