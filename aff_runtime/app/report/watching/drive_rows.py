"""What one steady stretch says of the friction of every drive whose torque is recorded.

J dw/dt = torque + R (tension after - tension before) - friction [source 2.9]. At a steady speed
the left side is zero: friction is the torque less R (tension before - tension after). It is that
of all that turns between the drive and the cells that read these tensions, idlers on the way too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from aff_runtime.app.report.comparison.turns import Array
from aff_runtime.app.report.comparison.window import Window, roll_angle
from aff_runtime.app.report.watching.order_rows import is_wound
from aff_runtime.app.report.watching.tables import DriveRow, HourRow
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.yaml_section import Section

MOST_ROWS = 50
"""Rows of one stretch, as with orders; a line has some ten drives."""
PARTS = 10
"""Parts of a stretch, 2 s and more each: loops of drives and tension have settled within one."""


def drive_rows(window: Window, hour: HourRow) -> Iterator[DriveRow]:
    """Yield what a stretch says of every drive that has a torque and a tension beside it."""
    rows = 0
    for name, given in window.section("rolls").items():
        section = Section.of(given)
        torque = window.readings(text_or(section.get("torque")))
        named = [text_or(section.get(key)) for key in ("tension_before", "tension_after")]
        sides = [window.readings(one) for one in named]
        angle = roll_angle(window, section)
        lost = any(n and side is None for n, side in zip(named, sides, strict=True))
        if torque is None or angle is None or lost or not any(named):
            continue
        rows += 1
        if rows > MOST_ROWS:
            return
        before, after = (np.zeros_like(torque) if side is None else side for side in sides)
        radius_m = float(np.mean(angle.radius_m))
        web_N_m = radius_m * (before - after)
        friction, error = _mean_and_error(torque - web_N_m)
        yield DriveRow(
            run_id=hour.run_id,
            hour=hour.hour,
            time_utc=hour.time_utc,
            signal=printable(text_or(section.get("torque")), 100),
            roll=printable(str(name), 100),
            is_roll=is_wound(section),
            correcting=hour.correcting,
            speed_m_s=hour.speed_m_s,
            radius_m=radius_m,
            speed_rad_s=math.tau * angle.rate_Hz(window.time_s),
            torque_N_m=float(np.nanmean(torque)),
            web_N_m=float(np.nanmean(web_N_m)),
            friction_N_m=friction,
            friction_error_N_m=error,
        )


def _mean_and_error(values: Array) -> tuple[float, float]:
    """Return the mean of readings and its standard error, from how parts of them differ."""
    finite = values[np.isfinite(values)]
    if finite.size < PARTS:
        return math.nan, math.nan
    means = np.array([part.mean() for part in np.array_split(finite, PARTS)])
    return float(finite.mean()), float(np.std(means, ddof=1)) / math.sqrt(PARTS)
