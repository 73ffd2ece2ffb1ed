"""One row of figures per room."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.house.imports import arrows_between, circles, floors, imported, module_names
from benchmarks.house.untyped import untyped

PACKAGES = ("aff_runtime", "sim_plant", "aff_hmi", "benchmarks")
SCREEN = 40  # lines of a function that fits a screen
SKIP = "# fmt: " + "skip"


@dataclass(frozen=True, slots=True, kw_only=True)
class Module:
    """What one file has.

    Attributes
    ----------
    functions : name and length in lines of every function.
    untyped : how often a dict of anything stands in it, by any name.
    skips : lines that the formatter is told to leave.
    """

    lines: int
    functions: tuple[tuple[str, int], ...]
    untyped: int
    skips: int
    imports: frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """Figures of one package; ``rooms`` are what lies directly in it."""

    name: str
    modules: int
    lines: int
    rooms: int
    floors: int
    arrows: int
    circles: int
    longest: tuple[str, int]
    long_functions: int
    untyped: int
    skips: int


def read_modules(root: Path, packages: Sequence[str] = PACKAGES) -> dict[str, Module]:
    """Return what every module of a checkout has, by dotted name."""
    known = module_names(root, packages)
    texts = {name: path.read_text(encoding="utf-8") for name, path in known.items()}
    trees = {name: ast.parse(text, str(known[name])) for name, text in texts.items()}
    counts = untyped(trees)
    found = {}
    for name, text in texts.items():
        tree = trees[name]
        found[name] = Module(
            lines=len(text.splitlines()),
            functions=tuple(_functions(tree)),
            untyped=counts[name],
            skips=text.count(SKIP),
            imports=frozenset(imported(name, tree, known)),
        )
    return found


def _functions(tree: ast.AST, place: str = "") -> Iterator[tuple[str, int]]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            length = (node.end_lineno or node.lineno) - node.lineno + 1
            yield f"{place}{node.name}", length
            yield from _functions(node, f"{place}{node.name}.")
        elif isinstance(node, ast.ClassDef):
            yield from _functions(node, f"{place}{node.name}.")
        else:
            yield from _functions(node, place)


def rooms(modules: Mapping[str, Module]) -> list[Room]:
    """Return one row per package that holds more than one module, outer ones first."""
    names = {name.rpartition(".")[0] for name in modules if "." in name}
    return [_room(name, modules) for name in sorted(names)]


def whole(modules: Mapping[str, Module]) -> Room:
    """Return the row of the repository, whose rooms are the packages."""
    return _row("all", {name.partition(".")[0] for name in modules}, modules)


def _room(name: str, modules: Mapping[str, Module]) -> Room:
    inside = {n: m for n, m in modules.items() if n == name or n.startswith(f"{name}.")}
    depth = name.count(".") + 2
    return _row(name, {".".join(n.split(".")[:depth]) for n in inside if n != name}, inside)


def _row(name: str, children: set[str], modules: Mapping[str, Module]) -> Room:
    within = sorted(children)
    arrows = arrows_between(within, {n: set(m.imports) for n, m in modules.items()})
    lengths = [
        (f"{n.rpartition('.')[2]}:{function}", size)
        for n, m in modules.items()
        for function, size in m.functions
    ]
    return Room(
        name=name,
        modules=len(modules),
        lines=sum(m.lines for m in modules.values()),
        rooms=len(within),
        floors=floors(within, arrows),
        arrows=len(arrows),
        circles=len(circles(within, arrows)),
        longest=max(lengths, key=lambda one: one[1], default=("", 0)),
        long_functions=sum(size > SCREEN for _, size in lengths),
        untyped=sum(m.untyped for m in modules.values()),
        skips=sum(m.skips for m in modules.values()),
    )
