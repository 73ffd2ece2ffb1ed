"""Puts a line, its PLC, the wire, the clock and the control socket together and runs them."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from aff_runtime.base.errors import WireError
from aff_runtime.base.numbers import finite_or_none
from aff_runtime.base.signals import StateBits, Status
from sim_plant.base.ports import SteppedLine
from sim_plant.servers.answers import Counts, PlantStatus, WebReport
from sim_plant.servers.control import ControlSocket
from sim_plant.servers.faults import FaultBoard, FaultEdge, FaultSpec
from sim_plant.servers.later import Later, PlantTimers, in_real_time
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.modbus_server import ModbusServer
from sim_plant.servers.modbus_udp import ModbusUdpServer
from sim_plant.servers.plant import Plant
from sim_plant.servers.plc import Plc
from sim_plant.servers.plc_code import CodePlc
from sim_plant.servers.plc_map import PlcMap
from sim_plant.servers.realtime import (
    RealTimeStepper,
    ask_for_realtime,
    shorten_garbage_collections,
)
from sim_plant.servers.recorder import PlantRecorder
from sim_plant.servers.stepped import SteppedClock
from sim_plant.servers.web_end import WebState
from sim_plant.servers.wire_faults import WireFaults


@dataclass(frozen=True, slots=True, kw_only=True)
class ServeOptions:
    """How to serve a plant.

    Attributes
    ----------
    host, port : where the Modbus server listens.
    udp : on UDP instead of TCP.
    can : ``dbc`` for a CAN bus instead of Modbus; empty for Modbus.
    can_interface, can_channel : ``frame_socket``, ``slcan_pty`` and a path, or python-can's.
    can_map : the PLC's signals on that bus.
    plc_code : the user's library in the place of the simulated PLC's program.
    faults : faults scheduled in plant time.
    allow_fc23 : False imitates a device without function 23.
    record, control : paths of the record and of the control socket, if wanted.
    duration_s : real time after which to stop; None runs until a signal.
    realtime : ask for real-time rights; with ``plc_code`` they are not asked for.
    stepped : time stands but for the command ``step``; faults and clients are timed by it.
    """

    host: str = "127.0.0.1"
    port: int = 5020
    udp: bool = False
    can: str = ""
    can_interface: str = "frame_socket"
    can_channel: str = ""
    can_map: Path = Path()
    plc_code: Path | None = None
    faults: tuple[FaultSpec, ...] = ()
    allow_fc23: bool = True
    record: Path | None = None
    control: Path | None = None
    duration_s: float | None = None
    realtime: bool = True
    stepped: bool = False
    max_connections: int = 4
    idle_timeout_s: float = 60.0


class PlantWire(Protocol):
    """What a plant is served on."""

    wire_faults: WireFaults
    trouble: str
    """Why it is not served though no fault forbids it; else empty."""

    @property
    def address(self) -> str:
        """What the ready line says."""
        ...

    async def open(self) -> None:
        """Begin to serve."""
        ...

    async def close(self) -> None:
        """End."""
        ...

    def take_edge(self, edge: FaultEdge) -> None:
        """Follow a fault that begins or ends."""
        ...

    async def settled(self) -> None:
        """Wait until what an edge began on the wire is done."""
        ...

    def counts(self) -> dict[str, int]:
        """Return what the status shows of the wire."""
        ...


def _wire(plant: Plant, options: ServeOptions) -> PlantWire:
    later: Later = PlantTimers(plant).later if options.stepped else in_real_time
    if options.can:
        from sim_plant.servers.can_catalogue import can_server  # noqa: PLC0415 (needs the can extra)

        return can_server(
            plant, options.can, options.can_map, options.can_interface, options.can_channel, later
        )
    device = ModbusDevice(plant.registers, allow_fc23=options.allow_fc23)
    if options.udp:
        return ModbusUdpServer(
            device, plant.faults, host=options.host, port=options.port, later=later
        )
    return ModbusServer(
        device,
        plant.faults,
        host=options.host,
        port=options.port,
        max_connections=options.max_connections,
        idle_timeout_s=options.idle_timeout_s,
        later=later,
    )


class PlantService:
    """One plant being served; ``run`` is its whole life.

    Raises
    ------
    PlantError
        A fault of the options would change nothing on this wire, or the PLC's code is none.
    """

    def __init__(self, line: SteppedLine, plc_map: PlcMap, options: ServeOptions) -> None:
        self._options = options
        code = options.plc_code
        plc = Plc(plc_map) if code is None else CodePlc(plc_map, code)
        self.plant = Plant(line, plc, FaultBoard(options.faults))
        self.server = _wire(self.plant, options)
        for spec in options.faults:
            self.server.wire_faults.check(spec, plc_map)
        self.plant.wire_faults = self.server.wire_faults
        self.stepper = self._clock()
        self.plant.edge_observers.append(self.server.take_edge)
        self._scheduler = "not asked"
        self._stop = asyncio.Event()

    def _clock(self) -> RealTimeStepper | SteppedClock:
        if self._options.stepped:
            return SteppedClock(self.plant.step, self.server.settled)
        return RealTimeStepper(self.plant.step, self.plant.sample_time_s)

    async def in_force(self) -> None:
        """Return when the PLC's next scan is over and the wire has followed it.

        Raises
        ------
        WireError
            The wire should be served again and cannot.
        """
        scans = self.plant.plc_scans
        while self.plant.plc_scans == scans:
            await self.stepper.next_sample()
        await self.server.settled()
        self._check_wire()

    async def step(self, samples: int) -> None:
        """Take ``samples`` samples of a stepped plant; see ``SteppedClock.advance``.

        Raises
        ------
        AffError
            They were not taken, or the wire should be served again and cannot.
        """
        await self.stepper.advance(samples)
        self._check_wire()

    def _check_wire(self) -> None:
        if self.server.trouble:
            raise WireError(f"{self.server.trouble}; it is tried again and again")

    def stop(self) -> None:
        """Ask ``run`` to return."""
        self._stop.set()

    async def run(self, announce: Callable[[str], None]) -> None:
        """Serve until stopped; ``announce`` gets the ready line and what the web's end does.

        Raises
        ------
        AffError
            An address, a path or the line cannot be used.
        """
        options = self._options
        recorder = PlantRecorder(options.record, self.plant) if options.record else None
        control = (
            ControlSocket(options.control, self.plant, self.status, self)
            if options.control
            else None
        )
        try:
            if recorder:
                self.plant.observers.append(recorder.take)
            await self.server.open()
            if control:
                await control.open()
            if options.stepped:
                self._scheduler = "stepped"
            elif options.realtime:
                if options.plc_code is None:  # a scan of it that hangs would keep the core
                    self._scheduler = "granted" if ask_for_realtime() else "refused"
                shorten_garbage_collections()
            self.plant.web.observers.append(lambda state: announce(self._web_says(state)))
            failure = self.stepper.start()
            announce(
                f"ready {self.server.address} "
                f"sample_time_s {self.plant.sample_time_s:g} realtime {self._scheduler}"
            )
            if self.plant.web.at_end:
                announce(self._web_says(self.plant.web.state))
            await self._until_stopped(failure)
        finally:
            self.stepper.stop()
            await self.server.close()
            if control:
                await control.close()
            if recorder:
                recorder.close()

    async def _until_stopped(self, failure: asyncio.Future[None]) -> None:
        stopped = asyncio.ensure_future(self._stop.wait())
        ends: set[asyncio.Future[Any]] = {stopped, failure}
        done, _ = await asyncio.wait(
            ends, timeout=self._options.duration_s, return_when=asyncio.FIRST_COMPLETED
        )
        stopped.cancel()
        if failure in done:
            failure.result()

    def _web_says(self, state: WebState) -> str:
        """Return what the log says of a new state of the web's end."""
        left_m = self.plant.web.left_m or 0.0
        return {
            WebState.STOPS: f"web at its end: {left_m:.1f} m left on the unwind roll; "
            f"the line stops and LINE_RUN is off. {self._how_to_go_on()}",
            WebState.STANDS: f"line stands, {left_m:.1f} m left. {self._how_to_go_on()}",
            WebState.STARTS: "full rolls are on: the line starts again, LINE_RUN as before",
            WebState.RUNS: f"line runs again, {left_m:.1f} m on the unwind roll",
        }[state]

    def _how_to_go_on(self) -> str:
        if not self.plant.takes_rolls:
            return "To go on, start sim-plant serve again."
        if self._options.control is None:
            return (
                "To go on, start sim-plant serve again; with --control PATH "
                "`sim-plant tell PATH roll` puts full rolls on."
            )
        return (
            f"To go on: `sim-plant tell {self._options.control} roll` (full rolls, the line "
            "starts again), or start sim-plant serve again."
        )

    def _web(self) -> WebReport:
        web = self.plant.web
        say = self._web_says(web.state) if web.at_end else ""
        return WebReport(left_m=web.left_m, state=web.state.value, say=say)

    def status(self) -> PlantStatus:
        """Return what the plant does now."""
        plant, registers, plc_map = self.plant, self.plant.registers, self.plant.plc.map
        words = {name: plc_map.write_word(registers.write_words, name) for name in plc_map.write}
        values = {n: finite_or_none(v) for n, v in plant.measured.items()}
        true_values = {n: v for n, v in values.items() if n.startswith("true_")}
        return PlantStatus(
            time_s=plant.time_s,
            applied_m_s=dict(plant.applied_m_s),
            max_abs_applied_m_s=dict(plant.max_abs_applied_m_s),
            counts_now=not plant.refusal,
            refusal=plant.refusal,
            true_tension_N={n: v for n, v in true_values.items() if n.endswith("tension_N")},
            measured={n: v for n, v in values.items() if n not in true_values},
            status=_bit_names(plant.plc.status),
            roll_id=plant.plc.roll_id,
            web=self._web(),
            aff=words,
            aff_bits=_bit_names(StateBits(words["state"] & 0xFF)),
            faults=plant.faults.names(),
            counts=self._counts(),
            realtime=self._scheduler,
        )

    def _counts(self) -> Counts:
        registers = self.plant.registers
        return Counts(
            scans=self.plant.scans,
            late_samples=self.stepper.late_samples,
            skipped_samples=self.stepper.skipped_samples,
            watchdog_trips=self.plant.plc.trips,
            reads=registers.reads,
            writes=registers.writes,
            foreign_reads=registers.foreign_reads,
            foreign_writes=registers.foreign_writes,
            wire=self.server.counts(),
        )


def _bit_names(bits: Status | StateBits) -> list[str]:
    return [bit.name for bit in bits if bit.name]


def serve(
    line: SteppedLine, plc_map: PlcMap, options: ServeOptions, announce: Callable[[str], None]
) -> None:
    """Serve until SIGTERM, SIGINT or the duration; see ``PlantService.run``."""

    async def main() -> None:
        service = PlantService(line, plc_map, options)
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, service.stop)
        await service.run(announce)

    asyncio.run(main())
