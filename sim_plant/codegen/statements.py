"""Statements of the kernel in C; conditions that differ by lane become masks."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Any

from sim_plant.codegen.expressions import combined, evaluate
from sim_plant.codegen.kinds import (
    INT,
    Group,
    Kind,
    Nothing,
    Scalar,
    Value,
    c_type,
    in_scalars,
    per_lane,
)
from sim_plant.codegen.places import store
from sim_plant.codegen.scope import Scope, as_kind, c_name, chosen

TRUTHS = Scalar("bool", True)


def write_block(scope: Scope, statements: Sequence[ast.stmt]) -> None:
    """Write statements; what follows a partial exit runs in the lanes that stayed."""
    before = scope.mask
    for number, statement in enumerate(statements):
        _RULES.get(type(statement), _unknown)(scope, statement)
        rest = statements[number + 1 :]
        if rest and isinstance(statement, ast.If | ast.For) and _leaves_some(scope, statement):
            scope.mask = _still_at_work(scope, before)
            scope.open(f"if (any({scope.mask}))")
            write_block(scope, rest)
            scope.close()
            break
    scope.mask = before


def _unknown(scope: Scope, node: ast.stmt) -> None:
    raise scope.error(f"no rule for {ast.unparse(node).splitlines()[0]!r}", node)


def _leaves_some(scope: Scope, statement: ast.stmt) -> bool:
    """Return whether lanes may have left this block, not all together, in a statement."""
    inside = list(ast.walk(statement))
    returns = any(isinstance(node, ast.Return) for node in inside)
    if returns and scope.learned.partly_returned:
        return True
    if not scope.loops or scope.loops[-1].lineno not in scope.learned.partly_left:
        return False
    return isinstance(statement, ast.If) and any(
        isinstance(node, ast.Break | ast.Continue) for node in inside
    )


def _still_at_work(scope: Scope, before: str | None) -> str:
    gone = ["returned_"] if scope.learned.partly_returned else []
    if scope.loops and scope.loops[-1].lineno in scope.learned.partly_left:
        gone += [f"broken{scope.loops[-1].lineno}_", f"skipped{scope.loops[-1].lineno}_"]
    parts = ([] if before is None else [before]) + [f"~{name}" for name in gone]
    name = scope.fresh("on")
    scope.write(f"const integers {name} = {' & '.join(parts)};")
    return name


def _expression(scope: Scope, node: ast.Expr) -> None:
    if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
        return
    scope.write(f"{evaluate(scope, node.value).code};")


def _assign(scope: Scope, node: ast.Assign) -> None:
    if len(node.targets) == 1 and isinstance(node.targets[0], ast.Tuple):
        _assign_several(scope, node.targets[0].elts, node)
        return
    value = evaluate(scope, node.value)
    if len(node.targets) > 1:
        value = scope.temporary(value)
    for place in node.targets:
        _put(scope, place, value)


def _assign_several(scope: Scope, places: list[ast.expr], node: ast.Assign) -> None:
    if isinstance(node.value, ast.Tuple):
        values = [scope.temporary(evaluate(scope, part)) for part in node.value.elts]
    else:
        group = evaluate(scope, node.value)
        if not isinstance(group.kind, Group):
            raise scope.error("several values wanted", node)
        values = parts_of(group, group.kind)
    for place, value in zip(places, values, strict=True):
        if not (isinstance(place, ast.Name) and place.id.startswith("_")):  # for nobody
            _put(scope, place, value)


def parts_of(value: Value, kind: Group) -> list[Value]:
    """Return the members of a group."""
    return [Value(f"{value.code}.part{i}", part) for i, part in enumerate(kind.parts)]


def _put(scope: Scope, place: ast.expr, value: Value) -> None:
    if isinstance(place, ast.Name):
        _put_name(scope, place.id, value)
    elif isinstance(place, ast.Subscript | ast.Attribute):
        store(scope, evaluate(scope, place.value), evaluate(scope, place), value, place)
    else:
        raise scope.error("no rule for this place", place)


def _put_name(scope: Scope, name: str, value: Value) -> None:
    kind = per_lane(value.kind) if scope.mask is not None else value.kind
    kind = scope.learn_local(name, kind)
    new = as_kind(value, kind)
    if scope.mask is not None and isinstance(kind, Scalar) and not _written_once(scope, name):
        new = chosen(Value(scope.mask, TRUTHS), new, Value(c_name(name), kind), kind)
    scope.write(f"{c_name(name)} = {new.code};")


def _written_once(scope: Scope, name: str) -> bool:
    """Return whether a name has one assignment, outside loops: no lane has an older value."""
    if scope.loops or name in scope.parameters:
        return False
    places = [
        node
        for node in ast.walk(scope.source.tree)
        if isinstance(node, ast.Name) and node.id == name and isinstance(node.ctx, ast.Store)
    ]
    return len(places) == 1


def _augment(scope: Scope, node: ast.AugAssign) -> None:
    load = ast.copy_location(_as_load(node.target), node.target)
    value = combined(scope, node.op, evaluate(scope, load), evaluate(scope, node.value), node)
    _put(scope, node.target, value)


def _as_load(place: ast.expr) -> ast.expr:
    made = ast.parse(ast.unparse(place), mode="eval").body
    assert isinstance(made, ast.expr)
    return made


def _if(scope: Scope, node: ast.If) -> None:
    test = evaluate(scope, node.test)
    if not in_scalars(test.kind).lanes:
        scope.open(f"if ({test.code})")
        write_block(scope, node.body)
        if node.orelse:
            scope.depth -= 1
            scope.open("} else")
            write_block(scope, node.orelse)
        scope.close()
        return
    test = scope.temporary(Value(as_kind(test, TRUTHS).code, TRUTHS))
    _masked(scope, test.code, node.body)
    if node.orelse:
        _masked(scope, f"~{test.code}", node.orelse)


def _masked(scope: Scope, condition: str, body: list[ast.stmt]) -> None:
    before = scope.mask
    name = scope.fresh("on")
    scope.write(
        f"const integers {name} = {condition if before is None else f'{before} & {condition}'};"
    )
    scope.open(f"if (any({name}))")
    scope.mask = name
    write_block(scope, body)
    scope.mask = before
    scope.close()


def _for(scope: Scope, node: ast.For) -> None:
    given = node.iter
    if not (
        isinstance(given, ast.Call)
        and isinstance(given.func, ast.Name)
        and given.func.id == "range"
        and len(given.args) == 1
        and isinstance(node.target, ast.Name)
        and not node.orelse
    ):
        raise scope.error("loops run over range(count)", node)
    stop = scope.temporary(as_kind(evaluate(scope, given.args[0]), INT)).code
    name = scope.fresh("n") if node.target.id == "_" else node.target.id
    scope.learned.locals.setdefault(name, INT)
    before, partly = scope.mask, node.lineno in scope.learned.partly_left
    if partly:
        scope.write(f"integers broken{node.lineno}_ = each_bool(false);")
    scope.open(f"for (int64_t {name} = 0; {name} < {stop}; {name}++)")
    scope.loops.append(node)
    if partly:
        scope.write(f"integers skipped{node.lineno}_ = each_bool(false);")
        scope.mask = _still_at_work(scope, before)
        scope.write(f"if (!any({scope.mask})) break;")
    write_block(scope, node.body)
    scope.loops.pop()
    scope.close()
    scope.mask = before


def _leave(scope: Scope, node: ast.stmt) -> None:
    word = "break" if isinstance(node, ast.Break) else "continue"
    loop = scope.loops[-1].lineno
    if scope.mask is None:
        scope.write(f"{word};")
        return
    scope.learned.partly_left.add(loop)
    stem = "broken" if word == "break" else "skipped"
    scope.write(f"{stem}{loop}_ |= {scope.mask};")


def _return(scope: Scope, node: ast.Return) -> None:
    value = _returned(scope, node)
    kind: Kind = value.kind
    if scope.mask is not None:
        scope.learned.partly_returned = True
        kind = per_lane(kind)
    scope.learn_return(kind)
    whole = scope.learned.returns or kind
    if scope.mask is not None:
        for part, new in _returned_parts(value, whole):
            chosen_part = chosen(Value(scope.mask, TRUTHS), new, part, part.kind)
            scope.write(f"{part.code} = {chosen_part.code};")
        scope.write(f"returned_ |= {scope.mask};")
    elif isinstance(whole, Nothing):
        scope.write("return;")
    else:
        finish(scope, value, whole)


def _returned(scope: Scope, node: ast.Return) -> Value:
    if node.value is None:
        return Value("", Nothing())
    if not isinstance(node.value, ast.Tuple):
        return evaluate(scope, node.value)
    values = [evaluate(scope, part) for part in node.value.elts]
    kind = Group(tuple(in_scalars(value.kind) for value in values))
    whole = scope.learned.returns
    wanted = whole.parts if isinstance(whole, Group) else kind.parts
    codes = [as_kind(v, k).code for v, k in zip(values, _widest(wanted, kind.parts), strict=True)]
    kind = Group(_widest(wanted, kind.parts))
    scope.program.group(kind)
    return scope.temporary(Value(f"({c_type(kind)}){{{', '.join(codes)}}}", kind))


def _widest(known: tuple[Scalar, ...], here: tuple[Scalar, ...]) -> tuple[Scalar, ...]:
    return tuple(
        Scalar(max((a.base, b.base), key=("bool", "int", "float").index), a.lanes or b.lanes)
        for a, b in zip(known, here, strict=True)
    )


def _returned_parts(value: Value, whole: Kind) -> list[tuple[Value, Value]]:
    """Return place and value of each member of what is returned."""
    if isinstance(whole, Nothing):
        return []
    if isinstance(whole, Group):
        assert isinstance(value.kind, Group)
        places = parts_of(Value("result_", whole), whole)
        return list(zip(places, parts_of(value, value.kind), strict=True))
    return [(Value("result_", whole), value)]


def finish(scope: Scope, value: Value, whole: Kind) -> None:
    """Return from the function in all lanes that are left."""
    if scope.learned.partly_returned:
        for part, new in _returned_parts(value, whole):
            code = chosen(Value("returned_", TRUTHS), part, new, part.kind).code
            scope.write(f"{part.code} = {code};")
        scope.write("return result_;")
        return
    scope.write(f"return {as_kind(value, whole).code};")


def _pass(scope: Scope, node: ast.Pass) -> None:
    del scope, node


_RULES: dict[type[ast.stmt], Callable[[Scope, Any], None]] = {
    ast.Expr: _expression,
    ast.Assign: _assign,
    ast.AugAssign: _augment,
    ast.If: _if,
    ast.For: _for,
    ast.Break: _leave,
    ast.Continue: _leave,
    ast.Return: _return,
    ast.Pass: _pass,
}
