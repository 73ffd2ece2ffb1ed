"""What is said beside a verdict: what cannot be claimed, and what is odd about records."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.nuisances import declared_nuisances, effective_radius_of
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.search.selection import Selection


def holdout_caveats(held: Sequence[Recording]) -> list[str]:
    """Return what the number of held-out records keeps from being claimed, as sentences."""
    if not held:
        return ["no held-out record: the error after is that of the record fitted"]
    if len(held) > 1:
        return [f"more than one held-out record: the errors are those of {held[0].path.name}"]
    return []


def shared_angle(fitted: Sequence[Recording]) -> list[str]:
    """Return what several fitted records keep from being claimed, as sentences.

    Every record begins with its rolls elsewhere; the fit has one start angle of an effect for all.
    """
    if len(fitted) < 2:
        return []
    names = " and ".join(record.path.name for record in fitted)
    return [
        f"{names} are fitted with one start angle per effect: what turns with a roller is found "
        "only where it began alike in all; give one of them, and hold another out"
    ]


def radii_of_profiles(selection: Selection, line: Declaration) -> list[str]:
    """Return which rolls with a profile may have a wrong radius as well, as sentences.

    The mean radius of a roll that is out of round is its profile's own: what moves its effective
    radius beyond tolerance is that mean, or a radius error of its drive.
    """
    known = {n.name: 0.5 * n.tolerance for n in declared_nuisances(line)}
    furthest = CRITERIA.search.degeneracy.outside_prior_sd
    said = []
    for h in (a.hypothesis for a in selection.accepted):
        number = effective_radius_of(h.location)
        if h.effect.profiles is None or number not in known:
            continue
        change = selection.adjustments.get(number, 0.0)
        if abs(change) > furthest * known[number]:
            said.append(
                f"a wrong radius in drive {h.location}: its effective radius is "
                f"{100.0 * change:+.2g} % off, beyond tolerance, which may be the mean of its "
                "profile as well"
            )
    return said


def announce(
    caveats: Iterable[str], records: Iterable[Recording], progress: Callable[[str], None]
) -> None:
    """Say what cannot be claimed and what was found about every record."""
    for text in caveats:
        progress(f"cannot be claimed: {text}")
    for record in records:
        for text in record.findings:
            progress(f"{record.path.name}: {text}")
