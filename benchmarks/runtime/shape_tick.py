"""A whole tick with the shape law on Modbus TCP over a bare FC23 by the same socket after it.

``python -m benchmarks.runtime.shape_tick SITE.yaml SECONDS`` is the runtime's end; prints JSON.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.app.wiring.assemble import assemble, cycle_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import WireError
from aff_runtime.base.python_child import module_command
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire
from aff_runtime.loop.realtime import RealtimeRequest, ask
from aff_runtime.loop.ticker import Ticker
from benchmarks.runtime.facts import FactRow, Section, quantiles_us, timing_row
from benchmarks.runtime.paced import PERIOD_NS, own_processor
from benchmarks.runtime.parts import respond
from benchmarks.runtime.whole_tick import COLUMNS, CONNECT_TICKS, Listener, beside_plant
from sim_plant.demo.wires import SITES

ROUNDS = 3
TARGET_P50, TARGET_P99 = 1.6, 1.8
ANSWER_S = 1.0


class Tap:
    """Notes which wire was connected and what was sent on it last."""

    def __init__(self) -> None:
        self.wire: TcpWire | None = None
        self.frame = b""
        send = TcpWire.send

        def noted(wire: TcpWire, frame: bytes) -> bool:
            self.wire, self.frame = wire, frame
            return send(wire, frame)

        setattr(TcpWire, "send", noted)  # noqa: B010 - a method of its class, on purpose


def bare_exchanges(tap: Tap, seconds: float) -> list[int]:
    """Send the last request again and again on the socket it went by; time of each, ns.

    Nothing is coded or judged: one send and one receive per period, on the runtime's own grid.
    """
    current = tap.wire.detach() if tap.wire is not None else None
    if current is None:
        raise WireError("the cycle ended without a connection: nothing to compare with")
    current.settimeout(ANSWER_S)
    clock = MonotonicClock()
    ticker = Ticker(clock, PERIOD_NS)
    found: list[int] = []
    ticker.start()
    for _ in range(round(seconds * 1e9 / PERIOD_NS)):
        ticker.wait()
        begun_ns = clock.now_ns()
        current.send(tap.frame)
        current.recv(1024)
        found.append(clock.now_ns() - begun_ns)
    current.close()
    return found


def runtime_end(site: Path, seconds: float) -> dict[str, Any]:
    """Run the cycle of a site, then bare exchanges, as long each; return ns per tick."""
    tap = Tap()
    assembly = assemble(load_parameters(site).checked(), MonotonicClock())
    listener = Listener(seconds)
    cycle = cycle_of(assembly, listener)
    ask(RealtimeRequest(cpus=(own_processor(),)))
    cycle.run()
    armed = [row for _, row in listener.rows if row[1] > 2 * CONNECT_TICKS]
    ticks = [round(row[COLUMNS["tick"]] * 1e3) for row in armed]
    bare = bare_exchanges(tap, seconds)
    assembly.gateway.close()
    return {"tick": ticks, "bare": bare}


def shape_tick(seconds: float) -> Section:
    """Measure both for ``seconds``, in turns of one after the other."""
    ticks: list[int] = []
    bare: list[int] = []
    for _ in range(ROUNDS):
        with tempfile.TemporaryDirectory() as name:
            respond(Path(name))
            ours = module_command("benchmarks.runtime.shape_tick")
            one = beside_plant("modbus", Path(name), ours, CONNECT_TICKS * 5e-3 + seconds / ROUNDS)
        ticks += one["tick"]
        bare += one["bare"]
    whole, alone = quantiles_us(ticks), quantiles_us(bare)
    return Section(
        title="Whole tick of the shape law over a bare FC23",
        note=f"config/{SITES['modbus']} with the response of the declared line; in each of "
        f"{ROUNDS} turns the cycle, then its last request again and again on the same socket, "
        "both on a grid of 5 ms.",
        rows=(
            timing_row("whole tick", ticks, "from wake-up to record"),
            timing_row("bare FC23", bare, "send and receive, nothing else"),
            ratio_row("ratio p50", whole[0], alone[0], TARGET_P50),
            ratio_row("ratio p99", whole[1], alone[1], TARGET_P99),
        ),
    )


def ratio_row(name: str, ours_us: float, theirs_us: float, target: float) -> FactRow:
    """Return a ratio beside what it shall be at most."""
    ratio = ours_us / theirs_us
    return FactRow(
        name=name,
        value=f"{ratio:.2f}",
        remark=f"target at most {target:g}: {'held' if ratio <= target else 'missed'}",
    )


if __name__ == "__main__":
    json.dump(runtime_end(Path(sys.argv[1]), float(sys.argv[2])), sys.stdout)
