"""What is odd about a record: stamps, gaps, spikes, saturation, resolution."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.ndimage import median_filter

from aff_runtime.base.channel_units import unit_of_name
from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.limits import path_text

RECORDS = CRITERIA.records
SAME_LEVEL_SHARE = 1e-9
"""Two readings that differ by less of the largest are one level, interpolated or rounded."""

Flags = npt.NDArray[np.bool_]


def even_grid(
    path: Path, time_s: Array, columns: Mapping[str, Array]
) -> tuple[float, dict[str, Array], list[str]]:
    """Return sample time, columns on an even grid and remarks about the stamps.

    Raises
    ------
    PlantError
        When stamps go back or are repeated, rows are too few, or the record has gaps.
    """
    if time_s.size < RECORDS.fewest_rows:
        raise PlantError(
            f"{path_text(path)}: has {time_s.size} rows, too few to judge; "
            f"give at least {RECORDS.fewest_rows}"
        )
    steps = np.diff(time_s)
    back = np.flatnonzero(steps < 0.0)
    if back.size:
        raise PlantError(
            f"{path_text(path)}: "
            f"{row_words(path, int(back[0]) + 1)}: time_s goes back; sort the rows "
            "by time, or give the part before it and the part after it as two records"
        )
    step = float(np.median(steps))
    odd = (steps > RECORDS.longest_gap_samples * step) | (steps == 0.0)
    off = _one_stamp_off(steps, step)
    bad, misplaced = np.flatnonzero(odd & ~off), _stamps_beside(odd & off)
    twice, gap = bad[steps[bad] == 0.0], bad[steps[bad] > 0.0]
    if twice.size:
        raise PlantError(
            f"{path_text(path)}: "
            f"{twice.size} rows have the time_s of the row before, the first is "
            f"{row_words(path, int(twice[0]) + 1)}; give each moment one row"
        )
    if gap.size:
        at = int(gap[0])
        raise PlantError(
            f"{path_text(path)}: {gap.size} gaps in time_s, the first after {row_words(path, at)} "
            f"({steps[at]:.4g} s where {step:.4g} s is usual); give a record without gaps"
        )
    remarks = [f"{misplaced} misplaced stamp{'s' * (misplaced > 1)}"] if misplaced else []
    mean = float((time_s[-1] - time_s[0]) / (time_s.size - 1))
    grid = time_s[0] + mean * np.arange(time_s.size)
    largest_offset_s = float(np.max(np.abs(time_s - grid)))
    arrays = {name: np.asarray(values, dtype=np.float64) for name, values in columns.items()}
    if largest_offset_s < RECORDS.jitter_share * mean:
        return mean, arrays, remarks
    # no stamp goes back here; one that repeats the one before it is told apart by a small ramp
    increasing_s = time_s + 1e-9 * step * np.arange(time_s.size)
    even = {name: np.interp(grid, increasing_s, values) for name, values in arrays.items()}
    uneven = f"stamps are uneven by up to {largest_offset_s:.2g} s: put on a grid of {mean:.6g} s"
    return mean, even, [*remarks, uneven]


def row_words(path: Path, row: int) -> str:
    """Return where data row ``row`` (from 0) stands: a line of a text file, a row of others."""
    text = path.name.lower().removesuffix(".gz").endswith((".csv", ".txt"))
    return f"line {row + 2}" if text else f"row {row + 1}"


def unwrapped(columns: Mapping[str, Array]) -> tuple[dict[str, Array], list[str]]:
    """Return columns with angles that start over (each turn, or each few) unwrapped, and remarks.

    A step of more than half a turn against the way the roll turns is taken for a start over. In a
    column with one, every step beyond half a turn is folded, as stamps are far closer than that.
    """
    continuous, remarks = dict(columns), []
    for name, values in columns.items():
        if not name.endswith("_angle_rad") or values.size < 2:
            continue
        steps = np.diff(values)
        over = int(np.sum(steps * np.sign(np.median(steps)) < -np.pi))
        if over:
            continuous[name] = np.unwrap(values)
            remarks.append(f"{name} starts over {over} times: unwrapped")
    return continuous, remarks


def _one_stamp_off(steps: Array, step: float) -> Flags:
    """Return per step (samples - 1,) whether it and a neighbour are two usual steps together.

    Odd steps of that kind are one misplaced stamp. In one pass over the array, as a hostile file
    may make every step odd.
    """
    makes_two = np.abs(steps[1:] + steps[:-1] - 2.0 * step) < RECORDS.misplaced_stamp_share * step
    found: Flags = np.zeros(steps.size, dtype=np.bool_)
    found[:-1] |= makes_two
    found[1:] |= makes_two
    return found


def _stamps_beside(odd: Flags) -> int:
    """Return how many misplaced stamps make the odd steps (samples - 1,).

    A run of one or two adjoining odd steps is one misplaced stamp, of three or four two.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], odd, [False]]).astype(np.int8)))
    lengths = edges[1::2] - edges[::2]
    return int(np.sum((lengths + 1) // 2))


def oddities(
    columns: Mapping[str, Array], count_sizes: Mapping[str, float] | None = None
) -> list[str]:
    """Return sentences about spikes, saturation, resolution and columns that stand still.

    ``count_sizes``: one count of a column, where that is known (``count_sizes_seen``).

    A reference, which a person or the PLC sets, has few levels and stays on one: of such a column
    neither coarse steps nor a level that it sits at are odd.
    """
    sentences = []
    known = count_sizes or {}
    for name, values in columns.items():
        if np.ptp(values) == 0.0:
            sentences.append(f"{name} stands still at {values[0]:g}")
            continue
        levels, unit = np.unique(values), unit_of_name(name)
        count_size, is_reference = known.get(name, 0.0), "_ref_" in name
        smallest = count_size or _smallest_step(levels)
        if (
            levels.size < RECORDS.coarse_levels_share * values.size
            and smallest > 0.0
            and not is_reference
        ):
            sentences.append(f"{name} is read in steps of {smallest:.3g} {unit}".rstrip())
        for level, side in ((levels[-1], "top"), (levels[0], "bottom")):
            stuck = float(np.mean(values == level))
            if (
                stuck > RECORDS.stuck_share
                and levels.size > RECORDS.stuck_levels
                and not is_reference
            ):
                sentences.append(f"{name} sits at its {side} {level:g} for {100 * stuck:.0f} %")
        # of few levels the smallest step may itself be a spike: then only a known count is allowed
        has_few = levels.size <= RECORDS.stuck_levels
        spikes = spikes_in(values, count_size if has_few else smallest)
        if spikes:
            sentences.append(f"{name} has {spikes} spike{'s' * (spikes > 1)}")
    return sentences


def count_sizes_seen(
    columns: Mapping[str, Array], word_counts: Mapping[str, float]
) -> dict[str, float]:
    """Return the size of one count per column of readings (samples,): its word's, or the sensor's.

    ``word_counts``: one count of the word of a column, where the site file has it.

    A sensor may be coarser than its word; of few levels that is not told from a spike. To be asked
    before anything is filled in between two readings, which would show a smaller one.
    """
    found = {}
    for name, values in columns.items():
        levels = np.unique(values[np.isfinite(values)])
        seen = _smallest_step(levels) if levels.size > RECORDS.stuck_levels else 0.0
        found[name] = max(word_counts.get(name, 0.0), seen)
    return found


def _smallest_step(levels: Array) -> float:
    """Return the smallest step between sorted levels, rounding left out; 0 without one."""
    steps = np.diff(levels)
    steps = steps[steps > SAME_LEVEL_SHARE * float(np.max(np.abs(levels)))]
    return float(np.min(steps)) if steps.size else 0.0


def spikes_in(values: Array, count_size: float = 0.0) -> int:
    """Return how many single samples stand far off their neighbours (Hampel).

    Far is ``spike_sigma`` times the spread: 1.4826 of the median absolute deviation, half of the
    standard deviation at least. One count (``count_size``) of a coarse word to or fro is no spike.
    """
    reach = RECORDS.spike_samples // 2  # at its ends a ramp looks like a spike
    deviation = (values - median_filter(values, RECORDS.spike_samples))[reach:-reach]
    spread = max(
        1.4826 * float(np.median(np.abs(deviation - np.median(deviation)))),
        0.5 * float(np.std(deviation)),
    )
    return (
        0
        if spread == 0.0
        else int(
            np.sum(
                np.abs(deviation)
                > max(RECORDS.spike_sigma * spread, RECORDS.spike_counts * count_size)
            )
        )
    )
