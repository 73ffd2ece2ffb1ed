"""One self-contained HTML page and its JSON twin."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader

from sim_plant.base.arrays import Array
from sim_plant.demo.evaluation import OrderReduction, more_orders, window
from sim_plant.demo.picture import write_picture
from sim_plant.demo.plots import block_plot, spectrum_plot, tension_plot, timing_plot
from sim_plant.demo.roll_plot import learned_orders, roll_plot
from sim_plant.demo.session import Session
from sim_plant.line.record_file import read_columns

WIRE_NAMES = {"modbus": "Modbus TCP", "can": "CAN by DBC", "canopen": "CANopen"}


def runtime_columns(folder: Path) -> dict[str, Array]:
    """Return the runtime's recorded columns, all segments joined."""
    segments = folder.glob("signals-*.csv.gz")
    paths = sorted(segments, key=lambda path: (len(path.name), path.name))  # 9999 before 10000
    parts = [read_columns(path, finite=False) for path in paths]
    names = parts[0] if parts else {}
    return {name: np.concatenate([part[name] for part in parts]) for name in names}


def write_report(session: Session, rows: list[OrderReduction], noise_N: float) -> Path:
    """Write ``report.html``, ``report.json`` and ``picture.svg``; return the page's path.

    ``noise_N`` is the load cell's noise per sample, for the floor of orders that are shown only.
    """
    out = session.plan.out.resolve()
    before = window(session.record, *session.before_s)
    after = window(session.record, *session.after_s)
    rms = [
        float(np.std(part[f"true_{name}"]))
        for name in ("unwind_tension_N", "pullroll_tension_N")
        for part in (before, after)
    ]
    columns = runtime_columns(session.run_folder)
    learned = learned_orders(columns)
    highest = max((one.order for one in learned if one.roll == "unwind"), default=0)
    judged = max(row.order for row in rows if row.roll == "unwind")
    more = more_orders(before, after, highest, noise_N, judged=judged)
    template = Environment(
        loader=PackageLoader("sim_plant.demo", "."), autoescape=True
    ).get_template("report.html.j2")
    page = template.render(
        line=session.plan.line.name,
        wire=WIRE_NAMES[session.plan.wire],
        speed_m_s=session.plan.line_speed_m_s,
        seed=session.plan.seed,
        before=session.before_s,
        after=session.after_s,
        rms=rms,
        rows=rows,
        tension=tension_plot(session),
        spectra=spectrum_plot(session),
        roll=roll_plot(learned),
        learned=learned,
        more=more,
        blocks=block_plot(columns),
        timing=timing_plot(columns),
        probe=session.probe_text,
    )
    write_picture(session, [*rows, *more], out / "picture.svg")
    path = out / "report.html"
    path.write_text(page, encoding="utf-8")
    twin = {
        "line_speed_m_s": session.plan.line_speed_m_s,
        "seed": session.plan.seed,
        "ripple_rms_N": dict(
            zip(
                ("unwind_before", "unwind_after", "pullroll_before", "pullroll_after"),
                rms,
                strict=True,
            )
        ),
        "orders": [
            dataclasses.asdict(row) | {"reduction_dB": row.reduction_dB, "passed": row.passed}
            for row in rows
        ],
        "more_orders": [
            dataclasses.asdict(row) | {"reduction_dB": row.reduction_dB} for row in more
        ],
        "learned_shape": [dataclasses.asdict(one) for one in learned],
        "exit_codes": session.exit_codes,
    }
    (out / "report.json").write_text(json.dumps(twin, indent=1) + "\n", encoding="utf-8")
    return path
