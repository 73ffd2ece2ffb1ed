"""The plant on CAN in virtual time: the runtime's link to it, without a bus driver."""

from __future__ import annotations

from collections import deque

from aff_runtime.base.ports import Clock
from sim_plant.servers.can_frames import BusFaults, CanFrame, CanNode
from sim_plant.servers.faults import Fault
from sim_plant.servers.plant import Plant
from tests.doubles.lockstep_plant import LockstepPlant


class LockstepBus:
    """A frame link whose other end is a plant that a test advances.

    Parameters
    ----------
    lockstep : the plant; every sample puts its frames on the bus.
    node : PLC and drives on the bus.
    clock : virtual; delayed frames come when it says.
    """

    def __init__(
        self, lockstep: LockstepPlant, node: CanNode, clock: Clock, *, seed: int = 0
    ) -> None:
        self._plant = lockstep.plant
        self._node = node
        self._clock = clock
        self._faults = BusFaults(self._plant.faults, seed)
        self._queue: deque[tuple[int, CanFrame]] = deque()
        self._was_cut = False
        self.bus_offs = 0
        self.closed = False
        self.arrived_ns = -1
        self.troubles: tuple[str, ...] = ()
        self.sent: deque[CanFrame] = deque(maxlen=64)
        self._plant.observers.append(self._on_sample)
        self._plant.edge_observers.append(
            lambda edge: (
                self._put(node.reset())
                if edge.spec.fault is (Fault.RESET if edge.began else Fault.RESTART)
                else None
            )
        )

    @property
    def carries(self) -> bool:
        """Return whether the bus takes frames."""
        return not self._faults.cut and not self.closed

    def ready(self) -> bool:
        """Return whether the bus lives; a cut one comes back as soon as the fault ends."""
        cut = self._faults.cut
        if cut and not self._was_cut:
            self.bus_offs += self._plant.faults.active(Fault.BUSOFF)
            self._queue.clear()
        self._was_cut = cut
        return not cut and not self.closed

    def send(self, frame: CanFrame) -> bool:
        """Hand a frame to the nodes."""
        self.sent.append(frame)
        if self._faults.arrives():
            self._put(self._node.take(CanFrame(*frame)))
        return not self._faults.cut

    def sync(self) -> bool:
        """Return whether the bus takes frames; it has no SYNC of its own."""
        return not self._faults.cut

    def receive(self, wait_ns: int) -> CanFrame | None:
        """Return the next frame that is due; nothing arrives while one waits."""
        del wait_ns
        if self._queue and self._queue[0][0] <= self._clock.now_ns():
            self.arrived_ns, frame = self._queue.popleft()
            return frame
        return None

    def close(self) -> None:
        """End the conversation."""
        self.closed = True

    def reopen(self) -> None:
        """Begin anew, as a fresh socket does: what was sent before is not heard."""
        self._queue.clear()
        self.closed = False

    def _on_sample(self, plant: Plant) -> None:
        self._put(self._node.publish(plant))
        if plant.faults.active(Fault.SECOND):
            for frame in self._node.second_master():
                self._node.take(frame)
                self._put([frame])

    def _put(self, frames: list[CanFrame]) -> None:
        faults = self._plant.faults
        late_ns = 0
        if faults.active(Fault.DELAY):
            late_ns = round(float(faults.argument(Fault.DELAY)) * 1e6)
        due_ns = self._clock.now_ns() + late_ns
        self._queue.extend((due_ns, frame) for frame in self._faults.on_the_way(frames))
