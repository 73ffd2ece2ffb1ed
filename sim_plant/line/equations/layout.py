"""Where each continuous state sits in ``LineState.y``."""

from __future__ import annotations

from typing import NamedTuple


class Layout(NamedTuple):
    """Offsets into ``y``: bodies, strains, rolls, cells, shafts, Maxwell, bounce and the rest."""

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
    carriage: int  # travel, then its rate, of each in turn
    heat: int  # warming of each part of a span that has some, K
    size: int


def layout_of(bodies: int, drives: int, cells: int, carriages: int, heats: int) -> Layout:
    """Return the offsets for a line of these sizes."""
    spans = bodies - 1
    widths = [bodies, bodies, spans, 2, 2, cells, 2 * cells, drives, drives, spans, 2]
    widths += [2 * carriages, heats]
    offsets = [0]
    for width in widths:
        offsets.append(offsets[-1] + width)
    return Layout(bodies, *offsets)
