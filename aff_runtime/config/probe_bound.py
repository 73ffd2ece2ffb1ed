"""How loud a probe may be at one actuator, by the site file."""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.config.models import Site
from aff_runtime.config.models.service import BOUND_SHARE

TIMES_LOUDER = 2.0
"""By which a louder probe is: four times the power, a coherence of 0.5 turns to 0.8."""


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
