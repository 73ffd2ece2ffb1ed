"""Runtime and plant in lockstep over one of the three wires, with a law that asks for too much."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.ports import Gateway
from aff_runtime.base.signals import ActuatorStep, Permission, Snapshot, State
from aff_runtime.config.can_wire import can_map_of, network_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.can.gateway import CanGateway
from aff_runtime.fieldbus.can.reader import CanReader
from aff_runtime.fieldbus.can.writer import CanWriter
from aff_runtime.fieldbus.canopen.link import CanopenLink
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.loop.cycle import Cycle, CycleSettings
from aff_runtime.loop.messages import Arm, Bypass, Message, SupervisorLost
from aff_runtime.loop.ports import Advice
from aff_runtime.safety.guard import Guard
from aff_runtime.safety.params import AppliedParams
from sim_plant.servers.can_catalogue import can_node
from sim_plant.servers.faults import parse_fault
from sim_plant.servers.plc import Plc
from sim_plant.servers.plc_map import PlcMap
from tests.doubles.can_lockstep import LockstepBus
from tests.doubles.lockstep_plant import LockstepPlant
from tests.doubles.virtual_clock import VirtualClock
from tests.sim_plant.servers.fake_line import FakeLine, default_map

CONFIG = Path(__file__).parents[2] / "config"
WIRES = {"modbus": "euclid.yaml", "can": "euclid_can.yaml", "canopen": "euclid_canopen.yaml"}
SITES = {wire: load_site(CONFIG / name) for wire, name in WIRES.items()}
FILES = {wire: wire_files(site, CONFIG) for wire, site in SITES.items()}
SAMPLE_S = 0.005
LIMITS_M_S = {"unwind": 0.15, "swrap_follower": 0.04}  # of config/euclid.yaml
LESS_THAN_A_COUNT = 1e-6  # m/s
GREED = 8.0 / 3.0  # times the unwind's limit; the follower's wish is five times its own


def without_echo(plc_map: PlcMap) -> PlcMap:
    """Return the map of a PLC that does not say whose heartbeat it took, nor what it applies."""
    read = {name: at for name, at in plc_map.read.items() if name != "aff_echo"}
    shown = 1 + len(plc_map.applied)  # the last words of the block
    return replace(plc_map, read=read, read_count=plc_map.read_count - shown, applied=())


class QuietLine(FakeLine):
    """A line that hardly answers to the correction, so that only the fault under test acts."""

    def step(self, inputs: Mapping[str, float]) -> Mapping[str, float]:
        quiet = {n: 0.0 if n.startswith("aff_") else v for n, v in inputs.items()}
        measured = dict(super().step(quiet))
        measured["pullroll_tension_N"] = 95.0 + math.sin(7.0 * self._angle_rad)
        return measured


class Greedy:
    """A law that asks for more than every limit, without pause, and looks at what it is given.

    Attributes
    ----------
    fault : how it is broken: ``law`` raises, ``lazy`` answers nothing, ``nan`` is no number.
    oldest_scans : age of the oldest reading that it was given as fresh, in scans of the PLC.
    largest : largest reading that it was given as fresh.
    """

    def __init__(self, plc: Plc) -> None:
        self.fault = ""
        self.oldest_scans = 0
        self.largest = 0.0
        self._plc = plc
        self._k = 0

    def step(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...] | None:
        if snapshot.fresh:
            age = (self._plc._heartbeat - snapshot.plc_heartbeat) & 0xFFFF
            self.oldest_scans = max(self.oldest_scans, age)
            self.largest = max(self.largest, *map(abs, snapshot.values[:2]))
        if self.fault == "law":
            raise RuntimeError("the law is broken")
        if self.fault == "lazy":
            return None
        self._k += 1
        most = GREED * LIMITS_M_S["unwind"]
        value = most * math.cos(0.02 * self._k)
        if self.fault == "nan":
            value = math.nan
        step = ActuatorStep(value=value, peak_bound=most, slew_bound=4.0 * most)
        return (step, replace(step, value=0.5 * value, peak_bound=0.5 * most))

    def telemetry(self) -> tuple[float, ...]:
        return ()

    def telemetry_names(self) -> tuple[str, ...]:
        return ()


class Around:
    """The outside of the cycle: an inbox, and nothing kept."""

    def __init__(self, guard: Guard) -> None:
        self.guard = guard
        self.inbox: list[Message] = []
        self.codes: list[int] = []

    def publish(self, record: Sequence[float]) -> None:
        pass

    def event(self, tick: int, t_ns: int, code: int) -> None:
        self.codes.append(code)

    def fault_text(self, text: str) -> None:
        pass

    def blocked(self, reasons: tuple[str, ...]) -> None:
        pass

    def poll(self) -> Sequence[Message]:
        messages, self.inbox = self.inbox, []
        return messages

    def advise(self, law: object) -> Advice:
        return Advice()

    def adopt(self, settings: object) -> None:
        pass

    def tick_done(self, first_exchange_ok: bool) -> None:
        pass


class MatrixBench:
    """One plant, one wire, one runtime that can be killed and started again.

    Attributes
    ----------
    largest_share : largest |correction| at the plant so far, of its own limit.
    compares : the site maps what the PLC applies.
    """

    def __init__(
        self,
        wire: str,
        seed: int = 0,
        sample_s: float = SAMPLE_S,
        *,
        echo: bool = True,
        applied: bool = True,
    ) -> None:
        self.wire = wire
        self.compares = applied
        self.plc_map = default_map() if echo else without_echo(default_map())
        self.sample_s = sample_s
        self._period_ns = round(sample_s * 1e9)
        self.site = SITES[wire]
        self.clock = VirtualClock()
        self.lockstep = LockstepPlant(QuietLine(sample_s), Plc(self.plc_map))
        self.plant = self.lockstep.plant
        self.bus: LockstepBus | None = None
        if wire != "modbus":
            protocol = {"can": "dbc", "canopen": "canopen"}[wire]
            node = can_node(self.plant, protocol, CONFIG / "plc" / f"can_{protocol}.yaml")
            self.bus = LockstepBus(self.lockstep, node, self.clock, seed=seed)
        self.law = Greedy(self.lockstep.plant.plc)
        self.applied: list[float] = []
        self.largest_share = 0.0
        self.running = True
        self.start()

    def start(self) -> None:
        """Start the runtime, as after power-up."""
        guarded = guard_params(self.site)
        if not self.compares:
            guarded = replace(guarded, applied=AppliedParams())
        outputs = tuple(replace(a, soft_start_s=0.2) for a in guarded.actuators)
        self.guard = Guard(replace(guarded, actuators=outputs, splice_settle_s=0.1))
        self.around = Around(self.guard)
        settings = CycleSettings(
            period_ns=self._period_ns,
            io_budget_ns=3_000_000,
            fade_s=self.site.freshness.fade_ms * 1e-3,
            channel_count=len(self.site.gateway.read.channels),
            output_count=2,
            law_columns=0,
            config_revision=1,
        )
        self.cycle = Cycle(
            settings=settings,
            clock=self.clock,
            gateway=self._gateway(),
            guard=self.guard,
            law=self.law,
            outside=self.around,
        )
        self.cycle._ticker.start()

    def _gateway(self) -> Gateway:
        site, clock = self.site, self.clock
        if self.bus is None:
            words = register_map(site)
            if "aff_echo" not in self.plc_map.read:
                words = replace(words, aff_echo=None, applied=())
            return WordGateway(self.lockstep, WordCodec(words), clock)
        if self.wire == "can":
            can_map = can_map_of(site, FILES[self.wire])
            return CanGateway(self.bus, CanReader(can_map), CanWriter(can_map), clock)
        network = network_of(site, FILES[self.wire])
        link = CanopenLink(self.bus, network.plans, own_node=100, heartbeat_ms=20, clock=clock)
        can_map = network.can_map
        return CanGateway(link, CanReader(can_map), CanWriter(can_map), clock)

    @property
    def alarm(self) -> int:
        """Alarm code of the next command."""
        return self.cycle._alarm

    @property
    def sent(self) -> tuple[float, ...]:
        """Corrections of the next command, SI."""
        return self.cycle._corrections

    def run(self, seconds: float) -> list[float]:
        """Advance both sides; return the largest correction at the plant, sample by sample."""
        begin = len(self.applied)
        for _ in range(round(seconds / self.sample_s)):
            self.applied.append(self.step())
        return self.applied[begin:]

    def step(self) -> float:
        """Advance both sides by one sample; return the largest correction at the plant."""
        self.plant.step()
        if self.running:
            self.running = self.cycle.tick()
        else:
            self.clock.advance_ns(self._period_ns)
        applied = self.plant.applied_m_s
        share = max(abs(applied[name]) / limit for name, limit in LIMITS_M_S.items())
        self.largest_share = max(self.largest_share, share)
        return max(map(abs, applied.values()))

    def arm(self) -> None:
        self.around.inbox.append(Arm())

    def bypass(self) -> None:
        self.around.inbox.append(Bypass())

    def until(self, *states: State, within_s: float = 3.0) -> bool:
        for _ in range(round(within_s / self.sample_s)):
            if self.guard.state in states:
                return True
            self.run(self.sample_s)
        return False

    def begin(self, spec: str) -> None:
        """Begin a fault of the wire, the plant, or (``!``) of the runtime itself."""
        name, _, _ = spec.partition(":")
        if name in {"!kill", "!stall"}:
            self.running = False
        elif name == "!supervisor":
            self.around.inbox.append(SupervisorLost())
        elif name in {"!law", "!lazy", "!nan"}:
            self.law.fault = name[1:]
        elif name == "!limit":
            rows = (replace(row, limit_m_s=LESS_THAN_A_COUNT) for row in self.plc_map.corrections)
            self.plant.plc.map = replace(self.plc_map, corrections=tuple(rows))
        else:
            self.lockstep.inject(parse_fault(spec))

    def end(self, spec: str) -> None:
        """End what ``begin`` began, where time alone does not."""
        name, _, _ = spec.partition(":")
        self.law.fault = ""
        self.plant.plc.map = self.plc_map
        if name in {"!kill", "!supervisor"}:
            if self.bus is not None:
                self.bus.reopen()
            self.start()
        self.running = True
