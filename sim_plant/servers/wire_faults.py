"""Which faults a wire has: one that it has not is refused, for it would do nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from aff_runtime.base.errors import PlantError
from sim_plant.servers.faults import TAKES_CHANNEL, Fault, FaultSpec
from sim_plant.servers.plc_map import PlcMap


class Medium(StrEnum):
    """What a line is served on."""

    TCP = "Modbus TCP"
    UDP = "Modbus UDP"
    DBC = "CAN by DBC"
    CANOPEN = "CANopen"


_CAN = (Medium.DBC, Medium.CANOPEN)
_OF: dict[Fault, tuple[Medium, ...]] = {  # the others are of the PLC or of every wire
    Fault.LOSE: (Medium.UDP, *_CAN),
    Fault.REORDER: _CAN,
    Fault.ERRORS: _CAN,
    Fault.BUSOFF: _CAN,
    Fault.SYNC: (Medium.CANOPEN,),
    Fault.RESET: (Medium.CANOPEN,),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class WireFaults:
    """What can be broken of one served line.

    Attributes
    ----------
    medium : what it is served on.
    channels : measured channels that this wire shows; None: all of the PLC's map.
    tells_errors : the bus can carry error frames of ours.
    """

    medium: Medium
    channels: frozenset[str] | None = None
    tells_errors: bool = True

    def check(self, spec: FaultSpec, plc_map: PlcMap) -> None:
        """Refuse a fault that would change nothing here.

        Raises
        ------
        PlantError
            The wire has no such fault, or the channel is none that it shows.
        """
        fault = spec.fault
        media = _OF.get(fault, tuple(Medium))
        if self.medium not in media:
            raise PlantError(
                f"fault {fault.value!r}: is of {' and '.join(media)}; "
                f"this line is served on {self.medium}"
            )
        if fault is Fault.ERRORS and not self.tells_errors:
            raise PlantError(
                "fault 'errors': only a controller sends error frames; serve the line on "
                "frame_socket or slcan_pty"
            )
        shown = [
            item.name
            for item in plc_map.channels
            if self.channels is None or item.name in self.channels
        ]
        if fault in TAKES_CHANNEL:
            _check_channel(spec, shown)
        elif fault is Fault.SWAP and self.medium not in _CAN:
            _check_two_words(plc_map)


def _check_channel(spec: FaultSpec, shown: Sequence[str]) -> None:
    there = f"the PLC shows {', '.join(shown)}"
    if spec.argument and spec.argument not in shown:
        name = f"{spec.fault.value}={spec.argument}"
        raise PlantError(f"fault {name!r}: no such channel; {there}")
    if not spec.argument and not any(name.endswith("_tension_N") for name in shown):
        raise PlantError(f"fault {spec.fault.value!r}: name a channel; {there}")


def _check_two_words(plc_map: PlcMap) -> None:
    if all(item.length == 1 for item in plc_map.channels):
        raise PlantError("fault 'swap': the PLC's map has no value of two words")
