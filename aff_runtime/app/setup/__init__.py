"""From the words of a PLC to a site file: what `aff-runtime setup` and the screen ask and find."""

__all__ = [
    "angles",
    "behaviour",
    "candidates",
    "decoding",
    "display",
    "draft",
    "floats",
    "interview",
    "plc",
    "quantities",
    "questions",
    "reading",
    "site_text",
    "status_bits",
]
