"""The wire in SI: a codec over a word transport, and the judgement of freshness.

A bus that does not speak in one block of words (CAN by PDO) implements ``base.ports.Gateway``
itself instead of a word transport.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from aff_runtime.base.ports import Clock, WordTransport
from aff_runtime.base.signals import NO_ECHO, Command, Outcome, Snapshot
from aff_runtime.fieldbus.liveness import HeartbeatOrder, Liveness, echo_age
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.scan_edge import ScanEdge

_OK = Outcome.OK
_HEARTBEAT_MASK = 0xFFFF
_NOTHING: tuple[float, ...] = ()


class WordGateway:
    """``Gateway`` over any word transport.

    What is fresh, and what the first reply after a loss is worth, ``Liveness`` says; that reply
    also restarts the wrapping counters. A reply whose heartbeat steps back (``HeartbeatOrder``) is
    BAD_REPLY.

    Unless the outcome is OK, ``values`` are NaN and heartbeat, status and roll id are the last
    ones known (0 before any).

    Parameters
    ----------
    transport : moves the words.
    codec : gives them meaning.
    clock : monotonic time.
    trouble : says why there is no connection; empty while there is one.
    wrote : whether the command was in the last exchange, not a question alone.
    edge : keeps the ticks off the edge of the PLC's scan; None: nothing does.

    Attributes
    ----------
    heartbeat_modulus : that of a word.
    shift_ns : how much later the next tick should start.
    """

    heartbeat_modulus = _HEARTBEAT_MASK + 1

    def __init__(
        self,
        transport: WordTransport,
        codec: WordCodec,
        clock: Clock,
        trouble: Callable[[], str] = str,
        wrote: Callable[[], bool] = lambda: True,
        edge: ScanEdge | None = None,
    ) -> None:
        self._edge = edge
        self.shift_ns = 0
        self._wrote = wrote
        self._trouble = trouble
        self._transport = transport
        self._codec = codec
        self._clock = clock
        self._no_values = (math.nan,) * codec.channel_count
        self._liveness = Liveness(clock.now_ns(), lost=False)
        self._order = HeartbeatOrder(_HEARTBEAT_MASK)
        self._known = False
        self._status = 0
        self._roll_id = 0

    @property
    def troubles(self) -> tuple[str, ...]:
        """Why there is no connection."""
        trouble = self._trouble()
        return (trouble,) if trouble else ()

    def exchange(self, command: Command, tick: int, deadline_ns: int) -> Snapshot:
        """Send ``command``, return what the PLC says; never blocks past the deadline."""
        outcome, words = self._transport.transact(self._codec.encode(command), deadline_ns)
        t_ns = self._clock.now_ns()
        values = self._no_values
        heartbeat, status, roll_id = 0, 0, 0
        liveness = self._liveness
        if outcome is _OK and len(words) != self._codec.read_count:
            outcome = Outcome.BAD_REPLY
        if outcome is _OK:
            if liveness.lost:
                self._codec.reset()
                self._order.forget()
                self._known = False
            heartbeat, status, roll_id, decoded = self._codec.decode(words)
            if not self._order.takes(heartbeat, liveness.heartbeat if self._known else None):
                outcome = Outcome.BAD_REPLY
            self._known = True
        outcome = liveness.judge(outcome, heartbeat, t_ns)
        age, applied = NO_ECHO, _NOTHING
        self.shift_ns = 0
        if outcome is _OK:
            if self._edge is not None:
                self.shift_ns = self._edge.shift_ns(heartbeat)
            self._status, self._roll_id, values = status, roll_id, decoded
            age = echo_age(command.heartbeat, self._codec.aff_echo(words))
            applied = self._codec.applied(words)
        return Snapshot(
            tick=tick,
            t_ns=t_ns,
            outcome=outcome,
            fresh=liveness.fresh,
            age_s=liveness.age_s(t_ns),
            plc_heartbeat=liveness.heartbeat,
            status=self._status,
            roll_id=self._roll_id,
            values=values,
            echo_age=age,
            applied=applied,
            command_sent=self._wrote(),
        )

    def close(self) -> None:
        """Release the connection."""
        self._transport.close()
