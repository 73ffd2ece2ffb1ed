"""Web from a roll to the next driven one: spans are springs, idlers are masses on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class WebChain:
    """A web path as few numbers; every one of them is found, none declared. (variants, 1) each.

    Attributes
    ----------
    stiffness_N_m : of the whole length, EA / L.
    mass_kg : of all idlers, J / r^2 summed.
    loss_s : Kelvin-Voigt, T = EA (strain + loss rate).
    renewal_rad_s : line speed over length.
    first_span, last_span : length over that of a span between idlers.
    """

    stiffness_N_m: Floats
    mass_kg: Floats
    loss_s: Floats
    renewal_rad_s: Floats
    first_span: Floats
    last_span: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """What a tension T and a surface speed V at the far end make, (variants, frequencies, 2)."""

    roll_speed: Complexes
    roll_tension: Complexes
    cell_tension: Complexes


def seen_from_the_far_end(chain: WebChain, s: Complexes, idlers: int, cell: int) -> Seen:
    """Return speed and tension at the roll and tension at the cell, per (T, V) of the far end.

    Going against the web, span by span: its tension stretches it, T (l s) / (k vis) = V_down -
    V_up with the strain that comes in from before (share of ``renewal_rad_s``), and an idler
    between two spans takes T_down - T_up = m s V. The strain on the roll is that of its winding
    and brings no ripple.

    Parameters
    ----------
    cell : the idler with the load cell, counted from the far end, 1 the last; it reads the mean of
        the two spans beside it.
    """
    spring = chain.stiffness_N_m * (1.0 + s * chain.loss_s)
    between = idlers - 1
    parts = chain.first_span + chain.last_span + between
    mass = chain.mass_kg / idlers
    one, none = np.ones_like(spring), np.zeros_like(spring)
    tension = np.stack([one, none], axis=-1)
    speed = np.stack([none, one], axis=-1)
    at_cell = tension
    carried = 1.0 + chain.renewal_rad_s / spring * mass * s
    for k in range(1, idlers + 1):
        length = (chain.last_span if k == 1 else 1.0) / parts
        speed = (speed - (length * s / spring)[..., None] * tension) / carried[..., None]
        before = tension - (mass * s)[..., None] * speed
        if k == cell:
            at_cell = 0.5 * (tension + before)
        tension = before
    length = chain.first_span / parts
    speed = speed - ((length * s + chain.renewal_rad_s) / spring)[..., None] * tension
    return Seen(roll_speed=speed, roll_tension=tension, cell_tension=at_cell)
