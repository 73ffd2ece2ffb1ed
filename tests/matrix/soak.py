"""``python -m tests.matrix.soak WIRE HOURS [SEED]``: random faults in virtual time.

Invariants in every sample: the correction at the plant stays within the limit; it is zero once
the guard has been in FAULT or BYPASS for the time the matrix allows. Afterwards: the line arms
again, memory and descriptors have not grown.
"""

from __future__ import annotations

import gc
import os
import random
import resource
import sys

from aff_runtime.base.signals import State
from tests.matrix.bench import LIMIT_M_S, SAMPLE_S, MatrixBench
from tests.matrix.cells import TABLE, ZERO_S

SAFE_STATES = (State.FAULT, State.BYPASS)


class Soak:
    """One bench under random faults and a random operator."""

    def __init__(self, wire: str, seed: int) -> None:
        self.dice = random.Random(seed)
        self.bench = MatrixBench(wire, seed=seed)
        rows = [row["spec"] for row in TABLE["faults"] if row[wire] != "-"]
        self.specs = [spec for spec in rows if not spec.startswith("!supervisor")]
        self.safe_for_s = self.faults = self.active_s = 0.0

    def watch(self, seconds: float) -> None:
        """Run and check every sample."""
        bench = self.bench
        for _ in range(round(seconds / SAMPLE_S)):
            (applied,) = bench.run(SAMPLE_S)
            assert applied <= LIMIT_M_S * (1 + 1e-6), f"{applied} above the limit"
            safe = bench.guard.state in SAFE_STATES
            self.safe_for_s = self.safe_for_s + SAMPLE_S if safe else 0.0
            assert not applied or self.safe_for_s <= ZERO_S, f"{applied} in {bench.guard.state}"
            self.active_s += SAMPLE_S if bench.guard.state is State.ACTIVE else 0.0
        bench.applied.clear()

    def turn(self) -> None:
        """Do one random thing."""
        dice, bench = self.dice, self.bench
        self.watch(dice.uniform(0.1, 4.0))
        if dice.random() < 0.1:
            bench.bypass()
        for _ in range(2):
            bench.arm()
            self.watch(0.4)
        spec = dice.choice(self.specs)
        name, _, length = spec.partition(":")
        length_s = dice.choice((0.01, 0.05, 0.1, 0.3, float(length or 0.5)))
        bench.begin(spec if name.startswith("!") else f"{name}:{length_s:.2f}")
        self.watch(length_s)
        bench.end(spec)
        self.faults += 1

    def recovers(self) -> bool:
        """Return whether the line arms again once everything is well."""
        self.bench.lockstep.plant.faults.clear()
        for _ in range(8):
            self.watch(1.0)
            self.bench.arm()
            if self.bench.until(State.ACTIVE, within_s=1.0):
                return True
        return False


def main(arguments: list[str]) -> int:
    """Run; 0 when every invariant held and nothing grew."""
    wire, hours = arguments[0], float(arguments[1])
    soak = Soak(wire, int(arguments[2]) if len(arguments) > 2 else 1)
    end_ns = round(hours * 3600e9)
    turns, early = 0, (0, 0)
    while soak.bench.clock.now_ns() < end_ns:
        soak.turn()
        turns += 1
        if turns == 20:
            early = _size()
    late = _size()
    print(
        f"{wire}: {soak.bench.clock.now_ns() / 3.6e12:.2f} h virtual, {soak.faults:.0f} faults, "
        f"active {soak.active_s:.0f} s, peak memory {early[0]} -> {late[0]} kB, "
        f"handles {early[1]} -> {late[1]}, recovers {soak.recovers()}"
    )
    return 0 if late[1] <= early[1] else 1


def _size() -> tuple[int, int]:
    """Return peak resident memory, kB, and open descriptors."""
    gc.collect()
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, len(os.listdir("/proc/self/fd"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
