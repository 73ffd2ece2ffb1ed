"""Modbus over UDP: what has the address of a server in it, and was sent by somebody else."""

import socket
import struct

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.frames import ModbusFrames, WireFunction
from aff_runtime.fieldbus.modbus.transport import ModbusTransport
from aff_runtime.fieldbus.modbus.udp_wire import UdpWire
from sim_plant.servers.faults import FaultBoard
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.modbus_udp import ModbusUdpServer
from tests.each_case import each_case

READ_2_FROM_0 = bytes.fromhex("0007 0000 0006 01 03 0000 0002")
ANSWER = bytes.fromhex("0007 0000 0003 01 83 02")
MOST = 10


class Words:
    """Registers that hold zeros."""

    def read(self, address, count):
        return [0] * count


class Net:
    """Takes what a server sends."""

    def __init__(self):
        self.sent = []

    def sendto(self, frame, _):
        self.sent.append(frame)


def server():
    """Return a server that has its socket, and what it sends."""
    made = ModbusUdpServer(ModbusDevice(Words()), FaultBoard(), host="127.0.0.1", port=1)
    made._transport = Net()
    return made, made._transport.sent


def test_two_servers_do_not_answer_each_other_for_ever():
    """Every exception was answered by an exception."""
    (first, from_first), (second, from_second) = server(), server()
    first.datagram_received(READ_2_FROM_0, ("127.0.0.1", 2))
    for _ in range(MOST):
        if from_first:
            second.datagram_received(from_first.pop(0), ("127.0.0.1", 1))
        if from_second:
            first.datagram_received(from_second.pop(0), ("127.0.0.1", 2))
    assert from_first + from_second == []


def test_an_answer_is_counted_as_no_request():
    made, sent = server()
    made.datagram_received(ANSWER, ("127.0.0.1", 2))
    assert (sent, made.refused) == ([], 1)


JUNK = b"\xff" * 9


def reply(tid, word):
    """Return the answer to a question for one word."""
    return struct.pack(">HHHBBBH", tid, 0, 5, 1, 3, 2, word)


@each_case("laid", [[2, 2], [2, 2, 2, 3], [JUNK, 2, 2], [JUNK] * 40 + [2], [2] * 99])
def test_an_answer_laid_before_its_question_was_asked_is_not_believed(laid):
    """One datagram was taken away per tick; the next one was the answer to the next question."""
    clock = MonotonicClock()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
        server.bind(("127.0.0.1", 0))
        server.settimeout(5.0)
        client = ModbusTransport(
            frames=ModbusFrames(device_id=1, read_start=0, read_count=1),
            wire=UdpWire("127.0.0.1", server.getsockname()[1]),
            clock=clock,
            function=WireFunction.FC3,
            silence_before_reconnect_s=60.0,
        )
        client.transact([], clock.now_ns() + 10_000_000)
        assert client.transact([], clock.now_ns() + 10_000_000)[0] is Outcome.TIMEOUT
        _, there = server.recvfrom(300)
        for tid in laid:
            server.sendto(tid if isinstance(tid, bytes) else reply(tid, 666), there)
        outcome, words = client.transact([], clock.now_ns() + 50_000_000)
        assert (outcome is Outcome.OK, words) == (False, [])
        client.close()
