"""Elements and fields: how they are read and written, in one line and in lanes."""

from __future__ import annotations

import ast

from sim_plant.codegen.kinds import (
    INT,
    ArrayOf,
    Record,
    RecordArray,
    Scalar,
    Struct,
    Value,
    c_type,
    in_scalars,
)
from sim_plant.codegen.scope import Scope, as_kind, chosen

EACH_INT = Scalar("int", True)


def _differs(value: Value) -> bool:
    return in_scalars(value.kind).lanes


def _number(scope: Scope, at: Value) -> Value:
    """Return an index; where it differs by lane, the lanes at rest get 0: a place that is."""
    if not _differs(at):
        return as_kind(at, INT)
    if scope.mask is None:
        return as_kind(at, EACH_INT)
    mask = Value(scope.mask, Scalar("bool", True))
    return chosen(mask, at, Value("INT64_C(0)", INT), EACH_INT)


def element(scope: Scope, base: Value, places: list[Value], node: ast.AST) -> Value:
    """Return an element, a row or a record of an array."""
    at = [_number(scope, place) for place in places]
    kind = base.kind
    if isinstance(kind, RecordArray):
        return _record(base, kind, at[0])
    if not isinstance(kind, ArrayOf):
        raise scope.error("only arrays have elements", node)
    if kind.axes == 2 and len(at) == 1:
        return _row(scope, base, kind, at[0], node)
    if len(at) != kind.axes:
        raise scope.error(f"an array of {kind.axes} axes has {len(at)} indices", node)
    where = at[0].code if len(at) == 1 else f"{at[0].code} * {base.code}.cols + {at[1].code}"
    found = Scalar(kind.base, kind.lanes)
    if not (kind.scattered or any(_differs(place) for place in at)):
        return Value(f"{base.code}.at[{where}]", found)
    if not kind.lanes:
        raise scope.error("the lanes share this array: one place of it at a time", node)
    if kind.scattered:
        where = f"{base.code}.row + {where}"
    return Value(f"gather_{kind.base}s({base.code}.at, {where})", found)


def _record(base: Value, kind: RecordArray, at: Value) -> Value:
    if _differs(at):
        code = f"(({kind.record}_each){{{base.code}.at, {at.code}}})"
        return Value(code, Record(kind.record, scattered=True))
    return Value(f"(&{base.code}.at[{at.code}])", Record(kind.record))


def _row(scope: Scope, base: Value, kind: ArrayOf, at: Value, node: ast.AST) -> Value:
    array, scattered = base.code, _differs(at)
    if scattered and not kind.lanes:
        raise scope.error("the lanes share this array: one row of it at a time", node)
    row = ArrayOf(kind.base, 1, kind.lanes, scattered)
    first = f"{at.code} * {array}.cols"
    start = f"{array}.at, {first}" if scattered else f"{array}.at + {first}"
    return Value(f"(({c_type(row)}){{{start}, {array}.cols}})", row)


def member(scope: Scope, base: Value, name: str, node: ast.AST) -> Value:
    """Return a field of a record or of a named tuple, or the size of an array."""
    kind, target = base.kind, scope.program.target
    if isinstance(kind, Struct):
        return Value(f"{base.code}->{name}", target.struct_field(kind.name, name))
    if isinstance(kind, ArrayOf | RecordArray) and name == "size":
        if isinstance(kind, ArrayOf) and kind.axes != 1:
            raise scope.error("the size of an array of two axes is not used", node)
        return Value(f"{base.code}.n", INT)
    if not isinstance(kind, Record):
        raise scope.error(f"no rule for .{name}", node)
    found = target.record_field(kind.record, name)
    if not kind.scattered:
        first = "[0]" if target.lanes and not found.lanes else ""
        return Value(f"{base.code}->{name}{first}", found)
    if not found.lanes:
        raise scope.error(f"{name} is the lanes' own: they share the record", node)
    return Value(f"gather_{found.base}s({_scattered(base, kind, name)})", found)


def _scattered(base: Value, kind: Record, name: str) -> str:
    width = f"(int64_t)(sizeof({kind.record}) / sizeof(floats))"
    return f"&{base.code}.at->{name}, {base.code}.index * {width}"


def store(scope: Scope, base: Value, place: Value, value: Value, node: ast.AST) -> None:
    """Write a value to the place (an element or a field of ``base``), in the lanes at work."""
    kind = in_scalars(place.kind)
    if (scope.mask is not None or _differs(value)) and not kind.lanes:
        raise scope.error("the lanes share this place and would write it each", node)
    new = as_kind(value, kind)
    if place.code.startswith("gather_"):
        where = place.code.split("(", 1)[1].removesuffix(")")
        everyone = "each_bool(true)" if scope.mask is None else scope.mask
        scope.write(f"scatter_{kind.base}s({everyone}, {where}, {new.code});")
        return
    if scope.mask is not None:
        new = chosen(Value(scope.mask, Scalar("bool", True)), new, place, kind)
    scope.write(f"{place.code} = {new.code};")
