"""``python -m tests.matrix.mutants``: take each reaction away and see which cells notice.

A mutant survives when every cell stays green without the reaction: then the matrix does not
prove it. The list of survivors is the result.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus import can_gateway, can_reader, canopen_node, gateway
from aff_runtime.safety import freshness, guard, limits, line_judge
from sim_plant.servers import canopen_device, plc
from tests.matrix.cells import Cell, cells, judge

Patch = tuple[Any, str, Any]


def _always(value: Any) -> Callable[..., Any]:
    return lambda *_, **__: value


def _believing(self: Any, deadline_ns: int) -> Outcome:
    outcome = _RECEIVE(self, deadline_ns)
    return Outcome.OK if outcome is Outcome.BAD_REPLY else outcome


def _unlimited(self: Any, wanted: Any, envelope: float, dt_s: float) -> None:
    self.output = 0.0 if wanted is None else wanted.value * envelope


_RECEIVE = can_gateway.CanGateway._receive

MUTANTS: dict[str, tuple[Patch, str]] = {
    "freshness: the PLC is always fresh": (
        (freshness.FreshnessJudge, "judge", _always(freshness.Freshness.GOOD)), ""),
    "guard: an overrun is no cause": (
        (guard.Guard, "_causes_of_time",
         lambda self, now_ns, fresh, overrun, alive: _CAUSES(self, self._observed_ns or now_ns,
                                                             fresh, False, alive)), ""),
    "guard: a lost supervisor is no cause": (
        (guard.Guard, "_causes_of_time",
         lambda self, now_ns, fresh, overrun, _: _CAUSES(self, now_ns, fresh, overrun, True)), ""),
    "guard: an internal fault is no fault": ((guard.Guard, "internal_fault", _always(None)), ""),
    "line judge: every reading is plausible": (
        (line_judge.LineJudge, "judge", lambda self, *a, **k: 0), ""),
    "limits: nothing is limited": (
        (limits.Limiter, "step", _unlimited), ""),
    "reader: every set is whole": ((can_reader.CanReader, "_is_whole", _always(True)), "can"),
    "reader: every heartbeat is in order": (
        (can_reader.CanReader, "_in_order", _always(True)), "can"),
    "gateway: a bad frame does no harm": (
        (can_gateway.CanGateway, "_receive", _believing), "can"),
    "node: operational without asking": (
        (canopen_node.NodeKeeper, "_heartbeat", _always(None)), "canopen"),
    "PLC: no watchdog": ((plc.Plc, "_heartbeat_moves", _always(True)), ""),
    "PLC: an intact zero does not end the ramp": ((plc.Plc, "_says_zero", _always(False)), ""),
    "device: process data never late": (
        (canopen_device.Device, "lost", _always(False)), "canopen"),
    "words: the first reply after a loss is believed": (
        (gateway.WordCodec, "reset", _always(None)), "modbus"),
}  # fmt: skip
_CAUSES = guard.Guard._causes_of_time


def relevant(wire: str) -> list[Cell]:
    """Return the cells worth running for a mutant of one wire (all for the shared rooms)."""
    return [cell for cell in cells(("ACTIVE", "FADING")) if not wire or cell.wire == wire]


def first_red(patch: Patch, wire: str) -> str:
    """Return the first cell that notices the mutant; empty when none does."""
    owner, name, replacement = patch
    if not hasattr(owner, name):
        return f"(no {owner.__name__}.{name})"
    original = getattr(owner, name)
    setattr(owner, name, replacement)
    try:
        for cell in relevant(wire):
            wrong = judge(cell)
            if wrong:
                return f"{cell}: {wrong}"
    finally:
        setattr(owner, name, original)
    return ""


def main() -> int:
    """Print every mutant with the cell that kills it; 1 when one survives."""
    survivors = []
    for name, (patch, wire) in MUTANTS.items():
        found = first_red(patch, wire)
        print(f"{'killed  ' if found else 'SURVIVES'}  {name}   {found}", flush=True)
        if not found:
            survivors.append(name)
    print(f"{len(MUTANTS) - len(survivors)} of {len(MUTANTS)} mutants killed")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
