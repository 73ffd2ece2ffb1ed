"""Where callers are heard: one line at a time, and every request gets an answer or a refusal."""

from __future__ import annotations

import selectors
from collections.abc import Callable

from aff_runtime.app.link.answers import refusal
from aff_runtime.app.link.peer import service_uids
from aff_runtime.app.link.request_socket import Asked, Caller, RequestSocket
from aff_runtime.app.link.requests import (
    MAX_REQUEST_BYTES,
    QUESTIONS,
    BabbleError,
    BadRequestError,
    Request,
    read_request,
)
from aff_runtime.base.errors import AffError, RefusedError

MAX_WAITING = 64  # callers that wait for an answer
MAX_OWED = 8  # answers that one caller waits for
LINES_PER_ROUND = 16  # of one caller, before others have their turn


class RequestDesk:
    """Takes callers and their requests off the socket.

    Parameters
    ----------
    requests : the listening socket.
    selector : tells when somebody speaks or listens again.
    do : does what was asked, or raises AffError; answers now or later.
    forget : called with a caller who has hung up.
    """

    def __init__(
        self,
        requests: RequestSocket,
        selector: selectors.BaseSelector,
        do: Callable[[Asked], None],
        forget: Callable[[Caller], None],
    ) -> None:
        self._requests = requests
        self._selector = selector
        self._do = do
        self._forget = forget
        selector.register(requests.listener, selectors.EVENT_READ)

    def serve(self, key: selectors.SelectorKey, events: int) -> bool:
        """Do what a selector's event asks for; False when it is none of the desk's."""
        if key.fileobj is self._requests.listener:
            self._accept()
        elif isinstance(key.data, Caller):
            if self._requests.callers.get(key.fd) is key.data:
                self._attend(key.data, events)
        else:
            return False
        return True

    def look_after(self) -> None:
        """See that answers given meanwhile reach those who did not take them at once."""
        for caller in self._requests.callers.values():
            if caller.has_more:
                self._await(caller)

    def close(self) -> None:
        """Send everybody away and remove the socket."""
        self._requests.close()

    def _accept(self) -> None:
        """Take one caller; when there are too many, the one who was silent longest goes."""
        caller = self._requests.accept()
        if caller is not None:
            self._selector.register(caller.connection, selectors.EVENT_READ, caller)
        surplus = self._requests.surplus()
        if surplus is not None:
            self._send_away(surplus, "too many callers, and this one has said nothing for longest")

    def _attend(self, caller: Caller, events: int) -> None:
        """Send to and read from one caller, ``LINES_PER_ROUND`` requests at most."""
        if events & selectors.EVENT_READ and not caller.read():
            self._hang_up(caller)
            return
        if not caller.flush():
            self._hang_up(caller)
            return
        for _ in range(LINES_PER_ROUND):
            line = caller.next_line()
            if line is None:
                break
            self._requests.heard(caller)
            try:
                self._hear(caller, line)
            except BabbleError as error:
                self._send_away(caller, str(error))
                return
        if caller.is_too_long:
            self._send_away(caller, f"a request has {MAX_REQUEST_BYTES} bytes at most")
            return
        self._await(caller)

    def _await(self, caller: Caller) -> None:
        """Wait until the caller takes more where something is left for it, else until it sends."""
        wanted = selectors.EVENT_WRITE if caller.has_more else selectors.EVENT_READ
        self._selector.modify(caller.connection, wanted, caller)

    def _hear(self, caller: Caller, line: bytes) -> None:
        """Have one request done."""
        try:
            request = read_request(line)
            self._check(caller, request)
        except BadRequestError as error:
            caller.send(refusal(error), error.ident)
            return
        asked = Asked(caller, request)
        try:
            self._do(asked)
        except AffError as error:
            asked.refuse(error)

    def _check(self, caller: Caller, request: Request) -> None:
        """Refuse to hear who may not speak for others, and questions beyond what may wait.

        ``bypass``, ``stop`` and ``status`` never wait.
        """
        if request.by and caller.peer.uid not in service_uids():
            raise BadRequestError("by: only a service of ours speaks for others", request.ident)
        if request.do not in QUESTIONS:
            return
        if caller.owed >= MAX_OWED or (not caller.owed and self._requests.waiting >= MAX_WAITING):
            text = "busy: too many questions wait for their answers; try again"
            raise BadRequestError(text, request.ident)

    def _send_away(self, caller: Caller, why: str) -> None:
        """Say why, as far as the caller listens, and hang up."""
        caller.send(refusal(RefusedError(f"{why}; connect again")))
        self._hang_up(caller)

    def _hang_up(self, caller: Caller) -> None:
        """Let go of one caller."""
        self._selector.unregister(caller.connection)
        self._forget(caller)
        self._requests.drop(caller)
