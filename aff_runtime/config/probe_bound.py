"""How loud a probe may be at one actuator, by the site file."""

from __future__ import annotations

import math
from dataclasses import dataclass

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.config.models import Site
from aff_runtime.config.models.service import BOUND_SHARE

TIMES_LOUDER = 2.0
"""By which a louder probe is: four times the power, a coherence of 0.5 turns to 0.8."""


LINE_SPEED, OF_SPEED_ALONE = "a line that runs", "a speed reference that moves a tension"
"""What a site file cannot say, and what no site file makes of another output."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeBound:
    """In the unit of the actuator's output.

    Attributes
    ----------
    given : the amplitude that the site file sets; None: it is chosen from the noise.
    most : that a chosen amplitude takes: of the probe's bound and the actuator's limit the lesser.
    key : of the site file, that holds ``most``.
    bound_N : by how much the tension may move, where the site file says it; None for none.
    share : of its mean by which it may move, where nothing is said and the amplitude is chosen.
    """

    given: float | None
    most: float
    key: str
    bound_N: float | None
    share: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedRipple:
    """How far a probe moves a tension before any probe has measured it.

    Attributes
    ----------
    ripple_N : at most; None where it is not known. ``speed_m_s`` : of the line, for which it is.
    lacks : keys of the site file, or what else, that would say it.
    """

    ripple_N: float | None
    speed_m_s: float | None
    lacks: tuple[str, ...]


def expected_ripple(
    site: Site, actuator: str, amplitude: float, speed_m_s: float
) -> ExpectedRipple:
    """Return by how much a probe moves the tension at most, by what the web is.

    The span behind a roller whose speed is off by ``a`` sin(w t) holds a tension of amplitude
    a E A / |v + i w L|: its length L makes it less, so a E A / v bounds it at every frequency.
    Neither the drive's overshoot nor the line's own tension loop is in it. From the balance
    of a span [source 2.20].

    Parameters
    ----------
    amplitude : of the probe, m/s. ``speed_m_s`` : of the line now; NaN where it is not known.
    """
    row, probe = site.actuators[actuator], site.probe
    if row.output != "velocity_reference" or unit_of_channel(row.error.signal) != "N":
        return ExpectedRipple(ripple_N=None, speed_m_s=None, lacks=(OF_SPEED_ALONE,))
    declared = row.drive.web_width_m if row.drive is not None else 0.0
    width_m = probe.web_width_m or declared or None
    known = {
        "probe.web_modulus_Pa": probe.web_modulus_Pa,
        "probe.web_thickness_m": probe.web_thickness_m,
        "probe.web_width_m": width_m,
        LINE_SPEED: speed_m_s if speed_m_s > row.active_above_m_s else None,
    }
    lacks = tuple(name for name, value in known.items() if value is None)
    if lacks:
        return ExpectedRipple(ripple_N=None, speed_m_s=None, lacks=lacks)
    stiffness_N = math.prod(v for n, v in known.items() if n != LINE_SPEED and v is not None)
    return ExpectedRipple(
        ripple_N=amplitude * stiffness_N / speed_m_s, speed_m_s=speed_m_s, lacks=()
    )


def probe_bound(site: Site, actuator: str) -> ProbeBound:
    """Return what bounds the amplitude of a probe at one actuator."""
    row, probe = site.actuators[actuator], site.probe
    of_speed = row.output == "velocity_reference"
    given = probe.amplitude_m_s if of_speed else probe.amplitude_N_m
    bound = probe.bound_m_s if of_speed else probe.bound_N_m
    key = "probe.bound_m_s" if of_speed else "probe.bound_N_m"
    is_tension = unit_of_channel(row.error.signal) == "N"
    bound_N = probe.bound_N if is_tension else None
    is_tenth = is_tension and given is None and bound_N is None
    return ProbeBound(
        given=given,
        most=min(bound, row.limit) if row.limit > 0 else bound,
        key=key,
        bound_N=bound_N,
        share=BOUND_SHARE if is_tenth else None,
    )
