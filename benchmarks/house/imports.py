"""Who imports whom, read from the sources without running them."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from benchmarks.house.statements import imports_of

Arrows = frozenset[tuple[str, str]]


def module_names(root: Path, packages: Sequence[str]) -> dict[str, Path]:
    """Return every module below ``root`` by its dotted name; a package is its ``__init__``."""
    found = {}
    for package in packages:
        for path in sorted((root / package).rglob("*.py")):
            parts = path.relative_to(root).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imported(name: str, tree: ast.Module, known: Mapping[str, Path]) -> Iterator[str]:
    """Yield the known modules that a module imports, wherever in it."""
    package = name if known[name].name == "__init__.py" else name.rpartition(".")[0]
    for node in imports_of(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield from _nearest(alias.name, known)
        else:
            base = node.module or ""
            if node.level:
                up = package.split(".")[: len(package.split(".")) + 1 - node.level]
                base = ".".join([*up, base] if base else up)
            for alias in node.names:
                whole = f"{base}.{alias.name}"
                yield from _nearest(whole if whole in known else base, known)


def _nearest(name: str, known: Mapping[str, Path]) -> Iterator[str]:
    """Yield the longest beginning of a dotted name that is a known module."""
    while name and name not in known:
        name = name.rpartition(".")[0]
    if name:
        yield name


def arrows_between(rooms: Sequence[str], imports: Mapping[str, set[str]]) -> Arrows:
    """Return the pairs (importer, imported) among rooms, each pair once.

    Parameters
    ----------
    rooms : dotted names of modules or packages, none inside another.
    imports : what every module imports.
    """
    room_of = {}
    for module in imports:
        name = module
        while name and name not in rooms:
            name = name.rpartition(".")[0]
        if name:
            room_of[module] = name
    pairs = (
        (room_of[a], room_of[b])
        for a, targets in imports.items()
        if a in room_of
        for b in targets
        if b in room_of
    )
    return frozenset((a, b) for a, b in pairs if a != b)


def circles(rooms: Sequence[str], arrows: Arrows) -> list[frozenset[str]]:
    """Return the groups of rooms that import each other, directly or by others."""
    reach = {room: _reached(room, arrows) for room in rooms}
    groups = {frozenset(b for b in reach[a] if a in reach[b]) | {a} for a in rooms}
    return sorted((g for g in groups if len(g) > 1), key=sorted)


def _reached(room: str, arrows: Arrows) -> set[str]:
    found: set[str] = set()
    ahead = [room]
    while ahead:
        here = ahead.pop()
        new = {b for a, b in arrows if a == here} - found
        found |= new
        ahead += new
    return found


def floors(rooms: Sequence[str], arrows: Arrows) -> int:
    """Return how many floors the rooms stand on; rooms of a circle share one."""
    group_of = {room: frozenset({room}) for room in rooms}
    for group in circles(rooms, arrows):
        group_of.update(dict.fromkeys(group, group))
    below: dict[frozenset[str], set[frozenset[str]]] = {g: set() for g in group_of.values()}
    for a, b in arrows:
        if group_of[a] != group_of[b]:
            below[group_of[a]].add(group_of[b])
    height: dict[frozenset[str], int] = {}

    def of(group: frozenset[str]) -> int:
        if group not in height:
            height[group] = 1 + max((of(g) for g in below[group]), default=0)
        return height[group]

    return max((of(group) for group in below), default=0)
