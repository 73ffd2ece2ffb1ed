"""One self-contained HTML page for a process engineer who has to decide."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader

from aff_runtime.base.channel_units import unit_of_name
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.nuisances import declared_nuisances
from sim_plant.refine.report.figures import channels_by_error, overlay, spectrum, wavenumber_map
from sim_plant.refine.report.wording import (
    coordinate_text,
    location_words,
    number_rows,
    place_words,
    remedy,
    size_of,
)

if TYPE_CHECKING:
    from sim_plant.refine.judge.holdout import Evaluation
    from sim_plant.refine.report.outcome import Outcome
    from sim_plant.refine.report.verdict import Verdict


SHOWN_SHIFTS = 5
"""Declared numbers estimated anew that the page shows; it folds the others away."""


def headline(verdict: Verdict) -> str:
    """Return the verdict in a few sentences: what, where, how large."""
    if verdict.answer == "nothing":
        return "Nothing found: the declared line explains the record fitted to its noise."
    names = [
        place_words(e.place) + (f", {size_of(e)}" if size_of(e) else "") for e in verdict.effects
    ]
    text = "Traced: " + "; ".join(names) + "." if names else ""
    for item in verdict.unknown:
        said = coordinate_text(item.kind, item.coordinate)
        text += f" Unknown: {said}; no effect of the library explains it."
    for ambiguity in verdict.ambiguous:
        text += f" {place_words(ambiguity.place)} cannot be told from "
        text += f"{', '.join(map(place_words, ambiguity.alternatives))}."
        text += "".join(f" To tell: {what}." for what in ambiguity.experiments)
    return text.strip()


def confidence(verdict: Verdict) -> str:
    """Return how far each effect is ahead of what else might explain the record."""
    said = []
    for e in verdict.effects:
        text = f"{place_words(e.place)} scores {e.score:.0f}, "
        if e.runner_up:
            text += f"the next best explanation ({place_words(e.runner_up)}) "
            text += f"{e.score - e.margin:.0f}"
        else:
            text += "no other explains the record as well"
        said.append(text)
    return "; ".join(said) + ". A difference of 10 decides." if said else ""


def gain(judged: Evaluation, held: bool) -> str:
    """Return what the amended line explains: on the tension and the channel that gained most."""
    ranked = channels_by_error(judged)
    tensions = [k for k in ranked if judged.channels[k].endswith("_N")]
    where = "On the held-out record" if held else "On the record fitted (no proof)"
    said = []
    for at in dict.fromkeys([*tensions[:1], ranked[0]]):
        unit = unit_of_name(judged.channels[at])
        before, after, floor = judged.before[at], judged.after[at], judged.floor[at]
        said.append(
            f"the error in {judged.channels[at]} is {before:.3g} {unit} rms as declared, "
            f"{after:.3g} {unit} as amended; noise alone leaves {floor:.3g} {unit}"
        )
    return f"{where} {'. There '.join(said)}. {_left(judged, ranked)}"


def _left(judged: Evaluation, ranked: Sequence[int]) -> str:
    """Return which tensions and speeds hold more than noise as amended."""
    above = above_noise(judged, ranked)
    if not above:
        return "As amended, all tensions and speeds are within 10 % of noise."
    named = ", ".join(f"{name} (x {ratio:.2f})" for name, ratio in above.items())
    return f"As amended, more than 10 % above noise: {named}."


def above_noise(judged: Evaluation, ranked: Sequence[int]) -> dict[str, float]:
    """Return error over noise floor, as amended, of the tensions and speeds well above noise."""
    return {
        judged.channels[k]: float(judged.after[k] / judged.floor[k])
        for k in ranked
        if judged.after[k] >= CRITERIA.report.above_noise * judged.floor[k]
    }


def next_step(verdict: Verdict, block: bool, above: Collection[str] = ()) -> str:
    """Return what the reader may do now.

    Parameters
    ----------
    block : there is an AFF block to paste.
    above : channels that hold more than noise.
    """
    if verdict.ambiguous:
        return "Make the record that tells the candidates apart before anything is changed."
    what = [remedy(e.place.effect, location_words(e.place.location)) for e in verdict.effects]
    said = []
    if block:
        said.append(
            "Paste the AFF block below into the site file. The ripple of a cancelled roller "
            f"comes back when the service is off; to be rid of it: {'; '.join(what)}."
        )
    elif what:
        said.append(f"This is no ripple to cancel: {'; '.join(what)}.")
    if verdict.unknown:
        said.append(
            "Look for what turns or swings at that coordinate; the amended line does not "
            "contain it."
            if verdict.unknown[0].kind in ("time", "travel", "angle")
            else "Record again with more speeds and a tension step, and more channels."
        )
    if said:
        return " ".join(said)
    if above:
        return (
            f"Do not take the declaration for right: {', '.join(above)} above noise on the record "
            "judged. Fit that record and judge on the other."
        )
    return "Nothing to do: the declaration stands."


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


def shift_rows(
    corrections: Mapping[str, float], tolerances: Mapping[str, float]
) -> list[ShiftRow]:
    """Return declared numbers estimated anew, those first that used most of their tolerance."""
    rows = []
    for name, value in corrections.items():
        tolerance = tolerances.get(name, 0.0)
        factor, unit = 100.0, "%"
        if name.endswith((".offset", "_draw")):
            factor, unit = 1.0, "N" if name.endswith(".offset") else "(absolute)"
        rows.append(
            ShiftRow(
                name=name,
                shift=f"{factor * value:+.3g} {unit}",
                tolerance=f"{factor * tolerance:.3g} {unit}" if tolerance else "",
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


def error_rows(judged: Evaluation) -> list[ErrorRow]:
    """Return the error of every channel."""
    rows = zip(judged.channels, judged.before, judged.after, judged.floor, strict=True)
    return [ErrorRow(name=n, before=b, after=a, floor=f) for n, b, a, f in rows]


def write_report(outcome: Outcome, command: str, amended: Path | None, block: Path | None) -> Path:
    """Write ``report.html``; return its path."""
    judged, selection = outcome.evaluation, outcome.selection
    verdict, step_s = outcome.verdict, selection.travels[0].sample_time_s
    tolerances = {n.name: n.tolerance for n in declared_nuisances(outcome.declared)}
    above = above_noise(judged, channels_by_error(judged))
    template = Environment(
        loader=PackageLoader("sim_plant.refine.report", "."), autoescape=True
    ).get_template("page.html.j2")
    page = template.render(
        headline=headline(verdict),
        sure=confidence(verdict),
        gain=gain(judged, bool(outcome.plan.holdout)),
        next_step=next_step(verdict, block is not None, above),
        verdict=verdict,
        rows=error_rows(judged),
        command=command,
        limits=outcome.limits,
        records=outcome.records,
        held=outcome.plan.holdout,
        accepted=selection.accepted,
        angles=judged.angles_rad,
        unwound=judged.unwound_m,
        shifts=shift_rows(selection.corrections, tolerances),
        shown_shifts=SHOWN_SHIFTS,
        keys={key for e in verdict.effects for key in e.parameters},
        best_each=best_each,
        numbers=number_rows,
        place_words=place_words,
        location_words=location_words,
        above=CRITERIA.report.above_noise,
        block=block.read_text(encoding="utf-8") if block else "",
        amended=amended.name if amended else "",
        overlay=overlay(judged, step_s),
        order_map=wavenumber_map(judged, step_s),
        spectra=spectrum(
            selection.before[0], selection.after[0], CRITERIA.search.unexplained.periodic
        ),
    )
    path = outcome.plan.out / "report.html"
    path.write_text(page, encoding="utf-8")
    return path
