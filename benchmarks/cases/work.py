"""One labelled pair from files to verdict; runs on a worker of the cluster."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.python_child import module_command

LIMIT_S = 1800.0
TRIES = 3
"""Of a run that is killed, as by the kernel when memory is short: that says nothing of refine."""


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
    at, name, out = pair.folder, pair.name, pair.out
    command = [
        *(*module_command("sim_plant.cli.main"), "refine"),
        *(str(at / f"{name}_a.yaml"), str(at / f"{name}_a.csv.gz")),
        *("--holdout", str(at / f"{name}_b.csv.gz"), "--out", str(out), "--workers", "1"),
    ]
    begun = time.monotonic()  # noqa: TID251
    try:
        for _ in range(TRIES):
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=LIMIT_S, check=False
            )
            if done.returncode >= 0:
                break
            sys.stderr.write(f"{name}: ended by signal {-done.returncode}\n")
        error = "" if done.returncode == 0 else done.stderr[-400:] or f"exit {done.returncode}"
    except subprocess.TimeoutExpired:
        error = f"longer than {LIMIT_S:.0f} s"
    path = out / "verdict.json"
    verdict = json.loads(path.read_text(encoding="utf-8")) if path.exists() and not error else {}
    spent_s = time.monotonic() - begun  # noqa: TID251
    return {"verdict": verdict, "time_s": spent_s, "error": error}
