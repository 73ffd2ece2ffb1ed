"""``python -m tests.matrix.soak WIRE HOURS [SEED] [CYCLE_MS]``: random faults in virtual time.

Invariants in every sample: the correction at the plant stays within the limit; it is zero once
the guard has been in FAULT or BYPASS for the time the matrix allows, and zero once a fault that
takes it away has lasted that long; but for one that is somebody else's, and nobody else is said
to have one. Afterwards: the line arms again, memory and descriptors have
not grown.
"""

from __future__ import annotations

import gc
import os
import random
import sys
from pathlib import Path

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import State
from tests.matrix.bench import SAMPLE_S, MatrixBench
from tests.matrix.cells import NOT_OURS, TABLE, ZERO_S

SAFE_STATES = (State.FAULT, State.BYPASS)
WARM_TURNS = 500


class Soak:
    """One bench under random faults and a random operator."""

    def __init__(self, wire: str, seed: int, sample_s: float = SAMPLE_S) -> None:
        self.dice = random.Random(seed)
        self.sample_s = sample_s
        self.bench = MatrixBench(wire, seed=seed, sample_s=sample_s)
        rows = [(row["spec"], row[wire]) for row in TABLE["faults"] if row[wire] != "-"]
        self.specs = [row for row in rows if not row[0].startswith("!supervisor")]
        self.safe_for_s = self.struck_for_s = self.active_s = 0.0
        self.takes_away = self.is_his = False
        self.faults = 0
        self.deeds: list[str] = []
        self.latest_ms = 0.0

    def watch(self, seconds: float) -> None:
        """Run and check every sample."""
        bench = self.bench
        guard, sample_s = bench.guard, self.sample_s
        for _ in range(round(seconds / sample_s)):
            applied = bench.step()
            assert bench.largest_share <= 1.0 + 1e-6, f"{bench.largest_share} of the limit"
            state = guard.state
            self.safe_for_s = self.safe_for_s + sample_s if state in SAFE_STATES else 0.0
            self.active_s += sample_s * (state is State.ACTIVE)
            if self.takes_away:
                self.struck_for_s += sample_s
            if applied and not self.is_his:
                late_s = max(self.safe_for_s, self.struck_for_s)
                assert late_s <= ZERO_S + sample_s, (
                    f"{applied} in {state.name} after {late_s:.3f} s (safe {self.safe_for_s:.3f}, "
                    f"struck {self.struck_for_s:.3f} s); the last deeds: {self.deeds[-6:]}"
                )
                if self.takes_away:
                    self.latest_ms = max(self.latest_ms, 1e3 * self.struck_for_s)

    def turn(self) -> None:
        """Do one random thing."""
        dice, bench = self.dice, self.bench
        self.watch(dice.uniform(0.1, 4.0))
        # an operator who reads "blocked by AFF_ENABLE_REQUEST=0" bypasses before arming again
        if dice.random() < (0.6 if bench.plant.plc.withdrawn else 0.1):
            bench.bypass()
            self.deeds.append("bypass")
        for _ in range(2):
            bench.arm()
            self.watch(0.4)
        spec, reaction = dice.choice(self.specs)
        name, _, length = spec.partition(":")
        length_s = dice.choice((0.01, 0.05, 0.1, 0.3, float(length or 0.5)))
        self.is_his = reaction == "tell"
        self.takes_away = reaction not in ("ride", "tell") and name != "reset"
        self.struck_for_s = 0.0
        told = bench.around.codes.count(NOT_OURS)
        del self.deeds[:-6]
        self.deeds.append(f"{spec} for {length_s:.2f} s in {bench.guard.state.name}")
        bench.begin(spec if name.startswith("!") else f"{name}:{length_s:.2f}")
        self.watch(length_s)
        assert self.is_his or bench.around.codes.count(NOT_OURS) <= told, self.deeds
        bench.end(spec)
        self.takes_away, self.is_his, self.struck_for_s = False, False, 0.0
        self.faults += 1

    def recovers(self) -> bool:
        """Return whether the line arms again once everything is well."""
        self.bench.lockstep.plant.faults.clear()
        for _ in range(8):
            self.watch(1.0)
            if self.bench.plant.plc.withdrawn:
                self.bench.bypass()
                self.watch(0.1)
            self.bench.arm()
            if self.bench.until(State.ACTIVE, within_s=1.0):
                return True
        return False


def main(arguments: list[str]) -> int:
    """Run; 0 when every invariant held and nothing grew."""
    wire, hours = arguments[0], float(arguments[1])
    seed = int(arguments[2]) if len(arguments) > 2 else 1
    cycle_ms = float(arguments[3]) if len(arguments) > 3 else 1e3 * SAMPLE_S
    soak = Soak(wire, seed, cycle_ms * 1e-3)
    watch, began_ns = MonotonicClock(), MonotonicClock().now_ns()
    end_ns, hour_ns = round(hours * 3600e9), 3_600_000_000_000
    turns, early = 0, (0, 0)
    while soak.bench.clock.now_ns() < end_ns:
        soak.turn()
        turns += 1
        if turns == WARM_TURNS:
            early = size()
        if soak.bench.clock.now_ns() > hour_ns:
            real_min = (watch.now_ns() - began_ns) / 60e9
            print(
                f"{hour_ns / 3.6e12:.0f} h, {soak.faults} faults, {size()}, {real_min:.1f} min",
                flush=True,
            )
            hour_ns += 3_600_000_000_000
    late = size()
    print(
        f"{wire}, cycle {cycle_ms:g} ms, seed {seed}: "
        f"{soak.bench.clock.now_ns() / 3.6e12:.2f} h virtual, {soak.faults} faults, "
        f"active {soak.active_s / 3600:.2f} h, zero at the latest {soak.latest_ms:.0f} ms after a "
        f"fault, memory {early[0]} -> {late[0]} kB, handles {early[1]} -> {late[1]}, "
        f"recovers {soak.recovers()}",
        flush=True,
    )
    return 0 if late[1] <= max(early[1], 3) and late[0] <= 1.05 * (early[0] or late[0]) else 1


def size() -> tuple[int, int]:
    """Return resident memory now, kB, and open descriptors."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") // 1024, len(os.listdir("/proc/self/fd"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
