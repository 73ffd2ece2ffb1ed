"""Which cases: drawn from seed and number alone, so that a campaign can stop and go on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.campaign.effects import CELLS, DRIVES, Fault

ROWS = 6000
TRAVEL, TIME, ANGLE = "travel", "time", "angle"


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


IDLERS = ("R1", "R2", "R3", "R5", "R7")
# effect: locations, first size, shapes to choose from
LIBRARY: dict[str, tuple[tuple[str, ...], float, tuple[float, ...]]] = {
    "eccentric_roller": ((*IDLERS, "swrap", "pull_roll"), 2e-5, (0.0,)),
    "out_of_round_roll": (("unwind", "unwind", "rewind"), 1e-4, (1.0, 2.0, 3.0, 0.0)),
    "unbalanced_roller": (("R1", "R3", "swrap", "pull_roll"), 5e-3, (0.0,)),
    "unbalanced_measuring_roller": (tuple(CELLS), 3e-4, (0.0,)),
    "torque_ripple": (tuple(DRIVES), 0.1, (2.0, 3.0, 4.0, 5.0, 6.0, 8.0)),
    "bearing_drag": (IDLERS, 0.01, (0.0,)),
    "web_modulus": (("web",), 0.1, (0.0,)),
    "wound_in_strain": (("web",), 1e-3, (0.0,)),
    "thermal_strain": (("pull_roll_zone",), 5e-5, (0.0,)),
    "slip": (("swrap", "pull_roll"), 2e-4, (0.8, 1.0)),
    "load_cell_filter": (("R2", "R7", "all"), 0.03, (0.0,)),
    "mains_hum": (tuple(CELLS), 0.2, (60.0, 120.0)),
    "loop_delay": (("unwind", "rewind"), 0.03, (0.0,)),
    "encoder_eccentricity": (tuple(DRIVES), 2e-4, (0.0, 1.0)),
}
OFTEN = ("eccentric_roller", "out_of_round_roll", "torque_ripple")
LINES = (
    "eccentric_roller",
    "out_of_round_roll",
    "torque_ripple",
    "unbalanced_roller",
    "mains_hum",
    "encoder_eccentricity",
)
LARGEST = {  # of effects without a line: beyond this nobody would ask why
    "bearing_drag": 0.2,
    "web_modulus": 0.5,
    "wound_in_strain": 5e-3,
    "thermal_strain": 2e-3,
    "slip": 5e-3,
    "load_cell_filter": 0.2,
    "loop_delay": 0.2,
}

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


def draw_fault(rng: np.random.Generator, names: tuple[str, ...]) -> Fault:
    """Return one library effect at one of its places, of its first size."""
    effect = str(rng.choice(names))
    places, size, shapes = LIBRARY[effect]
    sign = rng.choice([-1.0, 1.0]) if effect in ("web_modulus", "wound_in_strain") else 1.0
    return Fault(
        effect=effect,
        location=str(rng.choice(places)),
        size=size * float(sign),
        angle=float(rng.uniform(0.0, 2.0 * np.pi)),
        shape=float(rng.choice(shapes)),
    )


def draw_outside(rng: np.random.Generator) -> tuple[Fault, tuple[str, ...]]:
    """Return something that no library has, and the classes that say so rightly."""
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    span = str(rng.choice(["unwind", "R2", "swrap", "pull_roll", "R7"]))
    what = str(
        rng.choice(
            [
                "dancer_swing",
                "hidden_nip",
                "web_wave",
                "stiffening_web",
                "gusty_drive",
                "drifting_cell",
            ]
        )
    )
    if what == "dancer_swing":
        hertz = float(rng.uniform(0.6, 5.0))
        return Fault(effect=what, location=span, size=2e-5, angle=angle, shape=hertz, kind=TIME), (
            TIME,
        )
    if what == "hidden_nip":
        radius_m = float(rng.uniform(0.028, 0.1))
        return Fault(
            effect=what,
            location=span,
            size=2e-5,
            angle=angle,
            shape=1.0 / (2.0 * np.pi * radius_m),
            kind=TRAVEL,
        ), (TRAVEL,)
    if what == "web_wave":
        return Fault(
            effect=what,
            location="web",
            size=3e-3,
            shape=float(rng.uniform(0.35, 1.6)),
            kind=TRAVEL,
        ), (TRAVEL,)
    if what == "stiffening_web":
        return Fault(effect=what, location="web", size=0.3, kind="state"), ("state",)
    if what == "gusty_drive":
        drive = str(rng.choice(DRIVES))
        return Fault(effect=what, location=drive, size=0.05, kind="broadband"), ("broadband",)
    cell = str(rng.choice(CELLS))
    return Fault(effect=what, location=cell, size=0.01, kind="drift"), ("broadband", "state", TIME)


def draw_several(rng: np.random.Generator, count: int) -> tuple[Fault, ...]:
    """Return effects at places of their own, at most one of them static."""
    found: list[Fault] = []
    while len(found) < count:
        fault = draw_fault(rng, (*LIBRARY, *OFTEN) if not found else LINES)
        if fault.location not in {f.location for f in found}:
            found.append(fault)
    return tuple(found)


def removed(rng: np.random.Generator) -> tuple[Fault, tuple[str, ...], tuple[str, ...]]:
    """Return a library effect, the effects to leave out, and the class it is unknown by.

    Effects that make the same line at the same roller are left out with it.
    """
    fault = draw_fault(
        rng, ("eccentric_roller", "out_of_round_roll", "torque_ripple", "mains_hum")
    )
    same = (
        "eccentric_roller",
        "out_of_round_roll",
        "unbalanced_roller",
        "torque_ripple",
        "unbalanced_measuring_roller",
        "encoder_eccentricity",
        "roll_bounce",
    )
    rolls = fault.location in ("unwind", "rewind")
    if fault.effect == "mains_hum":
        return replace(fault, kind=TIME), ("mains_hum",), (TIME,)
    return replace(fault, kind=ANGLE if rolls else TRAVEL), same, (ANGLE,) if rolls else (TRAVEL,)


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
    fault = draw_fault(
        rng, ("eccentric_roller", "out_of_round_roll", "torque_ripple", "unbalanced_roller")
    )
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
