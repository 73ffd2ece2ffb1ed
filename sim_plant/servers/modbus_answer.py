"""One Modbus frame in, the frames of its answer out, spoilt by the faults of the wire."""

from __future__ import annotations

from typing import NamedTuple

from pymodbus.framer import FramerSocket
from pymodbus.pdu import DecodePDU

from sim_plant.servers.faults import Fault, FaultBoard
from sim_plant.servers.modbus_device import ModbusDevice

HEADER = 7  # bytes before the function code
_LONGEST_BODY = 254  # unit id and PDU
_FRAMER = FramerSocket(DecodePDU(is_server=True))


class Answer(NamedTuple):
    """Frames in the order of sending (none: no answer), and how late they are, s."""

    frames: tuple[bytes, ...]
    delay_s: float = 0.0


def request_length(data: bytes | bytearray) -> int:
    """Return the length of the request at the head of ``data``, HEADER bytes or more.

    0 for what is no Modbus: another protocol id, an impossible length.
    """
    protocol_id = int.from_bytes(data[2:4], "big")
    length = int.from_bytes(data[4:6], "big")
    return length + 6 if protocol_id == 0 and 2 <= length <= _LONGEST_BODY else 0


def answer_to(frame: bytes, device: ModbusDevice, faults: FaultBoard) -> Answer:
    """Let the device obey one whole request; return what is sent back."""
    if faults.active(Fault.MUTE):
        return Answer(())
    answer = device.answer(frame[HEADER:], busy=faults.active(Fault.BUSY))
    if faults.active(Fault.SHORT):
        answer = _without_last_word(answer)
    transaction_id = int.from_bytes(frame[:2], "big")
    if faults.active(Fault.TID):
        transaction_id = (transaction_id + 1) & 0xFFFF
    reply = _FRAMER.encode(answer, frame[6], transaction_id)
    if faults.active(Fault.PARTIAL):
        reply = reply[: len(reply) // 2]
    delay_s = float(faults.argument(Fault.DELAY)) * 1e-3 if faults.active(Fault.DELAY) else 0.0
    return Answer((reply, reply) if faults.active(Fault.DOUBLE) else (reply,), delay_s)


def _without_last_word(answer: bytes) -> bytes:
    """Return the answer two bytes shorter, with a byte count that agrees where there is one."""
    if answer[0] in {3, 23}:
        return bytes([answer[0], answer[1] - 2]) + answer[2:-2]
    return answer[:-2]
