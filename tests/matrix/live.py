"""``python -m tests.matrix.live [WIRE ...]``: the cells that need real processes.

Kills, stops, a full disk, rubbish in the site file and a stepped clock, in every state; and every
fault of the wire's table once more over the real transport, while a correction is at work.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path

from aff_runtime.base.errors import AffError
from tests.hil.live_line import LiveLine
from tests.matrix.bench import WIRES
from tests.matrix.cells import TABLE
from tests.matrix.deeds import DEEDS, Deed
from tests.matrix.disk import small_disk
from tests.matrix.live_judge import Seen, stays_at_zero, strike
from tests.processes import pause, until

SHIM = Path(__file__).with_name("stepped_clock.c")
STEPS = (("clock stepped an hour ahead", 3600), ("clock stepped an hour back", -3600))
STATES = ("FAULT", "PROBING", "SOFT_START", "ACTIVE", "FADING", "BYPASS")
ATTEMPTS = 3
_CLOSED = ("FAULT", "BYPASS")


def reach(line: LiveLine, state: str) -> None:
    """Bring the line into a state by what an operator or the PLC can do."""
    line.at_plant("set LINE_RUN 1")
    if state == "PROBING":
        _probe(line)
        return
    line.ensure_active()
    if state == "FAULT":
        line.at_plant("fault freeze:0.3")
        until("FAULT", lambda: line.state == "FAULT")
        pause(0.4)
    elif state in ("BYPASS", "SOFT_START"):
        line.ask("bypass")
        until("BYPASS", lambda: line.state == "BYPASS")
        pause(0.5)
        if state == "SOFT_START":
            line.arm()
    elif state == "FADING":
        line.at_plant("set LINE_RUN 0")


def _probe(line: LiveLine) -> None:
    """Start a probe and wait until it moves the line; ask again where the machine was too busy."""
    line.ensure_active()
    line.ask("bypass")
    pause(0.5)
    said: list[str] = []

    def ask() -> None:
        try:
            line.ask("probe", actuators=["unwind"])
        except (AffError, OSError) as error:
            said.append(str(error))

    def moves_or_ended(asking: threading.Thread) -> bool:
        rows = line.history(20)
        moves = bool(line.status().get("probing")) and any(any(v) for _, v in rows)
        return moves or not asking.is_alive()

    for _ in range(ATTEMPTS):
        asking = threading.Thread(target=ask, daemon=True)
        asking.start()
        until("the probe moves the line or ends", partial(moves_or_ended, asking))
        if asking.is_alive():
            return
    raise AssertionError(f"the probe never moved the line: {said}")


def wanted(reaction: str, state: str) -> str:
    """Return what the plant must show, given where the guard was."""
    if reaction == "zero" or state in _CLOSED:
        return "zero"
    return "fade" if state == "FADING" and reaction == "ride" else reaction


def cell(line: LiveLine, deed: Deed, state: str) -> Seen:
    """Do one cell, again where the machine paused meanwhile."""
    for attempt in range(ATTEMPTS):
        reach(line, state)
        line.at_plant("reset")
        seen = strike(line, deed.name, wanted(deed.reaction, state), deed.do)
        deed.undo(line)
        if not seen.wrong and deed.reaction in ("latch", "zero"):
            seen = stays_at_zero(line, seen)
        line.at_plant("set LINE_RUN 1")
        if line.status().get("probing"):
            line.ask("bypass")
            until("the probe has ended", lambda: not line.status().get("probing"))
        with contextlib.suppress(AffError):
            line.ensure_active()  # recovery: an operator's edge, no restart
        if not seen.wrong or not seen.held_up or attempt == ATTEMPTS - 1:
            break
    return seen


def wire_deeds(wire: str) -> list[Deed]:
    """Return the table's faults of the wire itself."""
    rows = [row for row in TABLE["faults"] if row[wire] not in ("-", "stay", "tell")]
    return [
        Deed(name=row["name"], reaction=row[wire], do=_injected(row["spec"]))
        for row in rows
        if not row["spec"].startswith("!")
    ]


def _injected(spec: str) -> Callable[[LiveLine], float]:
    name, _, length = spec.partition(":")
    lasts_s = min(0.9, float(length or 0.9)) if name != "reset" else 0.1

    def blow(line: LiveLine) -> float:
        return float(line.at_plant(f"fault {name}@0.05:{lasts_s:g}")["start_s"])

    return blow


def _step(clock: Path, offset_s: int) -> None:
    """Write where it is: the service has the file in its memory."""
    with clock.open("r+b") as stream:
        stream.write(offset_s.to_bytes(8, "little", signed=True))


def _stepped(clock: Path, offset_s: int) -> Callable[[LiveLine], float]:
    def blow(line: LiveLine) -> float:
        struck_s = line.now_s()
        _step(clock, offset_s)
        return struck_s

    return blow


def clock_cells(wire: str) -> list[tuple[str, str, Seen]]:
    """Step the wall clock under the whole service; monotonic time runs on."""
    found: list[tuple[str, str, Seen]] = []
    with small_disk() as folder:
        clock, shim = folder / "clock", folder / "stepped_clock.so"
        clock.write_bytes(bytes(8))
        subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", shim, SHIM, "-ldl"], check=True)
        environment = os.environ | {"LD_PRELOAD": str(shim), "STEPPED_CLOCK": str(clock)}
        line = LiveLine(folder, wire, environment)
        try:
            until("the service sees the PLC", lambda: line.status().get("comm") == "OK")
            for name, offset in STEPS:
                deed = Deed(name=name, reaction="ride", do=_stepped(clock, offset))
                for state in ("FAULT", "PROBING", "ACTIVE", "FADING", "BYPASS"):
                    _step(clock, 0)
                    found.append((name, state, cell(line, deed, state)))
                    _say(wire, *found[-1])
            hours = {
                row[11:13] for row in line.service.log.read_text().splitlines() if "INFO" in row
            }
            assert len(hours) > 1, f"the clock never stepped: {hours}"
        finally:
            line.close()
    return found


def process_cells(wire: str) -> list[tuple[str, str, Seen]]:
    """Every deed in every state, and the wire's own faults while a correction is at work."""
    found: list[tuple[str, str, Seen]] = []
    with small_disk() as folder:
        line = LiveLine(folder, wire)
        try:
            until("the service sees the PLC", lambda: line.status().get("comm") == "OK")
            for state in STATES:
                for deed in (*DEEDS, *(wire_deeds(wire) if state == "ACTIVE" else ())):
                    found.append((deed.name, state, cell(line, deed, state)))
                    _say(wire, *found[-1])
        finally:
            line.close()
    return found


def _say(wire: str, name: str, state: str, seen: Seen) -> None:
    zero = "" if seen.zero_s == 0.0 else f" last not zero {seen.zero_s * 1e3:.0f} ms"
    verdict = f"RED {seen.wrong}" if seen.wrong else "green"
    print(f"{wire:8} {state:10} {name:38} {verdict}{zero}", flush=True)


def main(arguments: list[str]) -> int:
    """Run the wires named (all without a name); 0 when every cell is green."""
    parser = argparse.ArgumentParser(prog="python -m tests.matrix.live", description=__doc__)
    parser.add_argument("wires", nargs="*", metavar="WIRE", help=f"of {', '.join(WIRES)}")
    wires = parser.parse_args(arguments).wires
    unknown = sorted(set(wires) - set(WIRES))
    if unknown:
        parser.error(f"no such wire: {', '.join(unknown)}; there are {', '.join(WIRES)}")
    found = []
    for wire in wires or list(WIRES):
        found += process_cells(wire)
        if shutil.which("cc"):
            found += clock_cells(wire)
        else:
            print(f"{wire}: no C compiler here, the clock was not stepped")
    bad = sum(bool(seen.wrong) for _, _, seen in found)
    print(f"{len(found) - bad} of {len(found)} cells green")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
