"""Ripple with the correction off and on, at the plant itself, beside what the card says."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from aff_runtime.app.card.entries import Measured
from aff_runtime.app.card.measure.proof import corrected
from aff_runtime.app.card.work import CardFile
from aff_runtime.config.models import Site
from benchmarks.wizard.playing import Pair
from sim_plant.base.arrays import Array
from sim_plant.base.order_tracking import order_amplitudes, reduction_dB
from sim_plant.demo.evaluation import window

ROLLS = ("unwind", "swrap_follower")
TOGETHER = ": all corrected orders together"


def ripple_N(part: Mapping[str, Array], site: Site, signal: str) -> float:
    """Return the root of the sum of squares of a tension's corrected orders, without noise."""
    square = 0.0
    keys = corrected(site)
    for roll in ROLLS:
        orders = sorted(order for of, name, order in keys if (of, name) == (signal, roll))
        if not orders:
            continue
        others = {one: part[f"true_{one}_angle_rad"] for one in ROLLS if one != roll}
        found = order_amplitudes(
            part[f"true_{signal}"], part[f"true_{roll}_angle_rad"], orders, others
        )
        square += float(np.sum(np.abs(found) ** 2))
    return math.sqrt(square)


def judged(
    record: dict[str, Array], pairs: Sequence[Pair], site: Site
) -> dict[str, dict[str, float]]:
    """Return by tension its ripple off and on, N, as means of the pairs, and the reduction, dB."""
    found = {}
    for signal in sorted({key[0] for key in corrected(site)}):
        off, on = (
            math.exp(
                sum(math.log(ripple_N(window(record, *span), site, signal)) for span in spans)
                / len(pairs)
            )
            for spans in ([pair.off for pair in pairs], [pair.on for pair in pairs])
        )
        found[signal] = {"off_N": off, "on_N": on, "dB": reduction_dB(off, on)}
    return found


def card_says(card: Path) -> dict[str, float]:
    """Return by tension what step 12 of a card has measured last, dB."""
    said = [one.content for one in CardFile.of(card).entries]
    proofs = [one for one in said if isinstance(one, Measured) and one.step == 12]
    figures = proofs[-1].result.figures if proofs else ()
    return {one.name.partition(":")[0]: one.value for one in figures if TOGETHER in one.name}
