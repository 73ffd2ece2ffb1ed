"""Modbus as a word transport: one transaction per tick, a hard deadline, its own reconnect."""

from __future__ import annotations

from enum import IntEnum
from typing import Final

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.byte_stream import (
    CLOSED,
    DOUBTED,
    LATE,
    SPOILT,
    UNHEARD,
    ByteStream,
    Connecting,
)
from aff_runtime.fieldbus.modbus.frames import (
    READ,
    READ_WRITE,
    WRITE,
    ModbusFrames,
    WireFunction,
    exception_text,
    frame_length,
    transaction_id,
)

_LAST_TID: Final = 0xFFFF
_STALE_WINDOW: Final = 8
_MOST_WAITING: Final = 64  # frames between two ticks, of which none was asked for
_BUFFER_BYTES: Final = 1024
_NO_WORDS: Final[list[int]] = []
_SILENT_SHARE: Final = 0.625  # of the time of the fault: 50 of 80 ms
_SILENT_CYCLES: Final = 2.5  # at least: a reply that is two ticks late costs no connection
_PROVEN_REPLIES: Final = 10  # good ones: the connection works, and what broke it is new
_SPOILT: Final = (
    "the last reply came spoilt (wrong CRC or length): check wiring, termination, baud and parity"
)


def silence_before_reconnect(cycle_s: float, fault_after_s: float) -> float:
    """Return how long a reply may be outstanding before its connection is replaced, s.

    Five eighths of ``fault_after_s``: a reply that is late by less costs nothing, at any cycle. A
    new connection is fresh three ticks after the drop (an attempt; heard once; heard twice),
    which is before ``fault_after_s`` where that is 11 cycles or more.
    """
    return max(_SILENT_SHARE * fault_after_s, _SILENT_CYCLES * cycle_s)


class _Link(IntEnum):
    DOWN = 0
    CONNECTING = 1
    UP = 2


_UP = _Link.UP
_OK, _TIMEOUT = Outcome.OK, Outcome.TIMEOUT
_FC3, _FC23 = WireFunction.FC3, WireFunction.FC23


class ModbusTransport:
    """``WordTransport`` that asks once per tick and believes only the answer to that question.

    - One request is in flight. While the reply to an earlier one is outstanding nothing is sent
      and the tick is TIMEOUT. A late reply is completed, recognised by its transaction id and
      thrown away, never returned.
    - ``silence_before_reconnect_s`` without the reply, or any breach of protocol, drops the
      connection, never in the tick that asked; an exception reply does neither, nor does our
      own lateness. A dropped connection is reset, so no old command is delivered later.
    - A reply that came SPOILT ends its request: the next tick asks anew. A request that is
      UNHEARD or DOUBTED (serial frames) is given up for a question whose reply has another
      function: a read after a write, or the next write after a read.
    - On a wire that may lose frames (``ByteStream.lossy``) an unanswered request counts as lost
      when its tick is over: the next tick asks anew, under the next id. There a reply that nobody
      asked for is thrown away instead of ending the connection. The time of silence counts from
      the first request without an answer.
    - Reconnecting moves one step per tick and waits for nothing. After a connection that gave
      ten good replies the first attempt comes at once; the pause before the others doubles from
      ``backoff_min_s`` to ``backoff_max_s`` until a good reply. The tick that starts an attempt
      is always NOT_CONNECTED, so a caller sees every reconnect.
    - A connection that replaces another one only reads (FC3) until a reply was good: a PLC that
      obeys and cannot be heard would otherwise hold a command anew, and its own watchdog would
      begin again, late.

    Parameters
    ----------
    frames : requests and reply checks.
    wire : the connection.
    clock : monotonic time, of the deadlines.
    function : FC23; FC16 then FC3; or FC3 alone, which writes nothing.
    silence_before_reconnect_s : how long a reply may be outstanding, s; a reply that is late by
        less, as after a pause of the PLC, costs no connection (``silence_before_reconnect``).
    backoff_min_s, backoff_max_s : pause before an attempt, first and longest, s.
    connect_timeout_s : time one attempt may take, s.

    Attributes
    ----------
    wrote : the last transaction's request held the write block: its OK is one to the command.

    Raises
    ------
    ConfigError
        When a number makes no sense.
    """

    def __init__(
        self,
        *,
        frames: ModbusFrames,
        wire: ByteStream,
        clock: Clock,
        function: WireFunction = WireFunction.FC23,
        silence_before_reconnect_s: float = 0.05,
        backoff_min_s: float = 0.1,
        backoff_max_s: float = 2.0,
        connect_timeout_s: float = 1.0,
    ) -> None:
        if not silence_before_reconnect_s > 0.0:
            raise ConfigError(
                f"silence_before_reconnect_s {silence_before_reconnect_s}: above 0, say 0.05"
            )
        if not 0.0 < backoff_min_s <= backoff_max_s or not connect_timeout_s > 0.0:
            raise ConfigError("back-off and connect timeout: 0 < backoff_min_s <= backoff_max_s")
        self._frames = frames
        self._wire = wire
        self._clock = clock
        self._function = function
        self._silence_ns = round(silence_before_reconnect_s * 1e9)
        self._backoff_min_ns = round(backoff_min_s * 1e9)
        self._backoff_max_ns = round(backoff_max_s * 1e9)
        self._connect_timeout_ns = round(connect_timeout_s * 1e9)

        self._link = _Link.DOWN
        self._act_at_ns = clock.now_ns()  # DOWN: next attempt; CONNECTING: give up
        self._backoff_ns = self._backoff_min_ns
        self._good = 0  # replies on this connection, counted up to the proof
        self._may_write = True
        self._tid = 0
        self._sent = 0  # requests on this connection, counted up to the stale window
        self._outstanding = False
        self._spoilt = False  # the reply to what is outstanding came, and is none
        self._doubted = False  # and may have been noise: the reply may still come
        self._read_only = False  # in this tick: the reply to a write may still come
        self._sent_at_ns = self._act_at_ns
        self._buffer = bytearray(_BUFFER_BYTES)
        self._view = memoryview(self._buffer)
        self._filled = 0
        self._reply = _NO_WORDS
        self.wrote = False
        self._asked = READ  # function code of the last request
        self._why = ""
        self.connects = 0

    @property
    def last_exception_code(self) -> int:
        """Code of the last exception reply, 0 for none yet."""
        return self._frames.last_exception_code

    @property
    def trouble(self) -> str:
        """Why nothing is heard, in words; empty after a good reply, or before an attempt."""
        return self._why

    def transact(self, write_words: list[int], deadline_ns: int) -> tuple[Outcome, list[int]]:
        """Exchange the blocks before ``deadline_ns``; never blocks longer, never raises."""
        self.wrote = False
        if self._link is not _UP and not self._advance_connect():
            return Outcome.NOT_CONNECTED, _NO_WORDS
        began_ns = self._clock.now_ns()
        outcome = self._exchange(write_words, deadline_ns)
        if outcome is _OK:
            self._good = min(self._good + 1, _PROVEN_REPLIES)
            self._may_write = True
            self._why = ""
            self._backoff_ns = self._backoff_min_ns
            return outcome, self._reply
        if outcome is _TIMEOUT:
            silent_ns = self._clock.now_ns() - self._sent_at_ns
            if self._spoilt:
                self._why = _SPOILT
            asked_before = self._outstanding and self._sent_at_ns < began_ns
            if asked_before and silent_ns >= self._silence_ns:
                if not self._spoilt:
                    self._why = f"no reply within {self._silence_ns * 1e-9:g} s"
                self._drop()
        elif outcome is Outcome.EXCEPTION:
            self._why = exception_text(self.last_exception_code, self._asked)
        else:
            broken = outcome is Outcome.BAD_REPLY
            why = "a reply broke the protocol" if broken else "closed by the other side"
            self._why = self._wire.why_closed or why
            self._drop()
        return outcome, _NO_WORDS

    def ask_for(self, frames: ModbusFrames) -> None:
        """Exchange other blocks from the next transaction on, on the same connection."""
        self._frames = frames

    def close(self) -> None:
        """Release the connection."""
        self._disconnect(abort=self._outstanding or self._link is _Link.CONNECTING)
        self._act_at_ns = self._clock.now_ns()

    def _advance_connect(self) -> bool:
        """Move the connection one step; True when it is up."""
        now_ns = self._clock.now_ns()
        if self._link is _Link.DOWN:
            if now_ns >= self._act_at_ns:
                if self._wire.start_connect():
                    self._link = _Link.CONNECTING
                    self._act_at_ns = now_ns + self._connect_timeout_ns
                else:
                    self._why = self._wire.why_closed
                    self._drop()
            return False
        state = self._wire.connecting()
        if state is Connecting.UP:
            self._link = _UP
            self._may_write = self.connects == 0
            self.connects += 1
            return True
        if state is Connecting.FAILED:
            self._why = self._wire.why_closed
            self._drop()
        elif now_ns >= self._act_at_ns:
            self._why = f"no connection within {self._connect_timeout_ns * 1e-9:g} s"
            self._drop()
        return False

    def _disconnect(self, *, abort: bool) -> None:
        self._wire.close(abort=abort)
        self._link = _Link.DOWN
        self._good = 0
        self._sent = 0
        self._filled = 0
        self._outstanding = self._spoilt = self._doubted = False

    def _drop(self) -> None:
        now_ns = self._clock.now_ns()
        proven = self._good >= _PROVEN_REPLIES
        self._disconnect(abort=True)
        self._act_at_ns = now_ns if proven else now_ns + self._backoff_ns
        if proven:
            return
        self._backoff_ns = min(2 * self._backoff_ns, self._backoff_max_ns)

    def _exchange(self, words: list[int], deadline_ns: int) -> Outcome:
        outcome = self._clear_late_replies(deadline_ns)
        if outcome is not _OK:
            return outcome
        if self._doubted:
            self._read_only = self._asked != READ
        if self._function is _FC3 or not self._may_write or self._read_only:
            tid = self._next_tid()
            return self._round_trip(self._frames.read_request(tid), READ, deadline_ns)
        if not self._frames.fits(words):
            return Outcome.BAD_REPLY
        self.wrote = True
        if self._function is _FC23:
            frame = self._frames.read_write_request(self._next_tid(), words)
            return self._round_trip(frame, READ_WRITE, deadline_ns)
        frame = self._frames.write_request(self._next_tid(), words)
        outcome = self._round_trip(frame, WRITE, deadline_ns)
        if outcome is not _OK:
            return outcome
        frame = self._frames.read_request(self._next_tid())
        return self._round_trip(frame, READ, deadline_ns)

    def _next_tid(self) -> int:
        self._tid = self._tid + 1 if self._tid < _LAST_TID else 1
        return self._tid

    def _clear_late_replies(self, deadline_ns: int) -> Outcome:
        """Take what arrived between ticks off the wire; OK when a request may be sent.

        After a reply that is LATE the next one is on its way, or was never asked for: it is given
        half of the tick's time, so that the new request does not meet it on the line.
        """
        self._read_only = False
        until_ns = 0
        for _ in range(_MOST_WAITING):
            now_ns = self._clock.now_ns()
            count = self._wire.receive(self._view[self._filled :], max(0, until_ns - now_ns))
            if count == CLOSED:
                return Outcome.NOT_CONNECTED
            if count in (SPOILT, DOUBTED):
                self._spoilt, self._doubted = True, count == DOUBTED
                return _OK
            if count == UNHEARD:
                return self._give_up()
            if count == LATE:
                self._sent_at_ns = now_ns
                until_ns = now_ns + (deadline_ns - now_ns) // 2
                continue
            if count == 0 and now_ns < until_ns:
                continue
            self._filled += count
            outcome = self._consume(0)
            if count == 0 or not self._wire.lossy:
                break
        else:  # what still waits may be the answer to a question not yet asked
            return Outcome.BAD_REPLY
        may_ask = self._wire.lossy or self._spoilt or not self._outstanding
        if outcome is _TIMEOUT and may_ask:
            return _OK
        return outcome

    def _give_up(self) -> Outcome:
        """Ask anew where the reply will have another function; OK when it will."""
        self._read_only = self._asked != READ
        writes = self._may_write and self._function is WireFunction.FC3_FC16
        return _OK if self._read_only or writes else _TIMEOUT

    def _round_trip(self, frame: bytes, function: int, deadline_ns: int) -> Outcome:
        if self._clock.now_ns() >= deadline_ns:
            return _TIMEOUT
        if not self._wire.send(frame):
            return Outcome.NOT_CONNECTED
        if not self._outstanding:
            self._sent_at_ns = self._clock.now_ns()
        self._outstanding, self._spoilt, self._doubted = True, False, False
        self._asked = function
        self._sent = min(self._sent + 1, _STALE_WINDOW)
        while True:
            wait_ns = deadline_ns - self._clock.now_ns()
            if wait_ns <= 0:
                return _TIMEOUT
            count = self._wire.receive(self._view[self._filled :], wait_ns)
            if count == CLOSED:
                return Outcome.NOT_CONNECTED
            if count in (SPOILT, DOUBTED):
                self._spoilt, self._doubted = True, count == DOUBTED
                return _TIMEOUT
            if count in (0, LATE):
                continue
            self._filled += count
            outcome = self._consume(function)
            if outcome is not _TIMEOUT:
                return outcome

    def _consume(self, function: int) -> Outcome:
        """Judge the complete frames in the buffer; TIMEOUT when the wanted one is not there.

        Parameters
        ----------
        function : the function code of the request just sent; 0 before sending, when every
            reply is late.
        """
        while True:
            length = frame_length(self._buffer, self._filled)
            if length < 0 or (length == 0 and self._filled == _BUFFER_BYTES):
                return Outcome.BAD_REPLY
            if length == 0:
                return _TIMEOUT
            age = self._age_of(transaction_id(self._buffer))
            if age < 0 and not self._wire.lossy:
                return Outcome.BAD_REPLY
            frame = bytes(self._view[:length])
            self._cut(length)
            if age == 0:
                self._outstanding = False
                if function:
                    outcome, self._reply = self._frames.parse_reply(frame, function)
                    return outcome

    def _age_of(self, tid: int) -> int:
        """How many requests ago ``tid`` was sent here; -1 when it never was."""
        age = (self._tid - tid) % _LAST_TID
        return age if tid != 0 and age < self._sent else -1

    def _cut(self, length: int) -> None:
        rest = self._filled - length
        if rest:
            self._view[:rest] = self._view[length : self._filled]
        self._filled = rest
