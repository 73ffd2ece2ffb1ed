"""The only door to the product: its command line, in the process of the campaign's worker."""

from __future__ import annotations

import contextlib
import io
import json
import traceback
from pathlib import Path
from typing import Any


def refine_files(folder: Path, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """Run ``sim-plant refine`` on ``a`` with ``b`` held out; return verdict and what it said.

    The answer has ``verdict`` (of ``verdict.json``), ``said`` (last lines) and ``error`` (the
    message of a refusal or of a crash, else empty).
    """
    from sim_plant.cli.main import main

    command = [
        "refine",
        str(folder / "a.yaml"),
        str(folder / "a.csv"),
        "--holdout",
        str(folder / "b.csv"),
        "--out",
        str(folder / "out"),
        "--workers",
        "1",
    ]
    for name in without:
        command += ["--without", name]
    said = io.StringIO()
    error = ""
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            code = main(command)
            error = f"exit code {code}" if code else ""
        except Exception:  # a crash is a result of the campaign, not its end
            error = traceback.format_exc()
    path = folder / "out" / "verdict.json"
    verdict = json.loads(path.read_text(encoding="utf-8")) if path.exists() and not error else {}
    return {"verdict": verdict, "said": said.getvalue().splitlines()[-60:], "error": error}
