"""One look from files to result; runs on a worker of the cluster, by the product's own command."""

from __future__ import annotations

import json
import math
import os
import time
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.fleet.looks import Look
from sim_plant.fleet.refine_command import refined
from sim_plant.refine.report.verdict import Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """A look, and the folder that its report goes to."""

    look: Look
    out: Path

    def __str__(self) -> str:
        return str(self.look)


@dataclass(frozen=True, slots=True, kw_only=True)
class LookResult:
    """What a look came to: a verdict, or None and why there is none.

    Attributes
    ----------
    fitted, held : names of its records; empty in a row of before there were names.
    declared : which line file it was told under, ``Mark.declared``.
    time_s, cpu_s : by the clock; of a core, NaN in a row of before it was counted.
    """

    line: str
    recorded: str
    verdict: Verdict | None
    error: str
    time_s: float
    fitted: str = ""
    held: str = ""
    declared: str = ""
    cpu_s: float = math.nan

    @property
    def answer(self) -> str:
        """The verdict in a word."""
        return "failed" if self.verdict is None else self.verdict.answer

    def of(self, look: Look, declared: str) -> LookResult:
        """Return it with the names of its look's records and line file."""
        return replace(self, fitted=look.fitted.name, held=look.held.name, declared=declared)

    def to_json(self) -> str:
        """Return the row that is kept of it."""
        verdict = None if self.verdict is None else json.loads(self.verdict.to_json())
        row = {"line": self.line, "recorded": self.recorded, "verdict": verdict}
        row |= {"fitted": self.fitted, "held": self.held, "declared": self.declared}
        row |= {"error": self.error, "time_s": self.time_s}
        row |= {} if math.isnan(self.cpu_s) else {"cpu_s": self.cpu_s}
        return json.dumps(row, indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str) -> LookResult:
        """Return what a kept row says.

        Raises
        ------
        PlantError
            When it is none.
        """
        try:
            row = json.loads(text)
            verdict = row["verdict"]
            date.fromisoformat(row["recorded"])
            return cls(
                line=str(row["line"]),
                recorded=str(row["recorded"]),
                verdict=None if verdict is None else Verdict.from_json(json.dumps(verdict)),
                error=str(row["error"]),
                time_s=float(row["time_s"]),
                cpu_s=float(row.get("cpu_s", math.nan)),
                **{name: str(row.get(name, "")) for name in ("fitted", "held", "declared")},
            )
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            raise PlantError(f"no row of a look ({error!r})") from error


def refine_look(order: Order) -> LookResult:
    """Refine one look."""
    look = order.look
    begun, before = time.monotonic(), os.times()  # noqa: TID251
    text, error = refined(look.file, look.fitted, look.held, order.out)
    after = os.times()
    return LookResult(
        line=look.line,
        recorded=look.recorded,
        verdict=Verdict.from_json(text) if text else None,
        error=error,
        time_s=time.monotonic() - begun,  # noqa: TID251
        cpu_s=sum(after[:4]) - sum(before[:4]),  # the child that refines is among its children
    )
