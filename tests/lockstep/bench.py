"""Runtime and plant in one process and in virtual time: the product's rooms, the real line."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.events import BY_CODE
from aff_runtime.base.ports import Gateway, Law
from aff_runtime.base.signals import Outcome, State
from aff_runtime.config.loader import load_site
from aff_runtime.config.models.site import Site
from aff_runtime.core.controller import Controller
from aff_runtime.core.law import LawBuilder
from aff_runtime.core.laws.catalogue import LAWS
from aff_runtime.core.params import SiteParams
from aff_runtime.core.response import Response
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.fieldbus.modbus.registers import RegisterMap
from aff_runtime.loop.cycle import Cycle, CycleSettings
from aff_runtime.loop.messages import Arm, Message
from aff_runtime.loop.ports import Advice
from aff_runtime.safety.guard import Guard
from aff_runtime.safety.params import GuardParams
from sim_plant.line import open_line
from sim_plant.line.running.simulation import LineSimulation
from sim_plant.servers.faults import parse_fault
from sim_plant.servers.map_file import load_plc_map
from sim_plant.servers.plc import Plc
from tests.doubles.lockstep_plant import LockstepPlant
from tests.doubles.virtual_clock import VirtualClock
from tests.lockstep.known_response import LINE, ROOT, SPEED_M_S

SITE = ROOT / "config" / "euclid_blocks.yaml"
PLC_MAP = ROOT / "config" / "plc" / "gateway_block.yaml"
SEED = 7


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What a bench is made of; the defaults are the shipped files. ``seed`` : of the noise."""

    line: Path = LINE
    site: Path = SITE
    plc_map: Path = PLC_MAP
    line_speed_m_s: float = SPEED_M_S
    words: RegisterMap | None = None
    law: SiteParams | None = None
    soft_start_s: float = 0.2
    seed: int = SEED
    responses: Mapping[str, Response] = field(default_factory=dict)
    laws: Mapping[str, LawBuilder] = field(default_factory=lambda: LAWS)


@cache
def settled(line: Path, line_speed_m_s: float, seed: int = SEED) -> LineSimulation:
    """Return the line at rest; building the hull of its roll is the slow part of a test."""
    return open_line(line, seed=seed, speed_m_s=line_speed_m_s)


class Outside:
    """The other processes of the service, as lists."""

    def __init__(self, guard: Guard) -> None:
        self._guard = guard
        self.inbox: list[Message] = []
        self.events: list[str] = []
        self.faults: list[str] = []
        self.blocked_by = ""
        self.watchers: list[Callable[[Sequence[float]], None]] = []

    def publish(self, record: Sequence[float]) -> None:
        for watcher in self.watchers:
            watcher(record)

    def event(self, tick: int, t_ns: int, code: int) -> None:
        self.events.append(BY_CODE[code].name)

    def fault_text(self, text: str) -> None:
        self.faults.append(text)

    def blocked(self, reasons: tuple[str, ...]) -> None:
        self.blocked_by = "; ".join(reasons)

    def poll(self) -> Sequence[Message]:
        messages, self.inbox = self.inbox, []
        return messages

    def advise(self, law: Law) -> Advice:
        assert isinstance(law, Controller)
        objections = law.arming_objections().items()
        return Advice(objections=tuple(f"{name}: {t}" for name, all_ in objections for t in all_))

    def adopt(self, settings: object) -> None:
        assert isinstance(settings, GuardParams)
        self._guard.adopt(settings)

    def tick_done(self, first_exchange_ok: bool) -> None:
        pass


class Transport:
    """Lets the plant live up to the moment of the request; a timeout takes its time."""

    def __init__(self, clock: VirtualClock, plant: LockstepPlant) -> None:
        self._clock, self._plant = clock, plant
        self._lived_ns = clock.now_ns()

    def live(self) -> None:
        now_ns = self._clock.now_ns()
        self._plant.advance((now_ns - self._lived_ns) * 1e-9)
        self._lived_ns = now_ns

    def transact(self, write_words: list[int], deadline_ns: int) -> tuple[Outcome, list[int]]:
        self.live()
        outcome, words = self._plant.transact(write_words, deadline_ns)
        if outcome is Outcome.TIMEOUT:
            self._clock.sleep_until_ns(deadline_ns)
        return outcome, words

    def close(self) -> None:
        pass


class Bench:
    """One line, one PLC, one runtime; ``run`` turns the time."""

    def __init__(self, setup: Setup) -> None:
        site = load_site(setup.site)
        self.channels = len(site.gateway.read.channels)
        self.period_ns = round(site.cycle_s * 1e9)
        params = guard_params(site)
        soft = tuple(replace(a, soft_start_s=setup.soft_start_s) for a in params.actuators)
        self.params = replace(params, actuators=soft)
        line = deepcopy(settled(setup.line, setup.line_speed_m_s, setup.seed))
        self.clock = VirtualClock()
        self.wire = LockstepPlant(line, Plc(load_plc_map(setup.plc_map)))
        self.plant = self.wire.plant
        self._transport = Transport(self.clock, self.wire)
        self.guard = Guard(self.params)
        self.law = Controller(setup.law or site_params(site), setup.responses, laws=setup.laws)
        self.outside = Outside(self.guard)
        gateway = self._gateway(site, setup)
        self.heartbeat_modulus = gateway.heartbeat_modulus
        self.cycle = self._cycle(gateway)

    def _gateway(self, site: Site, setup: Setup) -> Gateway:
        words = setup.words or register_map(site)
        return WordGateway(self._transport, WordCodec(words), self.clock)

    def _cycle(self, gateway: Gateway) -> Cycle:
        return Cycle(
            settings=CycleSettings(
                period_ns=self.period_ns,
                io_budget_ns=3_000_000,
                fade_s=self.params.fade_s,
                channel_count=self.channels,
                output_count=len(self.params.actuators),
                law_columns=0,
            ),
            clock=self.clock,
            gateway=gateway,
            guard=self.guard,
            law=self.law,
            outside=self.outside,
        )

    # --- time -------------------------------------------------------------------------------

    def run(self, seconds: float) -> None:
        """Let runtime and plant live."""
        end_ns = self.clock.now_ns() + round(seconds * 1e9)
        while self.clock.now_ns() < end_ns - self.period_ns // 2 and self.cycle.tick():
            pass
        assert not self.outside.faults, self.outside.faults

    def run_plant_alone(self, seconds: float) -> None:
        """Let the plant live without a runtime: it was killed."""
        self.clock.advance_ns(round(seconds * 1e9))
        self._transport.live()

    # --- what people do ---------------------------------------------------------------------

    def say(self, message: Message) -> None:
        """Tell the runtime something, heard at its next tick."""
        self.outside.inbox.append(message)

    def arm(self, seconds: float) -> None:
        """Arm and let it work."""
        self.say(Arm())
        self.run(seconds)
        assert self.guard.state is State.ACTIVE, (self.guard.state, self.outside.blocked_by)

    def inject(self, spec: str) -> float:
        """Inject a fault; return its start in plant time, s."""
        return self.plant.faults.inject(parse_fault(spec)).start_s

    # --- what is seen at the plant ----------------------------------------------------------

    @property
    def now_s(self) -> float:
        """Plant time, s."""
        return self.plant.time_s

    @property
    def applied(self) -> list[tuple[float, tuple[float, ...]]]:
        """Time and applied corrections of every sample so far."""
        return self.plant.history(20_000)
