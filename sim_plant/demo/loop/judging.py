"""What new blocks did, by the service's own records: kept where ripple fell, else undone."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from aff_runtime.base.errors import PlantError
from sim_plant.demo.processes import RUNTIME

PATIENCE_S = 120.0


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockOrder:
    """One order that a proposed site file corrects and the present one does not."""

    actuator: str
    signal: str
    roll: str
    order: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """The strongest of the new orders in two windows of the service's own records, N.

    ``change_dB`` : after over before. ``fell`` : it is lower, and not by chance.
    """

    order: BlockOrder
    before_N: float
    after_N: float
    change_dB: float
    fell: bool

    def __str__(self) -> str:
        """Return the judgement as a reason for the history."""
        size = f"{self.before_N:.3g} to {self.after_N:.3g} N, {self.change_dB:+.1f} dB"
        return f"{self.order.roll} {self.order.order}x: {size} by the service's own record"


def new_orders(site: Path, proposed: Path) -> tuple[BlockOrder, ...]:
    """Return what the blocks of a proposed site file correct beyond those of the present one."""
    old, new = (set(_orders(yaml.safe_load(f.read_text("utf-8")))) for f in (site, proposed))
    return tuple(sorted(new - old, key=lambda one: (one.actuator, one.roll, one.order)))


def _orders(site: Any) -> Iterator[BlockOrder]:
    for name, actuator in site["actuators"].items():
        for block in actuator["blocks"]:
            for order in block["orders"] if block.get("enabled", True) else ():
                yield BlockOrder(
                    actuator=name,
                    signal=actuator["error"]["signal"],
                    roll=block["roll"],
                    order=order,
                )


def judged(before: str, after: str, orders: tuple[BlockOrder, ...], out: Path) -> Judgement:
    """Compare two windows of the service's records, as ``aff-runtime compare`` does.

    Raises
    ------
    PlantError
        The windows cannot be compared, or none of ``orders`` is in both.
    """
    out.mkdir(parents=True, exist_ok=True)
    command = [*RUNTIME, "compare", before, after, "--out", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    if done.returncode:
        raise PlantError(f"aff-runtime compare: {done.stderr.strip()}")
    return strongest(json.loads((out / "compare.json").read_text("utf-8")), orders)


def strongest(compared: Any, orders: tuple[BlockOrder, ...]) -> Judgement:
    """Return the judgement on that of ``orders`` which was strongest before; of JSON.

    Raises
    ------
    PlantError
        None of them is in both windows.
    """
    known = {(one.signal, one.roll, one.order): one for one in orders}
    rows = [r for r in compared["rows"] if (r["signal"], r["roll"], r["order"]) in known]
    if not rows:
        wanted = ", ".join(f"{one.roll} {one.order}x" for one in orders) or "nothing"
        raise PlantError(f"the service's records show no {wanted} in both windows")
    row = max(rows, key=lambda r: float(r["before"]["amplitude"]))
    change = row["change"]
    value, high = change["value_dB"], change["high_dB"]
    return Judgement(
        order=known[row["signal"], row["roll"], row["order"]],
        before_N=row["before"]["amplitude"],
        after_N=row["after"]["amplitude"],
        change_dB=float("nan") if value is None else value,
        fell=_fell(value, high, change["bound"]),
    )


def _fell(value_dB: float | None, high_dB: float | None, bound: str) -> bool:
    """Return whether the whole interval is below zero, or what is left is in the noise."""
    if value_dB is None or bound in ("none", "at_least"):
        return False
    return value_dB < 0.0 if bound == "at_most" else high_dB is not None and high_dB < 0.0
