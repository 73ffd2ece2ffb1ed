"""Expressions of the kernel in C."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from types import ModuleType
from typing import Any

from sim_plant.codegen.calls import call
from sim_plant.codegen.kinds import (
    BOOL,
    FLOAT,
    INT,
    ArrayOf,
    Scalar,
    Value,
    c_type,
    in_scalars,
    joined,
)
from sim_plant.codegen.places import element, member
from sim_plant.codegen.scope import Scope, as_kind, c_name, chosen, in_floats, number_kind

_SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
_COMPARISONS = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}


def literal(value: float | bool) -> Value:
    """Return a constant; floats to the last bit."""
    if isinstance(value, bool):
        return Value("true" if value else "false", BOOL)
    if isinstance(value, int):
        return Value(f"INT64_C({value})", INT)
    if math.isinf(value):
        return Value("INFINITY" if value > 0.0 else "(-INFINITY)", FLOAT)
    return Value(repr(value), FLOAT)


def evaluate(scope: Scope, node: ast.expr) -> Value:
    """Return an expression in C.

    Raises
    ------
    TranslationError
        For what the kernel's language does not have.
    """
    rule = _RULES.get(type(node))
    if rule is None:
        raise scope.error(f"no rule for {ast.unparse(node)!r}", node)
    return rule(scope, node)


def _constant(scope: Scope, node: ast.Constant) -> Value:
    if not isinstance(node.value, int | float):
        raise scope.error(f"a number wanted, found {node.value!r}", node)
    return literal(node.value)


def _name(scope: Scope, node: ast.Name) -> Value:
    kind = scope.kind_of(node.id)
    if kind is not None:
        return Value(c_name(node.id), kind)
    meaning = scope.source.meaning(node.id)
    if isinstance(meaning, int | float):
        return literal(meaning)
    raise scope.error(f"{node.id} is no number that the kernel knows", node)


def _attribute(scope: Scope, node: ast.Attribute) -> Value:
    if isinstance(node.value, ast.Name) and scope.kind_of(node.value.id) is None:
        module = scope.source.meaning(node.value.id)
        if isinstance(module, ModuleType):
            return literal(float(getattr(module, node.attr)))
    return member(scope, evaluate(scope, node.value), node.attr, node)


def _subscript(scope: Scope, node: ast.Subscript) -> Value:
    if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
        return _length(scope, evaluate(scope, node.value.value), node)
    base = evaluate(scope, node.value)
    if isinstance(node.slice, ast.Slice):
        return _part(scope, base, node.slice)
    places = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    return element(scope, base, [evaluate(scope, place) for place in places], node)


def _length(scope: Scope, base: Value, node: ast.Subscript) -> Value:
    if not isinstance(base.kind, ArrayOf) or not isinstance(node.slice, ast.Constant):
        raise scope.error("the shape of an array along one axis wanted", node)
    names = ("rows", "cols") if base.kind.axes == 2 else ("n",)
    return Value(f"{base.code}.{names[int(str(node.slice.value))]}", INT)


def _part(scope: Scope, base: Value, part: ast.Slice) -> Value:
    if not isinstance(base.kind, ArrayOf) or base.kind.axes != 1 or part.step is not None:
        raise scope.error("a part of an array of one axis wanted", part)
    low = literal(0) if part.lower is None else evaluate(scope, part.lower)
    high = Value(f"{base.code}.n", INT) if part.upper is None else evaluate(scope, part.upper)
    first, stop = as_kind(low, INT).code, as_kind(high, INT).code
    span = f"{base.code}.at + ({first}), ({stop}) - ({first})"
    return Value(f"(({c_type(base.kind)}){{{span}}})", base.kind)


def _binary(scope: Scope, node: ast.BinOp) -> Value:
    left, right = evaluate(scope, node.left), evaluate(scope, node.right)
    return combined(scope, node.op, left, right, node)


def combined(scope: Scope, op: ast.operator, left: Value, right: Value, node: ast.AST) -> Value:
    """Return two numbers put together, as numba does it: no sum or product is reordered."""
    if isinstance(op, ast.Pow):
        return _power(scope, left, right, node)
    kind = number_kind(left, right)
    if isinstance(op, ast.Div) or kind.base == "float":
        left, right = in_floats([left, right])
        kind = Scalar("float", kind.lanes)
    if isinstance(op, ast.Mod):
        left, right = as_kind(left, kind), as_kind(right, kind)
        ending = f"{kind.base}s" if kind.lanes else kind.base
        return Value(f"modulo_{ending}({left.code}, {right.code})", kind)
    sign = _SIGNS.get(type(op))
    if sign is None:
        raise scope.error("no rule for this operator", node)
    if sign == "/" and in_scalars(left.kind).lanes and not in_scalars(right.kind).lanes:
        return Value(f"({left.code} * (1.0 / {right.code}))", kind)  # one division for all lanes
    return Value(f"({left.code} {sign} {right.code})", kind)


def _power(scope: Scope, base: Value, exponent: Value, node: ast.AST) -> Value:
    squarings = {"INT64_C(2)": 1, "INT64_C(4)": 2}.get(exponent.code)
    if squarings is None:
        raise scope.error("powers are 2 or 4", node)
    kind, code = in_scalars(base.kind), base.code
    for _ in range(squarings):
        code = f"square{'s' if kind.lanes else ''}({code})"
    return Value(code, kind)


def _unary(scope: Scope, node: ast.UnaryOp) -> Value:
    value = evaluate(scope, node.operand)
    if isinstance(node.op, ast.USub):
        return Value(f"(-{value.code})", value.kind)
    if isinstance(node.op, ast.Not):
        truth = as_kind(value, Scalar("bool", in_scalars(value.kind).lanes))
        return Value(f"({'~' if in_scalars(truth.kind).lanes else '!'}{truth.code})", truth.kind)
    raise scope.error("no rule for this sign", node)


def _compare(scope: Scope, node: ast.Compare) -> Value:
    values = [evaluate(scope, part) for part in (node.left, *node.comparators)]
    found = [_pair(scope, op, values[i], values[i + 1], node) for i, op in enumerate(node.ops)]
    return _all_of(found, "&&", "&")


def _pair(scope: Scope, op: ast.cmpop, left: Value, right: Value, node: ast.AST) -> Value:
    sign = _COMPARISONS.get(type(op))
    if sign is None:
        raise scope.error("no rule for this comparison", node)
    kind = number_kind(left, right)
    left, right = as_kind(left, kind), as_kind(right, kind)
    code = f"({left.code} {sign} {right.code})"
    return Value(f"((integers){code})" if kind.lanes else code, Scalar("bool", kind.lanes))


def _all_of(values: list[Value], plain: str, by_lane: str) -> Value:
    lanes = any(in_scalars(value.kind).lanes for value in values)
    kind = Scalar("bool", lanes)
    codes = [as_kind(value, kind).code for value in values]
    sign = by_lane if lanes else plain
    return Value(codes[0] if len(codes) == 1 else f"({f' {sign} '.join(codes)})", kind)


def _logic(scope: Scope, node: ast.BoolOp) -> Value:
    values = [evaluate(scope, part) for part in node.values]
    plain, by_lane = ("&&", "&") if isinstance(node.op, ast.And) else ("||", "|")
    return _all_of(values, plain, by_lane)


def _choice(scope: Scope, node: ast.IfExp) -> Value:
    test = evaluate(scope, node.test)
    yes, no = evaluate(scope, node.body), evaluate(scope, node.orelse)
    kind = in_scalars(joined(yes.kind, no.kind))
    if in_scalars(test.kind).lanes:
        return chosen(test, yes, no, Scalar(kind.base, True))
    yes, no = as_kind(yes, kind), as_kind(no, kind)
    cast = f"({c_type(kind)})" if kind.lanes else ""  # a sum of vectors has another name
    return Value(f"({test.code} ? {cast}{yes.code} : {cast}{no.code})", kind)


def _call(scope: Scope, node: ast.Call) -> Value:
    if node.keywords:
        raise scope.error("arguments are given by place", node)
    return call(scope, node, [evaluate(scope, given) for given in node.args])


_RULES: dict[type[ast.expr], Callable[[Scope, Any], Value]] = {
    ast.Constant: _constant,
    ast.Name: _name,
    ast.Attribute: _attribute,
    ast.Subscript: _subscript,
    ast.BinOp: _binary,
    ast.UnaryOp: _unary,
    ast.Compare: _compare,
    ast.BoolOp: _logic,
    ast.IfExp: _choice,
    ast.Call: _call,
}
