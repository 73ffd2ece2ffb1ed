"""A splice on its way through the line, in its equations: two webs in a span, and a seam."""

from __future__ import annotations

import math

from sim_plant.base.arrays import Array, LineArrays
from sim_plant.base.jit import compiled, compiled_inside
from sim_plant.elements.span import two_webs

SEAM_EDGE_M = 0.01
"""Length of web over which a seam lifts it: no web is bent sharply."""


@compiled
def on_wrap(piece_m: float, past_m: float, wrap_m: float) -> float:
    """Return how much a seam lifts the web off a roller that it reached ``past_m`` ago, 0..1.

    From its first edge on the wrap to its last edge off it. On a roll at the end nothing is
    wrapped.
    """
    if wrap_m <= 0.0:
        return 0.0
    come = min(max(past_m / SEAM_EDGE_M, 0.0), 1.0)
    gone = min(max((past_m - wrap_m - piece_m) / SEAM_EDGE_M, 0.0), 1.0)
    return come - gone


@compiled_inside
def wrapped(p: LineArrays, i: int, phi: Array, contacts: Array) -> float:
    """Return the length of web on the body after span ``i``, m; 0 on the last one."""
    if i + 1 >= phi.size:
        return 0.0
    turn = p.bodies[i + 1].sigma * (phi[i + 1] - phi[i])
    return float(contacts[i, 2] * (turn % (2.0 * math.pi)))


@compiled_inside
def with_two_webs(
    p: LineArrays, i: int, strain: float, free: float, free_out: float, new: float
) -> tuple[float, float]:
    """Return EA, N, of a span with this share of ``new`` web, and the strain at its exit.

    ``free`` strain on the mean and at the exit.
    """
    span, ratio = p.spans[i], p.web[0].splice_EA_ratio
    share = min(max(new, 0.0), 1.0)
    EA_N = two_webs(span.EA_N, ratio, share)
    at_exit = span.EA_N * (ratio if share == 1.0 else 1.0)
    return EA_N, free_out + (strain - free) * EA_N / at_exit


@compiled_inside
def seam_lift(p: LineArrays, i: int, phi: Array, contacts: Array, past_m: float) -> float:
    """Return by how much a seam that reached the body after span ``i`` lifts the web there, m."""
    web = p.web[0]
    wrap_m = wrapped(p, i, phi, contacts)
    return float(web.splice_step_m * on_wrap(web.splice_piece_m, past_m, wrap_m))
