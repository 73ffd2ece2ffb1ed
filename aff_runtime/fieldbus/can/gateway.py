"""The wire in SI over CAN: our frames out, one consistent set of the PLC's frames in."""

from __future__ import annotations

import math
from dataclasses import replace

from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import NO_ECHO, Command, Outcome, Snapshot, StateBits
from aff_runtime.fieldbus.can.frames import FrameLink
from aff_runtime.fieldbus.can.phase_lock import PhaseLock
from aff_runtime.fieldbus.can.reader import CanReader, Taken
from aff_runtime.fieldbus.can.writer import CanWriter
from aff_runtime.fieldbus.intruder import Intruder
from aff_runtime.fieldbus.liveness import Liveness, echo_age
from aff_runtime.fieldbus.scan_edge import ScanEdge

_NOTHING: tuple[float, ...] = ()
_LIVE = int(StateBits.ACTIVE | StateBits.FADING)
_MOST_FRAMES = 256  # read in one tick; a babbling bus must not hold the tick


class CanGateway:
    """``Gateway`` over cyclic CAN frames.

    A tick never waits: it takes what has arrived since the last one, sends the command, and SYNC
    where the bus has one (the answers belong to the next tick). How old the newest set is, the
    driver's receive stamp says; without a stamp, or with one that cannot be (a stepped clock), the
    set counts as old as it can be: from when the bus was last found empty. Heartbeat and
    correction leave from here alone, so they stop with the control thread.

    OK is a consistent set in this tick; TIMEOUT none; BAD_REPLY a frame of wrong length, or one
    of our own identifiers from somebody else (a second master), whatever else arrived;
    NOT_CONNECTED no bus, or nodes that do not all work; what can be sent is sent, so that a fade
    reaches whoever still listens. A tick that is held up past its deadline by more than
    ``command_life_s`` sends zeros without ACTIVE and FADING in place of its command. What is
    fresh, and what the first set after a loss is worth, ``Liveness`` says. Unless OK, ``values``
    are NaN.

    Parameters
    ----------
    link : the bus.
    reader, writer : meaning of the frames.
    clock : monotonic time.
    lock : where the other side sets the pace, when the ticks should start; None without.
    edge : where it answers to our SYNC, what keeps the ticks off the edge of its scan.
    command_life_s : a command older than this is not sent any more, s, and a set that arrived
        longer ago counts as a loss: on CANopen the one before a pause is all that waits.

    Attributes
    ----------
    foreign : frames that carried our identifiers.
    heartbeat_modulus : as many counts as its signal has.
    shift_ns : how much later (negative: earlier) the next tick should start.
    """

    def __init__(
        self,
        link: FrameLink,
        reader: CanReader,
        writer: CanWriter,
        clock: Clock,
        lock: PhaseLock | None = None,
        *,
        edge: ScanEdge | None = None,
        command_life_s: float = 0.080,
    ) -> None:
        self._link = link
        self.reader = reader
        self._writer = writer
        self._clock = clock
        self.heartbeat_modulus = reader.heartbeat_modulus
        self._ours = frozenset(writer.ids)
        self._no_values = (math.nan,) * len(reader.values)
        self._lock = lock
        self._edge = edge
        self._command_life_ns = round(command_life_s * 1e9)
        self._liveness = Liveness(clock.now_ns(), lost=True)
        self._emptied_ns = self._arrived_ns = clock.now_ns()
        self._stamped = False
        self.shift_ns = 0
        self.foreign = 0
        self._intruder = Intruder(clock)

    @property
    def troubles(self) -> tuple[str, ...]:
        """What the bus and its nodes say of themselves, and that somebody sends as we do."""
        trouble = self._intruder.trouble
        return (*self._link.troubles, trouble) if trouble else self._link.troubles

    def exchange(self, command: Command, tick: int, deadline_ns: int) -> Snapshot:
        """Send ``command``, return what the PLC says; never blocks past the deadline."""
        began_ns = self._clock.now_ns()
        self.shift_ns = 0
        outcome = self._receive(deadline_ns) if self._link.ready() else Outcome.NOT_CONNECTED
        if outcome is Outcome.OK and self._lock is not None and self._stamped:
            self.shift_ns = self._lock.shift_ns(began_ns - self._arrived_ns)
        if self._clock.now_ns() - deadline_ns > self._command_life_ns:
            command = _withdrawn(command)
        if not (self._link.carries and self._send(command)):
            outcome = Outcome.NOT_CONNECTED
        t_ns = self._clock.now_ns()
        reader, liveness = self.reader, self._liveness
        if outcome is Outcome.OK and t_ns - self._arrived_ns > self._command_life_ns:
            outcome = Outcome.NOT_CONNECTED  # it waited while the tick was held up
        if outcome is Outcome.NOT_CONNECTED:
            reader.reset()
        outcome = liveness.judge(outcome, reader.heartbeat, self._arrived_ns)
        values, age, applied = self._no_values, NO_ECHO, _NOTHING
        if outcome is Outcome.OK:
            if self._edge is not None:
                self.shift_ns = self._edge.shift_ns(liveness.heartbeat)
            values, age = reader.values, echo_age(command.heartbeat, reader.aff_echo)
            applied = reader.applied
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
            echo_age=age,
            applied=applied,
        )

    def close(self) -> None:
        """Release the bus."""
        self._link.close()

    def _send(self, command: Command) -> bool:
        sent = all(self._link.send(frame) for frame in self._writer.encode(command))
        return self._link.sync() and sent

    def _receive(self, deadline_ns: int) -> Outcome:
        """Take what has arrived, up to the deadline on a bus that never falls silent."""
        have_set = bad = False
        for _ in range(_MOST_FRAMES):
            frame = self._link.receive(0)
            if frame is None:
                if not self._link.ready():
                    return Outcome.NOT_CONNECTED
                self._emptied_ns = self._clock.now_ns()
                break
            taken = self.reader.take(frame)
            if taken is Taken.SET:
                have_set = True
                self._note_arrival()
            elif taken is Taken.BAD:
                bad = True
            elif taken is Taken.IGNORED and (frame.can_id, frame.extended) in self._ours:
                self.foreign += 1
                self._intruder.heard("the frames of this gateway")
                bad = True
            if self._clock.now_ns() >= deadline_ns:
                break
        if bad:
            return Outcome.BAD_REPLY
        return Outcome.OK if have_set else Outcome.TIMEOUT

    def _note_arrival(self) -> None:
        """Keep when the frame just taken was here; the earliest it can be if that is not known."""
        stamp_ns = self._link.arrived_ns
        self._stamped = self._emptied_ns <= stamp_ns <= self._clock.now_ns()
        self._arrived_ns = stamp_ns if self._stamped else self._emptied_ns


def _withdrawn(command: Command) -> Command:
    """Return the command that goes out in place of one that was meant for another moment."""
    zeros = (0.0,) * len(command.corrections)
    return replace(command, corrections=zeros, state_bits=command.state_bits & ~_LIVE)
