"""What was asked of the shape law, and what the rows say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

Row = dict[str, Any]
OWN = "shape-KF"


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """One line of the table of targets."""

    what: str
    asked: str
    reached: str
    met: str


def _met(share: float) -> str:
    return "yes" if share >= 1.0 else f"{100 * share:.0f} % of rows"


def _each(what: str, asked: str, values: Any, good: Any, digits: int = 0) -> Target:
    low, middle, high = (float(np.percentile(values, q, method="nearest")) for q in (0, 50, 100))
    text = f"min {low:.{digits}f}, median {middle:.{digits}f}, max {high:.{digits}f}"
    return Target(what=what, asked=asked, reached=text, met=_met(float(np.mean(good))))


def targets(rows: Sequence[Row]) -> list[Target]:
    """Return every target that the rows at hand can answer, both sets of seeds together."""
    own = [r for r in rows if r["law"] == OWN]
    found: list[Target] = []
    constant = [r for r in own if r["section"] == "constant"]
    if constant:
        found += _constant(constant)
        warm = [r["settle_turns"] for r in rows if r["law"] == "shape-KF, saved profile"]
        if warm:
            found.append(
                _each("1 from a saved profile, 20 dB", "2 turns", warm, [w <= 2 for w in warm], 1)
            )
    ramp = [r for r in own if r["section"] == "ramp"]
    if ramp:
        found += _ramp(ramp, rows)
    for name, rolls in (
        ("3 whole roll", [r for r in own if r["section"] == "roll" and "all5" not in r["case"]]),
    ):
        if rolls:
            v = [min(r["mean_dB"][:4]) for r in rolls]
            found.append(_each(f"{name}, mean 1x-4x", ">= 30 dB", v, [x >= 30 for x in v]))
            v = [r["ripple"] for r in rolls]
            found.append(_each(f"{name}, ripple", "<= 0.045", v, [x <= 0.045 for x in v], 3))
            v = [r["worst_5s"] for r in rolls]
            found.append(_each(f"{name}, worst 5 s", "<= 0.1", v, [x <= 0.1 for x in v], 3))
    both = [r for r in rows if r["law"] == "follower and unwind"]
    if both:
        v = [r["pullroll_1x_dB"] for r in both]
        found.append(_each("4 follower, pull-roll 1x", ">= 33 dB", v, [x >= 33 for x in v]))
        v = [r["unwind"] for r in both]
        found.append(_each("4 unwind tension meanwhile", "<= 1.0", v, [x <= 1 for x in v], 3))
    hidden = [r for r in own if r["section"] == "mismatch"]
    if hidden:
        v = [min(r["late_dB"][:2]) for r in hidden]
        found.append(_each("5 mismatch, 1x-2x", ">= 30 dB", v, [x >= 30 for x in v]))
        v = [min(r["late_dB"][2:4]) for r in hidden]
        found.append(_each("5 mismatch, 3x-4x", ">= 25 dB", v, [x >= 25 for x in v]))
        v = [r["ripple"] for r in hidden]
        found.append(_each("5 mismatch, no divergence", "ripple < 1", v, [x < 1 for x in v], 3))
    whole = [r["ripple"] for r in own if r["section"] == "roll" and "all5" in r["case"]]
    if whole:
        found.append(
            _each("5 whole roll, all five", "<= 0.1", whole, [x <= 0.1 for x in whole], 3)
        )
    peaks = [r["peak"] for r in own if "peak" in r]
    if peaks:
        found.append(_each("6 start-up peak", "<= 1.0", peaks, [p <= 1.0 for p in peaks], 2))
    found += _rivals(rows)
    for r in rows:
        if r["section"] == "timing":
            good = r["p50_us"] <= 250 and r["p99_us"] <= 500
            text = f"p50 {r['p50_us']:.0f}, p99 {r['p99_us']:.0f} us"
            found.append(
                Target(what=f"8 tick, {r['case']}", asked="p50 250, p99 500 us", reached=text,
                       met="yes" if good else "no")
            )  # fmt: skip
    return found


def _constant(constant: Sequence[Row]) -> list[Target]:
    v = [r["settle_turns"] for r in constant]
    found = [_each("1 cold, 20 dB on 1x-4x", "5 turns", v, [x <= 5 for x in v], 1)]
    middle = np.array([r["middle_dB"][:4] for r in constant]).ravel()
    reference = np.array([r["reference_dB"][:4] for r in constant]).ravel()
    there = np.isfinite(middle)
    middle, reference = middle[there], reference[there]
    found.append(_each("1 turns 10-20, each of 1x-4x", ">= 30 dB", middle, middle >= 30.0))
    share = float(np.mean(middle >= reference))
    found.append(
        Target(what="1 turns 10-20 at the noise reference", asked="70 % of orders",
               reached=f"{100 * share:.0f} %", met="yes" if share >= 0.7 else "no")
    )  # fmt: skip
    late = np.array([r["late_dB"][:4] for r in constant]).ravel()
    found.append(_each("1 later, each of 1x-4x", ">= 35 dB", late, late >= 35.0))
    ripple = np.array([r["ripple"] for r in constant])
    found.append(_each("1 total ripple", "<= 0.10", ripple, ripple <= 0.10, 3))
    median = float(np.median(ripple))
    met = "yes" if median <= 0.05 else "no"
    found.append(
        Target(what="1 total ripple, median", asked="<= 0.05", reached=f"{median:.3f}", met=met)
    )
    return found


def _ramp(ramp: Sequence[Row], rows: Sequence[Row]) -> list[Target]:
    clean = [r for r in ramp if "all5" not in r["case"]]
    found = []
    if clean:
        v = [r["first_dB"][0] for r in clean]
        found.append(_each("2 first ramp, 1x", ">= 22 dB", v, [x >= 22 for x in v]))
        v = [min(r["first_dB"][1:4]) for r in clean]
        found.append(_each("2 first ramp, 2x-4x", ">= 27 dB", v, [x >= 27 for x in v]))
        v = [r["first_ripple"] for r in clean]
        found.append(_each("2 first ramp, ripple", "<= 0.09", v, [x <= 0.09 for x in v], 3))
        perfect = {(r["case"].split(" R")[0], r["case"], r["seed"]): r["second_dB"][0]
                   for r in rows if r["law"] == "perfect roll"}  # fmt: skip
        gaps = [
            perfect[(r["case"].split(" R")[0], r["case"], r["seed"])] - r["second_dB"][0]
            for r in clean
        ]
        found.append(_each("2 second ramp, 1x below a perfect roll", "<= 3 dB", gaps,
                           [g <= 3 for g in gaps], 1))  # fmt: skip
    spoilt = [min(r["first_dB"][:2]) for r in ramp if "all5" in r["case"]]
    if spoilt:
        found.append(_each("5 ramp, all five, 1x-2x", ">= 18 dB", spoilt,
                           [x >= 18 for x in spoilt]))  # fmt: skip
    return found


def _rivals(rows: Sequence[Row]) -> list[Target]:
    """Compare total ripple row by row; the same case and seed."""
    key = {"constant": "ripple", "mismatch": "ripple", "roll": "ripple", "ramp": "first_ripple"}
    own = {(r["section"], r["case"], r.get("seed")): r for r in rows if r["law"] == OWN}
    found = []
    passed = {OWN, "oracle", "perfect roll", "shape-KF, saved profile", "shape-KF, no S-wrap"}
    for law in dict.fromkeys(r["law"] for r in rows if r["section"] in key):
        if law in passed:
            continue
        ratios = [
            r[key[r["section"]]] / own[(r["section"], r["case"], r["seed"])][key[r["section"]]]
            for r in rows
            if r["law"] == law and (r["section"], r["case"], r.get("seed")) in own
        ]
        spread = f"{min(ratios):.2f} to {max(ratios):.0f}, median {np.median(ratios):.1f}"
        text = f"{law} leaves {spread} times its ripple"
        share = float(np.mean([x >= 1.0 for x in ratios]))
        found.append(
            Target(what=f"7 ahead of {law}", asked="every row", reached=text, met=_met(share))
        )
    return found
