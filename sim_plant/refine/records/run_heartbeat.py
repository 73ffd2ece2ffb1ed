"""The PLC's heartbeat as a count of its scans that does not start over."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from aff_runtime.base.yaml_section import Section
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA

RUN = CRITERIA.records.run
FEWEST_BITS, WORD_BITS = 8, 16
"""Of a heartbeat: as few as a wire may have, and those of a Modbus word."""
HEARTBEAT_COUNTS = 2.0**WORD_BITS
"""After as many a heartbeat of one word starts over."""
MOST_BITS = 52
"""A longer count is no whole number in a record."""


def modulus_of(about: Section, columns: Mapping[str, Array]) -> tuple[float, str]:
    """Return after how many counts a run's heartbeat starts over, and a sentence where guessed.

    ``run.yaml`` has it of the wire. Of a run without it, it is that of a word, unless the
    heartbeat steps back, and most of these steps agree with the clock at the least power of 2
    above its largest count.
    """
    said = about.get("heartbeat_modulus")
    if isinstance(said, int) and 2**FEWEST_BITS <= said <= 2**MOST_BITS:
        return float(said), ""
    time_s, beat = columns["time_s"], columns["plc_heartbeat"]
    known = np.isfinite(time_s) & (np.abs(beat) < 2.0**MOST_BITS)
    time_s, beat = time_s[known], beat[known]
    word = HEARTBEAT_COUNTS
    if beat.size < 2:
        return word, ""
    bits = max(FEWEST_BITS, int(beat.max()).bit_length())
    steps, elapsed_s = np.diff(beat), np.diff(time_s)
    forward = (steps > 0.0) & (elapsed_s > 0.0) & (elapsed_s < RUN.late_s)
    back = (steps < 0.0) & (elapsed_s > 0.0) & (elapsed_s < RUN.late_s)
    if bits > WORD_BITS:
        return 2.0**bits, f"the PLC's heartbeat is taken to start over after {2**bits} counts"
    if bits == WORD_BITS or not back.any() or not forward.any():
        return word, ""
    scan_s = float(np.sum(elapsed_s[forward]) / np.sum(steps[forward]))
    off_s = np.abs((steps[back] + 2.0**bits) * scan_s - elapsed_s[back])
    if float(np.mean(off_s < RUN.late_s)) <= 0.5:
        return word, ""
    return 2.0**bits, f"the PLC's heartbeat is taken to start over after {2**bits} counts"


def scans_between(beat: Array, elapsed_s: Array, modulus: float) -> tuple[Array, Array]:
    """Return by how many counts each row's heartbeat is further than that of the row before.

    As the counter alone says, less than ``modulus``; and with the whole rounds of it that the
    clock has seen, ``elapsed_s`` over the usual time of a count.
    """
    moved: Array = np.mod(np.diff(beat), modulus)
    usual = (elapsed_s > 0.0) & (elapsed_s < RUN.late_s) & (moved > 0.0)
    counts = float(np.sum(moved[usual]))
    if not counts > 0.0:
        return moved, moved
    rounds = np.rint((elapsed_s * counts / float(np.sum(elapsed_s[usual])) - moved) / modulus)
    return moved, moved + modulus * np.maximum(rounds, 0.0)
