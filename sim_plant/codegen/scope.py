"""One function under translation: its names, the lanes that are at work, the lines so far."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field

from sim_plant.codegen.kinds import (
    FLOAT,
    Group,
    Kind,
    Nothing,
    Record,
    Scalar,
    Struct,
    TranslationError,
    Value,
    c_type,
    in_scalars,
    joined,
)
from sim_plant.codegen.sources import Source
from sim_plant.codegen.translation import Translation

C_WORDS = {"true", "false", "bool", "double", "float", "int", "long", "short", "signed", "auto"}
C_WORDS |= {"register", "default", "switch", "case", "const", "static", "inline", "union", "any"}


@dataclass(eq=False)
class Learned:
    """What one pass over a function finds out and the next one starts from.

    Attributes
    ----------
    locals : kind of every local name.
    returns : what the function returns; None before the first return.
    partly_returned : some lanes return before others.
    partly_left : loops (their place in the file) that some lanes leave, or go on in, earlier.
    """

    locals: dict[str, Kind] = field(default_factory=dict)
    returns: Kind | None = None
    partly_returned: bool = False
    partly_left: set[int] = field(default_factory=set)

    def state(self) -> tuple[object, ...]:
        """Return all of it, to compare."""
        return (dict(self.locals), self.returns, self.partly_returned, frozenset(self.partly_left))


@dataclass(eq=False)
class Scope:
    """What expressions and statements of one function share.

    Attributes
    ----------
    mask : C name of the lanes at work here; None: all of them.
    loops : the loops around this place, innermost last.
    """

    program: Translation
    source: Source
    parameters: dict[str, Kind]
    learned: Learned
    mask: str | None = None
    lines: list[str] = field(default_factory=list)
    loops: list[ast.For] = field(default_factory=list)
    depth: int = 1
    made: int = 0

    def write(self, line: str) -> None:
        """Add a line of C."""
        self.lines.append("    " * self.depth + line)

    def open(self, head: str) -> None:
        """Begin a block."""
        self.write(head + " {")
        self.depth += 1

    def close(self) -> None:
        """End a block."""
        self.depth -= 1
        self.write("}")

    def fresh(self, stem: str = "t") -> str:
        """Return a C name that nothing else has."""
        self.made += 1
        return f"{stem}{self.made}_"

    def temporary(self, value: Value) -> Value:
        """Return the value by a name, computed here and once."""
        name = self.fresh()
        if isinstance(value.kind, Struct):
            self.write(f"const {value.kind.name} {name} = {value.code};")
            return Value(f"(&{name})", value.kind)
        constant = "" if isinstance(value.kind, Record) else "const "  # what it points to is not
        self.write(f"{constant}{c_type(value.kind)} {name} = {value.code};")
        return Value(name, value.kind)

    def kind_of(self, name: str) -> Kind | None:
        """Return the kind of a name of this function; None when it is none of them."""
        return self.parameters.get(name, self.learned.locals.get(name))

    def learn_local(self, name: str, kind: Kind) -> Kind:
        """Record that a local name holds this kind, and return what it holds in all."""
        before = self.kind_of(name)
        now = kind if before is None else joined(before, kind)
        if name in self.parameters:
            if now != before:
                raise self.error(f"{name} is an argument and becomes another kind of number")
        else:
            self.learned.locals[name] = now
        return now

    def learn_return(self, kind: Kind) -> None:
        """Record what is returned."""
        known = self.learned.returns
        self.learned.returns = kind if known is None else joined(known, kind)

    def error(self, what: str, node: ast.AST | None = None) -> TranslationError:
        """Return the error with its place."""
        line = getattr(node, "lineno", self.source.tree.lineno)
        return TranslationError(f"{self.source.where}:{line} ({self.source.name}): {what}")


def c_name(name: str) -> str:
    """Return a name of the kernel as C may have it."""
    return f"{name}_" if name in C_WORDS else name


def as_kind(value: Value, wanted: Kind) -> Value:
    """Return the value as a number of the wanted kind, spread over the lanes where asked.

    Raises
    ------
    TranslationError
        When a number of each lane is wanted as one.
    """
    if value.kind == wanted or not isinstance(wanted, Scalar):
        return value
    have = in_scalars(value.kind)
    if have.lanes and not wanted.lanes:
        raise TranslationError(f"{value.code} differs from lane to lane and is wanted as one")
    code = value.code
    if not have.lanes:
        if have.base != wanted.base and "bool" not in (have.base, wanted.base):
            code = f"(({'double' if wanted.base == 'float' else 'int64_t'})({code}))"
        if wanted.lanes:
            code = f"each_{wanted.base}({code})"
    elif have.base != wanted.base:
        code = f"floats_of({code})" if wanted.base == "float" else f"({code})"
    return Value(code, wanted)


def chosen(mask: Value, yes: Value, no: Value, kind: Kind) -> Value:
    """Return ``yes`` in the lanes of the mask, ``no`` in the others."""
    if isinstance(kind, Nothing | Group):
        raise TranslationError(f"no choice between {kind}")
    there, other = as_kind(yes, kind), as_kind(no, kind)
    stem = "floats" if in_scalars(kind).base == "float" else "integers"
    return Value(f"choose_{stem}({mask.code}, {there.code}, {other.code})", kind)


def number_kind(*values: Value) -> Scalar:
    """Return the kind that holds all these numbers."""
    found: Kind = values[0].kind
    for value in values[1:]:
        found = joined(found, value.kind)
    return in_scalars(found)


def in_floats(values: list[Value]) -> list[Value]:
    """Return numbers as floats, each of its own lanes."""
    return [as_kind(value, Scalar(FLOAT.base, in_scalars(value.kind).lanes)) for value in values]
