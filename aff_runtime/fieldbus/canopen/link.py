"""A bus that is ready only while every CANopen node is configured, operational and healthy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from aff_runtime.base.ports import Clock
from aff_runtime.fieldbus.can.frames import Frame, FrameLink
from aff_runtime.fieldbus.canopen.node import OPERATIONAL, SYNC, NodeKeeper, NodePlan
from aff_runtime.fieldbus.intruder import Intruder

_MOST_FRAMES: Final = 64  # in one tick while nodes are being configured
_NOTHING: Final = Frame(-1, False, b"")  # nobody's business; says only that more may wait
_PRE_OPERATIONAL: Final = 0x7F
_MOST_LOOKS: Final = 8  # at a bus that is never found empty, before a silent node is lost anyway
_EARLY_SHARE: Final = 8  # a beat may leave this part of its period early, not a tick late


def managed_ids(plans: Sequence[NodePlan], own_node: int) -> tuple[tuple[int, bool], ...]:
    """Return the identifiers of network management that are listened for.

    Those of every node; SYNC and the heartbeat of our own node id too, which nobody else may send.
    """
    nodes = [base + plan.node_id for plan in plans for base in (0x080, 0x580, 0x700)]
    return tuple((can_id, False) for can_id in (*nodes, SYNC.can_id, 0x700 + own_node))


class CanopenLink:
    """``FrameLink`` over another one: network management below, process data through.

    A tick takes the answers to the SYNC before, sends its process data, then SYNC: drives act on
    the data and sample on one and the same SYNC. Our own heartbeat leaves with the ticks and with
    nothing else, so the drives' consumers see the control thread die. Somebody else's heartbeat
    of our node id would hide that death from them, and its SYNC is a second pace: while either is
    heard the bus is not ready. A node is lost by what was not among the frames that had arrived:
    after a pause of ours they wait to be read.

    Parameters
    ----------
    inner : the bus.
    plans : what each node is to be told.
    own_node : our node id.
    heartbeat_ms : period of our heartbeat.
    clock : monotonic time.

    Attributes
    ----------
    keepers : one per node.
    """

    def __init__(
        self,
        inner: FrameLink,
        plans: Sequence[NodePlan],
        *,
        own_node: int,
        heartbeat_ms: int,
        clock: Clock,
    ) -> None:
        self._inner = inner
        self._clock = clock
        now_ns = clock.now_ns()
        self.keepers = tuple(NodeKeeper(plan, now_ns) for plan in plans)
        self._heartbeat_id = 0x700 + own_node
        self._heartbeat_ns = heartbeat_ms * 1_000_000
        self._beat_at_ns = now_ns
        self._emptied_ns = now_ns
        self._looks = 0  # since the bus was found empty
        self._intruder = Intruder(clock)
        self._own_node = own_node

    @property
    def bus_offs(self) -> int:
        """How often the controller went bus-off."""
        return self._inner.bus_offs

    @property
    def troubles(self) -> tuple[str, ...]:
        """Return what is wrong with the bus, or else with its nodes, one sentence each."""
        if self._inner.troubles:
            return self._inner.troubles
        if self._intruder.trouble:
            return (self._intruder.trouble,)
        return tuple(
            f"{keeper.plan.name} (node {keeper.plan.node_id}): {keeper.trouble}"
            for keeper in self.keepers
            if not keeper.good
        )

    @property
    def carries(self) -> bool:
        """Whether the bus carries frames; a node may still be missing."""
        return self._inner.carries

    def ready(self) -> bool:
        """Move every node one step; True when all of them work."""
        if not self._inner.ready():
            return False
        now_ns = self._clock.now_ns()
        self._looks += 1
        good = self._all_good()
        if now_ns >= self._beat_at_ns - self._heartbeat_ns // _EARLY_SHARE:
            self._beat_at_ns = now_ns + self._heartbeat_ns
            state = OPERATIONAL if good else _PRE_OPERATIONAL
            self._inner.send(Frame(self._heartbeat_id, False, bytes((state,))))
        if not good:
            self._configure()
        for keeper in self.keepers:
            frame = keeper.tick(now_ns, self._taken_to_ns(now_ns))
            if frame is not None:
                self._inner.send(frame)
        return self._all_good() and good

    @property
    def arrived_ns(self) -> int:
        """When the last frame was here, monotonic; -1 when the bus below does not know."""
        return self._inner.arrived_ns

    def send(self, frame: Frame) -> bool:
        """Send process data; nodes act on it at the SYNC that follows."""
        return self._inner.send(frame)

    def sync(self) -> bool:
        """Send SYNC, also while nobody is listened to: a fade must reach the drives."""
        return self._inner.send(SYNC)

    def receive(self, wait_ns: int) -> Frame | None:
        """Return the next frame of process data; network management is dealt with here."""
        end_ns = self._clock.now_ns() + wait_ns
        for _ in range(_MOST_FRAMES):
            frame = self._inner.receive(max(0, wait_ns))
            if frame is None:
                self._found_empty()
                return None
            if not self._managed(frame):
                return frame
            wait_ns = end_ns - self._clock.now_ns()
        return _NOTHING

    def close(self) -> None:
        """Release the bus."""
        self._inner.close()

    def _all_good(self) -> bool:
        return not self._intruder.trouble and all(keeper.good for keeper in self.keepers)

    def _configure(self) -> None:
        """Take answers without waiting; process data of half a network goes nowhere."""
        for _ in range(_MOST_FRAMES):
            frame = self._inner.receive(0)
            if frame is None:
                self._found_empty()
                return
            self._managed(frame)

    def _found_empty(self) -> None:
        self._emptied_ns = self._clock.now_ns()
        self._looks = 0

    def _taken_to_ns(self, now_ns: int) -> int:
        """Return up to when everything that arrived was taken; a bus that babbles is no excuse."""
        return now_ns if self._looks > _MOST_LOOKS else self._emptied_ns

    def _managed(self, frame: Frame) -> bool:
        now_ns = self._clock.now_ns()
        if not frame.extended and frame.can_id in (self._heartbeat_id, SYNC.can_id):
            what = (
                "SYNC"
                if frame.can_id == SYNC.can_id
                else f"the heartbeat of node {self._own_node}"
            )
            self._intruder.heard(f"{what}, as this gateway does")
            return True
        return any(keeper.take(frame, now_ns) for keeper in self.keepers)
