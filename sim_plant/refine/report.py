"""One self-contained HTML page for a process engineer who has to decide."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader

from sim_plant.refine.figures import order_map, overlay, spectrum
from sim_plant.refine.unknown import LINE_THRESHOLD

if TYPE_CHECKING:
    from sim_plant.refine.outcome import Outcome


def headline(result: dict) -> str:  # type: ignore[type-arg]
    """Return the verdict in one sentence."""
    names = [f"{e['effect'].replace('_', ' ')} at {e['location']}" for e in result["effects"]]
    if result["verdict"] == "nothing":
        return "Nothing found: the declared line explains the record to its noise."
    text = "Traced: " + "; ".join(names) + "." if names else ""
    for item in result["unknown"]:
        where = ", ".join(f"{k} {v}" for k, v in item["coordinate"].items())
        text += f" Unknown, class {item['class']}: {where}; no effect of the library explains it."
    for item in result["ambiguous"]:
        text += f" {item['effect']} cannot be told from {', '.join(item['with'])}."
        text += "".join(f" To tell: {what}." for what in item["experiments"])
    return text.strip()


def write_report(outcome: Outcome, command: str, amended: Path | None, block: Path | None) -> Path:
    """Write ``report.html``; return its path."""
    judged, trace = outcome.judgement, outcome.trace
    step_s = trace.travels[0].sample_time_s
    rows = [
        {"name": n, "before": b, "after": a, "floor": f, "ratio": a / f if f else 0.0,
         "was": b / f if f else 0.0}
        for n, b, a, f in zip(judged.channels, judged.before, judged.after, judged.floor,
                              strict=True)
    ]  # fmt: skip
    template = Environment(
        loader=PackageLoader("sim_plant.refine", "."), autoescape=True
    ).get_template("report.html.j2")
    page = template.render(
        headline=headline(outcome.verdict), verdict=outcome.verdict, rows=rows, command=command,
        limits=outcome.limits, records=outcome.records, held=outcome.plan.holdout,
        steps=trace.steps, angles=judged.angles_rad,
        shifts=sorted(trace.corrections.items(), key=lambda row: row[0]),
        block=block.read_text(encoding="utf-8") if block else "",
        amended=amended.name if amended else "",
        overlay=overlay(judged, step_s), order_map=order_map(judged, step_s),
        spectra=spectrum(trace.before[0], trace.after[0], LINE_THRESHOLD),
    )  # fmt: skip
    path = outcome.plan.out / "report.html"
    path.write_text(page, encoding="utf-8")
    return path
