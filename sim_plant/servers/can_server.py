"""The plant on a CAN bus in real time: frames after every sample, faults on the way."""

from __future__ import annotations

from aff_runtime.base.errors import WireError
from sim_plant.servers.can_channel import CanChannel
from sim_plant.servers.can_frames import BusFaults, CanFrame, CanNode
from sim_plant.servers.faults import Fault, FaultEdge
from sim_plant.servers.later import Later, in_real_time
from sim_plant.servers.plant import Plant
from sim_plant.servers.wire_faults import WireFaults

_GONE = (Fault.DROP, Fault.REFUSE, Fault.RESTART)


class CanServer:
    """Puts one node's frames on a channel and hands it what the runtime sends.

    Attributes
    ----------
    sent, taken : frames put on the bus and taken from it.
    wire_faults : which faults it has.
    trouble : why the bus is not joined though no fault forbids it; else empty.
    """

    def __init__(
        self,
        plant: Plant,
        node: CanNode,
        channel: CanChannel,
        name: str,
        wire_faults: WireFaults,
        later: Later = in_real_time,
    ) -> None:
        self.trouble = ""
        self.wire_faults = wire_faults
        self._later = later
        self._plant = plant
        self._node = node
        self._channel = channel
        self._faults = BusFaults(plant.faults)
        self._open = False
        self._name = name
        self.sent = 0
        self.taken = 0
        plant.observers.append(self._on_sample)

    @property
    def address(self) -> str:
        """Return what the ready line says."""
        return f"can {self._name}"

    async def open(self) -> None:
        """Join the bus.

        Raises
        ------
        WireError
            The bus cannot be opened.
        """
        self._channel.open(self._take)
        self._open = True
        self._send(self._node.reset())

    async def close(self) -> None:
        """Leave the bus."""
        self._leave()

    async def settled(self) -> None:
        """Return at once: the bus is joined again within a sample."""

    def take_edge(self, edge: FaultEdge) -> None:
        """Follow a fault that begins or ends."""
        fault = edge.spec.fault
        if fault is Fault.BUSOFF:
            self._channel.report(bus_off=edge.began)
        elif fault in _GONE and edge.began:
            self._leave()
        elif fault is Fault.RESET and edge.began:
            self._send(self._node.reset())

    def counts(self) -> dict[str, int]:
        """Return what the status shows of the wire."""
        return {"frames_sent": self.sent, "frames_taken": self.taken}

    def _leave(self) -> None:
        if self._open:
            self._channel.close()
            self._open = False
            self.trouble = ""

    def _on_sample(self, plant: Plant) -> None:
        gone = any(plant.faults.active(fault) for fault in _GONE)
        if not self._open:
            if gone:
                return
            try:
                self._channel.open(self._take)
            except WireError as error:
                self.trouble = str(error)
                return
            self.trouble = ""
            self._open = True
            self._send(self._node.reset())
        if plant.faults.active(Fault.ERRORS):
            self._channel.report(bus_off=False, error=True)
        self._send(self._node.publish(plant))
        if plant.faults.active(Fault.SECOND):
            for frame in self._node.second_master():
                self._node.take(frame)
                self._send([frame])

    def _take(self, frame: CanFrame) -> None:
        self.taken += 1
        if self._faults.arrives():
            self._send(self._node.take(frame))

    def _send(self, frames: list[CanFrame]) -> None:
        arriving = self._faults.on_the_way(frames)
        self.sent += len(arriving)
        if self._plant.faults.active(Fault.DELAY):
            delay_s = float(self._plant.faults.argument(Fault.DELAY)) * 1e-3
            self._later(delay_s, lambda: self._put(arriving))
        else:
            self._put(arriving)

    def _put(self, frames: list[CanFrame]) -> None:
        for frame in frames:
            self._channel.send(frame)
