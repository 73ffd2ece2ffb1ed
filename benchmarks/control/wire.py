"""Rows over the real wire in real time: the simulated plant and the service as two processes."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchmarks.control import cases, scores, store
from benchmarks.control.jobs import BenchRow, Job
from benchmarks.control.laws import OWN
from benchmarks.control.lines import ROOT
from sim_plant.demo.evaluation import window
from sim_plant.demo.session import DemoPlan, Session, run_session

SITE = ROOT / "config" / "euclid.yaml"
ROWS = (("flat", 200.0), ("flat", 300.0), ("bulge", 200.0))
SEED = 1


def over_the_wire(folder: Path) -> list[BenchRow]:
    """Run the rows on Modbus TCP at 5 ms with the shipped site file, judged on the true tension.

    Both actuators correct, P comes from the probe; the line is the one of the lockstep rows.
    """
    rows = []
    for shape, fpm in ROWS:
        case = cases.Case(material="tyvek", fpm=fpm, radius_in=8.0, shape=shape)
        out = folder / "wire" / case.name.replace(" ", "_")
        out.parent.mkdir(parents=True, exist_ok=True)
        line = out.parent / f"{out.name}.yaml"
        line.write_text(yaml.safe_dump(case.line().model_dump(mode="json", by_alias=True)))
        session = run_session(
            DemoPlan(
                line=line,
                site=SITE,
                out=out,
                line_speed_m_s=case.speed_m_s,
                seed=SEED,
                before_s=20.0,
                learn_s=45.0,
                after_s=20.0,
            ),
            _say,
        )
        rows.append({"case": case.name, "law": OWN, "seed": SEED, **_row(session)})
    return rows


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def lockstep(folder: Path, name: str) -> BenchRow:
    """Return the figures of the same row in lockstep time; NaN where it has not been run."""
    case = next(c for c in cases.constant_cases() if c.name == name)
    row = store.load(folder, Job(section="constant", case=case, law=OWN, seed=SEED)) or {}
    return {
        "lockstep_dB": row.get("late_dB", [float("nan")] * 4),
        "lockstep_ripple": row.get("ripple", float("nan")),
    }


def _row(session: Session) -> dict[str, Any]:
    before = window(session.record, *session.before_s)
    after = window(session.record, *session.after_s)
    plain, left = _amplitudes(before), _amplitudes(after)
    tension = "true_unwind_tension_N"
    return {
        "plain_N": [float(x) for x in plain[:4]],
        "with_N": [float(x) for x in left[:4]],
        "late_dB": [float(x) for x in scores.ratio_dB(plain, left)],
        "ripple": scores.rms(after[tension]) / scores.rms(before[tension]),
        "probe": session.probe_text,
        "exit_codes": session.exit_codes,
    }


def _amplitudes(part: dict[str, Any]) -> scores.Array:
    time_s = np.asarray(part["time_s"])
    cycle_s = float((time_s[-1] - time_s[0]) / (time_s.size - 1))
    angles = [np.asarray(part[f"true_{r}_angle_rad"]) for r in ("unwind", "swrap_follower")]
    return scores.order_amplitudes(
        np.asarray(part["true_unwind_tension_N"]), angles[0], angles[1], cycle_s
    )
