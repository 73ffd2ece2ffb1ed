"""What a line is told frame by frame: speed, tensions, corrections."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim_plant.base.arrays import Array


class References(NamedTuple):
    """References of a run, one row a frame; as ``run_frames`` takes them."""

    line_speed_m_s: Array  # (f, 2) at start and end of the frame
    tension_ref_N: Array  # (f, l)
    aff_m_s: Array  # (f, d), or (f, 2 d) with torques, N m, behind


def held(line_speed_m_s: float, tension_N: Array, aff_m_s: Array, frames: int) -> References:
    """Return references that stay as they are, tension (l,) and corrections (d,)."""
    return References(
        np.full((frames, 2), line_speed_m_s),
        np.tile(tension_N, (frames, 1)),
        np.tile(aff_m_s, (frames, 1)),
    )


def between_rows(reference: Array, frames_per_row: int) -> Array:
    """Return the reference at start and end of every frame, linear between rows, (frames, 2)."""
    rows = np.arange(reference.size * frames_per_row + 1) / frames_per_row
    fine = np.interp(rows, np.arange(reference.size), reference)
    return np.column_stack((fine[:-1], fine[1:]))


def until_next_row(reference: Array, frames_per_row: int) -> Array:
    """Return the reference at start and end of every frame, held from row to row, (frames, 2)."""
    held_rows = np.repeat(reference, frames_per_row)
    return np.column_stack((held_rows, held_rows))
