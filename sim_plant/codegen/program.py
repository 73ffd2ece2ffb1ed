"""A whole translation: every function that the entries reach, once for each kind of arguments."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from sim_plant.codegen.kinds import Group, Kind, Nothing, Scalar, c_type, per_lane
from sim_plant.codegen.scope import Learned, Scope, c_name
from sim_plant.codegen.sources import Source, is_compiled, source_of
from sim_plant.codegen.statements import write_block
from sim_plant.codegen.target import RECORDS, STRUCTS, EntryPoint, Target
from sim_plant.codegen.translation import Function
from sim_plant.line.equations import kernel

PASSES = 12
"""Kinds settle in two or three passes over a function."""


class Program:
    """Translates functions on demand and keeps them in the order in which C wants them."""

    def __init__(self, target: Target) -> None:
        self.target = target
        self.structs: Mapping[str, type] = STRUCTS
        self.records = RECORDS
        self.functions: list[Function] = []
        self.groups: dict[str, Group] = {}
        self._made: dict[tuple[str, tuple[Kind, ...], bool], Function] = {}
        self._names: dict[str, int] = {}
        self._writes: dict[str, bool] = {}

    def entry(self, entry: EntryPoint) -> Function:
        """Translate an entry with all that it calls."""
        kinds = self.target.arguments(entry)
        return self.function(source_of(getattr(kernel, entry.name)), tuple(kinds.values()), False)

    def group(self, group: Group) -> None:
        """Have the C type of a group declared."""
        self.groups[c_type(group)] = group

    def writes(self, source: Source) -> bool:
        """Return whether a function, or one that it calls, writes to memory of its caller."""
        name = f"{source.where}.{source.name}"
        if name not in self._writes:
            self._writes[name] = any(_stores(node) for node in ast.walk(source.tree)) or any(
                self.writes(called) for called in _called(source)
            )
        return self._writes[name]

    def function(self, source: Source, kinds: tuple[Kind, ...], masked: bool) -> Function:
        """Return a function for these arguments; ``masked``: for some of the lanes."""
        key = (f"{source.where}.{source.name}", kinds, masked)
        if key not in self._made:
            self._made[key] = self._translated(source, kinds, masked)
            self.functions.append(self._made[key])
        return self._made[key]

    def _translated(self, source: Source, kinds: tuple[Kind, ...], masked: bool) -> Function:
        learned = Learned()
        parameters = dict(zip(source.parameters, kinds, strict=True))
        for _ in range(PASSES):
            before = learned.state()
            scope = Scope(self, source, parameters, learned, "lanes_" if masked else None)
            write_block(scope, source.tree.body)
            if learned.state() == before:
                break
        else:
            raise scope.error("its kinds do not settle")
        returns = learned.returns or Nothing()
        if learned.partly_returned and not isinstance(returns, Nothing):
            learned.returns = returns = per_lane(returns)
        if isinstance(returns, Group):
            self.group(returns)
        return self._written(scope, returns, masked)

    def _written(self, scope: Scope, returns: Kind, masked: bool) -> Function:
        name = self._name(scope.source.name)
        given = [f"{c_type(kind)} {c_name(arg)}" for arg, kind in scope.parameters.items()]
        given += ["const integers lanes_"] if masked else []
        ctype = returns.name if hasattr(returns, "name") else c_type(returns)
        head = f"static inline {ctype} {name}({', '.join(given)})"
        lines = [
            f"    {c_type(kind)} {c_name(local)} = {_zero(kind)};"
            for local, kind in _locals(scope)
        ]
        if scope.learned.partly_returned:
            lines.append("    integers returned_ = each_bool(false);")
            if not isinstance(returns, Nothing):
                lines.append(f"    {ctype} result_ = {{0}};")
        lines += scope.lines
        if scope.learned.partly_returned and not isinstance(returns, Nothing):
            lines.append("    return result_;")
        return Function(c_name=name, returns=returns, text="\n".join([head + " {", *lines, "}"]))

    def _name(self, stem: str) -> str:
        self._names[stem] = self._names.get(stem, 0) + 1
        return f"k_{stem}" + ("" if self._names[stem] == 1 else str(self._names[stem]))


def _zero(kind: Kind) -> str:
    return "0" if isinstance(kind, Scalar) and not kind.lanes else "{0}"


def _locals(scope: Scope) -> list[tuple[str, Kind]]:
    """Return the names to declare: those that are assigned; a loop declares its counter."""
    loops = [node for node in ast.walk(scope.source.tree) if isinstance(node, ast.For)]
    counters = {id(node.target) for node in loops}
    assigned = {
        node.id
        for node in ast.walk(scope.source.tree)
        if isinstance(node, ast.Name)
        and isinstance(node.ctx, ast.Store)
        and id(node) not in counters
    }
    return [(name, k) for name, k in scope.learned.locals.items() if name in assigned]


def _stores(node: ast.AST) -> bool:
    return isinstance(node, ast.Subscript | ast.Attribute) and isinstance(node.ctx, ast.Store)


def _called(source: Source) -> list[Source]:
    names = [
        node.func.id
        for node in ast.walk(source.tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    ]
    meanings = [source.meaning(name) for name in names]
    return [source_of(meaning) for meaning in meanings if is_compiled(meaning)]
