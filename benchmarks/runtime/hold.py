"""Hold a cycle of 1 ms on loopback and count late ticks: film line, Modbus TCP, two processes.

``python -m benchmarks.runtime.hold --minutes 10``; status 1 where more than the target were late.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.app.wiring.assemble import assemble, cycle_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.python_child import module_command
from aff_runtime.base.signals import Outcome, State
from aff_runtime.loop.realtime import RealtimeRequest, ask
from benchmarks.runtime.facts import FactRow, Section, machine, timing_row
from benchmarks.runtime.paced import own_processor
from benchmarks.runtime.page import text
from benchmarks.runtime.whole_tick import COLUMNS, CONNECT_TICKS, Listener, beside_plant
from sim_plant.demo.wires import FILM_SITES

PERIOD_NS = 1_000_000
MISSED = -1
TARGET_SHARE = 1e-3


class Keeper(Listener):
    """Keeps three numbers of a tick, not its record: ten minutes are 600 000 of them."""

    def __init__(self, seconds: float) -> None:
        super().__init__(seconds, PERIOD_NS)
        self.wake_us, self.tick_us = array("d"), array("d")
        self.good = self.active = 0
        self._skipped_before = 0.0

    def publish(self, record: Sequence[float]) -> None:
        """Keep what tells a late tick, once the wire is warm."""
        self.record = record
        if record[1] <= CONNECT_TICKS:
            self._skipped_before = record[MISSED]
            return
        self.wake_us.append(record[COLUMNS["wake"]])
        self.tick_us.append(record[COLUMNS["tick"]])
        self.good += record[COLUMNS["outcome"]] == Outcome.OK
        self.active += record[COLUMNS["state"]] == State.ACTIVE

    @property
    def skipped(self) -> int:
        """Grid points that no tick began on."""
        return round(self.record[MISSED] - self._skipped_before)


def late_ticks(wake_us: Sequence[float], tick_us: Sequence[float], period_us: float) -> int:
    """Return how many ticks did not end before the next grid point."""
    return int(np.sum(np.add(wake_us, tick_us) > period_us))


def runtime_end(site: Path, seconds: float) -> dict[str, Any]:
    """Run the cycle of ``site``; return its times per tick and how many were late."""
    record = load_parameters(site).checked()
    assembly = assemble(record, MonotonicClock())
    keeper = Keeper(seconds)
    cycle = cycle_of(assembly, keeper)
    rights = ask(RealtimeRequest(cpus=(own_processor(),)))
    cycle.run()
    assembly.gateway.close()
    return {
        "ticks": len(keeper.tick_us),
        "late": late_ticks(keeper.wake_us, keeper.tick_us, PERIOD_NS * 1e-3),
        "skipped": keeper.skipped,
        "good": keeper.good,
        "active": keeper.active,
        "wake_us": keeper.wake_us.tolist(),
        "tick_us": keeper.tick_us.tolist(),
        "refused": [line for line in rights.lines() if "refused" in line],
    }


def held(seconds: float) -> dict[str, Any]:
    """Run both ends; return what the runtime's end found, with ``share`` late or skipped."""
    with tempfile.TemporaryDirectory() as name:
        ours = (*module_command("benchmarks.runtime.hold"), "--end")
        found = beside_plant(
            "modbus", Path(name), ours, seconds, site=FILM_SITES["modbus"], line="film_ripple"
        )
    due = found["ticks"] + found["skipped"]
    return {**found, "share": (found["late"] + found["skipped"]) / due, "due": due}


def section(found: dict[str, Any], minutes: float) -> Section:
    """Return the result as a table."""
    share = found["share"]
    verdict = "held" if share <= TARGET_SHARE else "missed"
    refused = "; ".join(found["refused"]) or "all rights granted"
    return Section(
        title="A cycle of 1 ms on loopback",
        note=f"config/{FILM_SITES['modbus']} for {minutes:g} min, plant and runtime as two "
        "processes; the law has no response and adapts nothing.",
        rows=(
            FactRow(
                name="late ticks",
                value=f"{share:.3%}",
                remark=f"target at most {TARGET_SHARE:.1%}: {verdict}",
            ),
            FactRow(
                name="ticks",
                value=f"{found['late']} ended late, {found['skipped']} skipped, of {found['due']}",
                remark=f"{found['good']} with a good reply, {found['active']} active",
            ),
            timing_row("wake-up", [round(us * 1e3) for us in found["wake_us"]], refused),
            timing_row("whole tick", [round(us * 1e3) for us in found["tick_us"]]),
        ),
    )


def main() -> int:
    """Hold the cycle, print the table, write JSON where asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.runtime.hold")
    parser.add_argument("--minutes", type=float, default=10.0, help="how long (default 10)")
    parser.add_argument("--json", type=Path, help="write what was found, without single ticks")
    parser.add_argument("--end", nargs=2, metavar=("SITE", "SECONDS"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.end:
        json.dump(runtime_end(Path(options.end[0]), float(options.end[1])), sys.stdout)
        return 0
    before = machine()
    found = held(60.0 * options.minutes)
    print(text([before, section(found, options.minutes)]))
    if options.json:
        kept = {k: v for k, v in found.items() if k not in {"wake_us", "tick_us"}}
        options.json.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    return 0 if found["share"] <= TARGET_SHARE else 1


if __name__ == "__main__":
    sys.exit(main())
