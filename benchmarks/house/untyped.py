"""Dicts of anything: ``dict[str, Any]`` and its like, counted at every use of every name for one.

A name counts wherever it is read: assigned in the module, taken from another one by ``import`` or
as ``module.Name``, and given to what holds such a dict, as in ``list[dict[str, Any]]``. Names are
followed to where they were made, so it does not matter what they are called.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum, auto

from benchmarks.house.statements import imports_of

Trees = Mapping[str, ast.Module]


class Kind(Enum):
    """What a name stands for."""

    ANYTHING = auto()
    MAPPING = auto()
    UNTYPED = auto()


_PLAIN = {
    **dict.fromkeys(("Any", "object"), Kind.ANYTHING),
    **dict.fromkeys(
        ("dict", "Dict", "Mapping", "MutableMapping", "defaultdict", "OrderedDict"), Kind.MAPPING
    ),
}
Known = dict[str, dict[str, Kind]]
Imports = Sequence[ast.Import | ast.ImportFrom]
Given = Sequence[tuple[str, ast.expr]]


def untyped(trees: Trees, known: Known | None = None) -> dict[str, int]:
    """Return how often each module says a dict of anything; modules by dotted name."""
    names = known_names(trees) if known is None else known
    return {name: sum(_uses(tree, names[name])) for name, tree in trees.items()}


def other_names(known: Known) -> dict[str, set[str]]:
    """Return the names that each module has for a dict of anything."""
    return {
        module: {name for name, of in names.items() if of is Kind.UNTYPED}
        for module, names in known.items()
    }


def known_names(trees: Trees) -> Known:
    """Return what every module calls such things, followed through imports to no more news."""
    known: Known = {name: {} for name in trees}
    made = [(name, imports_of(tree), list(_given(tree))) for name, tree in trees.items()]
    size = -1
    while size < (size := sum(map(len, known.values()))):
        for name, imports, given in made:
            _learn(known[name], imports, given, known)
    return known


def _given(tree: ast.Module) -> Iterator[tuple[str, ast.expr]]:
    """Yield each name that a module gives to something, with what it is."""
    for node in tree.body:
        if isinstance(node, ast.Assign):
            yield from ((one.id, node.value) for one in node.targets if isinstance(one, ast.Name))
        if isinstance(node, ast.AnnAssign) and node.value and isinstance(node.target, ast.Name):
            yield node.target.id, node.value


def _learn(own: dict[str, Kind], imports: Imports, given: Given, known: Known) -> None:
    """Take up what a module calls such things."""
    for node in imports:
        if isinstance(node, ast.Import):
            for one in node.names:
                _take_all(one.asname or one.name, known.get(one.name, {}), own)
        else:
            for one in node.names:
                name, module = one.asname or one.name, node.module or ""
                plain = _PLAIN if module in ("typing", "collections", "collections.abc") else {}
                kind = known.get(module, {}).get(one.name, plain.get(one.name))
                if kind is not None:
                    own[name] = kind
                _take_all(name, known.get(f"{module}.{one.name}", {}), own)
    for target, value in given:
        kind = _kind(value, own)
        if kind is not None:
            own.setdefault(target, kind)


def _take_all(name: str, inside: Mapping[str, Kind], own: dict[str, Kind]) -> None:
    """Take up a module's names as ``name.word``."""
    for word, kind in tuple(inside.items()):
        own[f"{name}.{word}"] = kind


def _kind(node: ast.expr, own: Mapping[str, Kind]) -> Kind | None:
    """Return what an expression is, as the right side of a name's making."""
    if isinstance(node, ast.Name | ast.Attribute):
        return _named(node, own)
    if not isinstance(node, ast.Subscript | ast.BinOp):
        return None  # a value, such as a table
    return Kind.UNTYPED if any(_uses(node, own)) else None


def _named(node: ast.AST, own: Mapping[str, Kind]) -> Kind | None:
    if isinstance(node, ast.Name):
        return own.get(node.id, _PLAIN.get(node.id))
    if isinstance(node, ast.Attribute):
        dotted = _dotted(node)
        return own.get(dotted, _PLAIN.get(node.attr) if dotted.startswith("typing.") else None)
    return None


def _dotted(node: ast.expr) -> str:
    """Return ``a.b.c`` of a chain of names, and nothing of what is none."""
    if isinstance(node, ast.Name):
        return node.id
    before = _dotted(node.value) if isinstance(node, ast.Attribute) else ""
    return f"{before}.{node.attr}" if before and isinstance(node, ast.Attribute) else ""


def _uses(tree: ast.AST, own: Mapping[str, Kind]) -> Iterator[bool]:
    """Yield True for every use in a tree."""
    untyped_words = {name.rpartition(".")[2] for name, of in own.items() if of is Kind.UNTYPED}
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript):
            yield _is_untyped(node, own)
        elif isinstance(node, ast.Name):
            is_read = isinstance(node.ctx, ast.Load)
            yield is_read and own.get(node.id) is Kind.UNTYPED
        elif isinstance(node, ast.Attribute) and node.attr in untyped_words:
            yield own.get(_dotted(node)) is Kind.UNTYPED


def _is_untyped(node: ast.Subscript, own: Mapping[str, Kind]) -> bool:
    """Return whether it is a mapping with anything in a place of its own."""
    if _named(node.value, own) is not Kind.MAPPING or not isinstance(node.slice, ast.Tuple):
        return False
    return any(_named(part, own) is Kind.ANYTHING for part in node.slice.elts)
