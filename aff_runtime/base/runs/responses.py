"""Responses that were measured during a run: the files of a run folder that hold them.

One file per probe and actuator, ``response-ACTUATOR-DIGEST.json``: the text of the response file
with the units of its numbers.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping

MOST_RESPONSES = 300
"""Of one run; what is measured beyond that is not kept."""
LARGEST_RESPONSE = 1 << 20
"""Bytes of one."""
DIGITS = 12
"""Of the digest of a text that names its file: the same text twice is one file."""
RESPONSE_FILE = re.compile(r"response-[A-Za-z0-9_-]{1,100}\.json")
UNITS, GAIN = "units", "gain"


def response_file(actuator: str, text: str) -> str:
    """Return the name of the file that holds a response."""
    safe = re.sub(r"[^A-Za-z0-9_-]+", "-", actuator)[:64]
    return f"response-{safe}-{hashlib.sha256(text.encode()).hexdigest()[:DIGITS]}.json"


def with_units(text: str, gain_unit: str) -> str:
    """Return the text of a response file with the units of its numbers."""
    units: Mapping[str, str] = {
        GAIN: gain_unit,
        "frequency_Hz": "Hz",
        "phase_rad": "rad",
        "relative_error": "1",
        "coherence": "1",
        "delay_s": "s",
    }
    return json.dumps({**json.loads(text), UNITS: units}, indent=1, allow_nan=False) + "\n"
