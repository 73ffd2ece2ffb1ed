"""One Modbus request in, one answer out: FC3, FC6, FC16 and FC23 on the PLC's registers."""

from __future__ import annotations

from pymodbus.pdu import DecodePDU, ExceptionResponse, ModbusPDU
from pymodbus.pdu.register_message import (
    ReadHoldingRegistersRequest,
    ReadHoldingRegistersResponse,
    ReadWriteMultipleRegistersRequest,
    ReadWriteMultipleRegistersResponse,
    WriteMultipleRegistersRequest,
    WriteMultipleRegistersResponse,
    WriteSingleRegisterRequest,
    WriteSingleRegisterResponse,
)

from sim_plant.servers.registers import Registers

ILLEGAL_FUNCTION = 1
ILLEGAL_ADDRESS = 2
ILLEGAL_VALUE = 3
BUSY = 6
_FIXED_LENGTH = {3: 5, 6: 5}
_BYTE_COUNT_AT = {16: 5, 23: 9}
_MOST_READ = 125
_MOST_WRITTEN = {16: 123, 23: 121}


class ModbusDevice:
    """Answers requests.

    Attributes
    ----------
    requests, exceptions : how many were answered, and how many of them with an exception.
    """

    def __init__(self, registers: Registers, *, allow_fc23: bool = True) -> None:
        self._registers = registers
        self._functions = {3, 6, 16, 23} if allow_fc23 else {3, 6, 16}
        self._decoder = DecodePDU(is_server=True)
        self.requests = 0
        self.exceptions = 0

    def answer(self, request: bytes, *, busy: bool = False) -> bytes:
        """Return the answer's PDU (function code and data) to a request's PDU (not empty)."""
        self.requests += 1
        function = request[0]
        response: ModbusPDU
        if busy:
            response = ExceptionResponse(function, BUSY)
        elif function not in self._functions:
            response = ExceptionResponse(function, ILLEGAL_FUNCTION)
        else:
            response = self._obey(function, request)
        if response.isError():
            self.exceptions += 1
        return bytes([response.function_code & 0xFF]) + response.encode()

    def _obey(self, function: int, request: bytes) -> ModbusPDU:
        pdu = self._decoder.decode(request) if _well_formed(function, request) else None
        registers: list[int] | None
        match pdu:
            case ReadHoldingRegistersRequest():
                registers = self._registers.read(pdu.address, pdu.count)
                if registers is not None:
                    return ReadHoldingRegistersResponse(registers=registers)
            case ReadWriteMultipleRegistersRequest():
                registers = self._write_then_read(pdu)
                if registers is not None:
                    return ReadWriteMultipleRegistersResponse(registers=registers)
            case WriteMultipleRegistersRequest():
                if self._registers.write(pdu.address, pdu.registers):
                    return WriteMultipleRegistersResponse(address=pdu.address, count=pdu.count)
            case WriteSingleRegisterRequest():
                if self._registers.write(pdu.address, pdu.registers):
                    return WriteSingleRegisterResponse(
                        address=pdu.address, registers=pdu.registers
                    )
            case _:
                return ExceptionResponse(function, ILLEGAL_VALUE)
        return ExceptionResponse(function, ILLEGAL_ADDRESS)

    def _write_then_read(self, pdu: ReadWriteMultipleRegistersRequest) -> list[int] | None:
        """Write first, as the specification orders it; write nothing when the read would fail."""
        if not self._registers.readable(pdu.read_address, pdu.read_count):
            return None
        if not self._registers.write(pdu.write_address, pdu.write_registers):
            return None
        return self._registers.read(pdu.read_address, pdu.read_count)


def _well_formed(function: int, request: bytes) -> bool:
    """Return whether the length fits and the counts are within the specification."""
    if function in _FIXED_LENGTH:
        if len(request) != _FIXED_LENGTH[function]:
            return False
        return function == 6 or 1 <= int.from_bytes(request[3:5], "big") <= _MOST_READ
    at = _BYTE_COUNT_AT[function]
    if len(request) <= at or len(request) != at + 1 + request[at]:
        return False
    written = int.from_bytes(request[at - 2 : at], "big")
    if not 1 <= written <= _MOST_WRITTEN[function] or request[at] != 2 * written:
        return False
    return function == 16 or 1 <= int.from_bytes(request[3:5], "big") <= _MOST_READ
