"""What words of a PLC can be: decodings, scales, counters, angles, bits; nothing is asked here."""

__all__ = [
    "angles",
    "apart",
    "behaviour",
    "candidates",
    "decoding",
    "display",
    "floats",
    "reading",
    "scale_steps",
    "status_bits",
]
