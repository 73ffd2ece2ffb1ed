"""Impulse responses for the shape law, worked out by the check and handed to the cycle ready.

To find one takes some tenths of a second, which the control process does not have between two
ticks; the short-lived check has.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from aff_runtime.config.models import Site
from aff_runtime.core.impulse import LoopModel, from_response
from aff_runtime.core.response import Response

DIGITS = 6  # significant, of a tap


def taps_by_actuator(site: Site, responses: Mapping[str, str]) -> dict[str, tuple[float, ...]]:
    """Return the taps of every actuator that runs the shape law and has a response."""
    found = {}
    for name, actuator in site.actuators.items():
        if actuator.uses_shape and name in responses:
            impulse = from_response(
                Response.from_json(responses[name]),
                cycle_s=site.cycle_s,
                memory_s=actuator.response_memory_s,
            )
            found[name] = tuple(float(f"{tap:.{DIGITS}g}") for tap in impulse.taps[0])
    return found


def impulse_responses(taps_of: Mapping[str, Sequence[float]]) -> dict[str, LoopModel]:
    """Return the impulse responses by actuator, of their taps."""
    return {
        name: LoopModel(radius_m=np.array([np.nan]), taps=np.array([taps]))
        for name, taps in taps_of.items()
    }
