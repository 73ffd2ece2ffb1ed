"""``python -m tests.matrix.live_soak WIRE MINUTES [SEED]``: random faults on real processes.

The first third kills processes as well; in the rest the same processes live on, and their
memory, descriptors and threads are compared. Every blow is judged at the plant.
"""

from __future__ import annotations

import os
import random
import sys
from collections import defaultdict
from pathlib import Path

from tests.hil.live_line import LiveLine
from tests.matrix.cells import TABLE
from tests.matrix.deeds import HARMLESS, KILLS, Deed, recorder_pid
from tests.matrix.disk import small_disk
from tests.matrix.live_judge import Seen, stays_at_zero, strike
from tests.processes import CLOCK, pause, until

SPEED_M_S = 0.6  # a roll lasts 13 min down to
SMALLEST_M = 0.115  # a new roll then; the site file knows 4 in to 12 in
LOOKS = 10
KILL_SPACING_S = 32.0  # three deaths within a minute end the service, by design


def size_of(pid: int) -> tuple[int, int, int]:
    """Return resident memory, kB; open descriptors; threads."""
    status = Path(f"/proc/{pid}/status").read_text()
    rows = dict(line.split(":", 1) for line in status.splitlines() if ":" in line)
    handles = len(os.listdir(f"/proc/{pid}/fd"))
    return int(rows["VmRSS"].split()[0]), handles, int(rows["Threads"])


class LiveSoak:
    """One live line under random blows."""

    def __init__(self, line: LiveLine, wire: str, seed: int) -> None:
        self.line = line
        self.dice = random.Random(seed)
        rows = [row for row in TABLE["faults"] if row[wire] not in ("-", "tell")]
        self.faults = [(r["spec"], r[wire]) for r in rows if not r["spec"].startswith("!")]
        self.seen: list[Seen] = []
        self.rolls = 1
        self._next_kill_ns = 0

    def sizes(self) -> dict[str, tuple[int, int, int]]:
        """Return the size of every process, by its part."""
        line = self.line
        pids = {
            "supervisor": line.service.process.pid,
            "control": int(line.status()["control_pid"]),
            "recorder": recorder_pid(line),
            "plant": line.plant.process.pid,
        }
        return {part: size_of(pid) for part, pid in pids.items()}

    def turn(self, *, may_kill: bool) -> None:
        """Arm, do one random thing, judge it, and say so when it went wrong."""
        line, dice = self.line, self.dice
        self._keep_a_roll()
        line.ensure_active()
        now_ns = CLOCK.now_ns()
        if may_kill and now_ns > self._next_kill_ns and dice.random() < 0.5:
            self._next_kill_ns = now_ns + round(KILL_SPACING_S * 1e9)
            seen = self._deed(dice.choice(KILLS))
        elif dice.random() < 0.15:
            seen = self._deed(dice.choice(HARMLESS))
        else:
            seen = self._fault(*dice.choice(self.faults))
        self.seen.append(seen)
        if seen.wrong:
            print(f"  WRONG {seen}", flush=True)

    def _keep_a_roll(self) -> None:
        """Change rolls at speed, as the turret does, before the old one is used up."""
        if self.line.at_plant("status")["measured"]["unwind_radius_m"] < SMALLEST_M:
            change_s = self.line.at_plant("roll")["change_s"]
            self.line.wait_plant(change_s + 1.5)  # the splice is over
            self.rolls += 1

    def _deed(self, deed: Deed) -> Seen:
        seen = strike(self.line, deed.name, deed.reaction, deed.do)
        deed.undo(self.line)
        return seen if deed.reaction == "ride" else stays_at_zero(self.line, seen)

    def _fault(self, spec: str, reaction: str) -> Seen:
        name, _, length = spec.partition(":")
        short = self.dice.random() < 0.3 or float(length or 1.0) < 0.3
        lasts_s = self.dice.choice((0.01, 0.05, 0.12)) if short else 0.9
        wanted = "any" if short else reaction

        def blow(line: LiveLine) -> float:
            return float(line.at_plant(f"fault {name}@0.05:{lasts_s}")["start_s"])

        seen = strike(self.line, f"{name} {lasts_s:g} s", wanted, blow, lasts_s=max(lasts_s, 0.4))
        if reaction == "stay":  # the PLC refuses, and only an operator can tell the runtime
            self.line.ask("bypass")
            until("BYPASS", lambda: self.line.state == "BYPASS")
        return stays_at_zero(self.line, seen) if wanted in ("latch", "stay") else seen


def main(arguments: list[str]) -> int:
    """Run; 0 when every blow was answered as the table says and nothing grew."""
    wire, minutes = arguments[0], float(arguments[1])
    seed = int(arguments[2]) if len(arguments) > 2 else 1
    with small_disk() as folder:
        line = LiveLine(folder, wire, speed_m_s=SPEED_M_S)
        try:
            soak = LiveSoak(line, wire, seed)
            until("the service sees the PLC", lambda: line.status().get("comm") == "OK")
            rights = ", ".join(right["text"] for right in line.status()["meta"]["rights"])
            print(f"{wire}, {minutes:g} min, seed {seed}; {rights}", flush=True)
            code = _run(soak, minutes)
        finally:
            line.close()
        left = list(Path("/dev/shm").glob("aff-runtime*"))
        print(f"shared memory left behind: {len(left)}")
        return code or len(left) > 0


def _run(soak: LiveSoak, minutes: float) -> int:
    start_ns = CLOCK.now_ns()
    end_ns = start_ns + round(minutes * 60e9)
    calm_ns = start_ns + round(minutes * 20e9)
    early: dict[str, tuple[int, int, int]] = {}
    next_ns = start_ns
    while CLOCK.now_ns() < end_ns:
        kills = CLOCK.now_ns() < calm_ns
        soak.turn(may_kill=kills)
        sizes = soak.sizes()
        if not kills and not early and CLOCK.now_ns() > calm_ns + 120e9:
            early = _at_rest(soak)
        if CLOCK.now_ns() > next_ns:
            next_ns += 60_000_000_000
            print(
                f"{(CLOCK.now_ns() - start_ns) / 60e9:5.1f} min {len(soak.seen)} {sizes}",
                flush=True,
            )
    late = _at_rest(soak)
    return _report(soak, early, late)


def _at_rest(soak: LiveSoak) -> dict[str, tuple[int, int, int]]:
    """Return the least of ten looks: a request in work has a socket, a leak stays."""
    looks = []
    for _ in range(LOOKS):
        looks.append(soak.sizes())
        pause(0.1)
    return {
        part: tuple(min(values) for values in zip(*(look[part] for look in looks), strict=True))
        for part in looks[0]
    }


def _report(
    soak: LiveSoak, early: dict[str, tuple[int, int, int]], late: dict[str, tuple[int, int, int]]
) -> int:
    rows: dict[str, list[Seen]] = defaultdict(list)
    for seen in soak.seen:
        rows[seen.name].append(seen)
    for name, all_ in sorted(rows.items()):
        wrong = sum(bool(seen.wrong) for seen in all_)
        zero = max(seen.zero_s for seen in all_)
        largest = max(seen.largest for seen in all_)
        print(
            f"{name:34} {len(all_):4} times, last not zero {zero * 1e3:6.0f} ms, "
            f"largest {largest:.3f} of the limit, wrong {wrong}"
        )
    wrong = [seen for seen in soak.seen if seen.wrong]
    calm = [seen for seen in wrong if not seen.held_up]
    print(
        f"{len(soak.seen)} blows, {len(wrong)} wrong, {len(calm)} of them on a calm machine, "
        f"{soak.rolls} rolls"
    )
    grown = 0
    for part, (memory, handles, threads) in late.items():
        was = early.get(part, (0, 0, 0))
        grown += early != {} and (handles > was[1] or threads > was[2])
        print(
            f"{part:10} memory {was[0]} -> {memory} kB, handles {was[1]} -> {handles}, "
            f"threads {was[2]} -> {threads}"
        )
    return 1 if wrong or grown else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
