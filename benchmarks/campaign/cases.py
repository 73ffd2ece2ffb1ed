"""Which cases: drawn from seed and number alone, so that a campaign can stop and go on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.campaign.beyond import ANGLE, TIME, TRAVEL
from benchmarks.campaign.effect_table import BY_NAME, EFFECTS, Row
from benchmarks.campaign.effects import Fault

ROWS = 6000


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One case before its faults have their sizes.

    Attributes
    ----------
    number, group : place in the campaign, row of the table.
    seed : of everything random.
    faults : with sizes to begin with.
    snr : wanted, per fault; 0 keeps the size.
    without : effects left out of the library.
    classes : classes of the unknown that are right; empty where the library has the effect.
    speeds, commensurate, channels, colour : what the record is like; ``channels`` lists sensors
        that are kept, empty for all.
    """

    number: int
    group: str
    seed: int
    faults: tuple[Fault, ...] = ()
    snr: float = 0.0
    without: tuple[str, ...] = ()
    classes: tuple[str, ...] = ()
    speeds: int = 3
    commensurate: bool = False
    channels: tuple[str, ...] = ()
    colour: float = 0.05


GROUPS = (
    "single 0.4",
    "no effect",
    "pair",
    "outside",
    "single 0.2",
    "ablation",
    "triple",
    "single 0.4",
    "no effect",
    "pair",
    "removed",
    "single 0.2",
    "no effect",
    "triple",
)
"""Fourteen cases in a row: any stretch of the campaign is a small campaign."""
SEVERAL = {"pair": 2, "triple": 3}
ABLATIONS = ("one speed", "loop cells alone", "no encoder", "commensurate", "strong colour")


LIBRARY = tuple(row.name for row in EFFECTS if row.drawn_at)
OFTEN = tuple(row.name for row in EFFECTS if row.often)


def _often_first(wanted: Callable[[Row], bool]) -> tuple[str, ...]:
    """Return the effects that are wanted, those drawn often before the others."""
    return tuple(r.name for r in sorted(EFFECTS, key=lambda r: not r.often) if wanted(r))


def draw_fault(rng: np.random.Generator, names: tuple[str, ...]) -> Fault:
    """Return one library effect at one of its places, of its first size."""
    row = BY_NAME[str(rng.choice(names))]
    sign = rng.choice([-1.0, 1.0]) if row.either_sign else 1.0
    return Fault(
        effect=row.name,
        location=str(rng.choice(row.drawn_at)),
        size=row.first_size * float(sign),
        angle=float(rng.uniform(0.0, 2.0 * np.pi)),
        shape=float(rng.choice(row.shapes)),
    )


def draw_outside(rng: np.random.Generator) -> tuple[Fault, tuple[str, ...]]:
    """Return something that no library has, and the classes that say so rightly."""
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    span = str(rng.choice(["unwind", "R2", "swrap", "pull_roll", "R7"]))
    draws = {row.name: row.outside for row in EFFECTS if row.outside is not None}
    what = str(rng.choice(list(draws)))
    return draws[what](rng, what, angle, span)


def draw_several(rng: np.random.Generator, count: int) -> tuple[Fault, ...]:
    """Return effects at places of their own, at most one of them static."""
    found: list[Fault] = []
    others = _often_first(lambda row: row.beside_others)
    while len(found) < count:
        fault = draw_fault(rng, (*LIBRARY, *OFTEN) if not found else others)
        if fault.location not in {f.location for f in found}:
            found.append(fault)
    return tuple(found)


def removed(rng: np.random.Generator) -> tuple[Fault, tuple[str, ...], tuple[str, ...]]:
    """Return a library effect, the effects to leave out, and the class it is unknown by.

    Effects that make the same line at the same roller are left out with it.
    """
    fault = draw_fault(rng, _often_first(lambda row: row.taken_out))
    if BY_NAME[fault.effect].line == TIME:
        return replace(fault, kind=TIME), (fault.effect,), (TIME,)
    same = tuple(row.name for row in EFFECTS if row.line == "turn")
    kind = ANGLE if fault.location in ("unwind", "rewind") else TRAVEL
    return replace(fault, kind=kind), same, (kind,)


def numbers_of(cases: int, group: str = "") -> list[int]:
    """Return the first ``cases`` numbers of a campaign, those of one group alone where given."""
    return [n for n in range(cases) if group in ("", GROUPS[n % len(GROUPS)])]


def case_number(seed: int, number: int) -> Case:
    """Return case ``number`` of the campaign ``seed``."""
    rng = np.random.default_rng([seed, number])
    group = GROUPS[number % len(GROUPS)]
    base: dict[str, Any] = {"number": number, "seed": int(rng.integers(1 << 31))}
    if group == "ablation":
        return _ablated(rng, number, base)
    base["group"] = group
    if group.startswith("single"):
        fault = draw_fault(rng, (*LIBRARY, *OFTEN))
        return Case(faults=(fault,), snr=float(group.split()[1]), **base)
    if group in SEVERAL:
        return Case(faults=draw_several(rng, SEVERAL[group]), snr=0.6, **base)
    if group == "no effect":
        return Case(**base)
    if group == "outside":
        outside, classes = draw_outside(rng)
        return Case(faults=(outside,), snr=0.6, classes=classes, **base)
    fault, without, classes = removed(rng)
    return Case(faults=(fault,), snr=0.6, without=without, classes=classes, **base)


def _ablated(rng: np.random.Generator, number: int, base: dict[str, Any]) -> Case:
    what = ABLATIONS[number // len(GROUPS) % len(ABLATIONS)]
    fault = draw_fault(rng, _often_first(lambda row: row.in_ablations))
    more: dict[str, Any] = {}
    if what == "one speed":
        more = {"speeds": 1}
    elif what == "loop cells alone":  # a declared loop needs its cell, so two are the least
        more = {"channels": ("unwind_tension_N", "rewind_tension_N")}
    elif what == "no encoder":
        more = {
            "channels": (
                "unwind_tension_N",
                "pullroll_tension_N",
                "rewind_tension_N",
                "unwind_speed_rad_s",
                "line_speed_m_s",
                "pull_roll_speed_m_s",
                "rewind_speed_rad_s",
            )
        }
    elif what == "commensurate":
        more = {"commensurate": True}
    else:
        more = {"colour": 0.2}
    return Case(group=f"ablation: {what}", faults=(fault,), snr=0.6, **base, **more)
