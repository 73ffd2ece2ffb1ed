"""How much of a CAN bus the cyclic frames take, worst-case bit stuffing counted."""

from __future__ import annotations

MOST_SHARE = 0.5


def frame_bits(length: int, *, extended: bool = False) -> int:
    """Return the longest a classic data frame of ``length`` bytes can be, bits.

    g + 8 n + 13 bits with floor((g + 8 n - 1) / 4) stuff bits, g = 34 (11-bit identifier) or
    54 (29-bit); Davis, Burns, Bril, Lukkien, "Controller Area Network schedulability analysis",
    2007. 8 bytes with 11-bit identifier: 135 bits, interframe space included.
    """
    head = 54 if extended else 34
    return head + 8 * length + 13 + (head + 8 * length - 1) // 4


def bus_share(frames: list[tuple[int, bool]], bitrate: int, period_s: float) -> float:
    """Return the share of the bus that ``frames`` (length, extended), each once a period, take."""
    return sum(frame_bits(n, extended=e) for n, e in frames) / (bitrate * period_s)
