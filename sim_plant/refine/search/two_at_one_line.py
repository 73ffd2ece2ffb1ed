"""Two effects at one spectral line: what one leaves of it, a second one explains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.search.candidate import Progress
from sim_plant.refine.search.completeness import leaves_much, remaining_spectra
from sim_plant.refine.search.degenerate_pair import best_pair, same_wavenumbers
from sim_plant.refine.search.effect_fit import profile_reinitialised
from sim_plant.refine.search.one_more import best_of, explains_own_lines
from sim_plant.refine.search.selection import ACCEPTANCE, Extension, Selection, alike_margin
from sim_plant.refine.spectra.coordinates import rolls_along


def two_at_one_line(
    objective: Objective,
    selection: Selection,
    half: Extension,
    others: Sequence[Hypothesis],
    periodic: Sequence[Hypothesis],
    progress: Progress,
) -> tuple[Extension, ...]:
    """Return two effects that together leave nothing of the line of which ``half`` leaves much.

    ``half`` with one that is not periodic, with the same at another place (hum on two cells is
    one spectral line in time), or with another at the same place: a motor's ripple stands on the
    orders of its roll. What rolls on a body has a radius of its own: two of one radius at two
    places would be a coincidence, and their sum imitates any roller that nobody declared.

    Rollers of one radius are one line in travel, whatever is wrong with each of them: an idler
    that is off its centre and another that is out of balance. Alone, neither need be what
    explains most: two of them are looked for together. One that is not periodic and leaves much
    is taken only where they leave as much.
    """
    axes, h = selection.record_axes[0], half.hypothesis
    alike = [x for x in periodic if same_wavenumbers(axes, h, x)]
    rest = [x for x in periodic if x not in alike and x.key != h.key]
    elsewhere = [x for x in rest if x.effect.name == h.effect.name and not rolls_along(x)]
    beside = [x for x in rest if x.effect.name != h.effect.name and x.location == h.location]
    fallback: tuple[Extension, ...] = ()
    for group in (others, elsewhere, beside):
        second = _second(objective, selection, half, group, progress, beside_half=group is beside)
        if second is None:
            continue
        if not leaves_much(objective, selection.fit, second.fit):
            return half, second
        if group is others:
            fallback = half, second
        else:
            progress("  two of them leave too much: not accepted")
    return _rollers(objective, selection, [h, *alike], progress) or fallback


def _rollers(
    objective: Objective, selection: Selection, alike: Sequence[Hypothesis], progress: Progress
) -> tuple[Extension, ...]:
    """Return the two of effects of one wavenumber that explain most together, or none."""
    pair = best_pair(objective, selection.fit, alike)
    if pair is None:
        return ()
    progress(f"trying {' and '.join(str(h.key) for h in pair.two)} together")
    first = best_of(objective, selection, pair.two[:1], progress)
    if first is None:
        return ()
    second = _second(objective, selection, first, pair.two[1:], progress, beside_half=True)
    if second is None or leaves_much(objective, selection.fit, second.fit):
        progress("  two of them leave too much: not accepted")
        return ()
    margin = alike_margin(selection.fit.cost - second.fit.cost)
    one, other = (
        with_rivals(e, behind, margin)
        for e, behind in zip((first, second), pair.behind, strict=True)
    )
    return one, other


def with_rivals(
    extension: Extension, behind: Sequence[tuple[EffectAt, float]], margin: float
) -> Extension:
    """Return the extension with its rivals: places, and by how much (chi2) each is ``behind``.

    Those behind by less than ``margin`` are named with it.
    """
    found = extension.accepted
    rows = [(place, found.score - less) for place, less in behind]
    named = [place for place, less in behind if less < margin]
    told = replace(
        found,
        runner_up=rows[0][0] if rows else found.runner_up,
        margin=found.score - max(rows[0][1], 0.0) if rows else found.margin,
        rejected=(*rows, *found.rejected)[: ACCEPTANCE.reported_rejected],
        ambiguous=tuple(dict.fromkeys([*found.ambiguous, *named])),
    )
    return replace(extension, accepted=told)


def _second(
    objective: Objective,
    selection: Selection,
    half: Extension,
    group: Sequence[Hypothesis],
    progress: Progress,
    *,
    beside_half: bool,
) -> Extension | None:
    """Return the effect of a group that, given ``half``, leaves nothing of its spectral line."""
    if not group:
        return None
    progress(f"trying a second effect beside {half.hypothesis.key}")
    after = remaining_spectra(objective, half.fit, selection.record_axes)
    with_half = replace(selection, fit=half.fit, spectra_left=after)
    second = best_of(objective, with_half, group, progress, beside_half=beside_half)
    if second is None:
        return None
    fit = profile_reinitialised(objective, second.fit)
    there = explains_own_lines(objective, selection, fit)
    return replace(second, fit=fit) if there else None
