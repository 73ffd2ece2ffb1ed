"""The product's cycle, guard and wire, armed and at work on a PLC behind any Modbus wire."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.wires import gateway_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import ActuatorStep, Permission, Snapshot, State
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from aff_runtime.loop.cycle import Cycle, CycleSettings
from aff_runtime.loop.messages import Arm
from aff_runtime.loop.record import record_columns
from aff_runtime.safety.guard import Guard
from tests.aff_runtime.app.fake_plc import Plc
from tests.aff_runtime.loop.rig import Memory

SITE = Path(__file__).parents[3] / "config" / "euclid_blocks.yaml"
OUTPUTS = ("unwind_m_s", "swrap_follower_m_s")
ZERO_TICKS = 16  # of 20 ms: 300 ms and the tick before


def framed(plc: Plc, request: bytes) -> bytes:
    """Return the PLC's reply to an MBAP frame."""
    reply = plc.answer(request[7:])
    return request[:4] + (len(reply) + 1).to_bytes(2, "big") + request[6:7] + reply


class Hurried(MonotonicClock):
    """Real time, but nobody sleeps: the next tick comes at once."""

    def __init__(self) -> None:
        self._skipped_ns = 0

    def now_ns(self) -> int:
        return super().now_ns() + self._skipped_ns

    def sleep_until_ns(self, deadline_ns: int) -> None:
        self._skipped_ns += max(0, deadline_ns - self.now_ns())


class Steady:
    """A law that always asks for 0.01 m/s."""

    def step(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        return (ActuatorStep(value=0.01, peak_bound=0.01, slew_bound=0.1),) * 2

    def telemetry(self) -> tuple[float, ...]:
        return ()

    def telemetry_names(self) -> tuple[str, ...]:
        return ()


def site_on(wire: str, folder: Path, port: int) -> Site:
    """Return the shipped site on a wire, patient enough for a busy machine."""
    section = f"  {wire}: {{ host: 127.0.0.1, port: {port}, deadline_ms: 15 }}"
    text = re.sub(r"(?m)^  modbus_tcp:.*(\n    .*)*", section, SITE.read_text(), count=1)
    text = re.sub(r"stuck_after_s: [\d.]+", "stuck_after_s: 30", text)
    text = text.replace("cycle_ms: 5", "cycle_ms: 20", 1)
    text = text.replace("fault_after_ms: 80", "fault_after_ms: 140")
    text = text.replace("hold_after_ms: 15", "hold_after_ms: 60")
    path = folder / "site.yaml"
    path.write_text(text)
    return load_site(path)


class Runtime:
    """Cycle, guard and wire of a site, as fast as the PLC answers."""

    def __init__(self, site: Site, plc: Plc, clock: Clock | None = None) -> None:
        self.plc = plc
        params, channels = guard_params(site), tuple(site.gateway.read.channels)
        self._columns = record_columns(channels, OUTPUTS, ())
        soft = tuple(replace(a, soft_start_s=0.1) for a in params.actuators)
        clock = clock or Hurried()
        self.guard = Guard(replace(params, actuators=soft))
        self.gateway = gateway_of(site, {}, clock)
        self.outside = Memory(self.guard)
        settings = CycleSettings(
            period_ns=round(site.cycle_s * 1e9),
            io_budget_ns=round(site.gateway.deadline_ms * 1e6),
            fade_s=params.fade_s,
            channel_count=len(channels),
            output_count=len(OUTPUTS),
            law_columns=0,
        )
        self.cycle = Cycle(
            settings=settings,
            clock=clock,
            gateway=self.gateway,
            guard=self.guard,
            law=Steady(),
            outside=self.outside,
        )
        for _ in range(20):
            self.outside.inbox.append(Arm())
            self.run(25)
            if self.is_working:
                return
        pytest.fail(
            f"not at work: {self.guard.state} {self.outside.reasons} {self.gateway.troubles}"
        )

    @property
    def is_working(self) -> bool:
        return self.guard.state is State.ACTIVE and self.plc.words[3] == self.plc.words[8] == 1000

    def now(self, column: str) -> float:
        return self.outside.records[-1][self._columns.index(column)]

    @property
    def is_zero(self) -> bool:
        """Whether nothing goes out."""
        return not any(self.now(f"correction_{name}") for name in OUTPUTS)

    def run(self, ticks: int) -> None:
        for _ in range(ticks):
            self.cycle.tick()
        assert not self.outside.faults, self.outside.faults
