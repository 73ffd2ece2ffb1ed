"""The rows of the bench: what is run, how long, and when the law is enabled."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from benchmarks.control.lines import ALL_FIVE, FILM_SHARE, FPM_M_S, INCH_M, Hidden, nominal, spoilt
from sim_plant.line.declared.declaration import Declaration

ON_S = 10.0
ECCENTRIC_M = 0.0003
SHAPE_AT = {8.0: "flat", 6.375: "bulge", 4.75: "asym"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One row: a line, a speed, and what is hidden from the law."""

    material: str
    fpm: float
    radius_in: float
    shape: str | None
    hidden: Hidden = field(default_factory=Hidden)
    cycle_s: float = 0.005
    note: str = ""
    follower_m: float = ECCENTRIC_M
    lead_m: float = ECCENTRIC_M

    @property
    def name(self) -> str:
        """What the table calls it."""
        if self.material == "film":
            text = f"Film {60.0 * self.speed_m_s:.0f} m/min R{self.radius_in * INCH_M:g} m"
            return f"{text} {self.shape or 'round'} {self.note}".strip()
        web = "Tyvek" if self.material == "tyvek" else "PE"
        text = f"{web} {self.fpm:g} FPM R{self.radius_in:g} {self.shape or 'round'}"
        return f"{text} {self.note}".strip()

    @property
    def speed_m_s(self) -> float:
        """Line speed."""
        return self.fpm * FPM_M_S

    @property
    def turn_s(self) -> float:
        """Duration of one roll turn at the start."""
        return math.tau * self.radius_in * INCH_M / self.speed_m_s

    def line(self) -> Declaration:
        """Return the line with its faults of shape; the hidden ones are put in by ``run``."""
        return spoilt(
            nominal(self.material, self.radius_in * INCH_M),
            shape=self.shape,
            lead_m=self.lead_m,
            follower_m=self.follower_m,
            share=FILM_SHARE if self.material == "film" else 1.0,
        )

    def profile(self) -> npt.NDArray[np.float64]:
        """Return the speed of a constant run: 35 s or 30 turns after the start."""
        duration_s = ON_S + max(35.0, 26.0 * self.turn_s)
        return np.full(round(duration_s / self.cycle_s), self.speed_m_s)


def constant_cases() -> list[Case]:
    """Return the constant-speed rows."""
    grid = itertools.product(("tyvek", "pe"), (100.0, 200.0, 300.0), (8.0, 6.375, 4.75))
    cases = [Case(material=m, fpm=v, radius_in=r, shape=SHAPE_AT[r]) for m, v, r in grid]
    cases += [
        Case(material="tyvek", fpm=200.0, radius_in=8.0, shape="bulge"),
        Case(material="tyvek", fpm=200.0, radius_in=8.0, shape="asym"),
        Case(material="tyvek", fpm=300.0, radius_in=4.75, shape="flat"),
    ]
    return cases


HIDDEN = {
    "delay50": Hidden(delay_s=0.05),
    "cell3Hz": Hidden(cell_Hz=3.0),
    "EAx0.7": Hidden(EA_ratio=0.7),
    "Rtag+2%": Hidden(radius_tag_ratio=1.02),
    "wound50": Hidden(wound_in_ratio=0.5),
    "all5": ALL_FIVE,
    "12bit": Hidden(word_bits=12),
    "spikes": Hidden(spike_N=100.0),
}


def mismatch_cases() -> list[Case]:
    """Return the rows with something hidden from the law."""
    places = (("tyvek", 200.0, 8.0), ("tyvek", 300.0, 4.75), ("pe", 200.0, 6.375))
    cases = []
    for material, fpm, radius in places:
        base = {"material": material, "fpm": fpm, "radius_in": radius, "shape": "flat"}
        for note, hidden in HIDDEN.items():
            cases.append(Case(**base, hidden=hidden, note=note))  # type: ignore[arg-type]
        cases.append(Case(**base, cycle_s=0.01, note="10ms"))  # type: ignore[arg-type]
    return cases


FILM_ECCENTRIC_M = 2e-5
M_MIN_FPM = 1.0 / 0.3048


def film_case(m_min: float, radius_m: float, shape: str, **more: Any) -> Case:
    """Return the film line at a speed in m/min."""
    given = {"cycle_s": 0.001, "lead_m": 0.0, "follower_m": FILM_ECCENTRIC_M, **more}
    return Case(
        material="film", fpm=m_min * M_MIN_FPM, radius_in=radius_m / INCH_M, shape=shape, **given
    )


def film_cases() -> list[Case]:
    """Return the film line at constant speed: 1 ms, a softer web, a cycle of 2 ms."""
    softer = Hidden(EA_ratio=0.7, radius_tag_ratio=1.02)
    return [
        film_case(600.0, 0.3, "flat"),
        film_case(1000.0, 0.3, "flat"),
        film_case(600.0, 0.2, "bulge"),
        film_case(1000.0, 0.2, "asym"),
        film_case(600.0, 0.3, "flat", hidden=softer, note="EAx0.7 Rtag+2%"),
        film_case(600.0, 0.3, "flat", cycle_s=0.002, note="2ms"),
    ]


def film_ramp_cases() -> list[Case]:
    """Return the film line's ramps 600 to 1000 m/min, two of them in one run."""
    return [
        film_case(600.0, 0.3, "flat", note="ramp"),
        film_case(600.0, 0.2, "bulge", note="ramp"),
        film_case(600.0, 0.3, "flat", cycle_s=0.002, note="ramp 2ms"),
    ]


def film_ramp(case: Case) -> npt.NDArray[np.float64]:
    """Return line speed, m/s: 600 m/min, up in 20 s, down, up again; as ``ramp_profile``."""
    time_s = np.arange(0.0, 130.0, case.cycle_s)
    m_min = np.array([600.0, 600.0, 1000.0, 1000.0, 600.0, 600.0, 1000.0, 1000.0])
    return np.asarray(np.interp(time_s, RAMP_AT_S, m_min / 60.0))


def ramp_cases() -> list[Case]:
    """Return the ramps 100 to 300 FPM, two of them in one run."""
    cases = [
        Case(material=m, fpm=100.0, radius_in=r, shape=SHAPE_AT[r])
        for m in ("tyvek", "pe")
        for r in (8.0, 6.375)
    ]
    cases.append(
        Case(
            material="tyvek", fpm=100.0, radius_in=8.0, shape="flat", hidden=ALL_FIVE, note="all5"
        )
    )
    return cases


RAMP_AT_S = np.array([0.0, 30.0, 50.0, 65.0, 85.0, 100.0, 120.0, 130.0])
RAMPS_S = ((30.0, 50.0), (100.0, 120.0))


def ramp_profile() -> npt.NDArray[np.float64]:
    """Return line speed, m/s: 100 FPM, up in 20 s, down, up again."""
    time_s = np.arange(0.0, 130.0, 0.005)
    fpm = np.array([100.0, 100.0, 300.0, 300.0, 100.0, 100.0, 300.0, 300.0])
    return np.asarray(np.interp(time_s, RAMP_AT_S, fpm * FPM_M_S))


def roll_cases() -> list[Case]:
    """Return the whole rolls, 8 in to 2.5 in."""
    base = {"radius_in": 8.0, "shape": "flat"}
    grid = itertools.product(("tyvek", "pe"), (300.0, 200.0))
    cases = [Case(material=m, fpm=v, **base) for m, v in grid]  # type: ignore[arg-type]
    cases.append(
        Case(material="tyvek", fpm=300.0, hidden=ALL_FIVE, note="all5", **base)  # type: ignore[arg-type]
    )
    return cases


@dataclass(frozen=True, slots=True, kw_only=True)
class Schedule:
    """Speed, roll id and permission per sample; when it happens and when the line is back."""

    speed_m_s: npt.NDArray[np.float64]
    roll_id: npt.NDArray[np.int64]
    enabled: npt.NDArray[np.bool_]
    event_s: float
    back_s: float


def transient_cases() -> list[Case]:
    """Return stop and start, emergency stop and roll change, on both webs."""
    return [
        Case(material=m, fpm=200.0, radius_in=8.0, shape="flat", note=note)
        for m in ("tyvek", "pe")
        for note in ("stop, start", "emergency stop", "roll change")
    ]


def transient(case: Case) -> Schedule:
    """Return the plan of a transient: learn 50 s, the event, 45 s afterwards.

    A stop takes 10 s each way and stands for 10 s, with the permission to correct all the time;
    an emergency stop takes 2 s and takes the permission away until the line is back. A new roll
    has its own id and its shape at another angle (``NEW_ROLL_RAD``) of the encoder.
    """
    event_s, v = 60.0, case.speed_m_s
    down_s = {"stop, start": 10.0, "emergency stop": 2.0, "roll change": 0.0}[case.note]
    back_s = event_s + (down_s + 20.0 if down_s > 0.0 else 0.0)
    time_s = np.arange(0.0, back_s + 45.0, case.cycle_s)
    still = 0.0 if down_s > 0.0 else v
    at_s = [0.0, event_s, event_s + down_s + 1e-6, back_s - 10.0 + 2e-6, back_s + 3e-6]
    speed = np.interp(time_s, at_s, [v, v, still, still, v])
    enabled = time_s >= ON_S
    if case.note == "emergency stop":
        enabled &= (time_s < event_s) | (time_s >= back_s)
    changed = (time_s >= event_s) & (case.note == "roll change")
    return Schedule(
        speed_m_s=np.asarray(speed, dtype=np.float64),
        roll_id=1 + changed.astype(np.int64),
        enabled=enabled,
        event_s=event_s,
        back_s=back_s,
    )


def roll_duration_s(case: Case, end_in: float = 2.5) -> float:
    """Return how long the roll lasts down to a radius, s."""
    start_m, end_m = case.radius_in * INCH_M, end_in * INCH_M
    return math.pi * (start_m**2 - end_m**2) / case.line().web.thickness_m / case.speed_m_s


def follower_cases() -> list[Case]:
    """Return lines with a follower 0.5 mm out and an unwind that is not round."""
    return [
        Case(material=m, fpm=v, radius_in=8.0, shape="flat", follower_m=0.0005, lead_m=0.0)
        for m, v in (("tyvek", 200.0), ("tyvek", 300.0), ("pe", 200.0))
    ]
