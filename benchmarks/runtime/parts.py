"""Where the time of a tick goes: the shape law on Modbus TCP, part by part, at the seams.

``python -m benchmarks.runtime.parts SITE.yaml SECONDS`` is the runtime's end; prints JSON.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.app.wiring.assemble import assemble, cycle_of
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.order_columns import STATE
from aff_runtime.base.python_child import module_command
from aff_runtime.core.compiled.binary import COMPILED, NUMPY, VARIABLE, chosen
from aff_runtime.core.impulse import from_taps
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.loop import cycle as cycle_module
from aff_runtime.loop.realtime import RealtimeRequest, ask
from aff_runtime.loop.record import record_columns
from aff_runtime.safety.guard import Guard
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.ring import RingWriter
from benchmarks.control.nominal_loop import impulse_response
from benchmarks.runtime.facts import FactRow, Section, timing_row
from benchmarks.runtime.paced import PERIOD_NS, own_processor
from benchmarks.runtime.whole_tick import CONNECT_TICKS, Listener, beside_plant
from sim_plant.demo.wires import SITES

ROUNDS = 2
CYCLE_S, RADIUS_M, SIGNAL = PERIOD_NS * 1e-9, 0.16, "unwind_tension_N"
PARTS = WIRE, CODEC, GUARD, LAW, RECORD, RING = "wire", "codec", "guard", "law", "record", "ring"
SEAMS: tuple[tuple[Any, str, str], ...] = (
    (WordGateway, "exchange", WIRE),
    (WordCodec, "encode", CODEC),
    (WordCodec, "decode", CODEC),
    (WordCodec, "aff_echo", CODEC),
    (WordCodec, "applied", CODEC),
    (Guard, "observe", GUARD),
    (Guard, "limit", GUARD),
    (LawSlot, "step", LAW),
    (LawSlot, "law_telemetry", RECORD),
    (cycle_module, "build_record", RECORD),
)


class Stopwatch:
    """Adds up the time of every part in a tick, ns; a part inside another is taken out of it."""

    def __init__(self, now_ns: Callable[[], int]) -> None:
        self._now_ns = now_ns
        self._inside_ns = 0
        self.sums: dict[str, int] = {}

    def around(self, work: Callable[..., Any], part: str) -> Callable[..., Any]:
        """Return the same work with its time told to ``part``."""

        def timed(*given: Any, **named: Any) -> Any:
            before_ns, self._inside_ns = self._inside_ns, 0
            begun_ns = self._now_ns()
            try:
                return work(*given, **named)
            finally:
                took_ns = self._now_ns() - begun_ns
                self.sums[part] = self.sums.get(part, 0) + took_ns - self._inside_ns
                self._inside_ns = before_ns + took_ns

        return timed

    def take(self) -> dict[str, int]:
        """Return the sums of a tick and begin the next one."""
        found, self.sums = self.sums, {}
        return found


class Watcher(Listener):
    """Keeps the time of every part, and writes records to a ring as the service does."""

    def __init__(self, seconds: float, watch: Stopwatch, law: LawSlot, ring: RingWriter) -> None:
        super().__init__(seconds)
        self._watch, self._law = watch, law
        self._write = watch.around(ring.write, RING)
        names = law.law_telemetry_names()
        self._state = next(i for i, name in enumerate(names) if name.endswith(f".{STATE}"))
        self.parts: list[dict[str, int]] = []
        self.learned = 0

    def publish(self, record: Sequence[float]) -> None:
        """Write the record, then take the times of this tick."""
        law_values = self._law.law_telemetry()
        self._write((*record, *law_values))
        super().publish(record)
        found = self._watch.take()
        if record[1] > 2 * CONNECT_TICKS:  # armed for a while
            self.parts.append(found)
            self.learned += law_values[self._state] not in (OrderState.IDLE, OrderState.FROZEN)


def runtime_end(site: Path, seconds: float) -> dict[str, Any]:
    """Run the cycle of a site; return the time of every part per tick, ns."""
    clock = MonotonicClock()
    watch = Stopwatch(clock.now_ns)
    for owner, name, part in SEAMS:
        setattr(owner, name, watch.around(getattr(owner, name), part))
    assembly = assemble(load_parameters(site).checked(), clock)
    outputs = [f"{name}_m_s" for name in assembly.site.actuators]
    columns = record_columns(tuple(assembly.site.gateway.read.channels), outputs, ())
    ring = RingWriter((*columns, *assembly.law.law_telemetry_names()), meta=RunMeta())
    watcher = Watcher(seconds, watch, assembly.law, ring)
    cycle = cycle_of(assembly, watcher)
    ask(RealtimeRequest(cpus=(own_processor(),)))
    cycle.run()
    assembly.gateway.close()
    ring.close()
    rows = watcher.parts
    times = {part: [row.get(part, 0) for row in rows] for part in PARTS}
    return {**times, "learning": watcher.learned / max(1, len(rows))}


def respond(folder: Path) -> None:
    """Write the response of the declared line: without one no order is learned."""
    taps = impulse_response(
        "Tyvek", RADIUS_M, drive="unwind", channel=SIGNAL, cycle_s=CYCLE_S, memory_s=4.0
    )
    loop = from_taps((RADIUS_M,), [taps])
    frequency_Hz = np.geomspace(0.1, 20.0, 60)
    found = [loop.response(float(f), CYCLE_S, RADIUS_M) for f in frequency_Hz]
    phase_rad = np.unwrap(np.angle(found))
    points = [
        ResponsePoint(
            frequency_Hz=float(f),
            gain=abs(p),
            phase_rad=float(angle),
            relative_error=0.02,
            coherence=0.99,
        )
        for f, p, angle in zip(frequency_Hz, found, phase_rad, strict=True)
    ]
    provenance = Provenance(actuator="unwind", signal=SIGNAL)
    text = Response(points=points, delay_s=0.0, provenance=provenance).to_json()
    (folder / "learned").mkdir()
    (folder / "learned" / "euclid_unwind.json").write_text(text, encoding="utf-8")


def parts(seconds: float) -> Section:
    """Measure with the law by numpy and by the binary, in turns; ``seconds`` each."""
    ways = (NUMPY, COMPILED) if chosen() is not None else (NUMPY,)
    found: dict[tuple[str, str], list[int]] = {}
    shares: dict[str, list[float]] = {}
    for _ in range(ROUNDS):
        for way in ways:
            one = one_round(way, seconds / ROUNDS)
            shares.setdefault(way, []).append(one.pop("learning"))
            for part, ns in one.items():
                found.setdefault((way, part), []).extend(ns)
    learning = ", ".join(f"{min(each):.0%} by {way}" for way, each in shares.items())
    return Section(
        title="Parts of a tick, shape law on Modbus TCP",
        note=f"config/{SITES['modbus']} with the response of the declared line, {seconds:g} s "
        f"each in {ROUNDS} turns; ticks in which it learned: {learning}. The watch itself costs "
        "one to two us per part. All: the sum.",
        rows=table(found),
    )


def one_round(way: str, seconds: float) -> dict[str, Any]:
    """Measure one way once."""
    with tempfile.TemporaryDirectory() as name:
        respond(Path(name))
        ours = module_command("benchmarks.runtime.parts")
        return beside_plant("modbus", Path(name), ours, seconds, **{VARIABLE: way})


def table(found: Mapping[tuple[str, str], Sequence[int]]) -> tuple[FactRow, ...]:
    """Return a row per part and way, then the sums, ns by way and part."""
    rows = [timing_row(f"{part}, by {way}", ns) for (way, part), ns in found.items()]
    for way in dict.fromkeys(way for way, _ in found):
        sums = np.sum([ns for (each, _), ns in found.items() if each == way], axis=0)
        rows.append(timing_row(f"all, by {way}", sums))
    return tuple(rows)


if __name__ == "__main__":
    json.dump(runtime_end(Path(sys.argv[1]), float(sys.argv[2])), sys.stdout)
