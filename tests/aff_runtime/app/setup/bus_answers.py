"""Answers for the simulated line on CAN: what no DBC or EDS file says."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from pathlib import Path

from benchmarks.wizard.answers import BUS_ANSWERS, LINE_ANSWERS

CONFIG = Path(__file__).parents[4] / "config"
FILES = {"dbc": ("euclid.dbc",), "canopen": ("euclid_line.eds", "euclid_drive.eds")}
ANSWERS = {
    protocol: {**LINE_ANSWERS, "listen": "no", **more} for protocol, more in BUS_ANSWERS.items()
}


def begun(folder: Path, protocol: str, **changes: str | None) -> list[str]:
    """Put files and answers into a folder; return the arguments of the command."""
    for name in FILES[protocol]:
        shutil.copy(CONFIG / name, folder / name)
    answers: Mapping[str, str | None] = ANSWERS[protocol] | {
        name.replace("__", "."): value for name, value in changes.items()
    }
    path = folder / "answers.yaml"
    rows = (
        f"{name}: {json.dumps(value)}\n" for name, value in answers.items() if value is not None
    )
    path.write_text("".join(rows), encoding="utf-8")
    option = "--dbc" if protocol == "dbc" else "--eds"
    files = [word for name in FILES[protocol] for word in (option, str(folder / name))]
    named = ["--answers", str(path), "--state-dir", str(folder)]
    return ["setup", str(folder / "site.yaml"), *files, *named]
