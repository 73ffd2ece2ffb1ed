"""What the rows of a run are asked to be, read from the rows themselves."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.runtime.facts import FactRow, Section

TITLE = "Targets"
NUMBER = r"([\d.]+(?:e[+-]?\d+)?)"
NOTE = (
    "Figures of the tables below. Times of the shape law are asked of a machine on which it took "
    "105 us back to back, 463 us p50 and 784 us p99 paced, before there was a binary, the line of "
    "one on which it ran at 190 times real time. Ratios are asked of any; numpy stands for the "
    "law as it was. Not here: a cycle of 1 ms held for ten minutes "
    "(`python -m benchmarks.runtime.hold`)."
)
HOT, PACED = (f"Tick of the shape law, {how}" for how in ("back to back", "paced at 5 ms"))
PLAIN, KERNEL = "Tick of the law", "Compiled line"
BARE = "Whole tick of the shape law over a bare FC23"
COLD = "what is left of a paced tick is the interpreter's and memory that is cold ([ADR 0025]"
COLD += "(../adr/0025-the-laws-arithmetic-in-c-beside-numpy.md))"
NO_BINARY = "plain blocks have no compiled path: each is stepped by Python alone"


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """One figure and its bound.

    Attributes
    ----------
    section : the title of the table, or how it begins.
    row, remark : of its row; an empty remark is any.
    word : what stands before the figure; empty: it stands first.
    at_most, at_least : the one of the two that holds it.
    unit : of the figure, as shown.
    cause : of a miss, where it is known.
    """

    what: str
    section: str
    row: str
    remark: str = ""
    word: str = ""
    at_most: float | None = None
    at_least: float | None = None
    unit: str = ""
    cause: str = ""


TARGETS = (
    Target(what="simulated line", section=KERNEL, row="speed", at_least=400, unit=" x real time"),
    Target(what="its error", section=KERNEL, row="convergence", at_most=1e-5, unit=" of ripple"),
    *(
        Target(
            what=f"shape law, 16 orders, {how}, {word}",
            section=section,
            row="16 orders by compiled",
            word=word,
            at_most=bound,
            unit=" us",
            cause=COLD if section == PACED else "",
        )
        for section, how, word, bound in (
            (HOT, "back to back", "p50", 30),
            (PACED, "paced", "p50", 80),
            (PACED, "paced", "p99", 160),
        )
    ),
    *(
        Target(
            what=f"numpy over binary, 16 orders, {how}, {word}",
            section=section,
            row="16 orders",
            word=word,
            at_least=bound,
            cause=COLD if section == PACED else "",
        )
        for section, how, word, bound in (
            (HOT, "back to back", "p50", 3.5),
            (PACED, "paced", "p50", 5.5),
            (PACED, "paced", "p99", 5),
        )
    ),
    *(
        Target(
            what=f"24 orders over 16, binary, {how}",
            section=section,
            row="p50",
            remark="24 orders over 16, by compiled",
            at_most=1.4,
        )
        for section, how in ((HOT, "back to back"), (PACED, "paced"))
    ),
    Target(
        what="16 plain blocks, paced, p50",
        section=PLAIN,
        row="16 blocks",
        word="p50",
        at_most=40,
        unit=" us",
        cause=NO_BINARY,
    ),
    Target(what="whole tick over bare FC23, p50", section=BARE, row="ratio p50", at_most=1.6),
    Target(what="whole tick over bare FC23, p99", section=BARE, row="ratio p99", at_most=1.8),
)


def targets(sections: Sequence[Section]) -> Section:
    """Return every target beside its figure; a figure that is not there was not measured."""
    room = {
        target.row: _room(sections, target.row.removeprefix("ratio "), target.at_most)
        for target in TARGETS
        if target.section == BARE and target.at_most is not None
    }
    rows = tuple(_row(target, sections, room) for target in TARGETS)
    return Section(title=TITLE, note=NOTE, rows=rows)


def figure(row: FactRow, word: str) -> float:
    """Return the number behind a word of a row's value, or the one that it begins with."""
    found = re.search(rf"\b{word} {NUMBER}", row.value) if word else re.match(NUMBER, row.value)
    return float(found[1]) if found else float("nan")


def find(sections: Sequence[Section], title: str, row: str, remark: str = "") -> FactRow | None:
    """Return a row of the section whose title begins so; None where there is none."""
    for section in sections:
        for one in section.rows if section.title.startswith(title) else ():
            if one.name == row and remark in (one.remark, ""):
                return one
    return None


def _row(target: Target, sections: Sequence[Section], room: Mapping[str, str]) -> FactRow:
    found = find(sections, target.section, target.row, target.remark)
    value = figure(found, target.word) if found is not None else float("nan")
    if math.isnan(value):
        return FactRow(name=target.what, value="-", remark=f"{_asked(target)}: not measured")
    met = value <= target.at_most if target.at_most is not None else value >= _least(target)
    cause = target.cause or room.get(target.row, "")
    why = f"; {cause}" if cause and not met else ""
    verdict = f"{_asked(target)}: {'met' if met else 'missed'}{why}"
    return FactRow(name=target.what, value=f"{value:g}{target.unit}", remark=verdict)


def _least(target: Target) -> float:
    return target.at_least if target.at_least is not None else float("nan")


def _asked(target: Target) -> str:
    if target.at_most is not None:
        return f"at most {target.at_most:g}"
    return f"at least {_least(target):g}"


def _room(sections: Sequence[Section], word: str, ratio: float) -> str:
    """Return what such a ratio leaves beside the exchange, and what was taken."""
    bare, whole = (find(sections, BARE, row) for row in ("bare FC23", "whole tick"))
    if bare is None or whole is None:
        return ""
    exchange = figure(bare, word)
    return (
        f"beside a bare exchange of {exchange:g} us it leaves {(ratio - 1.0) * exchange:.0f} us "
        f"for guard, codec, law and record, which take {figure(whole, word) - exchange:.0f} us"
    )
