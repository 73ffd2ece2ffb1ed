"""Words that hold a float: AFF reads whole numbers alone, so it is said and not offered."""

from __future__ import annotations

import math

from aff_runtime.app.setup.words.display import Shown
from aff_runtime.app.setup.words.reading import Watched
from aff_runtime.base.units import accepted_units, to_si
from aff_runtime.fieldbus.modbus.probe_map import decodings


def float_hints(shown: Shown, seen: Watched, si_unit: str) -> list[str]:
    """Return what to tell of words that show the typed value as a float in some unit."""
    hints = []
    for address, series in sorted(seen.words.items()):
        second = seen.words.get(address + 1)
        if second is None:
            continue
        for row in decodings(series[-1], second[-1]):
            for unit in accepted_units(si_unit):
                si = row.f32 * to_si(unit)[1]
                if math.isfinite(si) and abs(si - shown.value) <= 1.5 * shown.half_digit:
                    hints.append(
                        f"words {address} and {address + 1} read {row.f32:.6g} {unit} as a float "
                        f"({row.order}). AFF takes whole numbers: let the PLC scale it."
                    )
                    break
    return hints
