"""Compiled lookup in shape tables, for the line's kernel.

It takes deviations from the mean radius, so one table serves a roll at every radius:
p = R + h, radius of curvature = R + rho.
"""

from __future__ import annotations

from math import floor, pi

from sim_plant.base.jit import compiled
from sim_plant.geometry.shapes import Floats

_TWO_PI = 2.0 * pi


@compiled
def support_at(h: Floats, dh: Floats, rho: Floats, psi_rad: float) -> tuple[float, float, float]:
    """Return deviations of h, h' and h + h'', m, at ``psi_rad`` (any turn).

    One quintic per cell matches h, h' and h'' at both ends, and all three results come from it:
    they are consistent to rounding, so the span identity survives interpolation.

    Parameters
    ----------
    h, dh, rho : columns of a ``ShapeTable``, n + 1 points, the last repeats the first.
    """
    cells = h.shape[0] - 1
    step = _TWO_PI / cells
    turn = psi_rad / _TWO_PI
    position = (turn - floor(turn)) * cells
    # an angle that is no number (a run that diverges) has no cell: any will do, the result is none
    i = min(int(position), cells - 1) if position >= 0.0 else 0
    t = position - i
    f0, f1 = h[i], h[i + 1]
    d0, d1 = dh[i] * step, dh[i + 1] * step
    s0, s1 = (rho[i] - f0) * step * step, (rho[i + 1] - f1) * step * step
    rise = f1 - f0
    a = 10.0 * rise - 6.0 * d0 - 4.0 * d1 - 1.5 * s0 + 0.5 * s1
    b = -15.0 * rise + 8.0 * d0 + 7.0 * d1 + 1.5 * s0 - s1
    c = 6.0 * rise - 3.0 * d0 - 3.0 * d1 - 0.5 * s0 + 0.5 * s1
    value = f0 + t * (d0 + t * (0.5 * s0 + t * (a + t * (b + t * c))))
    slope = d0 + t * (s0 + t * (3.0 * a + t * (4.0 * b + t * 5.0 * c)))
    bend = s0 + t * (6.0 * a + t * (12.0 * b + t * 20.0 * c))
    return value, slope / step, value + bend / (step * step)
