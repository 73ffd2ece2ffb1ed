"""Unusual plants, each declared by what is unlike the shipped one, and who commissions them.

PLC, wire, setup and runtime in one process and in virtual time: real Modbus frames, no socket.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from aff_runtime.app.setup.asking.dialogue import Dialogue
from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.questions import Question
from aff_runtime.app.setup.flow import interview, write
from aff_runtime.app.setup.words.reading import WordReader
from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.config.models import Site
from aff_runtime.fieldbus.modbus.byte_stream import Connecting
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.connections import modbus
from aff_runtime.fieldbus.modbus.frames import WireFunction
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from sim_plant.base.ports import SteppedLine
from sim_plant.demo.unusual_plants import PLANTS as ALL
from sim_plant.demo.unusual_plants import UnusualPlant
from sim_plant.servers.faults import FaultBoard
from sim_plant.servers.map_file import load_plc_map
from sim_plant.servers.modbus_answer import answer_to
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.plc import Plc
from tests.doubles.lockstep_plant import LockstepPlant
from tests.doubles.virtual_clock import VirtualClock

SECOND, SECOND_CHANNEL = "swrap_follower", "pullroll_tension_N"


class LeftOpenError(AssertionError):
    """A question without an answer."""


class RefusedAnswerError(Exception):
    """An answer was refused; the text is what the technician reads."""


PLANTS: Mapping[str, UnusualPlant] = {
    name: plant
    for name, plant in ALL.items()
    if plant.wire == "modbus" and plant != UnusualPlant()
}
"""Those that frames of Modbus reach, and that are unlike the shipped one."""


class FrameWire:
    """A byte stream to a PLC in virtual time: it lives up to each request, and answers at once."""

    lossy = False
    why_closed = ""

    def __init__(
        self,
        live: Callable[[], None],
        device: ModbusDevice,
        faults: FaultBoard,
        clock: VirtualClock,
    ) -> None:
        self._live, self._device, self._faults, self._clock = live, device, faults, clock
        self._waiting = b""

    def start_connect(self) -> bool:
        self._waiting = b""
        return True

    def connecting(self) -> Connecting:
        return Connecting.UP

    def send(self, frame: bytes) -> bool:
        self._live()
        self._waiting += b"".join(answer_to(frame, self._device, self._faults).frames)
        return True

    def receive(self, into: memoryview, wait_ns: int) -> int:
        part = self._waiting[: len(into)]
        if not part:
            self._clock.advance_ns(max(wait_ns, 1))
        self._waiting = self._waiting[len(part) :]
        into[: len(part)] = part
        return len(part)

    def close(self, *, abort: bool) -> None:
        self._waiting = b""


def gateway_on(wire: FrameWire, site: Site, clock: VirtualClock) -> WordGateway:
    """Return the site's own wire in SI on a virtual one."""
    section = site.gateway.modbus
    assert section is not None
    words = register_map(site)
    connection = modbus(
        wire,
        device_id=section.device_id,
        register_map=words,
        clock=clock,
        function=WireFunction(section.function),
    )
    return WordGateway(connection, WordCodec(words), clock, lambda: connection.trouble)


class Stand:
    """A line and its PLC before anything is known of them."""

    def __init__(self, plant: UnusualPlant, line: SteppedLine, folder: Path) -> None:
        self.unusual = plant
        self.folder = folder
        self.map = load_plc_map(plant.plc_map(folder))
        self.clock = VirtualClock(1)
        self.wire = LockstepPlant(line, Plc(self.map))
        self._lived_ns = self.clock.now_ns()
        self.plant = self.wire.plant
        self.device = ModbusDevice(self.plant.registers, allow_fc23=plant.fc23)

    def _live(self) -> None:
        now_ns = self.clock.now_ns()
        self.wire.advance((now_ns - self._lived_ns) * 1e-9)
        self._lived_ns = now_ns

    def reader(self, draft: Draft) -> WordReader:
        """Return what setup reads the PLC with."""
        wire = FrameWire(self._live, self.device, self.plant.faults, self.clock)
        unit = int(draft.answers["device_id"])
        return WordReader(wire, device_id=unit, clock=self.clock, where="the PLC")

    def gateway(self, site: Site) -> WordGateway:
        """Return what a service on this site file speaks to the PLC with."""
        wire = FrameWire(self._live, self.device, self.plant.faults, self.clock)
        return gateway_on(wire, site, self.clock)

    def commission(self, site: Path) -> Technician:
        """Let a technician with manual and displays write a site file.

        Raises
        ------
        RefusedAnswerError, AffError
            It cannot be done; says why.
        """
        kept = site.with_suffix(".setup.json")
        technician = Technician(self)
        dialogue = Dialogue(Draft(), kept, technician)
        interview(dialogue, self.reader)
        assert write(dialogue, site, None)
        return technician


class Technician:
    """Reads displays and the PLC's manual, and takes what setup is sure of.

    Attributes
    ----------
    unasked : names of the questions that had an answer of setup's own.
    said : all that setup said.
    """

    is_patient = False

    def __init__(self, stand: Stand) -> None:
        self._stand = stand
        self.unasked: list[str] = []
        self.said: list[str] = []
        self._answers: dict[str, str | Callable[[], str]] = {
            **self._machine(), **self._displays(), **stand.unusual.answers
        }  # fmt: skip

    def _machine(self) -> dict[str, str]:
        rows = self._stand.map
        applied = {f"applied.{row.name}": str(row.address) for row in rows.applied}
        return {
            "host": "10.0.0.1", "name": "Line", "second": SECOND, "count": "40",
            "speed_max": "8", "tension_max": "400 N", "radius_min": "0.05", "radius_max": "0.3",
            "limit": "0.15", "second_radius": "0.15367", "limit_second": "40 mm/s",
            "probe": "0.02", "status.word": str(rows.read["status"]), "roll_id": str(
                rows.read["roll_id"]), "echo": str(rows.read["aff_echo"]), **applied,
        }  # fmt: skip

    def _displays(self) -> dict[str, str | Callable[[], str]]:
        measured = self._measured
        words = {item.name: item.address for item in self._stand.map.channels}
        words[f"{SECOND}_tension_N"] = words[SECOND_CHANNEL]
        at = {f"{name}.pick": f"w{address}" for name, address in words.items()}
        speed = "line_speed_m_s"
        return {
            **at,
            "unwind_tension_N.display": lambda: f"{measured('tension_ref_N'):.1f} N",
            "tension_ref_N.display": lambda: f"{measured('tension_ref_N'):.1f} N",
            f"{speed}.display": lambda: f"{measured(speed):.2f} m/s",
            "unwind_radius_m.display": lambda: f"{1e3 * measured('unwind_radius_m'):.1f} mm",
            f"{SECOND}_speed_m_s.display": lambda: f"{60.0 * measured(speed):.0f} m/min",
            f"{SECOND}_tension_N.display": lambda: f"{measured(SECOND_CHANNEL):.0f} N",
        }

    def _measured(self, name: str) -> float:
        return self._stand.plant.measured[name]

    def answers_itself(self, name: str) -> bool:
        return False

    def answer(self, question: Question) -> str:
        if question.default is not None and question.name.endswith("_rad.pick"):
            self.unasked.append(question.name)
            return question.default
        given = self._answers.get(question.name, question.default)
        if given is None:
            raise LeftOpenError(f"{question.name}: {question.text} {question.rows}")
        return given if isinstance(given, str) else given()

    def refuse(self, question: Question, why: str) -> None:
        raise RefusedAnswerError(f"{question.name}: {why}")

    def say(self, line: str) -> None:
        self.said.append(line)

    complain = say
