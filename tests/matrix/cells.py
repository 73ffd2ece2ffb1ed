"""Every cell of the matrix, and the judgement of one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from tests import quick_yaml
from tests.matrix.bench import SAMPLE_S, WIRES, Greedy, MatrixBench

TABLE: dict[str, Any] = quick_yaml.safe_load((Path(__file__).parent / "table.yaml").read_text())
STATES = ("OFF", "SOFT_START", "ACTIVE", "FADING", "BYPASS")
ZERO_S = TABLE["zero_ms"] * 1e-3
PLAUSIBLE = 2000.0  # N: nothing above the site's own maximum may reach a law
OLDEST_SCANS = 3
_ROUNDING = 1.0 + 1e-6
NOT_OURS = BY_NAME["APPLIED_DIFFERS"].code


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One fault on one wire in one state, and what must happen."""

    fault: str
    spec: str
    wire: str
    state: str
    reaction: str

    def __str__(self) -> str:
        return f"{self.wire}-{self.state}-{self.fault}".replace(" ", "_")


def cells(states: tuple[str, ...] = STATES) -> Iterator[Cell]:
    """Yield every cell that can happen."""
    for row in TABLE["faults"]:
        for wire in WIRES:
            for state in states if row[wire] != "-" else ():
                yield Cell(
                    fault=row["name"], spec=row["spec"], wire=wire, state=state, reaction=row[wire]
                )


def judge(cell: Cell) -> str:
    """Run one cell; return what is wrong, empty when nothing is."""
    bench = MatrixBench(cell.wire, seed=len(cell.fault))
    wrong = _reach(bench, cell.state)
    if wrong:
        return wrong
    duration_s = float(cell.spec.partition(":")[2] or 0.5)
    if cell.reaction == "tell":
        return _tells(cell, bench, duration_s)
    bench.begin(cell.spec)
    during = bench.run(duration_s)
    bench.end(cell.spec)
    after = bench.run(max(0.4, ZERO_S + 0.1 - duration_s))
    whole = during + after
    wrong = _used_as_live(bench.law) if _is_told_apart(cell) else ""
    if not wrong and NOT_OURS in bench.around.codes:
        wrong = "the PLC is said to apply what is not ours"
    if not wrong and bench.largest_share > _ROUNDING:
        wrong = f"{bench.largest_share:.4f} of the limit"
    if wrong:
        return wrong
    if cell.state in {"OFF", "BYPASS"}:
        return "a correction without an operator" if any(whole) else _recovers(bench)
    return _reacts(cell, bench, during, after)


def _reacts(  # noqa: PLR0911 (one return per verdict)
    cell: Cell, bench: MatrixBench, during: list[float], after: list[float]
) -> str:
    """Judge the reaction that the table asks for, and the way back."""
    whole = during + after
    zero_from = round(ZERO_S / SAMPLE_S) + 1
    if cell.reaction == "latch":
        if any(whole[zero_from:]):
            return f"not zero {ZERO_S * 1e3:.0f} ms after the fault began"
        if bench.guard.state is not State.FAULT:
            return f"state {bench.guard.state.name}, not latched"
        return _recovers(bench)
    if cell.reaction == "stay":
        if any(whole[zero_from:]):
            return f"not zero {ZERO_S * 1e3:.0f} ms after the fault began"
        if "AFF_ENABLE_REQUEST=0" not in bench.guard.first_blocking():
            return f"the runtime does not know: {bench.guard.state.name}"
        bench.bypass()
        bench.run(0.02)
        bench.arm()  # at once, as operators do: the PLC must have seen the runtime idle before
        bench.run(1.0)
        if not any(bench.applied[-20:]):
            return f"bypass and arm at once: {bench.guard.state.name}, {bench.plant.refusal}"
        bench.bypass()
        bench.run(0.4)
        return _recovers(bench)
    if cell.reaction == "fade":
        if any(during[zero_from:]):
            return f"not zero {ZERO_S * 1e3:.0f} ms after the fault began"
        back = bench.run(1.5)
        return "" if cell.state == "FADING" or any(back) else "did not come back by itself"
    if cell.state != "FADING" and (bench.guard.state is not State.ACTIVE or not any(after[-20:])):
        return f"did not ride through: {bench.guard.state.name}"
    return ""


def _tells(cell: Cell, bench: MatrixBench, duration_s: float) -> str:
    """Judge that a correction which is not ours is told, that ours goes and nobody arms."""
    rests = State.BYPASS if cell.state == "BYPASS" else State.FAULT
    bench.begin(cell.spec)
    bench.run(ZERO_S)
    if bench.around.codes.count(NOT_OURS) != 1 or bench.alarm != NOT_OURS:
        return f"not told within {ZERO_S * 1e3:.0f} ms: alarm {bench.alarm}"
    bench.arm()
    his = bench.run(duration_s - ZERO_S)
    if not all(his[:-1]):  # in the last sample he is gone
        return "the fault did nothing"
    if any(bench.sent):
        return "ours did not go to zero"
    if bench.guard.state is not rests or "APPLIED_DIFFERS" not in bench.guard.first_blocking():
        return f"armed meanwhile: {bench.guard.state.name} {bench.guard.first_blocking()}"
    bench.end(cell.spec)
    bench.run(ZERO_S)
    return _recovers(bench)


def _is_told_apart(cell: Cell) -> bool:
    """Whether the wire itself shows that a reading is old or garbled.

    A constant delay on CAN does not: everything moves, late. A swapped status word may say that
    the line does not run, and of a line at rest every finite reading is believed.
    """
    return not cell.spec.startswith(("delay", "swap"))


def _used_as_live(law: Greedy) -> str:
    """Return what was given to the law as fresh and was not, empty when nothing was."""
    if law.largest > PLAUSIBLE:
        return f"the law was given {law.largest:.0f} N"
    if law.oldest_scans > OLDEST_SCANS:
        return f"the law was given readings {law.oldest_scans} scans old as fresh"
    return ""


def _reach(bench: MatrixBench, state: str) -> str:
    """Bring a fresh bench into a state; return why that failed."""
    bench.run(1.0 if bench.wire == "canopen" else 0.3)
    if state == "OFF":
        return "" if bench.guard.state in (State.FAULT, State.OFF, State.READY) else "armed itself"
    bench.arm()
    if not bench.until(State.ACTIVE, within_s=1.0):
        return f"never ACTIVE: {bench.guard.state.name} {bench.guard.first_blocking()}"
    if state == "SOFT_START":
        bench.run(0.05)
        return ""
    bench.run(0.4)
    if not any(bench.applied[-20:]):
        return f"no correction at the plant: {bench.plant.refusal}"
    if state == "BYPASS":
        bench.bypass()
        bench.run(0.4)
    elif state == "FADING":
        bench.begin("permissive=LINE_RUN:0.2")
        bench.run(0.05)
    return ""


def _recovers(bench: MatrixBench) -> str:
    """Arm again and expect the correction back, without a restart of either side."""
    if any(bench.run(0.5)):
        return "came back without an operator"
    for _ in range(4):
        bench.arm()
        if bench.until(State.ACTIVE, within_s=0.7):
            break
    bench.run(0.4)
    if bench.guard.state is not State.ACTIVE or not any(bench.applied[-20:]):
        return (
            f"does not recover: {bench.guard.state.name} {bench.guard.first_blocking()} "
            f"{bench.plant.refusal}"
        )
    return ""
