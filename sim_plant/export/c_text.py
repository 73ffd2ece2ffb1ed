"""Words and numbers in C."""

from __future__ import annotations

import math


def c_string(text: str) -> str:
    """Return a C string; what is not plain, and a percent sign, as octal bytes."""
    plain = "".join(
        chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?%' else f"\\{byte:03o}"
        for byte in text.encode()
    )
    return f'"{plain}"'


def c_bound(value: float) -> str:
    """Return a number in C to the last bit, infinite ones too."""
    return repr(value) if math.isfinite(value) else ("-" if value < 0 else "") + "INFINITY"
