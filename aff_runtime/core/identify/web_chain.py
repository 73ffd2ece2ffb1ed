"""Web from a roll to the next driven one: spans are springs, idlers are masses on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class WebChain:
    """A web path; every number of it is found, none declared. (variants, 1) each but the lists.

    Attributes
    ----------
    stiffness_N_m : of the whole length, EA / L.
    loss_s : Kelvin-Voigt, T = EA (strain + loss rate).
    renewal_rad_s : line speed over length.
    drag_rad_s : friction of the idlers over their mass.
    masses_kg : (variants, idlers), J / r^2 of each; the first is the last that the web passes.
    lengths : (variants, idlers + 1), span by span from the far end; their unit does not matter.
    """

    stiffness_N_m: Floats
    loss_s: Floats
    renewal_rad_s: Floats
    drag_rad_s: Floats
    masses_kg: Floats
    lengths: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """What a tension T and a surface speed V at the far end make, (2, variants, frequencies)."""

    roll_speed: Complexes
    roll_tension: Complexes
    cell_tension: Complexes


def seen_from_the_far_end(chain: WebChain, s: Complexes, cell: int) -> Seen:
    """Return speed and tension at the roll and tension at the cell, per (T, V) of the far end.

    Going against the web, span by span: its tension stretches it, T (l s) / (k vis) = V_down -
    V_up with the strain that comes in from before (share of ``renewal_rad_s``), and an idler
    between two spans takes T_down - T_up = m (s + drag) V. The strain on the roll is that of its
    winding and brings no ripple.

    Parameters
    ----------
    cell : the idler with the load cell, counted from the far end, 1 the last; it reads the mean of
        the two spans beside it.
    """
    spring = chain.stiffness_N_m * (1.0 + s * chain.loss_s)
    shares = chain.lengths / chain.lengths.sum(axis=1, keepdims=True)
    one, none = np.ones_like(spring), np.zeros_like(spring)
    tension, speed = np.stack([one, none]), np.stack([none, one])
    at_cell = tension
    slow, moved = s / spring, s + chain.drag_rad_s
    carried = chain.renewal_rad_s * moved / spring
    for k in range(chain.masses_kg.shape[1]):
        mass = chain.masses_kg[:, k, None]
        speed = (speed - shares[:, k, None] * slow * tension) / (1.0 + mass * carried)
        before = tension - mass * moved * speed
        if k + 1 == cell:
            at_cell = 0.5 * (tension + before)
        tension = before
    speed = speed - (shares[:, -1, None] * slow + chain.renewal_rad_s / spring) * tension
    return Seen(roll_speed=speed, roll_tension=tension, cell_tension=at_cell)
