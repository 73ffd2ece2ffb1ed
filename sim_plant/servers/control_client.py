"""One command to the control socket of a served plant, and its answer."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

_PATIENCE_S = 5.0


def ask(control: Path, command: str) -> dict[str, Any]:
    """Return the plant's answer to one command line.

    Raises
    ------
    OSError
        Nobody serves the socket.
    ValueError
        The answer is none.
    """
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
        client.settimeout(_PATIENCE_S)
        client.connect(str(control))
        client.sendall(command.encode() + b"\n")
        with client.makefile("rb") as stream:
            return dict(json.loads(stream.readline()))
