"""CAN frames on the plant's side, and what faults do to them on their way to the runtime."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import NamedTuple, Protocol

from sim_plant.servers.faults import Fault, FaultBoard
from sim_plant.servers.plant import Plant


class CanFrame(NamedTuple):
    """A classic data frame."""

    can_id: int
    extended: bool
    data: bytes


Take = Callable[[CanFrame], None]
_CUTTING = frozenset({Fault.BUSOFF, Fault.DROP, Fault.REFUSE, Fault.RESTART})
_ON_THE_WAY = _CUTTING | {
    Fault.MUTE,
    Fault.BUSY,
    Fault.PARTIAL,
    Fault.SHORT,
    Fault.TID,
    Fault.SWAP,
    Fault.LOSE,
    Fault.DOUBLE,
    Fault.REORDER,
}


class CanNode(Protocol):
    """What stands behind the bus on the plant's side: PLC, drives, or both."""

    channels: frozenset[str]
    """Measured channels that it shows."""

    def take(self, frame: CanFrame) -> list[CanFrame]:
        """Take a frame of the runtime; return what is answered at once."""
        ...

    def publish(self, plant: Plant) -> list[CanFrame]:
        """Return the frames of the sample just finished, in sending order."""
        ...

    def reset(self) -> list[CanFrame]:
        """Start again: forget what was heard and configured; return what start-up says."""
        ...

    def second_master(self) -> list[CanFrame]:
        """Return the frames of somebody else who writes zeros to us."""
        ...


class BusFaults:
    """The faults of the bus itself, the same in lockstep and in real time."""

    def __init__(self, faults: FaultBoard, seed: int = 0) -> None:
        self._faults = faults
        self._dice = random.Random(seed)

    @property
    def cut(self) -> bool:
        """Whether nothing passes in either direction."""
        return self._faults.any_of(_CUTTING)

    def arrives(self) -> bool:
        """Return whether one frame of the runtime reaches the nodes."""
        if self.cut or self._faults.active(Fault.MUTE):
            return False
        return not self._lost()

    def on_the_way(self, frames: list[CanFrame]) -> list[CanFrame]:
        """Return what reaches the runtime of one scan's ``frames``."""
        faults = self._faults
        if not faults.any_of(_ON_THE_WAY):
            return frames
        if self.cut or faults.active(Fault.MUTE) or faults.active(Fault.BUSY):
            return []
        changes: tuple[tuple[Fault, Callable[[list[CanFrame]], list[CanFrame]]], ...] = (
            (Fault.PARTIAL, lambda all_: all_[: len(all_) // 2]),
            (Fault.SHORT, lambda all_: [f._replace(data=f.data[:-1]) for f in all_]),
            (Fault.TID, lambda all_: [f._replace(can_id=f.can_id ^ 0x008) for f in all_]),
            (Fault.SWAP, lambda all_: [f._replace(data=f.data[::-1]) for f in all_]),
            (Fault.LOSE, lambda all_: [f for f in all_ if not self._lost()]),
            (Fault.DOUBLE, lambda all_: [f for f in all_ for _ in range(2)]),
            (Fault.REORDER, lambda all_: all_[::-1]),
        )
        for fault, change in changes:
            if faults.active(fault):
                frames = change(frames)
        return frames

    def _lost(self) -> bool:
        if not self._faults.active(Fault.LOSE):
            return False
        return self._dice.random() * 100.0 < float(self._faults.argument(Fault.LOSE))
