"""One verdict against the truth, and many scores as rows with their bounds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest

from benchmarks.campaign.effect_table import BY_NAME

NEEDED, NEEDED_STATIC = 100.0, 150.0
"""Chi-square above which an effect (with a line, without) pays its price and beats all chance."""
OUTCOMES = ("exact", "wrong", "unknown", "not identifiable", "missed", "part", "failed")


def wilson(hits: int, runs: int) -> tuple[float, float]:
    """Return the 95 % interval of a share   [Wilson 1927]."""
    if runs == 0:
        return 0.0, 1.0
    found = binomtest(hits, runs).proportion_ci(0.95, method="wilson")
    return float(found.low), float(found.high)


class Place(NamedTuple):
    """An effect at a location, by the names of a version 1 verdict."""

    effect: str
    location: str


def place(effect: str, location: str) -> Place:
    """Return where an effect is, as a verdict says it."""
    row = BY_NAME.get(effect)
    return Place(row.said_as if row is not None and row.said_as else effect, location)


def said_place(text: str) -> Place:
    """Return what a verdict says in one text, ``effect at location``."""
    effect, _, location = text.partition(" at ")
    return place(effect, location)


def keys(faults: Sequence[dict[str, Any]]) -> set[Place]:
    """Return effects and locations as verdicts say them."""
    return {place(f["effect"], f["location"]) for f in faults}


def left_open(verdict: dict[str, Any], truth: set[Place]) -> set[Place]:
    """Return what the verdict names but says may as well be one of the truth."""
    return {
        said_place(pair["effect"])
        for pair in verdict.get("ambiguous", ())
        if truth & {said_place(text) for text in pair["with"]}
    }


def outcome(row: dict[str, Any]) -> str:
    """Return what a case with library effects came to, one of ``OUTCOMES``.

    ``wrong`` names any effect or place that is not there, also beside right ones. ``not
    identifiable`` names the right ones as one possibility among others.
    """
    verdict = row["refine"]["verdict"]
    if not verdict:
        return "failed"
    truth, said = keys(row["faults"]), keys(verdict["effects"])
    if said - truth and said - truth <= left_open(verdict, truth):
        return "not identifiable"
    if said - truth:
        return "wrong"
    if said == truth and said:
        return {"traced": "exact", "not_identifiable": "not identifiable"}.get(
            verdict["verdict"], "part"
        )
    if said:
        return "part"
    return "missed" if verdict["verdict"] == "nothing" else "unknown"


def told_apart(row: dict[str, Any]) -> bool:
    """Return whether the record tells every fault from its like and from declared tolerances."""
    pairs = zip(row["faults"], row.get("evidence", ()), strict=False)
    shown = all(
        e >= (NEEDED_STATIC if BY_NAME[f["effect"]].standing else NEEDED) for f, e in pairs
    )
    return shown and not any(row.get("alike", ()))


def alike_said(row: dict[str, Any]) -> bool:
    """Return whether a case that no tool can decide was called so, the true effect among them."""
    return outcome(row) == "not identifiable"


def coordinate_error(row: dict[str, Any]) -> float | None:
    """Return the relative error of the first unknown's coordinate; None where there is none."""
    unknown = row["refine"]["verdict"].get("unknown") or [{}]
    given, true = unknown[0].get("coordinate", {}), row["coordinate"]
    for name in ("frequency_Hz", "wavenumber_1_m", "order"):
        if name in true and name in given:
            return float(given[name]) / float(true[name]) - 1.0
    return None


def class_right(row: dict[str, Any]) -> bool:
    """Return whether what no library effect explains is unknown, of the right class."""
    verdict = row["refine"]["verdict"]
    if not verdict or verdict["effects"] or verdict["verdict"] != "unknown":
        return False
    first = verdict["unknown"][0]["class"] if verdict["unknown"] else ""
    return first in row["classes"]


def covered(row: dict[str, Any]) -> list[bool]:
    """Return, per rightly traced effect, whether its 95 % interval holds the true size."""
    found = []
    for fault in row["faults"]:
        name, zero = BY_NAME[fault["effect"]].strength
        for said in row["refine"]["verdict"].get("effects", ()):
            same = keys([fault]) == keys([said])
            if same and name in said.get("interval95", {}):
                low, high = said["interval95"][name]
                found.append(low <= zero + fault["size"] <= high)
    return found


def held_out(row: dict[str, Any], moving: Sequence[str]) -> list[float]:
    """Return the rms after over the true floor of record b for the channels in ``moving``."""
    table = row["refine"]["verdict"].get("residual_rms", {})
    return [table[c]["after"] / row["floor"][c] for c in moving if c in table]


def quantile(values: Sequence[float], share: float) -> float:
    """Return a quantile, nan of nothing."""
    return float(np.quantile(values, share, method="inverted_cdf")) if values else math.nan
