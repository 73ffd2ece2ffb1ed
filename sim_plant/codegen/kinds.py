"""What a value of the kernel is, and whether it differs from lane to lane."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeVar

Base = Literal["float", "int", "bool"]
_RANK: dict[str, int] = {"bool": 0, "int": 1, "float": 2}


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number or a truth value; ``lanes``: one for each lane."""

    base: Base
    lanes: bool = False


@dataclass(frozen=True, slots=True)
class ArrayOf:
    """An array of one or two axes; ``scattered``: its row differs from lane to lane."""

    base: Base
    axes: int
    lanes: bool = False
    scattered: bool = False


@dataclass(frozen=True, slots=True)
class RecordArray:
    """A one-dimensional array of records."""

    record: str


@dataclass(frozen=True, slots=True)
class Record:
    """One record of an array; ``scattered``: another one in each lane."""

    record: str
    scattered: bool = False


@dataclass(frozen=True, slots=True)
class Struct:
    """A named tuple, handed over as a pointer."""

    name: str


@dataclass(frozen=True, slots=True)
class Group:
    """Several values that a function returns together."""

    parts: tuple[Scalar, ...]


@dataclass(frozen=True, slots=True)
class Nothing:
    """What a function without a result returns."""


Kind = Scalar | ArrayOf | RecordArray | Record | Struct | Group | Nothing
FLOAT, INT, BOOL = Scalar("float"), Scalar("int"), Scalar("bool")


@dataclass(frozen=True, slots=True)
class Value:
    """A C expression and what it is."""

    code: str
    kind: Kind


AnyKind = TypeVar("AnyKind", bound=Kind)


class TranslationError(Exception):
    """The kernel holds what the generator does not know; the message says where and what."""


def joined(one: Kind, other: Kind) -> Kind:
    """Return the kind that holds both.

    Raises
    ------
    TranslationError
        When none does.
    """
    if one == other:
        return one
    if isinstance(one, Scalar) and isinstance(other, Scalar):
        base = max(one.base, other.base, key=lambda name: _RANK[name])
        return Scalar(base, one.lanes or other.lanes)
    if isinstance(one, Group) and isinstance(other, Group) and len(one.parts) == len(other.parts):
        pairs = zip(one.parts, other.parts, strict=True)
        return Group(tuple(in_scalars(joined(a, b)) for a, b in pairs))
    raise TranslationError(f"no kind holds both {one} and {other}")


def in_scalars(kind: Kind) -> Scalar:
    """Return a kind that is a scalar; TranslationError for another one."""
    if not isinstance(kind, Scalar):
        raise TranslationError(f"a number wanted, found {kind}")
    return kind


def per_lane(kind: AnyKind) -> AnyKind:
    """Return the kind with one value for each lane; what is no number stays."""
    if isinstance(kind, Scalar):
        return replace(kind, lanes=True)
    if isinstance(kind, Group):
        return replace(kind, parts=tuple(per_lane(part) for part in kind.parts))
    return kind


C_SCALARS = {
    ("float", False): "double",
    ("int", False): "int64_t",
    ("bool", False): "bool",
    ("float", True): "floats",
    ("int", True): "integers",
    ("bool", True): "integers",
}


def stem(kind: ArrayOf) -> str:
    """Return how the C types of an array begin."""
    return f"{kind.base}_lanes" if kind.lanes else kind.base


def c_type(kind: Kind) -> str:
    """Return the C type of a kind."""
    match kind:
        case Scalar():
            found = C_SCALARS[kind.base, kind.lanes]
        case ArrayOf():
            found = f"{stem(kind)}_{'row' if kind.scattered else kind.axes}"
        case RecordArray():
            found = f"{kind.record}_array"
        case Record():
            found = f"{kind.record}_each" if kind.scattered else f"{kind.record} *"
        case Struct():
            found = f"const {kind.name} *"
        case Group():
            letters = (p.base[0].upper() if p.lanes else p.base[0] for p in kind.parts)
            found = f"group_{''.join(letters)}"
        case Nothing():
            found = "void"
    return found
