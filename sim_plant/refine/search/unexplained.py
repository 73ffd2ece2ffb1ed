"""What is left when no effect of the library explains more: its class and its coordinate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.fit.whitening import Whitening
from sim_plant.refine.search.coherence import Coupling, least_likely_coupling
from sim_plant.refine.search.outside_prior import PriorConflict, joint_conflict
from sim_plant.refine.search.spectral_line_in_noise import may_be_noise
from sim_plant.refine.search.strongest_zone import Heard, strongest_zone
from sim_plant.refine.search.unknown_event import event_left
from sim_plant.refine.spectra.coordinates import RecordAxes, near
from sim_plant.refine.spectra.spectral_lines import SpectralLines

UNEXPLAINED = CRITERIA.search.unexplained
ClassAndCoordinate = tuple[str, Mapping[str, float | str]]
"""Class and coordinate of a spectral line."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Unknown:
    """A residual that no effect of the library explains.

    Attributes
    ----------
    unknown_class : ``time``, ``travel`` or ``angle`` of a spectral line; ``event``, ``state`` or
        ``broadband``.
    coordinate : where it is: numbers and names, by key.
    chi2_reduction : what a free term would explain, chi-square; of coupled channels their score.
    also : classes and coordinates of spectral lines that the records do not tell from this one.
    """

    unknown_class: str
    coordinate: Mapping[str, float | str]
    chi2_reduction: float
    also: tuple[ClassAndCoordinate, ...] = ()

    def same_roll_as(self, other: Unknown) -> bool:
        """Return whether both are orders of the same roll."""
        roll = self.coordinate.get("roll")
        return (
            self.unknown_class == other.unknown_class == "angle"
            and roll == other.coordinate.get("roll")
        )

    @property
    def declared(self) -> str:
        """The declared number that would have to move; empty where it is something else."""
        return str(self.coordinate.get("declared", ""))

    @property
    def text(self) -> str:
        """Class and coordinate, for people."""
        where = ", ".join(
            f"{key} {value:.5g}" if isinstance(value, float) else f"{key} {value}"
            for key, value in self.coordinate.items()
        )
        return f"{self.unknown_class} ({where})"


def strongest_peak(
    spectra: Sequence[Sequence[SpectralLines]],
) -> tuple[SpectralLines, float, float]:
    """Return the strongest free spectral line of all records: spectrum, coordinate, chi-square."""
    best = max((s for record in spectra for s in record), key=lambda s: s.peak[1])
    return best, *best.peak


def what_is_left(
    objective: Objective,
    nominal: Fit,
    fit: Fit,
    record_axes: Sequence[RecordAxes],
    after: Sequence[Sequence[SpectralLines]],
) -> list[Unknown]:
    """Return the class and coordinate of what ``fit`` leaves.

    Nothing when it is noise, when it is little beside what there was without effects, or when it
    is only coupled channels beside free terms. ``after`` are the spectra of free spectral lines
    in what it leaves, over ``record_axes``.
    """
    excess = objective.excess(fit.cost, fit.residual)
    nominal_excess = nominal.cost - objective.expected_cost
    if fit.hypotheses and excess < UNEXPLAINED.remainder_share * nominal_excess:
        return []
    located = event_or_spectral_line(objective, fit, record_axes, after, excess)
    if located is not None:
        return [located]
    conflict = joint_conflict(objective, fit)
    if conflict is not None:
        return [outside_tolerance(conflict)]
    if loudest(objective.whitening, objective.split(fit.residual)) > UNEXPLAINED.loud:
        return [Unknown(unknown_class="broadband", chi2_reduction=excess, coordinate={})]
    if any(terms is not None for terms in objective.whitening.basis):
        return []  # what they leave of a spectral line is coupled as that is
    coupling = least_likely_coupling(objective, fit)
    return [coupled_channels(coupling)] if coupling.score > UNEXPLAINED.coupled else []


def event_or_spectral_line(
    objective: Objective,
    fit: Fit,
    record_axes: Sequence[RecordAxes],
    after: Sequence[Sequence[SpectralLines]],
    excess: float,
) -> Unknown | None:
    """Return what has a coordinate: an event first, for a step has slow spectral lines too."""
    event = event_left(objective, fit)
    line = with_zone(periodic_left(after, excess), heard(objective, fit, record_axes))
    if line is not None and may_be_noise(objective, record_axes, *strongest_peak(after)[:2]):
        line = None
    if event is None or (line is not None and rings(after, event[1])):
        return line
    return Unknown(unknown_class="event", coordinate=event[0], chi2_reduction=event[1])


def heard(objective: Objective, fit: Fit, record_axes: Sequence[RecordAxes]) -> list[Heard]:
    """Return what a fit leaves in every record, of channels whose noise is known."""
    pairs = zip(objective.pool.twins, objective.whitening.noise, strict=True)
    parts = zip(pairs, objective.split(fit.residual), record_axes, strict=True)
    return [
        Heard(
            line=twin.declaration,
            names=[n for n, use in zip(twin.channels, noise.analogue, strict=True) if use],
            left=left[noise.analogue],
            time_s=axes.time_s,
        )
        for (twin, noise), left, axes in parts
    ]


def with_zone(found: Unknown | None, records: Sequence[Heard]) -> Unknown | None:
    """Return a line in time with the zone in which it is strongest, all else as it is."""
    if found is None or found.unknown_class != "time" or not records:
        return found
    where = strongest_zone(records, float(found.coordinate["frequency_Hz"]))
    return replace(found, coordinate={**found.coordinate, **where})


def rings(after: Sequence[Sequence[SpectralLines]], chi2_reduction: float) -> bool:
    """Return whether most of what begins at a moment, by ``chi2_reduction``, is a spectral line.

    A resonance begins when the line comes to a speed that excites it. A step has strong spectral
    lines too, but of a few cycles only.
    """
    spectrum, at, of_line = strongest_peak(after)
    sure = at * spectrum.extent >= UNEXPLAINED.spectral_line_cycles
    return sure and of_line > UNEXPLAINED.ringing_share * chi2_reduction


def periodic_left(after: Sequence[Sequence[SpectralLines]], excess: float) -> Unknown | None:
    """Return the strongest free spectral line, if it counts and is a part of the ``excess``."""
    spectrum, at, chi2_reduction = strongest_peak(after)
    if (
        chi2_reduction > UNEXPLAINED.periodic
        and chi2_reduction > UNEXPLAINED.periodic_share * excess
    ):
        (unknown_class, where), *also = classes_at(after, spectrum, at)
        return Unknown(
            unknown_class=unknown_class,
            chi2_reduction=chi2_reduction,
            coordinate=where,
            also=tuple(also),
        )
    return None


def classes_at(
    after: Sequence[Sequence[SpectralLines]], spectrum: SpectralLines, at: float
) -> list[ClassAndCoordinate]:
    """Return the class and coordinate of the line at ``at``, then those not told from it.

    At one speed a line in time is one in travel, and one at an angle: all have the same cycles per
    record. Of records at several speeds only one axis has it at one frequency in all of them.
    Equation: c = a l / m, a the frequency in a record of extent m, l the extent of the other
    axis; not told apart where the chi-square over all records is less by no more than the
    ``margin`` of effects, or ``axis_share`` of it  [own].
    """
    cycles = at * spectrum.extent
    home = next(record for record in after if any(s is spectrum for s in record))
    rows = [(_over_records(after, s, cycles / s.extent), s) for s in home]
    # of equals the one whose line is strongest
    rows.sort(key=lambda row: (row[0], row[1] is spectrum), reverse=True)
    most, _ = rows[0]
    share = CRITERIA.without_line.axis_share * most
    least = most - max(CRITERIA.search.acceptance.margin, share)
    return [
        (s.axis, where_on(s.axis, s.roll, cycles / s.extent))
        for value, s in rows
        if value >= least
    ]


def _over_records(
    after: Sequence[Sequence[SpectralLines]], spectrum: SpectralLines, at: float
) -> float:
    """Return the chi-square reduction near one frequency of the same axis, over all records."""
    same = (s for r in after for s in r if (s.axis, s.roll) == (spectrum.axis, spectrum.roll))
    return sum(near(s, at) for s in same)


def line_or_broadband(
    after: Sequence[Sequence[SpectralLines]],
    excess: float,
    chi2_reduction: float,
    records: Sequence[Heard],
) -> Unknown:
    """Return what is left as its strongest free spectral line, else ``broadband``, this strong.

    ``records`` : what ``after`` are the spectra of; a line in time is placed by them.
    """
    found = with_zone(periodic_left(after, excess), records)
    return found or Unknown(
        unknown_class="broadband", chi2_reduction=chi2_reduction, coordinate={}
    )


def outside_tolerance(conflict: PriorConflict) -> Unknown:
    """Return declared numbers beyond tolerance as what is left, of class ``state``."""
    where: dict[str, float | str] = {
        "declared": conflict.number,
        "standard_deviations": conflict.standard_deviations,
    }
    return Unknown(unknown_class="state", chi2_reduction=conflict.chi2, coordinate=where)


def coupled_channels(coupling: Coupling) -> Unknown:
    """Return channels that move together otherwise than noise, as what is left, ``broadband``."""
    where: dict[str, float | str] = {
        "channels": " and ".join(coupling.channels),
        "from_Hz": coupling.from_Hz,
        "to_Hz": coupling.to_Hz,
    }
    return Unknown(unknown_class="broadband", chi2_reduction=coupling.score, coordinate=where)


def loudest(whitening: Whitening, left: Sequence[Array]) -> float:
    """Return the power left over the power that noise has, in the channel where that is most.

    ``left`` are innovations (channels, judged samples) per record. Coarse words do not count:
    their noise depends on the rate at which their steps are passed.
    """
    rows = zip(whitening.noise, left, kept_by_noise(whitening), strict=True)
    return max(
        float(np.max(np.mean(part[noise.analogue] ** 2, axis=1) / kept[noise.analogue]))
        for noise, part, kept in rows
    )


def kept_by_noise(whitening: Whitening) -> list[Array]:
    """Return the power (channels,) of noise to which ``loud`` is relative, per record; at least 1.

    Noise that is not the same all the time, nor from run to run (a torque that passes the play of
    a shaft), has more power after whitening than 1: taken from seeded runs, whitened as the
    record is. ``loud`` is some standard deviations above plain noise; here ``loud_sd`` of
    the runs' own are allowed.
    Equation: max(1, m, (m + k s) / loud), m and s mean and standard deviation of the runs' power,
    k = ``loud_sd``  [own].
    """
    found = []
    for noise, runs in zip(whitening.declared, whitening.realisations, strict=True):
        power = np.array([np.mean(noise.adjusted_to(r).whiten(r) ** 2, axis=1) for r in runs])
        mean, deviation = power.mean(axis=0), power.std(axis=0, ddof=min(1, len(power) - 1))
        wide = (mean + UNEXPLAINED.loud_sd * deviation) / UNEXPLAINED.loud
        found.append(np.maximum(np.maximum(mean, wide), 1.0))
    return found


def where_on(axis: str, roll: str, at: float) -> dict[str, float | str]:
    """Return the coordinate of a spectral line: ``at`` in cycles per unit of its axis."""
    if axis == "time":
        return {"frequency_Hz": at}
    if axis == "travel":
        return {"wavenumber_1_m": at, "equivalent_radius_m": 1.0 / (2.0 * np.pi * at)}
    return {"roll": roll, "order": at}
