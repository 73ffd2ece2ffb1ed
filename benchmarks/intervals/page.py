"""What intervals hold, by kind of number and by effect."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.campaign.score import wilson
from benchmarks.intervals.draws import SIZES
from sim_plant.effects.catalogue import BY_NAME as CATALOGUED
from sim_plant.refine.fit.spread import SPREAD

CLASSES = {"s": "time constant, delay, duration", "Hz": "frequency"}
"""What a number is, by its unit."""
NO_FIT = 1000.0
"""Standard deviations of chi-square: what leaves more has not been fitted."""
FAR = 4.0
"""Standard deviations of chi-square by which what a fit leaves is more than noise."""
ASKED = 0.90, 0.98
"""Share of intervals that hold, at least and at most."""


def error_ratio(number: Mapping[str, float]) -> float:
    """Return the error over the standard deviation that the interval stands for on its side."""
    value, true = number["value"], number["true"]
    side = number["high"] - value if true > value else value - number["low"]
    return (value - true) / max(side / SPREAD, 1e-300)


def number_class(effect: str, name: str) -> str:
    """Return what kind of number it is, by its unit and its part in the effect."""
    row = CATALOGUED[effect].accepts.get(name)
    onset = CATALOGUED[effect].onset
    if name in ("from_s", "at_length_m") or (onset is not None and name == onset.moment):
        return "moment, place in the web"
    if row is not None and row.unit in CLASSES:
        return CLASSES[row.unit]
    return "size" if row is None or row.role == "strength" else "shape, threshold, mass, damping"


def estimated(row: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the numbers of a draw that a verdict would tell.

    None where the fit is none (a line that the effect has made unstable), nor a number that may
    be anything from one bound to the other: the page says *not shown* of it.
    """
    if row["excess"] > NO_FIT:
        return []
    accepts = CATALOGUED[row["effect"]].accepts
    return [
        n
        for n in row["numbers"]
        if n["name"] not in accepts
        or n["low"] > accepts[n["name"]].low
        or n["high"] < accepts[n["name"]].high
    ]


def page(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the tables: a line per class of number, then one per effect and number."""
    classes: dict[str, list[Mapping[str, float]]] = defaultdict(list)
    groups: dict[tuple[str, str], list[Mapping[str, float]]] = defaultdict(list)
    for row in rows:
        for number in estimated(row):
            classes[number_class(row["effect"], number["name"])].append(number)
            groups[row["effect"], number["name"]].append(number)
    every = [number for numbers in groups.values() for number in numbers]
    classes = {**dict(sorted(classes.items())), "all": every}
    gone = [row["name"] for row in rows if not estimated(row)]
    missed = [
        f"{row['name']} {n['name']}: {n['value']:.4g} ({n['low']:.4g} to {n['high']:.4g}), "
        f"true {n['true']:.4g}"
        for row in rows
        for n in estimated(row)
        if not _holds(n)
    ]
    return (
        "\n".join(
            [
                "| number | held | share, 95 % of it | error over sd, rms | asked: 90 to 98 % |",
                "|---|---|---|---|---|",
                *(_of_class(name, numbers) for name, numbers in classes.items() if numbers),
                "",
                "| effect | number | held | error over sd, rms | half width, % |",
                "|---|---|---|---|---|",
                *(_line(*key, numbers) for key, numbers in groups.items()),
                "",
                f"Not held: {'; '.join(missed) or 'none'}.",
                "",
                f"No fit stands: {', '.join(gone) or 'none'}.",
            ]
        )
        + "\n"
    )


def document(rows: Sequence[Mapping[str, Any]], rounds: int) -> str:
    """Return the page of the documents: what was drawn, and the tables."""
    sizes = " and ".join(f"{size:g}" for size in SIZES)
    more = [row["name"] for row in rows if estimated(row) and row["excess"] > FAR]
    return f"""# Do the 95 % intervals hold?

Repeat: `python -m benchmarks.intervals --rounds {rounds} --docs`; a minute of a core a draw, goes
on where it was stopped.

{len(rows)} records of the campaign's generator, other code than the product: one effect of its
library each, in every form, its size {sizes} times that with which the campaign begins, in turn.
The effect is fitted at its place, without a search, with all that a search ends with; its
intervals are held against what was put in. *Error over sd*: an interval stands for {SPREAD:.2f}
standard deviations on either side; 1 is right, less is wide.

{page(rows)}
A fit leaves more than noise, by {FAR:g} standard deviations of chi-square, in {len(more)} of
{len(rows)} draws: {", ".join(more) or "none"}.
"""


def _of_class(name: str, numbers: Sequence[Mapping[str, float]]) -> str:
    held = sum(_holds(number) for number in numbers)
    low, high = wilson(held, len(numbers))
    fits = high >= ASKED[0] and low <= ASKED[1]
    inside = ASKED[0] <= held / len(numbers) <= ASKED[1]
    verdict = "met" if inside else "too few draws to say" if fits else "**missed**"
    return (
        f"| {name} | {held} of {len(numbers)} | {100.0 * held / len(numbers):.0f} % "
        f"({100.0 * low:.0f} to {100.0 * high:.0f} %) | {_error_rms(numbers):.2f} | {verdict} |"
    )


def _error_rms(numbers: Sequence[Mapping[str, float]]) -> float:
    return math.sqrt(float(np.mean([error_ratio(number) ** 2 for number in numbers])))


def _holds(number: Mapping[str, float]) -> bool:
    return number["low"] <= number["true"] <= number["high"]


def _line(effect: str, name: str, numbers: Sequence[Mapping[str, float]]) -> str:
    held = sum(_holds(number) for number in numbers)
    ratio = _error_rms(numbers)
    widths = [0.5 * (n["high"] - n["low"]) / max(abs(n["true"]), 1e-300) for n in numbers]
    width = f"{100 * float(np.median(widths)):.2f}"
    return f"| {effect} | {name} | {held} of {len(numbers)} | {ratio:.2f} | {width} |"
