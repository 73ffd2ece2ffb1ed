"""Forward selection: a residual is traced to effects, one after another, against free terms.

One round is screen -> fit -> score -> accept (`one_more.best_of`); every step is a function of
values.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit, nominal_fit
from sim_plant.refine.fit.objective import Objective, conditioned_on, with_free_numbers
from sim_plant.refine.fit.roll_synchronisation import synchronised, synchronising_shifts
from sim_plant.refine.model.hypotheses import Hypothesis
from sim_plant.refine.model.parameter_effects import equivalents
from sim_plant.refine.search.added_effect import rolling_only
from sim_plant.refine.search.candidate import Progress
from sim_plant.refine.search.completeness import remaining_spectra, sure_excess
from sim_plant.refine.search.events import event_candidates
from sim_plant.refine.search.exchange import exchanged, joined, pruned, with_rivals_at_own_line
from sim_plant.refine.search.free_terms import (
    PERIODIC_CLASSES,
    explained_by_free_term,
    free_term_basis,
    goes_free,
)
from sim_plant.refine.search.number_ranges import with_number_ranges
from sim_plant.refine.search.one_more import best_of, explains_own_lines, looked_from
from sim_plant.refine.search.one_thing import told_as, whole_of
from sim_plant.refine.search.outside_prior import fit_conflicts, joint_conflict, total_shifts
from sim_plant.refine.search.placed_events import placed_anew, with_moment_refined
from sim_plant.refine.search.profile_detail import joint_refit
from sim_plant.refine.search.remainder import classified, shown_before
from sim_plant.refine.search.screening import by_periodic_chi2
from sim_plant.refine.search.selection import (
    Extension,
    Selection,
    at_noise_floor,
    later_score,
    least_beside,
    preferred,
    standing,
)
from sim_plant.refine.search.set_apart import own_spectral_lines, set_apart, wander_of
from sim_plant.refine.search.two_at_one_line import two_at_one_line
from sim_plant.refine.search.unexplained import Unknown, heard
from sim_plant.refine.spectra.aliases import with_aliases, with_orders, with_radii, with_resonances
from sim_plant.refine.spectra.coordinates import axes_of, is_periodic

ACCEPTANCE = CRITERIA.search.acceptance


def forward_selection(
    objective: Objective,
    library: Sequence[Hypothesis],
    progress: Progress,
    without: Collection[str] = (),
) -> Selection:
    """Return effects that explain the records, and what remains unexplained.

    A spectral line that no effect explains becomes a free term, a declared number beyond its
    tolerance goes free, and the whole search is made again beside them: an effect is claimed only
    for what those cannot explain, and none at the coordinate of a term or that says the same as
    the number. What is unknown is told as one thing where it is (`whole_of`). ``without`` are
    effects that ``library`` leaves out.
    """
    first = selection = select(objective, library, progress, without)
    whole = whole_of(objective, first)
    known: tuple[Unknown, ...] = ()
    for _ in range(ACCEPTANCE.most_free_terms):
        fresh = [u for u in selection.unknown if goes_free(u) and u not in known]
        if not fresh or (whole is not None and any(u.declared for u in fresh)):
            break
        known = (*known, *fresh)
        named = ", ".join(u.text for u in fresh)
        progress(f"no effect explains {named}: searching beside a free term")
        further = _beside(objective, library, known, first, progress, without)
        more = [u for u in further.unknown if not any(u.same_roll_as(t) for t in known)]
        # before: with the lines that are now free terms, for the report
        selection = replace(
            further,
            unknown=(*known, *more),
            spectra_declared=first.spectra_declared,
            heard_declared=first.heard_declared,
        )
    if whole is None:
        return _without_needless_numbers(objective, selection, progress)
    progress(f"all of it is one thing: {whole.text}")
    told = replace(told_as(whole, selection), adjustments={})
    return _taken_back(objective, told, progress)


def _beside(
    objective: Objective,
    library: Sequence[Hypothesis],
    known: Sequence[Unknown],
    first: Selection,
    progress: Progress,
    without: Collection[str],
) -> Selection:
    """Return what is found where spectral lines and declared numbers of ``known`` are free.

    How much of what was left a number takes up is not known before: it counts as all of it.
    """
    numbers = {u.declared for u in known if u.declared}
    lines = [u for u in known if not u.declared]
    taken_up = sum(term.chi2_reduction for term in lines)
    target = objective
    if numbers:
        target = with_free_numbers(objective, numbers)
        taken_up += first.fit.cost - objective.expected_cost
    if lines:
        basis = [free_term_basis(lines, axes) for axes in first.record_axes]
        target = conditioned_on(target, basis)
    line = objective.pool.twins[0].declaration
    same = {(e.effect.name, e.location) for e in equivalents(line) if e.number in numbers}
    rest = [
        h
        for h in library
        if (h.effect.name, h.location) not in same
        and not explained_by_free_term(h, lines, first.record_axes[0])
    ]
    found = select(target, rest, progress, without, chi2_of_free_terms=taken_up)
    return replace(found, adjustments={}) if numbers else found


def _without_needless_numbers(
    objective: Objective, selection: Selection, progress: Progress
) -> Selection:
    """Return the selection without free numbers that its effects make needless.

    They are where all that is unknown are such numbers, and the effects, fitted with every
    tolerance, leave nothing.
    """
    fit = selection.fit
    if not selection.accepted or not selection.unknown:
        return selection
    if not all(u.declared for u in selection.unknown):
        return selection
    near, again = joint_refit(objective, replace(fit, shifts=rolling_only(fit.shifts)))
    seen = classified(near, replace(selection, fit=again, unknown=()))
    if seen.unknown or joint_conflict(near, again) is not None:
        return selection
    progress("beside the effects no declared number has to leave its tolerance")
    return replace(seen, adjustments=total_shifts(near, again))


def select(
    objective: Objective,
    library: Sequence[Hypothesis],
    progress: Progress,
    without: Collection[str] = (),
    chi2_of_free_terms: float = 0.0,
) -> Selection:
    """Return the effects found one after another, and what is left then."""
    start = nominal_fit(objective, synchronising_shifts(objective, {}))
    objective, nominal = joint_refit(objective, start)
    selection = _nothing_yet(objective, synchronised(objective, nominal), chi2_of_free_terms)
    for _ in range(ACCEPTANCE.most_effects):
        extensions = next_extensions(objective, selection, library, progress, without)
        if not extensions:
            break
        progress("all numbers together, at the declared drive tick")
        extended = with_moment_refined(objective, extensions[-1].fit)
        objective, fit = joint_refit(objective, extended)
        if selection.accepted:
            objective, fit = _with_events_placed_anew(objective, fit, progress)
        selection = replace(
            selection,
            fit=fit,
            accepted=(*selection.accepted, *(e.accepted for e in extensions)),
            spectra_left=remaining_spectra(objective, fit, selection.record_axes),
        )
        quiet = at_noise_floor(selection, objective.expected_cost, sure_excess(objective))
        if quiet and not own_spectral_lines(selection):
            break
    selection = looked_over(objective, selection, progress)
    selection = _with_remainder(objective, selection, progress)
    if selection.accepted:
        progress("between which ends the numbers lie")
    return with_number_ranges(objective, selection)


def _with_events_placed_anew(
    objective: Objective, fit: Fit, progress: Progress
) -> tuple[Objective, Fit]:
    moved = placed_anew(objective, fit)
    if moved is fit:
        return objective, fit
    progress("an event is placed anew beside the others")
    return joint_refit(objective, moved)


def looked_over(objective: Objective, selection: Selection, progress: Progress) -> Selection:
    """Return the selection with its effects at their best places, without those not missed."""
    if not selection.accepted:
        return selection
    if len(selection.accepted) == 1:
        return with_rivals_at_own_line(objective, selection)
    progress("every effect elsewhere, and without it, beside the others")
    before = selection.fit.hypotheses
    selection = joined(objective, selection, progress)
    selection = pruned(objective, exchanged(objective, selection, progress), progress)
    if selection.fit.hypotheses == before:
        return selection
    near, fit = joint_refit(objective, selection.fit)
    return replace(
        selection, fit=fit, spectra_left=remaining_spectra(near, fit, selection.record_axes)
    )


def _nothing_yet(objective: Objective, nominal: Fit, chi2_of_free_terms: float) -> Selection:
    """Return the selection without an effect."""
    rows = zip(objective.pool.twins, objective.measured, objective.whitening.noise, strict=True)
    record_axes = tuple(axes_of(twin, y, nominal.case, noise.first) for twin, y, noise in rows)
    spectra = remaining_spectra(objective, nominal, record_axes)
    return Selection(
        nominal=nominal,
        fit=nominal,
        record_axes=record_axes,
        spectra_declared=spectra,
        spectra_left=spectra,
        chi2_of_free_terms=chi2_of_free_terms,
        heard_declared=tuple(heard(objective, nominal, record_axes)),
    )


def _with_remainder(objective: Objective, selection: Selection, progress: Progress) -> Selection:
    """Return the selection with what is left classified, and declared numbers put right.

    Effects that are not periodic are taken back when structure is left that is no spectral line.
    Without a coordinate of its own such an effect is known only by how well it fits: one that
    leaves more than noise has at best imitated the cause. So are periodic ones that explain little
    of what is left then: what is irregular has a share at every line.
    """
    selection = classified(objective, selection)
    if all(u.unknown_class in PERIODIC_CLASSES for u in selection.unknown):
        if not selection.accepted:
            return selection
        return replace(selection, adjustments=total_shifts(objective, selection.fit))
    fewer = _taken_back(objective, selection, progress)
    return selection if fewer is selection else classified(objective, fewer)


def _taken_back(objective: Objective, selection: Selection, progress: Progress) -> Selection:
    """Return the selection without effects that may imitate structure that is no line.

    Those stay that a record shows before an event begins.
    """
    fit = selection.fit
    kept = standing(selection.accepted, objective.excess(fit.cost, fit.residual))
    kept = sorted({*kept, *shown_before(objective, selection)})
    if len(kept) == len(fit.hypotheses):
        return selection
    progress("structure is left that is no line: effects that are none are taken back")
    rest = gauss_newton_fit(
        objective,
        [fit.hypotheses[k] for k in kept],
        [fit.values[k] for k in kept],
        fit.shifts,
        rounds=CRITERIA.fit.rounds_near,
        quick=False,
    )
    return replace(
        selection,
        fit=rest,
        accepted=tuple(selection.accepted[k] for k in kept),
        spectra_left=remaining_spectra(objective, rest, selection.record_axes),
        ranges=tuple(selection.ranges[k] for k in kept) if selection.ranges else (),
    )


def next_extensions(
    objective: Objective,
    selection: Selection,
    library: Sequence[Hypothesis],
    progress: Progress,
    without: Collection[str] = (),
) -> tuple[Extension, ...]:
    """Return the next effect, or two that belong together, or none; the last has the fit of all.

    Periodic effects are tried first where there is a spectral line, then those that are not; a
    broad resonance imitates what has no spectral line, so others are tried after it always. An
    effect that leaves much of its own spectral line may be half of a pair: a second effect that
    is not periodic (a delay, a filter) can have changed how the line answers the first.
    """
    library = with_aliases(library, selection.record_axes, selection.spectra_left)
    library = with_orders(library, selection.record_axes, selection.spectra_left)
    library = with_radii(library, selection.record_axes, selection.spectra_left)
    library = with_resonances(library, selection.record_axes)
    periodic, others = by_periodic_chi2(library, selection.record_axes, selection.spectra_left)
    resonant = [h for h in periodic if h.effect.resonant]
    plain = [h for h in periodic if not h.effect.resonant]
    cost = selection.fit.cost
    progress(f"cost {cost:.0f}, noise alone {objective.expected_cost:.0f}")
    left = cost - min(objective.expected_cost, cost - ACCEPTANCE.least_excess)
    names = {h.effect.name for h in library}
    complete: list[Extension] = []
    partial: list[Extension] = []
    wander = wander_of(objective, selection)
    apart = set_apart(objective, selection, at_spectral_lines=False, wander=wander)
    for group in (plain, resonant, others):
        if group is others:
            conflicts = fit_conflicts(objective, selection.fit, names, progress)
            apart = set_apart(objective, selection, at_spectral_lines=True, wander=wander)
            weigh = objective if apart is None else apart.objective
            judged = selection if apart is None else apart.selection
            least = least_beside(judged, later_score(judged))
            base = looked_from(selection.fit, apart)
            events = event_candidates(weigh, base, without, progress, least)
            extension = best_of(objective, selection, group, progress, conflicts, events, apart)
        else:
            extension = best_of(objective, selection, group, progress, apart=apart)
        if extension is None:
            continue
        if explains_own_lines(objective, selection, extension.fit, apart):
            complete.append(extension)
            explained = cost - extension.fit.cost
            if group is plain and explained > ACCEPTANCE.decisive_share * left:
                break
        else:
            progress("  leaves too much: not accepted alone")
            if is_periodic(extension.hypothesis):
                partial.append(extension)
    first, alone = preferred(complete, partial)
    if first is None or alone:
        return () if first is None else (first,)
    return two_at_one_line(objective, selection, first, others, periodic, progress)
