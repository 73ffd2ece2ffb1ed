"""Counts of a window that wrap earlier than their site file says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from aff_runtime.app.report.comparison.turns import Array
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.counted_angle import early_wrap, modulus_rad, range_counts
from aff_runtime.base.yaml_section import Section


def counts_that_wrap_early(
    time_s: Array, readings: Mapping[str, Array], channels: Section
) -> Iterator[str]:
    """Yield a sentence per counted angle (rows,) that does, with what to write."""
    for name, values in readings.items():
        channel = channels.section(name)
        modulus = modulus_rad(channel) if name.endswith("_rad") else 0.0
        found = early_wrap(time_s, values, modulus) if modulus else None
        if found is not None:
            yield f"{printable(name, 80)}: {found.words(modulus, range_counts(channel))}"
