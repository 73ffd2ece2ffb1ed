"""The page of the house: before its redesign and as it is, and what a recipe costs in files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.house.rooms import SCREEN, Module, Room, rooms, whole

BEFORE = "87bebfbe"  # the sources that the redesign began from
LAID_OUT = "986cef13"  # the same ones in the formatter's own layout
MOST_UNTYPED = 40
MOST_FILES = {"an effect": 3, "a wire": 6, "a law": 5}
PROVING = {"an effect": "3742867a", "a wire": "ba9db1ea", "a law": "b5541895"}
NOTE = f"""\
Read from the sources of each revision by one script. `{BEFORE}` is what the redesign began from
([ADR 0018](../adr/0018-rooms-within-rooms.md)); `{LAID_OUT}` is the same code in the formatter's
own layout, with which numbers of lines are to be compared.

- *Rooms*, *floors*, *arrows* and *circles* are of what lies directly in a room; all other columns
  are of everything in it.
- An arrow is one room that imports another one, however often.
- *Dict of anything*: uses of `dict[str, Any]` and its like, by whatever name. Where the product's
  stand, and why, is in `tests/house/test_dicts_at_edges.py`.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Revision:
    """The modules of one revision, and what the page calls it."""

    name: str
    modules: Mapping[str, Module]


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """One commit that adds what a recipe is for.

    Attributes
    ----------
    files : what ``git show --stat`` lists.
    most : how many the recipe may take.
    """

    what: str
    commit: str
    files: tuple[str, ...]
    most: int


def page(revisions: Sequence[Revision], proofs: Sequence[Proof]) -> str:
    """Return the page; the first revision is the one before, the last one what is."""
    before, now = revisions[0], revisions[-1]
    parts = (
        f"# The house\n\nWritten by `make house EXTRA=--docs` on `{now.name}`.\n\n{NOTE}",
        f"## Packages\n\n{_packages(revisions)}",
        f"Dicts of anything in the product, all packages but `benchmarks`: "
        f"{_product(before)} before, {_product(now)} now; at most {MOST_UNTYPED} may be, "
        f"{'met' if _product(now) <= MOST_UNTYPED else 'missed'}.\n",
        f"## Rooms\n\n{_side_by_side(before, now)}",
        f"## What a recipe costs\n\nFiles of the commit that proves each of the [recipes]"
        f"(../../CONTRIBUTING.md#four-recipes), by `git show --stat`.\n\n{_proofs(proofs)}",
    )
    return "\n".join(parts)


def _product(revision: Revision) -> int:
    return sum(
        module.untyped
        for name, module in revision.modules.items()
        if name.partition(".")[0] != "benchmarks"
    )


def _rooms(revision: Revision) -> dict[str, Room]:
    found = (whole(revision.modules), *rooms(revision.modules))
    return {room.name: room for room in found}


def _packages(revisions: Sequence[Revision]) -> str:
    head = (
        *("package", "revision", "modules", "lines", "rooms", "floors", "arrows", "circles"),
        *(f"over {SCREEN} lines", "longest function", "dict of anything", "fmt: skip"),
    )
    found = [(revision.name, _rooms(revision)) for revision in revisions]
    names = sorted({n for _, there in found for n in there if "." not in n}, key=_all_first)
    rows = [
        (
            *(name, f"`{revision}`", room.modules, room.lines, room.rooms, room.floors),
            *(room.arrows, room.circles, room.long_functions, _longest(room)),
            *(room.untyped, room.skips),
        )
        for name in names
        for revision, there in found
        if (room := there.get(name))
    ]
    return _table(head, rows)


def _all_first(name: str) -> tuple[bool, str]:
    return name != "all", name


def _side_by_side(before: Revision, now: Revision) -> str:
    """Return the rooms within packages, both revisions in a row."""
    head = ["room"]
    for what in ("modules", "rooms", "floors", "arrows", "longest function", "dict of anything"):
        head += [f"{what} before", "now"]
    old, new = _rooms(before), _rooms(now)
    rows = []
    for name in sorted(name for name in old.keys() | new.keys() if "." in name):
        pairs = zip(_figures(old.get(name)), _figures(new.get(name)), strict=True)
        rows.append((name, *(figure for pair in pairs for figure in pair)))
    return _table(head, rows)


def _figures(room: Room | None) -> tuple[object, ...]:
    if room is None:
        return ("",) * 6
    return (room.modules, room.rooms, room.floors, room.arrows, _longest(room), room.untyped)


def _longest(room: Room) -> str:
    function, length = room.longest
    return f"`{function}` {length}" if length else ""


def _proofs(proofs: Sequence[Proof]) -> str:
    head = ("what", "commit", "files", "at most", "", "which")
    return _table(
        head,
        [
            (
                *(proof.what, f"`{proof.commit}`", len(proof.files), proof.most),
                "met" if len(proof.files) <= proof.most else "missed",
                ", ".join(f"`{name}`" for name in proof.files),
            )
            for proof in proofs
        ],
    )


def _table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    lines = (head, ["---"] * len(head), *rows)
    return "".join(f"| {' | '.join(str(cell) for cell in line)} |\n" for line in lines)
