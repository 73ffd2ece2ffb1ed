"""What every trial gives on a record that was not fitted, and which numbers are its own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.without_line.general.catalogue import PAST
from sim_plant.refine.without_line.general.effect import OutputRecord
from sim_plant.refine.without_line.general.least_squares import block_edges, moments
from sim_plant.refine.without_line.general.model import own_regressors, regressors
from sim_plant.refine.without_line.general.search import Search, Trial, saves_enough, strongest_lag

GENERAL = CRITERIA.without_line.general

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedTrial:
    """One row of the table: what was tried, what it gave.

    Attributes
    ----------
    effect : name in the catalogue.
    what : as text.
    left_out_rms : error on blocks of the records fitted that were left out.
    held_out_rms : error on the record judged.
    taken : the model that was chosen has it.
    """

    effect: str
    what: str
    left_out_rms: float
    held_out_rms: float
    taken: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """One output of the record judged.

    Attributes
    ----------
    rows : everything that was tried.
    explained : by what is used in the end (judged,).
    declared_rms, plain_rms, chosen_rms : error of the declared filter, of plain least squares,
        and of the model chosen.
    shift_samples : own shift of this record against the first fitted, and its standard
        deviation; None where it needs none.
    own : this record needed an own zero and drift.
    used : the trial that explains in the end.
    fell_back : the model chosen was worse here than plain least squares, which took its place.
    """

    rows: tuple[JudgedTrial, ...]
    explained: Array
    declared_rms: float
    plain_rms: float
    chosen_rms: float
    shift_samples: tuple[float, float] | None
    own: bool
    used: Trial
    fell_back: bool


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))


@lru_cache(maxsize=4)
def _filter_part(trial: Trial, record: OutputRecord, shift_samples: float) -> Array:
    """Return what the weights explain (judged,), without an own zero and drift.

    Cached, so not to be written to: `explained_by` begins at the same shift for both its halves.
    """
    a = regressors(trial.model, record, shift_samples)
    explained: Array = a @ trial.weights[: a.shape[1]]
    return explained


def _own_numbers(
    trial: Trial, record: OutputRecord, mask: Mask, *, shift: bool, own: bool
) -> tuple[float, Array]:
    """Return shift in samples and weights of zero and drift, from the samples of a mask.

    ``shift``, ``own`` : whether the record is to have a shift, or a zero and drift, of its own.
    """
    beside = own_regressors(record) if own else np.zeros((record.judged.size, 0))
    shift_samples = strongest_lag(record, _filter_part(trial, record, 0.0), mask) if shift else 0.0
    weights: Array = np.zeros(beside.shape[1])
    for _ in range(GENERAL.own_shift_steps if shift else 1):
        explained = _filter_part(trial, record, shift_samples)
        columns = [beside]
        if shift:
            moved = _filter_part(trial, record, shift_samples + GENERAL.slope_samples)
            columns.append(((moved - explained) / GENERAL.slope_samples)[:, None])
        a = np.hstack(columns)
        if a.shape[1] == 0:
            break
        found = np.linalg.lstsq(a[mask], (record.judged - explained)[mask], rcond=None)[0]
        weights = np.asarray(found[: beside.shape[1]], dtype=np.float64)
        if shift:
            shift_samples += float(
                np.clip(found[-1], -GENERAL.most_shift_samples, GENERAL.most_shift_samples)
            )
    return shift_samples, weights


def explained_by(trial: Trial, record: OutputRecord, *, shift: bool, own: bool) -> Array:
    """Return what a model explains of a record that was not fitted (judged,).

    Numbers of this record alone (shift, zero, drift) are found on every second block and used on
    the others, both ways: no sample is judged by numbers that were fitted to it.
    """
    if not shift and not own:
        return _filter_part(trial, record, 0.0)
    odd = _odd_blocks(record)
    found = np.empty(record.judged.size)
    for mask in (odd, ~odd):
        shift_samples, weights = _own_numbers(trial, record, ~mask, shift=shift, own=own)
        found[mask] = _filter_part(trial, record, shift_samples)[mask]
        if own:
            found[mask] += (own_regressors(record) @ weights)[mask]
    return found


def _odd_blocks(record: OutputRecord) -> Mask:
    odd = np.zeros(record.judged.size, dtype=bool)
    edges = block_edges(record.judged.size, 1)
    for k in range(1, edges.size - 1, 2):
        odd[edges[k] : edges[k + 1]] = True
    return odd


def _blocks(values: Array) -> Array:
    """Return the sum of squares of every block (blocks,)."""
    edges = block_edges(values.size, 1)
    found: Array = np.add.reduceat(values**2, edges[:-1].tolist())
    return found


def own_shift(trial: Trial, record: OutputRecord) -> tuple[float, float]:
    """Return a record's shift against the first fitted and its standard deviation, samples."""
    everywhere = np.ones(record.judged.size, dtype=bool)
    shift_samples, _ = _own_numbers(trial, record, everywhere, shift=True, own=True)
    explained = _filter_part(trial, record, shift_samples)
    moved = _filter_part(trial, record, shift_samples + GENERAL.slope_samples)
    slope = (moved - explained) / GENERAL.slope_samples
    found = moments(
        [np.column_stack([own_regressors(record), slope])], [record.judged - explained]
    )
    return shift_samples, float(found.spread()[-1])


def judge(search: Search, record: OutputRecord) -> Judged:
    """Return what every trial gives on a record, and what is used in the end."""
    best = search.best
    output = record.judged
    shift, own = False, best.model.own
    explained = explained_by(best, record, shift=shift, own=own)
    # own numbers are taken where they save enough: a shift, a zero and drift, or both
    can_shift = bool(record.inputs) and best.model.back >= 0  # else there is nothing to shift
    for tried_shift, tried_own in ((True, own), (False, True), (True, True)):
        if (tried_shift and not can_shift) or (tried_shift, tried_own) == (shift, own):
            continue
        tried = explained_by(best, record, shift=tried_shift, own=tried_own)
        if saves_enough(_blocks(output - explained), _blocks(output - tried)):
            explained, shift, own = tried, tried_shift, tried_own
    simple = {
        trial.what: (trial, explained_by(trial, record, shift=False, own=False))
        for trial in (search.declared, search.plain)
    }
    chosen_rms = rms(output - explained)
    used, simpler = min(simple.values(), key=lambda pair: rms(output - pair[1]))
    fell_back = rms(output - simpler) < chosen_rms
    return Judged(
        rows=tuple(_rows(search, record, (shift, own), chosen_rms)),
        explained=simpler if fell_back else explained,
        declared_rms=rms(output - simple[search.declared.what][1]),
        plain_rms=rms(output - simple[search.plain.what][1]),
        chosen_rms=chosen_rms,
        shift_samples=own_shift(best, record) if shift else None,
        own=own,
        used=used if fell_back else best,
        fell_back=fell_back,
    )


def _rows(
    search: Search, record: OutputRecord, needed: tuple[bool, bool], chosen_rms: float
) -> list[JudgedTrial]:
    """Return the table; ``needed``: has the record judged an own shift, an own zero and drift."""
    rows = []
    for trial in search.tried:
        explained = explained_by(
            trial, record, shift=bool(trial.model.shifts), own=trial.model.own
        )
        rows.append(
            JudgedTrial(
                effect=trial.effect,
                what=trial.what,
                left_out_rms=trial.rms,
                held_out_rms=rms(record.judged - explained),
                taken=_taken(trial, search.best),
            )
        )
    names = [w for w, used in zip(("shift", "zero and drift"), needed, strict=True) if used]
    what = "what was chosen" + (f", with this record's own {' and '.join(names)}" if names else "")
    rows.append(
        JudgedTrial(
            effect="chosen",
            what=what,
            left_out_rms=search.best.rms,
            held_out_rms=chosen_rms,
            taken=True,
        )
    )
    return rows


def _taken(trial: Trial, best: Trial) -> bool:
    """Return whether the chosen model has the filter and every effect of this trial."""
    a, b = trial.model, best.model
    if (a.ahead, a.back, bool(a.delays)) != (b.ahead, b.back, bool(b.delays)):
        return False
    if trial.effect == PAST or (a.own and not b.own) or (a.shifts and not b.shifts):
        return False
    there = {(x.effect, x.place) for x in b.effects}
    return all((x.effect, x.place) in there for x in a.effects)
