"""The whole tick on each wire against the plant's server: both ends are real processes.

``python -m benchmarks.runtime.whole_tick SITE.yaml SECONDS`` is the runtime's end; prints JSON.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.app.wiring.assemble import assemble, cycle_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.ports import Law
from aff_runtime.base.python_child import module_command
from aff_runtime.base.signals import Outcome, State
from aff_runtime.loop.messages import Arm, Message, Stop
from aff_runtime.loop.ports import Advice
from aff_runtime.loop.realtime import RealtimeRequest, ask
from benchmarks.runtime.child import environment
from benchmarks.runtime.facts import FactRow, Section, quantiles_us, timing_row
from benchmarks.runtime.paced import PERIOD_NS, own_processor
from sim_plant.demo.processes import Child
from sim_plant.demo.wires import SITES, wire_up

CONFIG = Path(__file__).resolve().parents[2] / "config"
CONNECT_TICKS = 400
ROUNDS = 3
STAMPS = "stamps.json"
WIRES = {"modbus": "Modbus TCP, one FC23", "can": "CAN by DBC", "canopen": "CANopen 402"}
COLUMNS = {"state": 3, "outcome": 6, "heartbeat": 9, "wake": -4, "io": -3, "tick": -2}


class Listener:
    """The outside of the cycle: arms once the wire is up, keeps times, stops in the end."""

    def __init__(self, seconds: float, period_ns: int = PERIOD_NS) -> None:
        self._clock = MonotonicClock()
        self._last = CONNECT_TICKS + round(seconds * 1e9 / period_ns)
        self.record: Sequence[float] = ()
        self.rows: list[tuple[int, Sequence[float]]] = []

    def publish(self, record: Sequence[float]) -> None:
        """Keep a record, and when the correction stood, once the wire is warm."""
        self.record = record
        if record[1] > CONNECT_TICKS:
            self.rows.append((self._clock.now_ns(), record))

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

    def blocked(self, reasons: tuple[str, ...]) -> None:
        """Ignore what stands against arming."""

    def adopt(self, guard_params: object) -> None:
        """Ignore new settings; there are none."""

    def tick_done(self, first_exchange_ok: bool) -> None:
        """Feed no watchdog."""


def runtime_end(site: Path, seconds: float) -> dict[str, Any]:
    """Run the cycle of ``site``; return its times per tick, ns, and what it used when."""
    record = load_parameters(site).checked()
    assembly = assemble(record, MonotonicClock())
    listener = Listener(seconds)
    cycle = cycle_of(assembly, listener)
    ask(RealtimeRequest(cpus=(own_processor(),)))
    cycle.run()
    assembly.gateway.close()
    rows = listener.rows
    times = {
        name: [round(row[COLUMNS[name]] * 1e3) for _, row in rows]
        for name in ("wake", "io", "tick")
    }
    good = [(at_ns, row) for at_ns, row in rows if row[COLUMNS["outcome"]] == Outcome.OK]
    return {
        **times,
        "used": [(at_ns, int(row[COLUMNS["heartbeat"]])) for at_ns, row in good],
        "ticks": len(rows),
        "good": len(good),
        "active": sum(row[COLUMNS["state"]] == State.ACTIVE for _, row in rows),
    }


def one_round(wire: str, seconds: float) -> dict[str, Any]:
    """Measure one wire once; adds the age of the data in each good tick, ns."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found = beside_plant(
            wire, folder, module_command("benchmarks.runtime.whole_tick"), seconds
        )
        made_ns = {int(k): int(v) for k, v in json.loads((folder / STAMPS).read_text()).items()}
    found["age"] = [at_ns - made_ns[beat] for at_ns, beat in found.pop("used")]
    return found


def beside_plant(
    wire: str,
    folder: Path,
    ours: Sequence[str],
    seconds: float,
    *,
    site: str | None = None,
    line: str = "euclid_ripple",
    **more: str,
) -> dict[str, Any]:
    """Run a runtime's end against the plant's server; return what it printed.

    Parameters
    ----------
    folder : gets the site file, and what the plant writes.
    ours : command of that end; gets the site file and ``seconds``.
    site, line : names in ``config`` and ``config/lines``; the wire's shipped site without.
    more : in its environment.
    """
    wired = wire_up(wire, CONFIG / (site or SITES[wire]), folder)
    command = [
        *(*module_command("benchmarks.runtime.stamped_plant"), str(folder / STAMPS)),
        *(str(CONFIG / "lines" / f"{line}.yaml"), *wired.plant_arguments),
    ]
    env = environment()
    with Child("plant", command, folder / "plant.log", ready="ready", environment=env):
        done = subprocess.run(
            [*ours, str(wired.site), str(seconds)],
            check=True,
            stdout=subprocess.PIPE,
            text=True,
            env={**env, **more},
        )
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def whole_tick(seconds: float) -> list[Section]:
    """Measure every wire for ``seconds``, in turns, so that a busy minute meets them all."""
    found: dict[str, dict[str, Any]] = {}
    for _ in range(ROUNDS):
        for wire in WIRES:
            one = one_round(wire, seconds / ROUNDS)
            sums = found.setdefault(wire, {})
            for name, value in one.items():
                sums[name] = sums[name] + value if name in sums else value
    modbus_us = quantiles_us(found["modbus"]["tick"])[1]
    sections = []
    for wire, title in WIRES.items():
        one = found[wire]
        ratio = quantiles_us(one["tick"])[1] / modbus_us
        ticks = f"{one['good']} of {one['ticks']} with a new set, {one['active']} active"
        sections.append(
            Section(
                title=f"Whole tick on {title}",
                note=f"config/{SITES[wire]}, plant and runtime as two processes, {ROUNDS} turns "
                f"of {seconds / ROUNDS:.3g} s with the other wires in between.",
                rows=(
                    timing_row("wire", one["io"], "send the last command, take what is there"),
                    timing_row("whole tick", one["tick"], "from wake-up to record"),
                    timing_row("wake-up", one["wake"]),
                    timing_row("age of the data", one["age"], "PLC's scan to correction"),
                    FactRow(name="ticks", value=ticks),
                    FactRow(name="p99 to Modbus", value=f"{ratio:.2f}", remark="whole tick"),
                ),
            )
        )
    return sections


if __name__ == "__main__":
    json.dump(runtime_end(Path(sys.argv[1]), float(sys.argv[2])), sys.stdout)
