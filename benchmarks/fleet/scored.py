"""What a look told, beside what its line hides."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.fleet.example import FIRST_DAY, GROWTH, grown
from sim_plant.fleet.findings import Finding, findings_of
from sim_plant.fleet.refine_look import LookResult
from sim_plant.line.declared.declaration import EffectEntry
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.verdict import Verdict

FATES = ("named", "one of several", "beside others", "another", "unknown", "missed", "failed")
QUIET, CLAIMED = "nothing", "claimed"
"""Of a healthy line: nothing was said of it, or anything."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scored:
    """One look: its result and the effect that its records have, of the size of that day."""

    result: LookResult
    hidden: EffectEntry | None

    @property
    def fate(self) -> str:
        """What became of the hidden effect, one of ``FATES``; of a healthy line see there."""
        verdict = self.result.verdict
        if verdict is None:
            return "failed"
        if self.hidden is None:
            return QUIET if verdict.answer == "nothing" else CLAIMED
        return fate_of(verdict, EffectAt(self.hidden.effect, self.hidden.location))

    @property
    def findings(self) -> list[Finding]:
        """The rows of the fleet's table."""
        return list(findings_of(self.result))

    @property
    def holds(self) -> bool | None:
        """Whether the interval of a rightly named size holds the true one; None: none is told."""
        if self.hidden is None or self.fate not in ("named", "one of several"):
            return None
        for found in self.findings:
            same = (found.effect, found.place) == (self.hidden.effect, self.hidden.location)
            if same and math.isfinite(found.size_low) and math.isfinite(found.size_high):
                return found.size_low <= true_size(self.hidden, found) <= found.size_high
        return None


def fate_of(verdict: Verdict, true: EffectAt) -> str:
    """Return what a verdict makes of a line with the effect ``true``.

    ``one of several``: it, or what the verdict cannot tell from it, is all that is named.
    ``beside others``: it is named, and something that is not there. ``another``: only such.
    """
    said = {found.place for found in verdict.effects}
    alike = {a.place for a in verdict.ambiguous if true in (a.place, *a.alternatives)}
    if not said:
        return "unknown" if verdict.unknown else "missed"
    if not verdict.names(true):
        return "another"
    if said - {true} - alike or verdict.unknown:
        return "beside others"
    return "one of several" if alike or verdict.answer != "traced" else "named"


def true_size(hidden: EffectEntry, told: Finding) -> float:
    """Return the true value of the number that a finding tells."""
    given = hidden.parameters
    for pair in BY_NAME[hidden.effect].quadratures:
        if pair.amplitude and pair.amplitude == told.number:
            return math.hypot(float(given[pair.cos]), float(given[pair.sin]))
    return float(given[told.number])


def in_order(hidden: EffectEntry | None, results: Sequence[LookResult]) -> list[Scored]:
    """Return the looks of one line, the effect of each as large as on its day."""
    found = []
    for result in sorted(results, key=lambda result: result.recorded):
        weeks = (date.fromisoformat(result.recorded) - FIRST_DAY).days // 7
        found.append(Scored(result=result, hidden=grown(hidden, GROWTH**weeks)))
    return found
