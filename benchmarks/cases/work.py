"""One labelled pair from files to verdict; runs on a worker of the cluster."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim_plant.fleet.refine_command import refined

LIMIT_S = 1800.0
"""For each try of a pair."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Where a pair lies, its name, its part of the data, and the folder to refine into."""

    folder: Path
    name: str
    part: str
    out: Path

    def __str__(self) -> str:
        return f"{self.part} {self.name}"


def refine(pair: Pair) -> dict[str, Any]:
    """Run the product's command line on one pair; return verdict, time and what went wrong."""
    at, name = pair.folder, pair.name
    begun = time.monotonic()  # noqa: TID251
    text, error = refined(
        at / f"{name}_a.yaml", at / f"{name}_a.csv.gz", at / f"{name}_b.csv.gz", pair.out, LIMIT_S
    )
    verdict = json.loads(text) if text else {}
    spent_s = time.monotonic() - begun  # noqa: TID251
    return {"verdict": verdict, "time_s": spent_s, "error": error}
