"""Which cases: dealt from seed and number alone, so that a campaign can stop and go on.

Effects are dealt like cards. A round of a group gives each effect of the library once, so a whole
number of rounds draws each equally often, whatever the seed; rounds of pairs bring new pairs until
every two effects have met.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.campaign.beyond import ANGLE, TIME, TRAVEL
from benchmarks.campaign.effect_row import further
from benchmarks.campaign.effect_table import BY_NAME, EFFECTS, LIBRARY
from benchmarks.campaign.fault import ALWAYS_S, FOREVER_S, Fault

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


CYCLE = {
    "no effect": 25,
    "single 0.4": 8,
    "single 0.2": 6,
    "pair": 7,
    "triple": 4,
    "outside": 4,
    "removed": 2,
    "ablation": 2,
}
"""Cases of each group in a cycle; any stretch of the campaign is a small campaign."""
SIZE = {"single 0.4": 1, "single 0.2": 1, "pair": 2, "triple": 3}
SEATS = -(-len(LIBRARY) // 6) * 6
"""Of a round: each effect has one, the others are free for any; pairs and triples fit in."""
ABLATIONS = ("one speed", "loop cells alone", "no encoder", "commensurate", "strong colour")


def spread_out(counts: dict[str, int]) -> tuple[str, ...]:
    """Return every name as often as told, each evenly over the whole."""
    at = [((j + 0.5) / n, name) for name, n in counts.items() for j in range(n)]
    return tuple(name for _, name in sorted(at))


GROUPS = spread_out(CYCLE)


def place_in_group(number: int) -> tuple[str, int]:
    """Return the group of a case, and how many cases of it come before."""
    cycle, at = divmod(number, len(GROUPS))
    group = GROUPS[at]
    return group, cycle * CYCLE[group] + GROUPS[:at].count(group)


def cases_for(times: int) -> int:
    """Return the number of cases that draws every effect at least so often, of any seed."""
    cycles = 1
    while sum(CYCLE[g] * cycles * n // SEATS for g, n in SIZE.items()) < times:
        cycles += 1
    return cycles * len(GROUPS)


def dealt(seed: int, group: str, index: int) -> list[str]:
    """Return the effects of a case, none of them twice; a free seat is filled by lot."""
    size = SIZE[group]
    turn, at = divmod(index, SEATS // size)
    own = list(CYCLE).index(group)
    lots = np.random.default_rng([seed, own, turn])
    if size == 2:  # as chess players meet: each two once before any two meet again
        seats = np.random.default_rng([seed, own]).permutation(SEATS)
        others = SEATS - 1
        game = int(lots.permutation(SEATS // 2)[at])
        hand = [others if game == 0 else (turn + game) % others, (turn - game) % others]
        hand = [int(seats[k]) for k in hand]
    else:
        hand = [int(k) for k in lots.permutation(SEATS)[size * at : size * (at + 1)]]
    names = [LIBRARY[k].name for k in hand if k < len(LIBRARY)]
    rest = [row.name for row in LIBRARY if row.name not in names]
    free = np.random.default_rng([seed, own, turn, at]).permutation(rest)
    return [*names, *map(str, free[: size - len(names)])]


def draw_fault(rng: np.random.Generator, name: str, turn: int, taken: Sequence[str] = ()) -> Fault:
    """Return an effect in the form whose turn it is, at one of its places that is not taken.

    A place is shared where the effect has no other.
    """
    row = BY_NAME[name]
    form = row.forms[turn % len(row.forms)]
    places = form.drawn_at or row.drawn_at
    free = [place for place in places if place not in taken] or places
    sign = rng.choice([-1.0, 1.0]) if form.either_sign else 1.0
    from_s, from_b_s = moments(rng) if form.begins else (ALWAYS_S, ALWAYS_S)
    return Fault(
        effect=name,
        location=str(rng.choice(free)),
        size=form.first_size * float(sign),
        angle=float(rng.uniform(0.0, 2.0 * np.pi)),
        shape=float(rng.choice(form.shapes)),
        form=form.name,
        numbers=further(form, rng),
        from_s=from_s,
        from_b_s=from_b_s,
    )


def moments(rng: np.random.Generator) -> tuple[float, float]:
    """Return when something begins in record a, and in b: then, before it, or never."""
    first, second = rng.uniform(18.0, 42.0, size=2)
    return float(first), float(rng.choice([second, second, second, ALWAYS_S, FOREVER_S]))


def draw_several(rng: np.random.Generator, names: Sequence[str], turn: int) -> tuple[Fault, ...]:
    """Return these effects, each at a place of its own where it has the choice."""
    found: list[Fault] = []
    for name in names:
        found.append(draw_fault(rng, name, turn, [f.location for f in found]))
    return tuple(found)


def draw_outside(rng: np.random.Generator, turn: int) -> tuple[Fault, tuple[str, ...]]:
    """Return something that no library has, and the classes that say so rightly."""
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    span = str(rng.choice(["unwind", "R2", "swrap", "pull_roll", "R7"]))
    draws = [(row.name, row.outside) for row in EFFECTS if row.outside is not None]
    what, draw = draws[turn % len(draws)]
    return draw(rng, what, angle, span)


def removed(rng: np.random.Generator, turn: int) -> tuple[Fault, tuple[str, ...], tuple[str, ...]]:
    """Return a library effect, the effects to leave out, and the class it is unknown by.

    Effects that make the same line at the same roller are left out with it.
    """
    names = [row.name for row in LIBRARY if row.taken_out]
    fault = draw_fault(rng, names[turn % len(names)], turn)
    if BY_NAME[fault.effect].line == TIME:
        return replace(fault, kind=TIME), (fault.effect,), (TIME,)
    same = tuple(row.name for row in LIBRARY if row.line == "turn")
    kind = ANGLE if fault.location in ("unwind", "rewind") else TRAVEL
    return replace(fault, kind=kind), same, (kind,)


def numbers_of(cases: int, group: str = "", effect: str = "", seed: int = 0) -> list[int]:
    """Return the first ``cases`` numbers of a campaign, of one group or effect where given."""
    return [
        n
        for n in range(cases)
        if group in ("", GROUPS[n % len(GROUPS)])
        and (not effect or effect in {f.effect for f in case_number(seed, n).faults})
    ]


def case_number(seed: int, number: int) -> Case:
    """Return case ``number`` of the campaign ``seed``."""
    rng = np.random.default_rng([seed, number])
    group, index = place_in_group(number)
    base: dict[str, Any] = {"number": number, "seed": int(rng.integers(1 << 31))}
    if group == "ablation":
        return _ablated(rng, index, base)
    base["group"] = group
    if group in SIZE:
        turn = index // (SEATS // SIZE[group]) + list(CYCLE).index(group)
        faults = draw_several(rng, dealt(seed, group, index), turn)
        snr = float(group.split()[1]) if group.startswith("single") else 0.6
        return Case(faults=faults, snr=snr, **base)
    if group == "no effect":
        return Case(**base)
    if group == "outside":
        outside, classes = draw_outside(rng, index)
        return Case(faults=(outside,), snr=0.6, classes=classes, **base)
    fault, without, classes = removed(rng, index)
    return Case(faults=(fault,), snr=0.6, without=without, classes=classes, **base)


def _ablated(rng: np.random.Generator, index: int, base: dict[str, Any]) -> Case:
    what = ABLATIONS[index % len(ABLATIONS)]
    names = [row.name for row in LIBRARY if row.in_ablations]
    fault = draw_fault(rng, names[index % len(names)], index)
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
