"""Which idlers stand for others in a first look: those whose effects show at the same wavenumber.

A line answers what happens at one idler nearly as it answers the same at the next, at the same
wavenumber only: one of another radius is another wave, and is stood for by none.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.candidate import Candidate
from sim_plant.refine.spectra.coordinates import orders_of

SCREENING = CRITERIA.search.screening


@dataclass(frozen=True, slots=True, kw_only=True)
class LikeIdlers:
    """The idlers that hypotheses are at, along the web, by the wavenumber of what is tried there.

    Attributes
    ----------
    radius_m : of every idler of the line, by name, along the web.
    starts : least wavenumber of each group, rising, times 2 pi; 0 of what shows at none.
    idlers : names along the web, per group.
    """

    radius_m: dict[str, float]
    starts: tuple[float, ...]
    idlers: tuple[tuple[str, ...], ...]

    @classmethod
    def of(cls, hypotheses: Sequence[Hypothesis], line: Declaration) -> LikeIdlers:
        """Return the idlers of these hypotheses; load cells, always tried, do not count."""
        radius_m = {r.name: r.radius_m for r in line.rollers if r.kind == "idler"}
        bare = cls(radius_m=radius_m, starts=(), idlers=())
        tried = [h for h in hypotheses if h.location in radius_m and h.effect.place != "cell"]
        starts: list[float] = []
        for wave in sorted({bare._wave(h) for h in tried}):
            if not starts or wave > starts[-1] * (1.0 + CRITERIA.spectra.same_coordinate_share):
                starts.append(wave)
        there = {(bisect_right(starts, bare._wave(h)) - 1, h.location) for h in tried}
        idlers = (
            tuple(name for name in radius_m if (k, name) in there) for k in range(len(starts))
        )
        return cls(radius_m=radius_m, starts=tuple(starts), idlers=tuple(idlers))

    def _wave(self, h: Hypothesis) -> float:
        """Return the least wavenumber at which a hypothesis at an idler shows, times 2 pi, 1/m."""
        radius_m = self.radius_m[h.location]
        return min(orders_of(h, radius_m), default=0.0) / radius_m

    def beside(self, h: Hypothesis) -> tuple[str, ...]:
        """Return the idlers along the web at which what is tried shows as ``h`` does.

        None of an effect in a load cell, or elsewhere than at an idler.
        """
        if h.effect.place == "cell" or h.location not in self.radius_m:
            return ()
        return self.idlers[bisect_right(self.starts, self._wave(h)) - 1]

    def thinned(self, hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
        """Return the hypotheses at the middle one of every three like idlers, one of each group.

        Of few idlers at all of them, and always at load cells: an effect in one shows in its
        reading. Of an effect that is not tried at the middle ones, its own middle one.
        """
        if len({name for group in self.idlers for name in group}) <= SCREENING.few_idlers:
            return list(hypotheses)
        rows = [(self._group_of(h), h) for h in hypotheses]
        kept = {
            group: self._standing({h.location for s, h in rows if s == group}, group[1])
            for group, _ in rows
            if group is not None
        }
        return [h for group, h in rows if group is None or h.location in kept[group]]

    def _group_of(self, h: Hypothesis) -> tuple[str, tuple[str, ...]] | None:
        """Return effect and idlers among which a hypothesis is thinned; None: it is not."""
        idlers = self.beside(h)
        return (h.effect.name, idlers) if idlers else None

    @staticmethod
    def _standing(tried: set[str], idlers: Sequence[str]) -> set[str]:
        """Return the places among those ``tried`` that stand for like ``idlers``."""
        step = SCREENING.idler_step
        found = tried & set(idlers[step // 2 :: step] or idlers)
        own = [name for name in idlers if name in tried]
        return found or {own[len(own) // 2]}

    def neighbours(
        self, hypotheses: Sequence[Hypothesis], candidates: Sequence[Candidate]
    ) -> list[Hypothesis]:
        """Return hypotheses not tried yet near the two best places of their effect.

        Near along the web, and among the like idlers of that place. ``candidates`` are those
        tried, best first.
        """
        near: set[EffectAt] = set()
        by_name = sorted(candidates, key=lambda c: c.hypothesis.effect.name)
        for name, same in groupby(by_name, key=lambda c: c.hypothesis.effect.name):
            for c in list(same)[:2]:
                at = c.hypothesis.location
                worth = c.score > max(0.0, SCREENING.neighbour_share * candidates[0].score)
                if not worth or at not in self.radius_m:
                    continue
                for along in (tuple(self.radius_m), self.beside(c.hypothesis)):
                    near |= {EffectAt(name, other) for other in _within_reach(along, at)}
        done = {c.hypothesis.key for c in candidates}
        return [h for h in hypotheses if h.key in near and h.key not in done]


def _within_reach(along: Sequence[str], name: str) -> Sequence[str]:
    if name not in along:
        return ()
    at, reach = along.index(name), SCREENING.neighbour_reach
    return along[max(0, at - reach) : at + reach + 1]
