"""The wire in SI over CAN: our frames out, one consistent set of the PLC's frames in."""

from __future__ import annotations

import math

from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import Command, Outcome, Snapshot
from aff_runtime.fieldbus.can_frames import FrameLink
from aff_runtime.fieldbus.can_reader import CanReader, Taken
from aff_runtime.fieldbus.can_writer import CanWriter
from aff_runtime.fieldbus.liveness import Liveness

_MOST_FRAMES = 256  # read in one tick; a babbling bus must not hold the tick


class CanGateway:
    """``Gateway`` over cyclic CAN frames.

    Each tick sends the command, then takes what has arrived; when no new set is among it, it
    waits for one until the deadline. Heartbeat and correction leave from here alone, so they stop
    with the control thread.

    OK is a consistent set in this tick; TIMEOUT none; BAD_REPLY a frame of wrong length, or one
    of our own identifiers from somebody else (a second master), whatever else arrived;
    NOT_CONNECTED no bus, or nodes that do not all work; what can be sent is sent, so that a fade
    reaches whoever still listens. What is fresh, and what the first set after a loss is worth,
    ``Liveness`` says. Unless OK, ``values`` are NaN.

    Parameters
    ----------
    link : the bus.
    reader, writer : meaning of the frames.
    clock : monotonic time.

    Attributes
    ----------
    foreign : frames that carried our identifiers.
    """

    def __init__(
        self, link: FrameLink, reader: CanReader, writer: CanWriter, clock: Clock
    ) -> None:
        self._link = link
        self.reader = reader
        self._writer = writer
        self._clock = clock
        self._ours = frozenset(writer.ids)
        self._no_values = (math.nan,) * len(reader.values)
        self._liveness = Liveness(clock.now_ns(), lost=True)
        self.foreign = 0

    def exchange(self, command: Command, tick: int, deadline_ns: int) -> Snapshot:
        """Send ``command``, return what the PLC says; never blocks past the deadline."""
        outcome = Outcome.NOT_CONNECTED
        ready = self._link.ready()
        sent = self._link.carries and self._send(command)
        if ready and sent:
            outcome = self._receive(deadline_ns)
        t_ns = self._clock.now_ns()
        reader, liveness = self.reader, self._liveness
        if outcome is Outcome.NOT_CONNECTED:
            reader.reset()
        outcome = liveness.judge(outcome, reader.heartbeat, t_ns)
        values = reader.values if outcome is Outcome.OK else self._no_values
        return Snapshot(
            tick=tick,
            t_ns=t_ns,
            outcome=outcome,
            fresh=liveness.fresh,
            age_s=liveness.age_s(t_ns),
            plc_heartbeat=liveness.heartbeat,
            status=reader.status,
            roll_id=reader.roll_id,
            values=values,
        )

    def close(self) -> None:
        """Release the bus."""
        self._link.close()

    def _send(self, command: Command) -> bool:
        return all(self._link.send(frame) for frame in self._writer.encode(command))

    def _receive(self, deadline_ns: int) -> Outcome:
        """Take frames until a new set is there; drain what follows it without waiting."""
        before = self._liveness.heartbeat
        have_set = have_new = bad = False
        for _ in range(_MOST_FRAMES):
            wait_ns = 0 if have_new else deadline_ns - self._clock.now_ns()
            frame = self._link.receive(max(0, wait_ns))
            if frame is None:
                if not self._link.ready():
                    return Outcome.NOT_CONNECTED
                if have_new or wait_ns <= 0:
                    break
                continue
            taken = self.reader.take(frame)
            if taken is Taken.SET:
                have_set = True
                have_new = have_new or self.reader.heartbeat != before
            elif taken is Taken.BAD:
                bad = True
            elif taken is Taken.IGNORED and (frame.can_id, frame.extended) in self._ours:
                self.foreign += 1
                bad = True
        if bad:
            return Outcome.BAD_REPLY
        return Outcome.OK if have_set else Outcome.TIMEOUT
