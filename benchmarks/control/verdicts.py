"""What was asked of the shape law, and what the rows say."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.control.jobs import BOTH, ORACLE, PERFECT, SAVED, BenchRow
from benchmarks.control.laws import OWN, RIVALS

RIPPLE = {"constant": "ripple", "mismatch": "ripple", "roll": "ripple", "ramp": "first_ripple"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """One line of the table of targets, for one set of seeds."""

    what: str
    asked: str
    reached: str
    share: float

    @property
    def met(self) -> str:
        """Return yes, no, or the share of rows that meet it."""
        if self.share >= 1.0:
            return "yes"
        return f"{100 * self.share:.0f} %" if self.share > 0.0 else "no"


def _each(
    what: str, asked: str, values: Iterable[float], good: Callable[[float], bool], digits: int = 0
) -> list[Target]:
    v = np.array([x for x in values if not np.isnan(x)], dtype=np.float64)
    if v.size == 0:
        return []
    low, middle, high = (float(np.percentile(v, q, method="nearest")) for q in (0, 50, 100))
    text = f"{low:.{digits}f} / {middle:.{digits}f} / {high:.{digits}f}"
    share = float(np.mean([good(float(x)) for x in v]))
    return [Target(what=what, asked=asked, reached=text, share=share)]


def _share(what: str, asked: str, wanted: float, values: Sequence[bool]) -> list[Target]:
    if not values:
        return []
    share = float(np.mean(values))
    text = f"{100 * share:.0f} %"
    return [Target(what=what, asked=asked, reached=text, share=1.0 if share >= wanted else 0.0)]


def targets(rows: Sequence[BenchRow]) -> list[Target]:
    """Return every target that the rows at hand can answer; rows of one set of seeds."""
    own = [r for r in rows if r["law"] == OWN]

    def of(section: str, law: str = OWN) -> list[BenchRow]:
        return [r for r in rows if r["section"] == section and r["law"] == law]

    spoilt = [r for r in of("roll") if "all5" in r["case"]]
    rolls = [r for r in of("roll") if "all5" not in r["case"]]
    both = of("follower", BOTH)
    hidden = of("mismatch")
    return [
        *_constant(rows),
        *_ramp(rows),
        *_each(
            "3 whole roll, mean of 1x-4x",
            ">= 30 dB",
            (min(r["mean_dB"][:4]) for r in rolls),
            lambda x: x >= 30,
        ),
        *_each(
            "3 whole roll, ripple",
            "<= 0.045",
            (r["ripple"] for r in rolls),
            lambda x: x <= 0.045,
            3,
        ),
        *_each(
            "3 whole roll, worst 5 s",
            "<= 0.1",
            (r["worst_5s"] for r in rolls),
            lambda x: x <= 0.1,
            3,
        ),
        *_each(
            "4 follower, pull-roll 1x",
            ">= 33 dB",
            (r["pullroll_1x_dB"] for r in both),
            lambda x: x >= 33,
        ),
        *_each(
            "4 unwind tension meanwhile",
            "<= 1.0",
            (r["unwind"] for r in both),
            lambda x: x <= 1,
            3,
        ),
        *_each(
            "5 mismatch, 1x-2x",
            ">= 30 dB",
            (min(r["late_dB"][:2]) for r in hidden),
            lambda x: x >= 30,
        ),
        *_each(
            "5 mismatch, 3x-4x",
            ">= 25 dB",
            (min(r["late_dB"][2:4]) for r in hidden),
            lambda x: x >= 25,
        ),
        *_each(
            "5 mismatch, no divergence",
            "ripple < 1",
            (r["ripple"] for r in hidden),
            lambda x: x < 1,
            3,
        ),
        *_each(
            "5 ramp, all five, 1x-2x",
            ">= 18 dB",
            (min(r["first_dB"][:2]) for r in of("ramp") if "all5" in r["case"]),
            lambda x: x >= 18,
        ),
        *_each(
            "5 whole roll, all five, ripple",
            "<= 0.1",
            (r["ripple"] for r in spoilt),
            lambda x: x <= 0.1,
            3,
        ),
        *_each(
            "6 start-up peak, constant speed",
            "<= 1.0",
            (r["peak"] for r in of("constant")),
            lambda x: x <= 1.0,
            3,
        ),
        *_each(
            "6 start-up peak, mismatch",
            "<= 1.0",
            (r["peak"] for r in hidden),
            lambda x: x <= 1.0,
            3,
        ),
        *_ahead(rows, own),
        *_film(rows),
    ]


def _constant(rows: Sequence[BenchRow]) -> list[Target]:
    def of(law: str) -> list[BenchRow]:
        return [r for r in rows if r["section"] == "constant" and r["law"] == law]

    def at_reference(law: str) -> list[bool]:
        return [
            m >= reference
            for r in of(law)
            for m, reference in zip(r["middle_dB"][:4], r["reference_dB"][:4], strict=True)
            if not np.isnan(m)
        ]

    constant = of(OWN)
    ripple = [r["ripple"] for r in constant]
    found = [
        *_each(
            "1 cold, 20 dB on 1x-4x reached",
            "5 turns",
            (r["first_turns"] for r in constant),
            lambda x: x <= 5,
            1,
        ),
        *_each(
            "1 cold, 20 dB on 1x-4x kept from then on",
            "5 turns",
            (r["settle_turns"] for r in constant),
            lambda x: x <= 5,
            1,
        ),
        *_each(
            "1 from a saved profile, 20 dB",
            "2 turns",
            (r["first_turns"] for r in of(SAVED)),
            lambda x: x <= 2,
            1,
        ),
        *_each(
            "1 the same with the best fixed weights",
            "(cap)",
            (r["first_turns"] for r in of(ORACLE)),
            lambda x: x <= 2,
            1,
        ),
        *_each(
            "1 turns 10-20, each of 1x-4x",
            ">= 30 dB",
            (m for r in constant for m in r["middle_dB"][:4]),
            lambda x: x >= 30,
        ),
        *_share("1 turns 10-20 at the noise reference", "70 % of orders", 0.7, at_reference(OWN)),
        *_share("1 the same with a perfect roll", "(cap)", 0.7, at_reference(PERFECT)),
        *_each(
            "1 later, each of 1x-4x",
            ">= 35 dB",
            (m for r in constant for m in r["late_dB"][:4]),
            lambda x: x >= 35,
        ),
        *_each("1 total ripple", "<= 0.10", ripple, lambda x: x <= 0.1, 3),
    ]
    if ripple:
        median = float(np.median(ripple))
        found.append(
            Target(
                what="1 total ripple, median",
                asked="<= 0.05",
                reached=f"{median:.3f}",
                share=float(median <= 0.05),
            )
        )
    return found


def _ramp(rows: Sequence[BenchRow]) -> list[Target]:
    ramp = [r for r in rows if r["section"] == "ramp" and "all5" not in r["case"]]
    own = [r for r in ramp if r["law"] == OWN]
    perfect = {r["case"]: r for r in ramp if r["law"] == PERFECT}
    gaps = [
        perfect[r["case"]]["second_dB"][0] - r["second_dB"][0] for r in own if r["case"] in perfect
    ]
    return [
        *_each("2 first ramp, 1x", ">= 22 dB", (r["first_dB"][0] for r in own), lambda x: x >= 22),
        *_each(
            "2 the same with a perfect roll",
            "(cap)",
            (r["first_dB"][0] for r in perfect.values()),
            lambda x: x >= 22,
        ),
        *_each(
            "2 first ramp, 2x-4x",
            ">= 27 dB",
            (min(r["first_dB"][1:4]) for r in own),
            lambda x: x >= 27,
        ),
        *_each(
            "2 first ramp, ripple",
            "<= 0.09",
            (r["first_ripple"] for r in own),
            lambda x: x <= 0.09,
            3,
        ),
        *_each("2 second ramp, 1x below a perfect roll", "<= 3 dB", gaps, lambda x: x <= 3, 1),
    ]


def _film(rows: Sequence[BenchRow]) -> list[Target]:
    """Judge the film line: a row's worst order of its steady part or of both its ramps.

    Orders that the line itself does not let go down show it with a perfect roll.
    """

    def of(law: str) -> list[BenchRow]:
        return [r for r in rows if r["section"] == "film" and r["law"] == law]

    return [
        *_each(
            "8 film, every order below 60 Hz, ramps included",
            ">= 20 dB",
            (min(r["worst_dB"]) for r in of(OWN)),
            lambda x: x >= 20,
        ),
        *_each(
            "8 the same with a perfect roll",
            "(cap)",
            (min(r["worst_dB"]) for r in of(PERFECT)),
            lambda x: x >= 20,
        ),
        *_each(
            "8 film, total ripple, ramps included",
            "<= 0.10",
            (max(r["ripple"]) for r in of(OWN)),
            lambda x: x <= 0.1,
            3,
        ),
    ]


def beaten(rows: Sequence[BenchRow]) -> list[tuple[BenchRow, float]]:
    """Return every row of a rival with less ripple than the shape law's, and the ratio."""
    judged = [r for r in rows if r["section"] in RIPPLE]
    own = {(r["section"], r["case"], r["seed"]): r for r in judged if r["law"] == OWN}
    found = []
    for r in judged:
        mine = own.get((r["section"], r["case"], r["seed"]))
        if r["law"] in RIVALS and mine is not None:
            ratio = r[RIPPLE[r["section"]]] / mine[RIPPLE[r["section"]]]
            if ratio < 1.0:
                found.append((r, float(ratio)))
    return found


def _ahead(rows: Sequence[BenchRow], own_rows: Sequence[BenchRow]) -> list[Target]:
    """Compare total ripple row by row; the same case and seed."""
    own = {(r["section"], r["case"]): r for r in own_rows if r["section"] in RIPPLE}
    found: list[Target] = []
    for law in RIVALS:
        ratios = [
            r[RIPPLE[r["section"]]] / own[(r["section"], r["case"])][RIPPLE[r["section"]]]
            for r in rows
            if r["law"] == law and (r["section"], r["case"]) in own
        ]
        found += _each(
            f"7 ripple of {law} over the shape law's",
            "> 1 in every row",
            ratios,
            lambda x: x >= 1.0,
            1,
        )
    return found
