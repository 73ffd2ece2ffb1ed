"""One request to the running service, from a command line or a screen."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import AffError, RefusedError, WireError


class ServiceClient:
    """A connection to the request socket.

    Raises
    ------
    WireError
        When no service listens there.
    """

    def __init__(self, path: Path, *, timeout_s: float = 5.0) -> None:
        self._path = path
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(timeout_s)
        try:
            self._socket.connect(str(path))
        except OSError as error:
            self._socket.close()
            raise WireError(
                f"{path}: no service answers ({error.strerror}); "
                "start it with `aff-runtime run SITE.yaml`, or name its --runtime-dir"
            ) from None
        self._stream = self._socket.makefile("rb")

    def ask(self, do: str, *, timeout_s: float | None = None, **arguments: Any) -> dict[str, Any]:
        """Send one request and return its answer.

        Raises
        ------
        RefusedError
            When the service says no; the message says why.
        WireError
            When the service goes away or says nothing.
        """
        if timeout_s is not None:
            self._socket.settimeout(timeout_s)
        try:
            self._socket.sendall(json.dumps({"do": do, **arguments}).encode() + b"\n")
            line = self._stream.readline()
        except OSError as error:
            raise WireError(f"{self._path}: the service does not answer ({error})") from None
        if not line:
            raise WireError(f"{self._path}: the service closed the connection; see its log")
        answer: dict[str, Any] = json.loads(line)
        if not answer.get("ok", False):
            raise _refusal(answer)
        return answer

    def close(self) -> None:
        """Hang up."""
        self._stream.close()
        self._socket.close()


def _refusal(answer: dict[str, Any]) -> AffError:
    """Return the error that a negative answer stands for."""
    error: AffError = RefusedError(str(answer.get("message", "refused")))
    error.exit_code = int(answer.get("exit_code", RefusedError.exit_code))
    return error
