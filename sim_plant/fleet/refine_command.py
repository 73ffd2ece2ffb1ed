"""The product's own command on two records, for those that refine many."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from aff_runtime.base.python_child import module_command

TRIES = 3
"""Of a run that is killed, as by the kernel when memory is short: that says nothing of refine."""
LAST_WORDS = 400


def refined(
    line: Path, fitted: Path, held: Path, out: Path, limit_s: float | None = None
) -> tuple[str, str]:
    """Run ``sim-plant refine`` on one core; return the verdict as JSON, or "" and why not.

    ``limit_s`` is for each try; without it the caller has one.
    """
    command = [
        *(*module_command("sim_plant.cli.main"), "refine", str(line), str(fitted)),
        *("--holdout", str(held), "--out", str(out), "--workers", "1"),
    ]
    for _ in range(TRIES):
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=limit_s, check=False
            )
        except subprocess.TimeoutExpired:
            return "", f"longer than {limit_s:.0f} s"
        if done.returncode >= 0:
            break
        sys.stderr.write(f"{fitted.name}: ended by signal {-done.returncode}\n")
    if done.returncode != 0:
        return "", done.stderr.strip()[-LAST_WORDS:] or f"ended with code {done.returncode}"
    return (out / "verdict.json").read_text(encoding="utf-8"), ""
