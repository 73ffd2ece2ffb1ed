"""Calls of built-ins, of mathematics and of the kernel's own functions."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import Any

from sim_plant.codegen.kinds import (
    FLOAT,
    INT,
    Group,
    Kind,
    Scalar,
    Struct,
    Value,
    c_type,
    in_scalars,
)
from sim_plant.codegen.scope import Scope, as_kind, in_floats, number_kind
from sim_plant.codegen.sources import Source, is_compiled, source_of

MATHEMATICS: dict[Callable[..., Any], str] = {
    math.sin: "sin",
    math.cos: "cos",
    math.tanh: "tanh",
    math.exp: "exp",
    math.floor: "floor",
}
"""``floor`` gives a float here: its value is one, and no number is too large for it."""


def call(scope: Scope, node: ast.Call, given: list[Value]) -> Value:
    """Return a call; one of a function that writes memory is made where it stands."""
    meaning = _meaning(scope, node.func)
    if is_compiled(meaning):
        return _own(scope, source_of(meaning), given)
    if meaning in (float, int):
        return _converted(given[0], "float" if meaning is float else "int")
    if meaning in (min, max):
        return _extreme("least" if meaning is min else "largest", given)
    if meaning is abs:
        kind = in_scalars(given[0].kind)
        return Value(f"absolute{'s' if kind.lanes else ''}({in_floats(given)[0].code})", kind)
    if meaning in MATHEMATICS:
        value = in_floats(given)[0]
        stem = "lanes" if in_scalars(value.kind).lanes else "plain"
        return Value(f"{stem}_{MATHEMATICS[meaning]}({value.code})", value.kind)
    if isinstance(meaning, type) and meaning.__name__ in scope.program.structs:
        codes = ", ".join(as_kind(value, INT).code for value in given)
        return Value(f"(({meaning.__name__}){{{codes}}})", Struct(meaning.__name__))
    raise scope.error(f"no rule for a call of {ast.unparse(node.func)}", node)


def _meaning(scope: Scope, node: ast.expr) -> Any:
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return getattr(scope.source.meaning(node.value.id), node.attr, None)
    return scope.source.meaning(node.id) if isinstance(node, ast.Name) else None


def _converted(value: Value, base: str) -> Value:
    kind = in_scalars(value.kind)
    if base == kind.base:
        return value
    if base == "float":
        return as_kind(value, Scalar("float", kind.lanes))
    if kind.lanes:
        return Value(f"integers_of({value.code})", Scalar("int", True))
    return Value(f"((int64_t)({value.code}))", INT)


def _extreme(stem: str, given: list[Value]) -> Value:
    kind = number_kind(*given)
    codes = [as_kind(value, kind).code for value in given]
    ending = f"{kind.base}s" if kind.lanes else kind.base
    return Value(f"{stem}_{ending}({', '.join(codes)})", kind)


def _own(scope: Scope, source: Source, given: list[Value]) -> Value:
    arguments = [
        _as_declared(value, source.annotation(name))
        for name, value in zip(source.parameters, given, strict=True)
    ]
    writes = scope.program.writes(source)
    masked = writes and scope.mask is not None
    made = scope.program.function(source, tuple(a.kind for a in arguments), masked)
    codes = [argument.code for argument in arguments]
    if masked:
        codes.append(str(scope.mask))
    found = Value(f"{made.c_name}({', '.join(codes)})", made.returns)
    if isinstance(made.returns, Group | Struct) or (writes and c_type(made.returns) != "void"):
        return scope.temporary(found)
    return found


def _as_declared(value: Value, annotation: str) -> Value:
    wanted: dict[str, Kind] = {"float": FLOAT, "int": INT}
    if annotation not in wanted:
        return value
    base = in_scalars(wanted[annotation]).base
    return as_kind(value, Scalar(base, in_scalars(value.kind).lanes))
