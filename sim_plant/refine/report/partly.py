"""What a verdict leaves although every effect it found is named."""

from __future__ import annotations

from aff_runtime.base.channel_units import unit_of_name
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.report.facts import NOTHING_KNOWN, RefineFacts
from sim_plant.refine.report.verdict import Verdict


def misses(verdict: Verdict) -> list[str]:
    """Return the tensions that the amended line leaves well above their noise, the worst first.

    Equation: (after / floor)^2 - 1 >= ``missed_power``  [own].
    """
    power = {
        name: (error.after / error.noise_floor) ** 2 - 1.0
        for name, error in verdict.residual_rms.items()
        if name.endswith("_N") and error.noise_floor > 0.0
    }
    missed = [name for name, beyond in power.items() if beyond >= CRITERIA.report.missed_power]
    return sorted(missed, key=lambda name: -power[name])


def is_incomplete(facts: RefineFacts) -> bool:
    """Return whether more declared numbers left their tolerance than are worth a look each."""
    return len(facts.far) > CRITERIA.report.named_numbers


def incomplete(facts: RefineFacts) -> str:
    """Return how many declared numbers left their tolerance, as part of a sentence."""
    return f"{len(facts.far)} of {len(facts.shifts)} declared numbers had to leave their tolerance"


def partly(verdict: Verdict, facts: RefineFacts = NOTHING_KNOWN) -> str:
    """Return what a model that names all its effects still misses, a sentence; "" if nothing."""
    if not verdict.effects or verdict.answer not in ("traced", "not_identifiable"):
        return ""
    missed = misses(verdict)
    said = [incomplete(facts)] if is_incomplete(facts) else []
    if missed:
        error, unit = verdict.residual_rms[missed[0]], unit_of_name(missed[0])
        said = [
            f"{missed[0]} still misses by {error.after:.2g} {unit} "
            f"(noise {error.noise_floor:.2g} {unit})",
            *said,
        ]
    if not said:
        return ""
    what = "the places stand" if len(verdict.effects) > 1 else "the place stands"
    what = "what was found stands" if verdict.ambiguous else what
    return f"Partly: {', and '.join(said)}; {what}, the numbers do not."
