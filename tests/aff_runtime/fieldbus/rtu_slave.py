"""A Modbus RTU device on a pty pair: pymodbus' own framer, our simulated PLC's registers."""

from __future__ import annotations

import os
import select
import threading
import tty

from pymodbus.framer import FramerRTU
from pymodbus.pdu import DecodePDU

from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.registers import Registers
from tests.sim_plant.servers.fake_line import default_map


class Slave:
    """A device on the other end of the line; ``spoil`` changes what it answers."""

    def __init__(self) -> None:
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.path = os.ttyname(self.slave)
        self.registers = Registers(default_map())
        self.device = ModbusDevice(self.registers)
        self.framer = FramerRTU(DecodePDU(is_server=True))
        self.spoil = lambda frame: frame
        self._on = True
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self) -> None:
        buffer = b""
        while self._on:
            if not select.select([self.master], [], [], 0.02)[0]:
                continue
            buffer += os.read(self.master, 512)
            used, device_id, _, pdu = self.framer.decode(buffer)
            buffer = buffer[used:]
            if pdu:
                answer = self.framer.encode(self.device.answer(pdu), device_id, 0)
                os.write(self.master, self.spoil(answer))

    def close(self) -> None:
        self._on = False
        self._thread.join(5)
        os.close(self.master)
        os.close(self.slave)
