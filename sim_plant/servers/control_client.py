"""One command to the control socket of a served plant, and its answer."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

_PATIENCE_S = 5.0
_PER_SAMPLE_S = 0.01  # some thirty times what a sample takes


def ask(control: Path, command: str) -> dict[str, Any]:
    """Return the plant's answer to one command line; ``step N`` is waited for as N asks.

    Raises
    ------
    OSError
        Nobody serves the socket.
    ValueError
        The answer is none.
    """
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
        client.settimeout(_patience_s(command))
        client.connect(str(control))
        client.sendall(command.encode() + b"\n")
        with client.makefile("rb") as stream:
            return dict(json.loads(stream.readline()))


def _patience_s(command: str) -> float:
    name, _, number = command.partition(" ")
    steps = int(number) if name == "step" and number.isdecimal() else 0
    return _PATIENCE_S + _PER_SAMPLE_S * steps
