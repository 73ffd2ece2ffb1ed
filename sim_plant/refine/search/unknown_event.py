"""Something that begins at a moment and that no effect of the library explains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.line.arrays.locations import zones
from sim_plant.line.declared.declaration import Declaration, RollAngle
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.noise.innovations import filter_taps

EVENTS = CRITERIA.search.events


def event_left(objective: Objective, fit: Fit) -> tuple[dict[str, float | str], float] | None:
    """Return where and when what is left begins, and its chi-square beyond noise, or None.

    Of the first record that is as quiet as noise up to a moment, and louder from there on.
    """
    rows = zip(
        objective.pool.twins, objective.split(fit.residual), objective.whitening.noise, strict=True
    )
    for record, (twin, left, noise) in enumerate(rows):
        names = [n for n, use in zip(twin.channels, noise.analogue, strict=True) if use]
        power = left[noise.analogue] ** 2
        found = event_in(twin.declaration, names, power, noise.first)
        if found is None:
            continue
        where, chi2_reduction = found
        if len(objective.pool.twins) > 1:
            where["record"] = float(record + 1)  # from 1, as people read it in the verdict
        return where, chi2_reduction
    return None


def event_in(
    line: Declaration, names: Sequence[str], power: Array, first: int
) -> tuple[dict[str, float | str], float] | None:
    """Return where and when power (channels, judged samples; noise: 1) begins, and how much.

    ``first`` is the first judged sample.
    """
    step_s = line.sample_time_s
    at = beginning(power, step_s)
    if at is None:
        return None
    after = power[:, at:]
    loudest = names[int(np.argmax(after.mean(axis=1)))]
    where: dict[str, float | str] = {
        "from_s": (first + at) * step_s,
        "zone": zone_of(line, loudest),
        "channel": loudest,
    }
    return where, float(np.sum(after - 1.0))


def beginning(power: Array, step_s: float) -> int | None:
    """Return the sample from which power (channels, samples; noise: 1) is more than noise.

    None where it is not, or was all along. A sample counts up to ``sample_power``: an event moves
    most samples of a bin, a spike one, or as many as a filter is long where it was whitened; what
    is no longer than that (``_lasts``) is passed over.
    """
    power = np.minimum(power, EVENTS.sample_power)
    size = max(1, round(EVENTS.bin_s / step_s))
    blocks = power[:, : power.shape[1] // size * size]
    level = blocks.reshape(blocks.shape[0], -1, size).mean(axis=(0, 2))
    spread = np.sqrt(2.0 / (size * power.shape[0]))
    first_bins = level[: max(1, int(EVENTS.level_share * level.size))]
    loud = level > np.median(first_bins) + EVENTS.bin_sd * spread
    calm = np.ones(level.size, dtype=bool)
    for first in map(int, np.flatnonzero(loud[:-1] & loud[1:])):
        quiet = float(level[:first][calm[:first]].mean()) if calm[:first].any() else np.inf
        if first * EVENTS.bin_s < EVENTS.quiet_s or quiet > 1.0 + EVENTS.contrast:
            return None
        rise = level[first : first + round(EVENTS.quiet_s / EVENTS.bin_s)].mean() - quiet
        if rise < EVENTS.contrast:
            return None
        if _lasts(power[:, first * size :], quiet, step_s):
            near = slice(max(0, (first - 2) * size), (first + 2) * size)
            more = power[:, near].mean(axis=0) - (quiet + 0.5 * rise)
            return near.start + int(np.argmin(np.cumsum(more)))
        calm[first : first + 2] = False
    return None


def _lasts(power: Array, quiet: float, step_s: float) -> bool:
    """Return whether power (channels, samples from where it is loud on) is no spike.

    A spike is there for as long as the noise filter, with the one of its colour. Without the
    loudest part of that length the next ``quiet_s`` are louder than ``quiet``, by ``lasts_sd``.
    """
    reach = filter_taps(step_s) + CRITERIA.noise.colour_taps + 1
    part = power[:, : max(round(EVENTS.quiet_s / step_s), 2 * reach)].mean(axis=0) - quiet
    rest = part.size - reach
    if rest <= 0:
        return False
    sums = np.concatenate(([0.0], np.cumsum(part)))
    left = float(sums[-1] - np.max(sums[reach:] - sums[:-reach])) / rest
    sd = float(np.sqrt(2.0 / (power.shape[0] * rest)))
    return bool(left > EVENTS.lasts_sd * sd)


def zone_of(line: Declaration, channel: str) -> str:
    """Return the zone at the roller whose sensor gives a channel; without a zone the roller."""
    sensor = next(s for s in line.sensors if s.channel == channel and not isinstance(s, RollAngle))
    body = line.body(sensor.roller)
    for name, spans in zones(line).items():
        if body in (spans[0], *(k + 1 for k in spans)):
            return name
    return sensor.roller
