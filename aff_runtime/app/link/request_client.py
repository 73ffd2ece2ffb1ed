"""One request to the running service, from a command line or a screen.

Who answers is as good as who asks: before a word is said, the folder must belong to a user whose
service we trust, and the process that listens in it too (root, ourselves, the service's own user).
"""

from __future__ import annotations

import errno
import json
import socket
import struct
from pathlib import Path
from typing import Any

from aff_runtime.app.link.answers import Done
from aff_runtime.app.link.peer import (
    NOBODY_LOGGED_IN,
    Peer,
    own_process,
    peer_of,
    service_uids,
    user_name,
)
from aff_runtime.app.link.runtime_directory import check_trusted, how_to_reach
from aff_runtime.base.errors import AffError, RefusedError, WireError
from aff_runtime.base.printable import printable

MAX_ANSWER_BYTES = 1 << 22
MAX_NAME_CHARACTERS = 40  # with the text around it within ``requests.MAX_BY_CHARACTERS``
_TIMEVAL = struct.Struct("ll")


class ServiceClient:
    """A connection to the request socket.

    Raises
    ------
    WireError
        When no service listens there, or it is busy.
    RefusedError
        When folder or listener belong to somebody whose service this cannot be.
    """

    def __init__(self, path: Path, *, timeout_s: float = 5.0) -> None:
        self._path = path
        check_trusted(path.parent)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            self._connect(timeout_s)
            self._check_listener()
        except BaseException:
            self._socket.close()
            raise
        self._socket.settimeout(timeout_s)
        self._stream = self._socket.makefile("rb")

    def _connect(self, timeout_s: float) -> None:
        """Connect, waiting for a place in the queue."""
        patience = _TIMEVAL.pack(int(timeout_s), int(timeout_s % 1.0 * 1e6))
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, patience)
        try:
            self._socket.connect(str(self._path))
        except OSError as error:
            if error.errno == errno.EAGAIN:
                text = f"the service is busy: its queue stayed full for {timeout_s:g} s; try again"
                raise WireError(f"{self._path}: {text}") from None
            if error.errno == errno.EACCES:
                raise RefusedError(how_to_reach(self._path.parent)) from None
            raise WireError(
                f"{self._path}: no service answers ({error.strerror or error}); "
                "start it with `aff-runtime run SITE.yaml`, or name its --runtime-dir"
            ) from None

    def _check_listener(self) -> None:
        """Refuse an answer from anybody else's process."""
        peer = peer_of(self._socket)
        if peer.uid not in service_uids():
            raise RefusedError(
                f"{self._path}: process {peer.pid} of uid {peer.uid} ({user_name(peer.uid)}) "
                "listens there, which is no service of ours; nothing was asked. Name the "
                "service's own --runtime-dir"
            )

    def ask(self, do: str, *, timeout_s: float | None = None, **arguments: Any) -> dict[str, Any]:
        """Send one request and return its answer, every text in it made printable.

        Raises
        ------
        RefusedError
            When the service says no; the message says why.
        WireError
            When the service goes away or says nothing that can be understood.
        """
        if timeout_s is not None:
            self._socket.settimeout(timeout_s)
        if "by" not in arguments and (login := login_behind(own_process())):
            arguments["by"] = login
        try:
            self._socket.sendall(json.dumps({"do": do, **arguments}).encode() + b"\n")
            line = self._stream.readline(MAX_ANSWER_BYTES)
        except OSError as error:
            raise WireError(f"{self._path}: the service does not answer ({error})") from None
        if not line:
            raise WireError(f"{self._path}: the service closed the connection; see its log")
        answer = _read_answer(line)
        if answer is None:
            raise WireError(f"{self._path}: the answer cannot be read; is it another release?")
        done = Done.from_json(answer)
        if not done.ok:
            raise _refusal(done)
        return answer

    def close(self) -> None:
        """Hang up."""
        self._stream.close()
        self._socket.close()


def _read_answer(line: bytes) -> dict[str, Any] | None:
    """Return an answer, None when the line is none."""
    try:
        said = json.loads(line)
        return shown(said) if isinstance(said, dict) else None
    except (ValueError, RecursionError):
        return None


def shown(value: Any) -> Any:
    """Return plain data whose texts, keys among them, show as themselves."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, dict):
        return {printable(key): shown(inner) for key, inner in value.items()}
    return [shown(inner) for inner in value] if isinstance(value, list) else value


def _refusal(answer: Done) -> AffError:
    """Return the error that a negative answer stands for."""
    error: AffError = RefusedError("\n".join((answer.message or "refused", *answer.more)))
    if answer.exit_code is not None:
        error.exit_code = answer.exit_code
    return error


def login_behind(caller: Peer) -> str:
    """Return the login from which root commands, for ``by``; empty for others, and without one.

    The installed service does not see the processes of root (ProtectProc=invisible), so it cannot
    look itself. Its own user's processes it sees.
    """
    login = caller.login_uid
    if caller.uid != 0 or login is None or login in (0, NOBODY_LOGGED_IN):
        return ""
    return f"login {login} ({user_name(login)[:MAX_NAME_CHARACTERS]})"
