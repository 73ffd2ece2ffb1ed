"""The lives of each roller: from one exchange to the next, with the web that ran."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.trend import Array

SECONDS_PER_HOUR = 3600.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Life:
    """One life of a roller.

    Attributes
    ----------
    number : from 1 on. ``since``, ``until`` : UTC; None where it began before the store, or lasts.
    why : what was said at the exchange that began it.
    web_km, running_h : web and hours of it that the store has, at any speed.
    turns : of the roller in that web; None where its radius was never known.
    """

    roll: str
    number: int
    since: np.datetime64 | None
    until: np.datetime64 | None
    why: str
    web_km: float
    running_h: float
    turns: float | None


def lives(store: Store) -> list[Life]:
    """Return every life of every roller, rollers by name, each one's lives in their order."""
    orders = store.orders
    rollers = sorted(set(orders["roll"][~orders["is_roll"]]))
    return [life for roll in rollers for life in _of_roller(store, roll)]


def _of_roller(store: Store, roll: str) -> list[Life]:
    exchanges = store.exchanges
    ours = exchanges["roll"] == roll
    order = np.argsort(exchanges["on_utc"][ours], kind="stable")
    begins = [None, *exchanges["on_utc"][ours][order]]
    whys = ["", *(str(why) for why in exchanges["why"][ours][order])]
    radius_m = _radius_m(store, roll)
    found = []
    for number, (since, until) in enumerate(itertools.pairwise([*begins, None]), start=1):
        inside = _between(store.hours["time_utc"], since, until)
        length_m = store.hours["length_m"][inside]
        web_m = float(np.nansum(length_m))
        found.append(
            Life(
                roll=roll,
                number=number,
                since=since,
                until=until,
                why=whys[number - 1],
                web_km=1e-3 * web_m,
                running_h=_running_h(store.hours["covered_s"][inside], length_m),
                turns=web_m / (2.0 * math.pi * radius_m) if radius_m > 0.0 else None,
            )
        )
    return found


def _between(
    times: NDArray[np.datetime64], since: np.datetime64 | None, until: np.datetime64 | None
) -> NDArray[np.bool_]:
    inside = np.ones(times.size, dtype=np.bool_)
    if since is not None:
        inside &= times >= since
    if until is not None:
        inside &= times < until
    return inside


def _running_h(covered_s: Array, length_m: Array) -> float:
    """Return the hours that were recorded while web ran."""
    return float(covered_s[length_m > 0.0].sum()) / SECONDS_PER_HOUR


def _radius_m(store: Store, roll: str) -> float:
    """Return a roller's radius, NaN where the store does not know it."""
    radii = store.orders["radius_m"][store.orders["roll"] == roll]
    known = radii[np.isfinite(radii)]
    return float(np.median(known)) if known.size else math.nan
