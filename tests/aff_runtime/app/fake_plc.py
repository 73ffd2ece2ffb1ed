"""A PLC in 100 lines: one Modbus TCP server, a web of one spring, commands on standard input.

Commands: ``status N``, ``freeze``, ``thaw``, ``words`` (answers with the write block as JSON).
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import select
import socket
import struct
import time
from collections import deque

READY_STATUS = 1 | 2 | 8 | 32 | 64
GAIN_N_PER_M_S = -2000.0
TURNS_HZ = 0.9
DELAY_S = 0.005
"""What was written this long ago acts: half a cycle of 10 ms, so with the next reading."""


class Plc:
    """Answers FC23 and FC3 on the default gateway block."""

    def __init__(self) -> None:
        self.status = READY_STATUS
        self.frozen = False
        self.words = [0] * 10
        self.ripple_N = 3.0
        self.heartbeat = 0
        self.start_s = time.monotonic()
        self.delays = [deque([(0.0, 0.0)]) for _ in range(2)]

    def read_block(self) -> list[int]:
        if not self.frozen:
            self.heartbeat = (self.heartbeat + 1) & 0xFFFF
        turns = TURNS_HZ * (time.monotonic() - self.start_s)
        ripple = self.ripple_N * math.cos(math.tau * turns) + 1e-3 * (self.heartbeat % 7)
        milli = [int(1e3 * (90.0 + ripple + GAIN_N_PER_M_S * acting(d))) for d in self.delays]
        (high, low), (high_2, low_2) = ((m >> 16, m & 0xFFFF) for m in milli)
        angle = divmod(int(turns * 4096) & 0xFFFFFFFF, 0x10000)
        return [
            *(self.heartbeat, self.status, high, low, 9000, 1000, 8000, 1000, 1),
            *(high_2, low_2, *angle, *angle, self.words[0]),
            *(self.words[3], self.words[8]),  # applied at once, without a limit of its own
        ]

    def take(self, words: list[int]) -> None:
        self.words = words
        for delay, word in zip(self.delays, (words[3], words[8]), strict=True):
            correction_m_s = (word - 0x10000 if word & 0x8000 else word) * 1e-5
            delay.append((time.monotonic(), correction_m_s))

    def answer(self, pdu: bytes) -> bytes:
        function = pdu[0]
        if function == 23:
            _, _, _, count, n_bytes = struct.unpack(">HHHHB", pdu[1:10])
            self.take(list(struct.unpack(f">{count}H", pdu[10 : 10 + n_bytes])))
        elif function != 3:
            return struct.pack(">BB", function | 0x80, 1)
        block = self.read_block()
        return struct.pack(f">BB{len(block)}H", function, 2 * len(block), *block)


def acting(delay: deque[tuple[float, float]]) -> float:
    """Return the newest value that is as old as the delay, and forget the older ones."""
    until_s = time.monotonic() - DELAY_S
    while len(delay) > 1 and delay[1][0] <= until_s:
        delay.popleft()
    return delay[0][1]


def serve(plc: Plc, listener: socket.socket) -> None:
    clients: dict[socket.socket, bytes] = {}
    commands = b""
    while True:
        ready, _, _ = select.select([listener, 0, *clients], [], [])
        for source in ready:
            if source is listener:
                client, _ = listener.accept()
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                clients[client] = b""
            elif source == 0:
                chunk = os.read(0, 4096)
                if not chunk:
                    return
                *lines, commands = (commands + chunk).split(b"\n")
                for line in lines:
                    obey(plc, line.decode().split())
            else:
                hear(plc, source, clients)


def hear(plc: Plc, client: socket.socket, clients: dict[socket.socket, bytes]) -> None:
    try:
        chunk = client.recv(4096)
    except OSError:
        chunk = b""
    if not chunk:
        del clients[client]
        client.close()
        return
    data = clients[client] + chunk
    while len(data) >= 7 and len(data) >= 6 + (length := struct.unpack(">H", data[4:6])[0]):
        reply = plc.answer(data[7 : 6 + length])
        with contextlib.suppress(OSError):
            client.sendall(data[:4] + struct.pack(">HB", len(reply) + 1, data[6]) + reply)
        data = data[6 + length :]
    clients[client] = data


def obey(plc: Plc, command: list[str]) -> None:
    match command:
        case ["shake", amplitude]:
            plc.ripple_N = float(amplitude)
        case ["status", number]:
            plc.status = int(number)
        case ["freeze"]:
            plc.frozen = True
        case ["thaw"]:
            plc.frozen = False
    print(json.dumps(plc.words), flush=True)


def main() -> None:
    listener = socket.create_server(("127.0.0.1", 0))
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(70))
    print(listener.getsockname()[1], flush=True)
    serve(Plc(), listener)


if __name__ == "__main__":
    main()
