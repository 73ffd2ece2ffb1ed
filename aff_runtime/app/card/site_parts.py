"""A site file in parts: which keys belong together, and a digest of each part.

A step rests on the parts that its figures come from. The whole file's hash would turn every step
to "again" by an edit that a later step asks for: the noise that step 1 proposes, the settle time
of step 9, the orders of step 10.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from enum import StrEnum

from aff_runtime.config.findings import KeyPath, dotted
from aff_runtime.config.leaves import leaves
from aff_runtime.config.models import Site


class Part(StrEnum):
    """Keys of a site file that change together, in the words of the card."""

    LINE = "cycle and speed of the line"
    CHANNELS = "channels and their scales"
    WIRE = "wire and its other words"
    PERMISSIVES = "permissives and believable ranges"
    FRESHNESS = "freshness"
    ROLLS = "rolls"
    SIGNALS = "signal and output of the actuators"
    LIMITS = "limits and ramps of the actuators"
    LAW = "law, drive and noise of the actuators"
    TUNING = "orders, amplitudes, settle_s and memory_turns"
    ASIDE = "name, probe and recording"


_ANY = "*"
_PARTS: tuple[tuple[tuple[str, ...], Part], ...] = (
    (("line", "name"), Part.ASIDE),
    (("line",), Part.LINE),
    (("version",), Part.ASIDE),
    (("gateway", "read", "channels"), Part.CHANNELS),
    (("gateway", "address_base"), Part.CHANNELS),
    (("gateway", "word_order"), Part.CHANNELS),
    (("gateway",), Part.WIRE),
    (("permissives",), Part.PERMISSIVES),
    (("plausibility",), Part.PERMISSIVES),
    (("freshness",), Part.FRESHNESS),
    (("rolls",), Part.ROLLS),
    (("actuators", _ANY, "error", "signal"), Part.SIGNALS),
    (("actuators", _ANY, "error", "reference"), Part.SIGNALS),
    (("actuators", _ANY, "output"), Part.SIGNALS),
    (("actuators", _ANY, "limit_m_s"), Part.LIMITS),
    (("actuators", _ANY, "limit_N_m"), Part.LIMITS),
    (("actuators", _ANY, "slew_m_s2"), Part.LIMITS),
    (("actuators", _ANY, "slew_N_m_s"), Part.LIMITS),
    (("actuators", _ANY, "soft_start_s"), Part.LIMITS),
    (("actuators", _ANY, "active_above_m_s"), Part.LIMITS),
    (("actuators", _ANY, "blocks"), Part.TUNING),
    (("actuators", _ANY, "memory_turns"), Part.TUNING),
    (("actuators",), Part.LAW),
    (("probe",), Part.ASIDE),
    (("recording",), Part.ASIDE),
)
"""Beginnings of paths; the first row that fits counts. What has no row is of the line: all steps
that look at the site file rest on that."""
ALL = tuple(part for part in Part if part is not Part.ASIDE)
"""What may change what runs."""
_OF_FILES = (Part.CHANNELS, Part.WIRE)
"""Parts that a DBC or EDS file says more of: where each value lies, its scale and sign."""


def part_of(path: KeyPath) -> Part:
    """Return the part that a key belongs to."""
    return next((part for row, part in _PARTS if _fits(row, path)), Part.LINE)


def parts_of(site: Site, wire_digests: Mapping[str, str]) -> dict[str, str]:
    """Return the SHA-256 of every part by its name.

    Parameters
    ----------
    wire_digests : of the files that describe the wire, by name.
    """
    values: dict[Part, list[object]] = {part: [] for part in Part}
    for part in _OF_FILES:
        values[part] += [[name, wire_digests[name]] for name in sorted(wire_digests)]
    for leaf in leaves(site):
        values[part_of(leaf.path)].append([dotted(leaf.path), leaf.value])
    return {part.name: _digest(content) for part, content in values.items()}


def _fits(row: Sequence[str], path: KeyPath) -> bool:
    return len(path) >= len(row) and all(
        want in (_ANY, key) for want, key in zip(row, path, strict=False)
    )


def _digest(content: object) -> str:
    text = json.dumps(content, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return hashlib.sha256(text.encode("ascii")).hexdigest()
