"""How loud a probe may be at one actuator, by the site file."""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.config.models import Site

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
    """

    given: float | None
    most: float
    key: str


def probe_bound(site: Site, actuator: str) -> ProbeBound:
    """Return what bounds the amplitude of a probe at one actuator."""
    row, probe = site.actuators[actuator], site.probe
    of_speed = row.output == "velocity_reference"
    given = probe.amplitude_m_s if of_speed else probe.amplitude_N_m
    bound = probe.bound_m_s if of_speed else probe.bound_N_m
    key = "probe.bound_m_s" if of_speed else "probe.bound_N_m"
    return ProbeBound(given=given, most=min(bound, row.limit) if row.limit > 0 else bound, key=key)
