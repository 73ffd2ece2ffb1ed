"""What the page of trends shows: groups, windows, curves, in the reader's language."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from aff_hmi.see.flags import Flag
from aff_hmi.see.series import MEASURED, NOW, REFERENCE, VALUE, WITHOUT, Series
from aff_hmi.see.trend_rows import LARGEST, LEAST, MEAN
from aff_hmi.see.trends import Curves
from aff_hmi.words import N_, Say
from aff_runtime.base.numbers import finite_or_none

GROUPS = {
    "ripple": N_("Ripple, rms"),
    "tension": N_("Tension"),
    "correction": N_("Correction"),
    "let_out": N_("Let out by the guard"),
    "speed": N_("speed"),
    "radius": N_("radius"),
    "timing": N_("Tick and age of the data"),
}
OF_ORDERS = {"dB": N_("Orders in dB"), "mm": N_("Shape of the orders")}
ROLES = {
    VALUE: "",
    REFERENCE: N_("set point"),
    NOW: N_("of the orders, now"),
    WITHOUT: N_("of the orders, without AFF (estimate)"),
    MEASURED: N_("measured, all that moves"),
}
GOOD = {
    "ripple": N_("Good: now stays far below without AFF while the correction goes out."),
    "tension": N_("Good: a narrow band around the set point; the band is least to largest."),
    "correction": N_("Good: well inside the limit; at the limit an order gives way."),
    "let_out": N_("Good: 100 % while active; less means that the guard holds back."),
    "timing": N_("Good: tick well below the cycle; a single high tick shows even in a year."),
    "dB": N_("Good: minus 20 dB or lower, and steady; only while the correction goes out."),
    "mm": N_("Good: steady; a slow rise is a bearing or a roll that wears."),
}
WINDOW_WORDS = {
    "1min": N_("1 min"),
    "10min": N_("10 min"),
    "1h": N_("1 h"),
    "8h": N_("8 h"),
    "7d": N_("7 days"),
    "1y": N_("1 year"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """One curve: least, mean and largest of every bin; None where it was not known."""

    label: str
    unit: str
    dashed: bool
    least: list[float | None]
    mean: list[float | None]
    largest: list[float | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class TrendPart:
    """Answer to one question; times are wall time, s.

    Attributes
    ----------
    t_s, wide_s : where each bin begins, and how much time it is of.
    active, fault : shares of bins.
    """

    from_s: float
    to_s: float
    bin_s: int
    t_s: list[int]
    wide_s: list[int]
    curves: list[Curve]
    active: list[float | None]
    fault: list[float | None]
    flags: Sequence[Flag]
    good: str


def group_name(group: str, say: Say) -> str:
    """Return a group in the reader's language."""
    kind, _, actuator = group.partition(" ")
    if kind in OF_ORDERS:
        return f"{say(OF_ORDERS[kind])}: {actuator}"
    return say(GROUPS[group])


def trend_part(curves: Curves, flags: Sequence[Flag], say: Say) -> TrendPart:
    """Return curves for a page, with what happened meanwhile."""
    shown = [(n, one) for n, one in enumerate(curves.series) if one.group != "state"]
    states = {one.label: n for n, one in enumerate(curves.series) if one.group == "state"}
    kind = shown[0][1].group.partition(" ")[0]
    bins = curves.binned.bins
    return TrendPart(
        from_s=round(curves.from_s, 1),
        to_s=round(curves.to_s, 1),
        bin_s=curves.binned.bin_s,
        t_s=[int(t) for t in curves.binned.t_s],
        wide_s=[int(wide) for wide in curves.wide_s],
        curves=[
            Curve(
                label=label(one, say),
                unit=one.unit,
                dashed=one.role in (REFERENCE, WITHOUT),
                least=_numbers(bins[:, LEAST, n]),
                mean=_numbers(bins[:, MEAN, n]),
                largest=_numbers(bins[:, LARGEST, n]),
            )
            for n, one in shown
        ],
        active=_numbers(bins[:, MEAN, states["ACTIVE"]]) if "ACTIVE" in states else [],
        fault=_numbers(bins[:, MEAN, states["FAULT"]]) if "FAULT" in states else [],
        flags=flags,
        good=say(GOOD[kind]) if kind in GOOD else "",
    )


def label(one: Series, say: Say) -> str:
    """Return the words of a curve."""
    role = ROLES[one.role]
    return f"{one.label}, {say(role)}" if role else one.label


def _numbers(values: object) -> list[float | None]:
    return [
        finite_or_none(value, 4)
        for value in values.tolist()  # type: ignore[attr-defined]
    ]
