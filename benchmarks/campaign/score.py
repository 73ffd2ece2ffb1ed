"""One verdict against the truth, and many scores as rows with their bounds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest

from benchmarks.campaign.effect_row import truth
from benchmarks.campaign.effect_table import BY_NAME
from benchmarks.campaign.fault import Fault

NEEDED, NEEDED_STATIC = 100.0, 150.0
"""Chi-square above which an effect (with a line, without) pays its price and beats all chance."""
OUTCOMES = ("exact", "wrong", "unknown", "not identifiable", "missed", "part", "failed")


def wilson(hits: int, runs: int) -> tuple[float, float]:
    """Return the 95 % interval of a share   [Wilson 1927]."""
    if runs == 0:
        return 0.0, 1.0
    found = binomtest(hits, runs).proportion_ci(0.95, method="wilson")
    return float(found.low), float(found.high)


class EffectAt(NamedTuple):
    """An effect at a location, by the names of a version 1 verdict."""

    effect: str
    location: str


def place(effect: str, location: str) -> EffectAt:
    """Return where an effect is, as a verdict says it."""
    row = BY_NAME.get(effect)
    return EffectAt(row.said_as if row is not None and row.said_as else effect, location)


def said_place(text: str) -> EffectAt:
    """Return what a verdict says in one text, ``effect at location``."""
    effect, _, location = text.partition(" at ")
    return place(effect, location)


def keys(faults: Sequence[dict[str, Any]]) -> set[EffectAt]:
    """Return effects and locations as verdicts say them."""
    return {place(f["effect"], f["location"]) for f in faults}


def left_open(verdict: dict[str, Any], truth: set[EffectAt]) -> set[EffectAt]:
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


def shows(row: dict[str, Any], at: int) -> bool:
    """Return whether the record tells effect ``at`` from its like and from declared tolerances."""
    needed = NEEDED_STATIC if BY_NAME[row["faults"][at]["effect"]].standing else NEEDED
    evidence, alike = row.get("evidence", ()), row.get("alike", ())
    return (at >= len(evidence) or evidence[at] >= needed) and not (at < len(alike) and alike[at])


def told_apart(row: dict[str, Any]) -> bool:
    """Return whether the record tells every fault from its like and from declared tolerances."""
    return all(shows(row, at) for at in range(len(row["faults"])))


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


FATES = ("exact", "set", "wrong", "missed")


def fates(row: dict[str, Any]) -> list[str]:
    """Return per effect of a case what became of it, one of ``FATES``.

    ``exact`` is named at its place as the only one, ``set`` as one of those that a named set
    holds; ``wrong`` is not named while something that is not there is, ``missed`` is not named.
    A run that failed misses all.
    """
    verdict = row["refine"]["verdict"] or {"effects": []}
    said = keys(verdict["effects"])
    beside = {
        said_place(pair["effect"]): {said_place(text) for text in pair["with"]}
        for pair in verdict.get("ambiguous", ())
    }
    held = set().union(*(beside.get(claim, set()) for claim in said))
    truths = [place(f["effect"], f["location"]) for f in row["faults"]]
    found = []
    false = any(not ({claim} | beside.get(claim, set())) & set(truths) for claim in said)
    for true in truths:
        if true in said:
            found.append("set" if beside.get(true) else "exact")
        elif true in held:
            found.append("set")
        else:
            found.append("wrong" if false else "missed")
    return found


def said_of(row: dict[str, Any], fault: dict[str, Any]) -> list[dict[str, Any]]:
    """Return what a verdict says of one effect of its case, where it names it."""
    effects = row["refine"]["verdict"].get("effects", ())
    return [said for said in effects if keys([said]) == keys([fault])]


def covered(row: dict[str, Any]) -> list[bool]:
    """Return, per number of a rightly named effect, whether its 95 % interval holds the truth."""
    found = []
    for fault in row["faults"]:
        true = truth(BY_NAME[fault["effect"]], Fault.read(fault))
        for said in said_of(row, fault):
            for name, (value, _) in true.items():
                if name in said.get("interval95", {}):
                    low, high = said["interval95"][name]
                    found.append(low <= value <= high)
    return found


def size_errors(row: dict[str, Any], at: int) -> list[float]:
    """Return the relative errors of the sizes that a verdict gives effect ``at`` of its case."""
    fault = row["faults"][at]
    true = truth(BY_NAME[fault["effect"]], Fault.read(fault))
    return [
        abs(float(said["parameters"][name]) - value) / abs(value - absent)
        for said in said_of(row, fault)
        for name, (value, absent) in true.items()
        if name in said["parameters"]
    ]


def moment_errors(row: dict[str, Any], at: int) -> list[float]:
    """Return by how many seconds a verdict misses the moment at which effect ``at`` begins.

    A moment in metres of web off the roll is taken to seconds by the line's speed there.
    """
    fault = row["faults"][at]
    if fault.get("from_s", -1.0) < 0.0:
        return []
    web_m, speed_m_s = row.get("moments", {}).get(str(at), (math.nan, math.nan))
    found = []
    for said in said_of(row, fault):
        numbers = said["parameters"]
        if float(numbers.get("from_s", -1.0)) >= 0.0:
            found.append(abs(float(numbers["from_s"]) - fault["from_s"]))
        elif "at_length_m" in numbers:
            found.append(abs(float(numbers["at_length_m"]) - web_m) / speed_m_s)
    return found


def held_out(row: dict[str, Any], moving: Sequence[str]) -> list[float]:
    """Return the rms after over the true floor of record b for the channels in ``moving``."""
    table = row["refine"]["verdict"].get("residual_rms", {})
    return [table[c]["after"] / row["floor"][c] for c in moving if c in table]


def quantile(values: Sequence[float], share: float) -> float:
    """Return a quantile, nan of nothing."""
    return float(np.quantile(values, share, method="inverted_cdf")) if values else math.nan
