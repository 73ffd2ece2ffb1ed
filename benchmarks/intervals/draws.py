"""Effects of known numbers, drawn as the campaign draws them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.campaign.cases import Case, draw_fault
from benchmarks.campaign.effect_row import EffectRow, Form, truth
from benchmarks.campaign.effect_table import BY_NAME, LIBRARY
from benchmarks.campaign.work import web_at_moments

SIZES = (5.0, 1.5)
"""Times the size that the campaign begins with, round after round."""


def forms() -> list[tuple[EffectRow, int, Form]]:
    """Return every form of every effect of the library of whose size something is told."""
    return [
        (row, turn, form)
        for row in LIBRARY
        for turn, form in enumerate(row.forms)
        if row.name != "out_of_round_roll"
    ]


def drawn(turn: int, at: int) -> Case:
    """Return draw ``at`` of a round, one effect of known numbers."""
    row, form_turn, form = forms()[at]
    rng = np.random.default_rng([turn, at])
    fault = draw_fault(rng, row.name, form_turn)
    wanted = abs(fault.size) * SIZES[turn % len(SIZES)]
    size = min(max(wanted, form.least), form.largest)
    if form.step:
        size = form.step * max(1, round(size / form.step))
    fault = replace(fault, size=math.copysign(size, fault.size))
    return Case(number=at, group="interval", seed=1000 * turn + at, faults=(fault,))


def draws(rounds: int, only: str) -> Iterator[tuple[str, Case]]:
    """Yield the draws asked for by name."""
    for turn in range(rounds):
        for at, (row, form_turn, _) in enumerate(forms()):
            name = f"{turn}-{at:02d}-{row.name}-{form_turn}"
            if only in name:
                yield name, drawn(turn, at)


def true_numbers(case: Case) -> dict[str, float]:
    """Return what is true of the effect's numbers, by their names in a verdict."""
    (fault,) = case.faults
    told = {name: float(value) for name, (value, _) in truth(BY_NAME[fault.effect], fault).items()}
    for name, value in fault.numbers:
        told.setdefault(name, value)
    if fault.from_s >= 0.0:
        told |= {"from_s": fault.from_s, "at_length_m": web_at_moments(case, case.faults)["0"][0]}
    return told
