"""The tables of the page: errors, declared numbers as estimated anew, what was rejected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.plots import is_angle_or_radius
from sim_plant.refine.report.wording import shift_text

DIGITS = 2
"""Of a ratio as the page writes it: what rounds to a limit is not told as beyond it."""


def is_above(ratio: float) -> bool:
    """Return whether an error over its noise floor is told as above noise."""
    return round(ratio, DIGITS) > CRITERIA.report.above_noise


def above_noise(judged: Evaluation, ranked: Sequence[int]) -> dict[str, float]:
    """Return error over noise floor, as amended, of the tensions and speeds well above noise."""
    return {
        judged.channels[k]: float(judged.rms_amended[k] / judged.floor[k])
        for k in ranked
        if is_above(float(judged.rms_amended[k] / judged.floor[k]))
    }


def best_each(rejected: Sequence[tuple[EffectAt, float]]) -> list[tuple[EffectAt, float]]:
    """Return the best score of each effect and place: some were tried in several forms."""
    best: dict[EffectAt, float] = {}
    for place, score in rejected:
        best[place] = max(score, best.get(place, score))
    return list(best.items())


@dataclass(frozen=True, slots=True, kw_only=True)
class ShiftRow:
    """A declared number estimated anew; ``used``: share of its tolerance."""

    name: str
    shift: str
    tolerance: str
    used: float

    @property
    def is_far(self) -> bool:
        """Whether it is surely beyond its tolerance, if it has one."""
        return round(self.used, DIGITS) >= CRITERIA.report.outside_tolerance


def shift_rows(
    adjustments: Mapping[str, float], tolerances: Mapping[str, float]
) -> list[ShiftRow]:
    """Return declared numbers estimated anew, those first that used most of their tolerance."""
    rows = []
    for name, value in adjustments.items():
        tolerance = tolerances.get(name, 0.0)
        rows.append(
            ShiftRow(
                name=name,
                shift=shift_text(name, value),
                tolerance=shift_text(name, tolerance).lstrip("+") if tolerance else "",
                used=abs(value) / tolerance if tolerance else 0.0,
            )
        )
    return sorted(rows, key=lambda row: (-row.used, row.name))


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorRow:
    """Error of one channel, rms, and over its noise floor."""

    name: str
    before: float
    after: float
    floor: float

    @property
    def was(self) -> float:
        """Before over floor."""
        return self.before / self.floor if self.floor else 0.0

    @property
    def ratio(self) -> float:
        """After over floor."""
        return self.after / self.floor if self.floor else 0.0

    @property
    def mark(self) -> str:
        """How the page shows the ratio: within noise, above it, or grey: it does not count."""
        if is_angle_or_radius(self.name):
            return "sum"
        return "miss" if is_above(self.ratio) else "ok"


def error_rows(judged: Evaluation) -> list[ErrorRow]:
    """Return the error of every channel."""
    rows = zip(judged.channels, judged.rms_declared, judged.rms_amended, judged.floor, strict=True)
    return [ErrorRow(name=n, before=b, after=a, floor=f) for n, b, a, f in rows]
