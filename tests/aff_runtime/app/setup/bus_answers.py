"""Answers for the simulated line on CAN: what no DBC or EDS file says."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from pathlib import Path

from tests.aff_runtime.app.setup.machine_answers import MACHINE_ANSWERS

CONFIG = Path(__file__).parents[4] / "config"
FILES = {"dbc": ("euclid.dbc",), "canopen": ("euclid_line.eds", "euclid_drive.eds")}
MACHINE = {
    "name": "Euclid",
    "second": "swrap_follower",
    "second.tension": "pullroll_tension_N",
    "scan_ms": "5",
    "listen": "no",
    "speed_max": "300 FPM",
    **MACHINE_ANSWERS,
    "unwind_angle_rad.scale": "4096 counts/turn",
    "swrap_follower_angle_rad.scale": "4096 counts/turn",
}
NODES = {
    "node.1": "line 1 euclid_line.eds",
    "node.2": "unwind_drive 3 euclid_drive.eds",
    "node.3": "follower_drive 4 euclid_drive.eds",
    "signal.line_speed_m_s": "unwind_drive.0x606C",
    "unwind_tension_N.scale": "0.001",
    "tension_ref_N.scale": "0.01",
    "line_speed_m_s.scale": "0.0001",
    "unwind_radius_m.scale": "0.02 mm",
    "swrap_follower_speed_m_s.scale": "0.0001",
    "pullroll_tension_N.scale": "0.001",
    "lost.unwind_drive": "-1",
    "lost.follower_drive": "-1",
}
ANSWERS = {"dbc": MACHINE, "canopen": MACHINE | NODES}


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
