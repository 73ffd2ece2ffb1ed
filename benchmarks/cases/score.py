"""One verdict against its label, and many as shares with bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import stats

from benchmarks.cases.numbers import Declared, errors
from benchmarks.cases.outside import is_honest

Key = tuple[str, str]
WITHOUT_PLACE = "all"  # a label that stands for every place of its kind
SAME_PLACE: Mapping[str, str] = {"swrap": "swrap_lead"}
UNKNOWN_LINE = Declared()


@dataclass(frozen=True, slots=True, kw_only=True)
class Label:
    """What was hidden in a pair.

    Attributes
    ----------
    effects : per effect, every (effect, place) that counts as right.
    healthy, outside : no effect at all; one that no library holds.
    visible : whether the records show it.
    words : each effect with its place, as it was hidden.
    hidden : the entries of ``labels.yaml``, numbers and all.
    line : what the line's file says of numbers that an effect changes.
    """

    name: str
    effects: tuple[frozenset[Key], ...]
    healthy: bool
    outside: bool
    visible: bool
    words: tuple[str, ...] = ()
    hidden: tuple[Mapping[str, Any], ...] = field(default=(), repr=False)
    line: Declared = UNKNOWN_LINE

    @property
    def kind(self) -> str:
        """``healthy``, ``outside``, ``single`` or ``pair``."""
        if self.healthy or self.outside:
            return "healthy" if self.healthy else "outside"
        return "single" if len(self.effects) == 1 else "pair"


def label_of(case: Mapping[str, Any], line: Declared = UNKNOWN_LINE) -> Label:
    """Return the label of one entry of ``labels.yaml``.

    ``accept`` lists other places or other effects that count as right.
    """
    effects = []
    for effect in case["effects"]:
        name, place = effect["effect_class"], effect["location"]
        right = {(name, place), (name, SAME_PLACE.get(place, place))}
        for other in effect["accept"]:
            right |= {(name, other), (other, place)}
        effects.append(frozenset(right))
    return Label(
        name=case["case"],
        effects=tuple(effects),
        healthy=bool(case["healthy"]),
        outside=bool(case["outside"]),
        visible=bool(case["visible"]),
        words=tuple(f"{e['effect_class']} at {e['location']}" for e in case["effects"]),
        hidden=tuple(case["effects"]),
        line=line,
    )


def _key(text: str) -> Key:
    effect, _, place = text.partition(" at ")
    return effect, place


def named_sets(verdict: Mapping[str, Any]) -> list[frozenset[Key]]:
    """Return what a verdict claims: one set per effect, of one key where it is sure."""
    beside = {_key(row["effect"]): map(_key, row["with"]) for row in verdict.get("ambiguous", ())}
    found = []
    for row in verdict.get("effects", ()):
        key = row["effect"], row["location"]
        found.append(frozenset({key, *beside.get(key, ())}))
    return found


def outcome(label: Label, verdict: Mapping[str, Any]) -> str:
    """Return what a verdict came to.

    exact : every effect named, nothing else, each sure.
    set : the same with at least one named set that holds the true one.
    part : some of the effects, nothing wrong. wrong : something that is not there.
    unknown : honest, no effect named. nothing : nothing claimed. failed : no verdict.
    """
    if not verdict:
        return "failed"
    claims, left = named_sets(verdict), list(label.effects)
    wrong = False
    for claim in claims:
        hit = next((true for true in left if true & claim), None)
        if hit is None:
            wrong = True
        else:
            left.remove(hit)
    if wrong:
        return "wrong"
    if claims and not left:
        return "set" if any(len(claim) > 1 for claim in claims) else "exact"
    if claims:
        return "part"
    return "unknown" if verdict.get("unknown") else "nothing"


def is_right(label: Label, came_to: str) -> bool:
    """Return whether an outcome is the right one for this kind of case."""
    wanted = {"healthy": ("nothing",), "outside": ("unknown",)}
    return came_to in wanted.get(label.kind, ("exact", "set"))


def is_right_outside(label: Label, verdict: Mapping[str, Any]) -> bool:
    """Return whether a verdict tells class and coordinate of what no library holds."""
    return is_honest(label.hidden[0]["parameters"], verdict)


def number_errors(label: Label, verdict: Mapping[str, Any]) -> dict[str, float]:
    """Return by how much, in %, the numbers of a right single effect are off, by name."""
    if label.kind != "single" or not is_right(label, outcome(label, verdict)):
        return {}
    return errors(label.hidden[0], verdict, label.line)


def over_floor(verdict: Mapping[str, Any]) -> tuple[float, float] | None:
    """Return the worst tension's held-out error over its floor, before and after."""
    rows = [
        (row["before"] / row["noise_floor"], row["after"] / row["noise_floor"])
        for name, row in verdict.get("residual_rms", {}).items()
        if name.endswith("_N") and row["noise_floor"] > 0.0
    ]
    return (max(b for b, _ in rows), max(a for _, a in rows)) if rows else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Share:
    """Hits of tries, with the 95 % interval of Wilson."""

    hits: int
    tries: int

    def __str__(self) -> str:
        if not self.tries:
            return "0 of 0"
        low, high = stats.binomtest(self.hits, self.tries).proportion_ci(0.95, "wilson")
        share = 100.0 * self.hits / self.tries
        return f"{self.hits} of {self.tries} ({share:.0f} %, {100 * low:.0f} to {100 * high:.0f})"


def share_of(flags: Sequence[bool]) -> Share:
    """Return how many of ``flags`` are set."""
    return Share(hits=sum(flags), tries=len(flags))


def quantile_text(values: Sequence[float]) -> str:
    """Return median and 90 % quantile."""
    if not values:
        return "-"
    median, ninety = np.quantile(values, (0.5, 0.9))
    return f"{median:.3f} / {ninety:.3f}"
