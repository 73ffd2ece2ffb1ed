"""The wire in SI: a codec over a word transport, and the judgement of freshness.

A bus that does not speak in one block of words (CAN by PDO) implements ``base.ports.Gateway``
itself instead of a word transport.
"""

from __future__ import annotations

import math

from aff_runtime.base.ports import Clock, WordTransport
from aff_runtime.base.signals import Command, Outcome, Snapshot
from aff_runtime.fieldbus.codec import WordCodec


class WordGateway:
    """``Gateway`` over any word transport.

    Only the PLC's own heartbeat proves that it lives: a server keeps answering with frozen words
    when its program has stopped. The first good reply after NOT_CONNECTED is reported as
    NOT_CONNECTED as well: it gives the heartbeat to compare with and restarts the wrapping
    counters, but its values go nowhere.

    Unless the outcome is OK, ``values`` are NaN and heartbeat, status and roll id are the last
    ones known (0 before any).

    Parameters
    ----------
    transport : moves the words.
    codec : gives them meaning.
    clock : monotonic time.
    """

    def __init__(self, transport: WordTransport, codec: WordCodec, clock: Clock) -> None:
        self._transport = transport
        self._codec = codec
        self._clock = clock
        self._no_values = (math.nan,) * codec.channel_count
        self._moved_at_ns = clock.now_ns()
        self._heartbeat = 0
        self._heartbeat_known = False
        self._was_lost = False
        self._status = 0
        self._roll_id = 0

    def exchange(self, command: Command, tick: int, deadline_ns: int) -> Snapshot:
        """Send ``command``, return what the PLC says; never blocks past the deadline."""
        outcome, words = self._transport.transact(self._codec.encode(command), deadline_ns)
        t_ns = self._clock.now_ns()
        values = self._no_values
        fresh = False
        if outcome is Outcome.OK and len(words) != self._codec.read_count:
            outcome = Outcome.BAD_REPLY
        if outcome is Outcome.NOT_CONNECTED:
            self._was_lost = True
        elif outcome is Outcome.OK and self._was_lost:
            self._was_lost = False
            self._codec.reset()
            self._heartbeat = self._codec.decode(words)[0]
            self._heartbeat_known = True
            outcome = Outcome.NOT_CONNECTED
        elif outcome is Outcome.OK:
            heartbeat, self._status, self._roll_id, values = self._codec.decode(words)
            fresh = self._heartbeat_known and heartbeat != self._heartbeat
            self._heartbeat = heartbeat
            self._heartbeat_known = True
            if fresh:
                self._moved_at_ns = t_ns
        return Snapshot(
            tick=tick,
            t_ns=t_ns,
            outcome=outcome,
            fresh=fresh,
            age_s=(t_ns - self._moved_at_ns) * 1e-9,
            plc_heartbeat=self._heartbeat,
            status=self._status,
            roll_id=self._roll_id,
            values=values,
        )

    def close(self) -> None:
        """Release the connection."""
        self._transport.close()
