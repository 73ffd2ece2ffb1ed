"""The wire in SI over CAN: our frames out, one consistent set of the PLC's frames in."""

from __future__ import annotations

import math

from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import Command, Outcome, Snapshot
from aff_runtime.fieldbus.can_frames import FrameLink
from aff_runtime.fieldbus.can_reader import CanReader, Taken
from aff_runtime.fieldbus.can_writer import CanWriter

_MOST_FRAMES = 256  # read in one tick; a babbling bus must not hold the tick


class CanGateway:
    """``Gateway`` over cyclic CAN frames.

    Each tick sends the command, then takes what has arrived; when no new set is among it, it
    waits for one until the deadline. Heartbeat and correction leave from here alone, so they stop
    with the control thread.

    OK is a consistent set in this tick; TIMEOUT none; BAD_REPLY a frame of wrong length, or one
    of our own identifiers from somebody else (a second master), whatever else arrived;
    NOT_CONNECTED no bus, or nodes that do not all work; what can be sent is sent, so that a fade
    reaches whoever still listens. The first set after NOT_CONNECTED is reported as NOT_CONNECTED:
    it gives the heartbeat to compare with, its values go nowhere. Unless OK, ``values`` are NaN.

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
        self._moved_at_ns = clock.now_ns()
        self._heartbeat = 0
        self._heartbeat_known = False
        self._was_lost = True
        self.foreign = 0

    def exchange(self, command: Command, tick: int, deadline_ns: int) -> Snapshot:
        """Send ``command``, return what the PLC says; never blocks past the deadline."""
        outcome = Outcome.NOT_CONNECTED
        ready = self._link.ready()
        sent = self._link.carries and self._send(command)
        if ready and sent:
            outcome = self._receive(deadline_ns)
        t_ns = self._clock.now_ns()
        reader = self.reader
        fresh = False
        values = self._no_values
        if outcome is Outcome.NOT_CONNECTED:
            if not self._was_lost:
                self._was_lost = True
            reader.reset()
        elif outcome is Outcome.OK and self._was_lost:
            self._was_lost = False
            self._heartbeat, self._heartbeat_known = reader.heartbeat, True
            outcome = Outcome.NOT_CONNECTED
        elif outcome is Outcome.OK:
            fresh = self._heartbeat_known and reader.heartbeat != self._heartbeat
            self._heartbeat, self._heartbeat_known = reader.heartbeat, True
            values = reader.values
            if fresh:
                self._moved_at_ns = t_ns
        return Snapshot(
            tick=tick,
            t_ns=t_ns,
            outcome=outcome,
            fresh=fresh,
            age_s=(t_ns - self._moved_at_ns) * 1e-9,
            plc_heartbeat=self._heartbeat,
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
        before = self._heartbeat
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
