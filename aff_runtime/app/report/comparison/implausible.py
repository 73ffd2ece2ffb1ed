"""Readings of a window beyond what its site file calls plausible: one alone moves every order."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from aff_runtime.app.report.comparison.window import Window, number
from aff_runtime.base.channel_units import suffix_of_unit, unit_of_channel
from aff_runtime.base.printable import printable
from aff_runtime.base.yaml_section import Section


def implausible_readings(window: Window) -> Iterator[str]:
    """Yield a sentence per channel with readings beyond its range under ``plausibility``."""
    for name, given in window.section("plausibility").items():
        values, unit = window.readings(str(name)), unit_of_channel(str(name))
        if values is None or not unit:
            continue
        low, high = _range(Section.of(given), unit)
        count = int(np.sum((values < low) | (values > high)))
        if count:
            yield (
                f"{printable(str(name), 80)}: {count} readings are not plausible by its site file "
                f"({low:g} to {high:g} {unit}): its figures are with them"
            )


def _range(given: Section, unit: str) -> tuple[float, float]:
    """Return lowest and highest plausible value, SI; infinite where none can be read."""
    ends = (number(given.get(f"{end}_{suffix_of_unit(unit)}"), unit) for end in ("min", "max"))
    low, high = ends
    return -math.inf if math.isnan(low) else low, math.inf if math.isnan(high) else high
