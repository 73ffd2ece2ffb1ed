"""What the record held out confirms of what was found: not what it refutes, nor an imitation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.imitated_lines import imitated_line
from sim_plant.refine.judge.apart import apart_from
from sim_plant.refine.judge.holdout import Evaluation, evaluate
from sim_plant.refine.judge.refutation import (
    as_declared,
    leaves_large,
    leaves_much,
    made_worse,
    of_numbers_alone,
    refuted,
    shows_something_else,
    takes_less_than_left,
    takes_little,
)
from sim_plant.refine.judge.rest_shown import rest_in_floors, rest_shown
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Twin
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.confidence import sizes_shown
from sim_plant.refine.search.candidate import Progress
from sim_plant.refine.search.selection import Selection
from sim_plant.refine.search.set_apart import has_large_wander
from sim_plant.refine.search.strongest_zone import Heard
from sim_plant.refine.search.taken_back import withdrawn, without_accepted, without_effects
from sim_plant.refine.search.unexplained import Unknown, line_or_broadband, rings, strongest_peak
from sim_plant.refine.search.unknown_event import event_in
from sim_plant.refine.search.wandering import wander_changes

LINE_CYCLES = CRITERIA.search.unexplained.spectral_line_cycles


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecordWithTwin:
    """A record and the twin of the line that it was made on."""

    record: Recording
    twin: Twin

    @property
    def measured(self) -> Array:
        """The modelled channels of the record (channels, samples)."""
        return np.stack([self.record.columns[name] for name in self.twin.channels])


def judge(
    judged: RecordWithTwin,
    selection: Selection,
    workers: int,
    progress: Progress,
    *,
    held_out: bool,
) -> Evaluation:
    """Return the error of one record as declared and as amended."""
    shifts = tuple(sorted(selection.adjustments.items()))
    with SimulationPool([judged.twin], workers, progress) as pool:
        return evaluate(pool, judged.measured, selection.fit.effects, shifts, find_angles=held_out)


@dataclass(frozen=True, eq=False)
class Judgement:
    """A record judged with the effects selected.

    ``changes`` : what it shows of slow changes of their sizes; looked for once, when asked.
    """

    judged: RecordWithTwin
    selection: Selection
    evaluation: Evaluation
    workers: int
    progress: Progress

    @cached_property
    def changes(self) -> list[Array]:
        """See `wander_there`."""
        return wander_there(
            self.judged, self.selection, self.evaluation, self.workers, self.progress
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Claimed:
    """What is claimed once effects were left out that the record held out does not confirm.

    Attributes
    ----------
    said : a sentence on each of those: which, and why it is not claimed.
    """

    selection: Selection
    evaluation: Evaluation
    said: tuple[str, ...] = ()


def confirmed(
    judged: RecordWithTwin,
    selection: Selection,
    evaluation: Evaluation,
    workers: int,
    progress: Progress,
) -> Claimed:
    """Return what the record held out confirms: all is withdrawn that it refutes or imitates.

    In its place nothing is unknown where that record shows no more than noise, beside declared
    numbers as they were estimated with it.
    """
    said: tuple[str, ...] = ()
    against = refutation(selection, evaluation)
    if against:
        said = (not_confirmed(selection, judged.record, against),)
        progress(said[0])
        shows_more = leaves_much(of_numbers_alone(evaluation))
        selection = withdrawn(selection) if shows_more else without_effects(selection)
        evaluation = as_declared(evaluation)
    alone = without_imitated_lines(judged, selection, evaluation, workers, progress)
    sized = without_sizeless(judged, alone.selection, alone.evaluation, workers, progress)
    claimed = without_imitations(
        judged, sized.selection, sized.evaluation, workers, progress, (*alone.said, *sized.said)
    )
    return replace(claimed, said=(*said, *claimed.said))


def without_imitated_lines(
    judged: RecordWithTwin,
    selection: Selection,
    evaluation: Evaluation,
    workers: int,
    progress: Progress,
) -> Claimed:
    """Return what is claimed without every two effects that only imitate their spectral line."""
    said: list[str] = []
    while pair := imitated_line(judged.twin, selection, evaluation):
        keys = " and ".join(str(selection.accepted[at].hypothesis.key) for at in pair)
        said.append(
            f"not claimed: {keys}: they leave more of their spectral line on "
            f"{judged.record.path.name} than two causes do; their four numbers imitate it"
        )
        progress(said[-1])
        if len(selection.accepted) == len(pair):
            selection, evaluation = withdrawn(selection), as_declared(evaluation)
            break
        for at in sorted(pair, reverse=True):
            selection = without_accepted(selection, at)
        evaluation = judge(judged, selection, workers, progress, held_out=True)
    return Claimed(selection=selection, evaluation=evaluation, said=tuple(said))


def without_sizeless(
    judged: RecordWithTwin,
    selection: Selection,
    evaluation: Evaluation,
    workers: int,
    progress: Progress,
) -> Claimed:
    """Return what is claimed without effects that may have no size, the weakest first."""
    said: list[str] = []
    while not all(shown := sizes_shown(selection)):
        sizeless = [k for k, has_size in enumerate(shown) if not has_size]
        at = min(sizeless, key=lambda k: selection.accepted[k].score)
        key = selection.accepted[at].hypothesis.key
        said.append(f"not claimed: {key}: the fit is better with it, but its size may be none")
        progress(said[-1])
        selection = without_accepted(selection, at)
        evaluation = judge(judged, selection, workers, progress, held_out=True)
    return Claimed(selection=selection, evaluation=evaluation, said=tuple(said))


def without_imitations(
    judged: RecordWithTwin,
    selection: Selection,
    evaluation: Evaluation,
    workers: int,
    progress: Progress,
    before: tuple[str, ...] = (),
) -> Claimed:
    """Return what is claimed without effects that can be imitations, one after the other.

    What an imitation explained has a cause that is not named. Where the record held out shows
    surely more than noise without it, that is unknown, and the verdict says so. So does it where
    the weakest stays for its response is shown, or where the effects, which are there, leave more
    of what that record shows than right ones do.

    Parameters
    ----------
    before : sentences on effects that are not claimed already.
    """
    said = list(before)
    judgement = Judgement(judged, selection, evaluation, workers, progress)
    while weak := without_weakest_imitation(judgement):
        if weak.shown:
            break
        said.append(weak.said)
        progress(weak.said)
        selection, evaluation = weak.selection, weak.evaluation
        judgement = Judgement(judged, selection, evaluation, workers, progress)
    beside = weak is not None or has_more(judgement)
    if leaves_much(evaluation) and (said or beside):
        stays = stays_unknown(judged, selection, evaluation)
        said.append(f"unknown: what is left on {judged.record.path.name}: {stays.text}")
        progress(said[-1])
        selection = replace(selection, unknown=(stays,))
    return Claimed(selection=selection, evaluation=evaluation, said=tuple(said))


def has_more(judgement: Judgement) -> bool:
    """Return whether a record held out has more in it than the effects that are claimed.

    They leave most of what it shows, or more of it than right effects do; the latter apart from
    slow changes of effects whose size is never quite constant.
    """
    selection, evaluation = judgement.selection, judgement.evaluation
    if not selection.accepted or selection.unknown or not leaves_much(evaluation):
        return False
    if shows_something_else(evaluation):
        return True
    return leaves_large(evaluation) and leaves_large(apart_from(evaluation, judgement.changes))


def stays_unknown(judged: RecordWithTwin, selection: Selection, evaluation: Evaluation) -> Unknown:
    """Return what is left on the record held out: what begins there, a spectral line, or neither.

    Beside an effect that is never quite constant neither is named: its changes have moments and
    slow lines of their own. Nor is a line of fewer cycles than ``spectral_line_cycles``: a drift
    of the record has such lines at any coordinate.
    """
    after, chi2_reduction = rest_shown(judged.twin, evaluation)
    irregular = Unknown(unknown_class="broadband", chi2_reduction=chi2_reduction, coordinate={})
    if any(has_large_wander(accepted) for accepted in selection.accepted):
        return irregular
    names, rest = rest_in_floors(evaluation)
    event = event_in(judged.twin.declaration, names, rest**2, evaluation.first)
    if event is None or rings([after], event[1]):
        spectrum, at, _ = strongest_peak([after])
        sure = at * spectrum.extent >= LINE_CYCLES
        if not sure:
            return irregular
        first, step_s = evaluation.first, judged.record.sample_time_s
        time_s: Array = np.arange(first, first + rest.shape[1], dtype=np.float64) * step_s
        heard = Heard(line=judged.twin.declaration, names=names, left=rest, time_s=time_s)
        return line_or_broadband([after], chi2_reduction, chi2_reduction, [heard])
    where = event[0] | {"held_out": judged.record.path.name}
    return Unknown(unknown_class="event", chi2_reduction=event[1], coordinate=where)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WithoutImitation:
    """What is claimed without an effect that can be an imitation.

    Attributes
    ----------
    said : the sentence that names the effect and why it is not claimed.
    shown : the record shows its response, so it stays all the same.
    """

    selection: Selection
    evaluation: Evaluation
    said: str
    shown: bool


def without_weakest_imitation(judgement: Judgement) -> WithoutImitation | None:
    """Return what is claimed without the weakest effect, where it can be an imitation, or None.

    It can be one where it takes less away on the record held out than all effects leave there,
    and that is surely more than noise. Both are apart from slow changes of effects whose size is
    never quite constant, as in the search (`set_apart`): the weakest was found by what is none of
    them, and imitates none. A lone effect, or one beside something unknown, is not
    looked at; nor is an event that the record held out does not have: of that it says nothing.
    """
    judged, selection, evaluation = judgement.judged, judgement.selection, judgement.evaluation
    if selection.unknown or len(selection.accepted) < 2 or not leaves_much(evaluation):
        return None
    shown = [
        k
        for k, accepted in enumerate(selection.accepted)
        if not accepted.hypothesis.moment_parameter
        or str(accepted.hypothesis.key) in evaluation.moments
    ]
    if not shown:
        return None
    seen = apart_from(evaluation, judgement.changes)
    if not leaves_much(seen):
        return None
    at = min(shown, key=lambda k: selection.accepted[k].score)
    fewer = without_accepted(selection, at)
    without = judge(judged, fewer, judgement.workers, judgement.progress, held_out=True)
    seen_without = apart_from(without, judgement.changes)
    if not takes_less_than_left(seen, seen_without):
        return None
    key = selection.accepted[at].hypothesis.key
    said = f"not claimed: {key}: takes less away on {judged.record.path.name} than is left there"
    stays = not takes_little(seen, seen_without)
    return WithoutImitation(selection=fewer, evaluation=without, said=said, shown=stays)


def wander_there(
    judged: RecordWithTwin,
    selection: Selection,
    evaluation: Evaluation,
    workers: int,
    progress: Progress,
) -> list[Array]:
    """Return what a record shows of slow changes of the effects' sizes (channels, samples) each.

    One per effect that wanders by enough to hide another and pair of intervals; the effects as
    they are in this record.
    """
    large = {a.hypothesis.key for a in selection.accepted if has_large_wander(a)}
    if not large:
        return []
    there = {(e.effect, e.location): dict(e.parameters) for e in evaluation.effects}
    found = [h for h in selection.fit.hypotheses if (h.key.effect, h.key.location) in there]
    rows = [(h.names, there[h.key.effect, h.key.location]) for h in found]
    fit = replace(
        selection.fit,
        hypotheses=tuple(replace(h, record_index=None) for h in found),
        values=tuple(tuple(float(known[name]) for name in names) for names, known in rows),
        shifts=dict(selection.adjustments),
    )
    with SimulationPool([judged.twin], workers, progress) as pool:
        wandering = [k for k, h in enumerate(found) if h.key in large]
        return [change[0] for k in wandering for change in wander_changes(pool, fit, k)]


def refutation(selection: Selection, evaluation: Evaluation) -> str:
    """Return why the record held out refutes the effects found, as part of a sentence, or ""."""
    if not selection.accepted:
        return ""
    if not selection.unknown:
        return "explains what was fitted, and not" if refuted(evaluation) else ""
    worse = made_worse(evaluation)
    return f"beside what is unknown, and {', '.join(worse)} worse with it in" if worse else ""


def not_confirmed(selection: Selection, record: Recording, against: str) -> str:
    """Return the sentence on effects that the record held out refutes."""
    effects = " and ".join(str(accepted.hypothesis.key) for accepted in selection.accepted)
    return f"not claimed: {effects}: {against} {record.path.name}"
