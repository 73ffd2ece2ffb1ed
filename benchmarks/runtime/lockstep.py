"""The control process's ticks in virtual time, on a byte stream that stands in for the PLC.

What the plant answered to each request is kept once (`benchmarks.runtime.instructions`) and
played back here, so that a counted process holds nothing but the runtime: gateway, guard, law,
record, ring and the link to a supervisor.

``python -m benchmarks.runtime.lockstep FOLDER`` plays back under callgrind.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

from aff_runtime.app.control.outside import ControlOutside
from aff_runtime.app.link import messages
from aff_runtime.app.link.packets import Link, link_pair
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.wiring import assemble as assembling
from aff_runtime.app.wiring import wires
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.base.ports import Law
from aff_runtime.fieldbus.modbus.byte_stream import Connecting
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.loop import cycle as cycle_module
from aff_runtime.loop.cycle import Cycle
from aff_runtime.loop.ports import Advice
from aff_runtime.safety.guard import Guard
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.slots import SlotWriter

ARMED_AT = 50
"""Tick after which it is armed."""
WARM_TICKS = 1600
COUNTED_TICKS = 400
"""Every part has done all that it does in turns: each 8th, 16th, 20th, 100th tick."""
TICKS = WARM_TICKS + COUNTED_TICKS
NEVER_NS = 1 << 62
PARAMETERS, SCRIPT, DOORS = "parameters.json", "script.json", "doors"
SEAMS: tuple[tuple[Any, str, str], ...] = (
    (Cycle, "tick", "rest"),
    (WordGateway, "exchange", "wire"),
    (WordCodec, "encode", "codec"),
    (WordCodec, "decode", "codec"),
    (WordCodec, "aff_echo", "codec"),
    (WordCodec, "applied", "codec"),
    (Guard, "observe", "guard"),
    (Guard, "limit", "guard"),
    (LawSlot, "step", "law"),
    (LawSlot, "law_telemetry", "record"),
    (cycle_module, "build_record", "record"),
    (SlotWriter, "write", "ring"),
)
PARTS = ("wire", "codec", "guard", "law", "record", "ring", "rest")
STAND_IN = "stand_in"
INSIDE = {"wire": ("codec", STAND_IN), "rest": ("wire", "guard", "law", "record", "ring")}
"""Which parts run inside another one, and are taken out of its sum."""

Answer = Callable[[bytes], bytes]


class VirtualClock:
    """Time that moves only when somebody sleeps."""

    def __init__(self) -> None:
        self._now_ns = 10**9

    def now_ns(self) -> int:
        """Return virtual time, ns."""
        return self._now_ns

    def sleep_until_ns(self, deadline_ns: int) -> None:
        """Jump there."""
        self._now_ns = max(self._now_ns, deadline_ns)


class StandIn:
    """A byte stream that has the answer to a request as soon as it is sent."""

    lossy = False
    why_closed = ""

    def __init__(self, answer: Answer) -> None:
        self.answer = answer
        self._waiting = b""

    def start_connect(self) -> bool:
        """Be connected."""
        return True

    def connecting(self) -> Connecting:
        """Be connected."""
        return Connecting.UP

    def send(self, frame: bytes) -> bool:
        """Take a request, and make its answer."""
        self._waiting = self.answer(frame)
        return True

    def receive(self, into: memoryview, wait_ns: int) -> int:
        """Return the whole answer."""
        count = len(self._waiting)
        into[:count], self._waiting = self._waiting, b""
        return count

    def close(self, *, abort: bool) -> None:
        """Close nothing."""


class Unopposed(ControlOutside):
    """Asks the law's side as ever, and lets an actuator without a response arm, as other benches.

    Such an actuator adapts nothing.
    """

    def advise(self, law: Law) -> Advice:
        """Return the law side's advice without its objections."""
        return replace(super().advise(law), objections=())


class Lockstep:
    """The control process of a parameter record, tick by tick; ``answer`` plays the PLC."""

    def __init__(self, parameters: ParameterRecord, answer: Answer) -> None:
        clock = VirtualClock()
        ours, theirs = link_pair()
        self._supervisor = Link(theirs)
        with (
            patch.object(wires, "wire_of", lambda *_: StandIn(answer)),
            patch("secrets.randbelow", lambda _: 0),
        ):
            assembly = assembling.assemble(parameters, clock)
            outside = Unopposed(assembly, Link(ours), RunMeta(), clock)
            self.cycle = assembling.cycle_of(assembly, outside)
        self.guard = assembly.guard
        self._ticks = 0

    def tick(self) -> None:
        """Do one tick; hear what the control process says, and arm it in time."""
        self.cycle.tick()
        while (passed := self._supervisor.receive_passed()) is not None:
            if passed[1] is not None:
                os.close(passed[1])
        self._ticks += 1
        if self._ticks == ARMED_AT:
            self._supervisor.send(messages.Arm(id=1, valid_until_ns=NEVER_NS))


def playing_back(script: Sequence[tuple[str, str]]) -> Answer:
    """Return what answers each request as it was answered; another request is an error."""
    rest = iter(script)

    def answer(frame: bytes) -> bytes:
        asked, answered = next(rest)
        if frame.hex() != asked:
            raise ValueError(f"asked {frame.hex()}, in the script {asked}")
        return bytes.fromhex(answered)

    return answer


def through(door: Callable[..., Any], work: Callable[..., Any]) -> Callable[..., Any]:
    """Return the same work, called through the C function of a part."""

    def counted(*given: Any, **named: Any) -> Any:
        return door(work, given, named)

    return counted


def count(folder: Path) -> None:
    """Play a script back; the last ticks are counted, each part behind its door."""
    record = json.loads((folder / PARAMETERS).read_text(encoding="utf-8"))
    script = json.loads((folder / SCRIPT).read_text(encoding="utf-8"))
    sys.path.append(str(folder))
    doors = importlib.import_module(DOORS)
    for owner, name, part in SEAMS:
        setattr(owner, name, through(getattr(doors, part), getattr(owner, name)))
    answer = through(getattr(doors, STAND_IN), playing_back(script))
    lockstep = Lockstep(ParameterRecord.from_json(record), answer)
    for _ in range(WARM_TICKS):
        lockstep.tick()
    doors.begin()
    for _ in range(COUNTED_TICKS):
        lockstep.tick()
    doors.end()


if __name__ == "__main__":
    count(Path(sys.argv[1]))
