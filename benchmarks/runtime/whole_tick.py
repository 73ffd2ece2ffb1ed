"""The whole tick over loopback TCP against the plant's server: both ends are real.

``python -m benchmarks.runtime.whole_tick PORT SECONDS`` is the runtime's end and prints JSON.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from aff_runtime.app.assemble import assemble, cycle_of
from aff_runtime.app.validation import load_record
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.ports import Law
from aff_runtime.base.signals import Outcome, State
from aff_runtime.loop.messages import Arm, Message, Stop
from aff_runtime.loop.realtime import RealtimeRequest, ask
from aff_runtime.loop.seams import Advice
from benchmarks.runtime.facts import Row, Section, timing_row
from benchmarks.runtime.paced import PERIOD_NS, own_processor
from sim_plant.demo.processes import PLANT, Child
from sim_plant.demo.wires import free_port

CONFIG = Path(__file__).resolve().parents[2] / "config"
CONNECT_TICKS = 200
NAMES = ("io", "tick", "wake")


class Listener:
    """The outside of the cycle: arms once the wire is up, keeps times, stops in the end."""

    def __init__(self, seconds: float) -> None:
        self._last = CONNECT_TICKS + round(seconds * 1e9 / PERIOD_NS)
        self.record: Sequence[float] = ()
        self.rows: list[Sequence[float]] = []

    def publish(self, record: Sequence[float]) -> None:
        """Keep a record once the wire is warm."""
        self.record = record
        if record[1] > CONNECT_TICKS:
            self.rows.append(record)

    def poll(self) -> Sequence[Message]:
        """Arm once, stop at the end."""
        tick = self.record[1] if self.record else 0
        if tick == CONNECT_TICKS:
            return (Arm(),)
        return (Stop(),) if tick == self._last else ()

    def advise(self, law: Law) -> Advice:
        """Object to nothing: a law without a response adapts nothing."""
        return Advice()

    def event(self, tick: int, t_ns: int, code: int) -> None:
        """Ignore events."""

    def fault_text(self, text: str) -> None:
        """Show what went wrong inside a tick."""
        print(text, file=sys.stderr)

    def blocked(self, text: str) -> None:
        """Ignore what stands against arming."""

    def adopt(self, guard_params: object) -> None:
        """Ignore new settings; there are none."""

    def tick_done(self, first_exchange_ok: bool) -> None:
        """Feed no watchdog."""


def runtime_end(port: int, seconds: float) -> dict[str, Any]:
    """Run the shipped site's cycle against ``port`` and return its times, ns."""
    record = load_record(CONFIG / "euclid_blocks.yaml").record or {}
    record["site"]["gateway"]["modbus_tcp"]["port"] = port
    assembly = assemble(record, MonotonicClock())
    listener = Listener(seconds)
    cycle = cycle_of(assembly, listener)
    ask(RealtimeRequest(cpus=(own_processor(),)))
    cycle.run()
    assembly.gateway.close()
    columns = {"state": 3, "outcome": 6, "wake": -4, "io": -3, "tick": -2}
    rows = listener.rows
    times = {name: [round(row[columns[name]] * 1e3) for row in rows] for name in NAMES}
    good = sum(row[columns["outcome"]] == Outcome.OK for row in rows)
    active = sum(row[columns["state"]] == State.ACTIVE for row in rows)
    return {**times, "ticks": len(rows), "good": good, "active": active}


def whole_tick(seconds: float) -> Section:
    """Measure for ``seconds`` with the plant served in a process of its own."""
    port = free_port()
    with tempfile.TemporaryDirectory() as folder:
        line = str(CONFIG / "lines" / "euclid_ripple.yaml")
        command = [*PLANT, "serve", line, "--modbus", f"127.0.0.1:{port}"]
        with Child("plant", command, Path(folder) / "plant.log", ready="ready"):
            found = json.loads(
                subprocess.run(
                    [sys.executable, "-m", __name__, str(port), str(seconds)],
                    check=True,
                    stdout=subprocess.PIPE,
                    text=True,
                ).stdout
            )
    ticks = f"{found['good']} of {found['ticks']} answered in time, {found['active']} active"
    return Section(
        title="Whole tick over loopback TCP",
        note=f"Plant and runtime as two processes, config/euclid_blocks.yaml, {seconds:g} s; "
        "no measured response, so the blocks follow their angles and adapt nothing.",
        rows=(
            timing_row("wire, one FC23", found["io"]),
            timing_row("whole tick", found["tick"]),
            timing_row("wake-up", found["wake"]),
            Row(name="ticks", value=ticks),
        ),
    )


if __name__ == "__main__":
    json.dump(runtime_end(int(sys.argv[1]), float(sys.argv[2])), sys.stdout)
