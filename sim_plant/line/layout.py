"""Where each continuous state sits in ``LineState.y``."""

from __future__ import annotations

from typing import NamedTuple


class Layout(NamedTuple):
    """Offsets into ``y``: angles, speeds, strains, roll radii, cells, shafts, Maxwell, bounce."""

    n: int
    theta: int
    omega: int
    strain: int
    radius: int  # unwind, rewind
    flow: int  # unstretched length out of the unwind, into the rewind
    cell: int
    resonance: int
    twist: int  # shaft twist, then motor speed, per drive
    motor: int
    maxwell: int
    bounce: int
    size: int


def layout_of(bodies: int, drives: int, cells: int) -> Layout:
    """Return the offsets for a line of these sizes."""
    spans = bodies - 1
    widths = (bodies, bodies, spans, 2, 2, cells, 2 * cells, drives, drives, spans, 2)
    offsets = [0]
    for width in widths:
        offsets.append(offsets[-1] + width)
    return Layout(bodies, *offsets)
