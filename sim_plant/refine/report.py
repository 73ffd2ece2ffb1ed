"""One self-contained HTML page for a process engineer who has to decide."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, PackageLoader

from sim_plant.refine.figures import overlay, spectrum, told_by, wavenumber_map
from sim_plant.refine.units import suffix_of
from sim_plant.refine.unknown import LINE_THRESHOLD

if TYPE_CHECKING:
    from sim_plant.refine.holdout import Judgement
    from sim_plant.refine.outcome import Outcome


HIDDEN = ("cos", "sin", "angle_rad", "smoothing_rad")


def size_of(row: dict[str, Any]) -> str:
    """Return the numbers of an effect that say how much of it there is, with their units."""
    found = []
    for name, value in row["parameters"].items():
        if isinstance(value, str):
            found.append(value)
        elif not name.startswith(HIDDEN):
            found.append(f"{name} {value:.4g}")
    return ", ".join(found)


def headline(result: dict[str, Any]) -> str:
    """Return the verdict in one sentence."""
    names = [
        f"{e['effect'].replace('_', ' ')} at {e['location']}"
        + (f" ({size_of(e)})" if size_of(e) else "")
        for e in result["effects"]
    ]
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


def gain(judged: Judgement, held: bool) -> str:
    """Return what the amended line explains, on the channel that gained most."""
    at = told_by(judged)[0]
    unit = suffix_of(judged.channels[at]).replace("_s", "/s")
    where = "On the held-out record" if held else "On the record fitted (no proof)"
    before, after, floor = judged.before[at], judged.after[at], judged.floor[at]
    return (
        f"{where} the error in {judged.channels[at]} is {before:.3g} {unit} rms as declared, "
        f"{after:.3g} {unit} as amended; noise alone leaves {floor:.3g} {unit}."
    )


def next_step(result: dict[str, Any], block: bool) -> str:
    """Return what the reader may do now."""
    if result["ambiguous"]:
        return "Make the record that tells the candidates apart before anything is changed."
    if block:
        return (
            "Paste the AFF block below under an actuator of the site file, or have the roller "
            "trued: the ripple of a cancelled roller comes back when the service is off."
        )
    if result["effects"]:
        return "This is no ripple to cancel: put the machine, or the declaration, right."
    if result["unknown"]:
        return (
            "Look for what turns or swings at that coordinate; the amended line does not "
            "contain it."
            if result["unknown"][0]["class"] in ("time", "travel", "angle")
            else "Record again with more speeds and a tension step, and more channels."
        )
    return "Nothing to do: the declaration stands."


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
        headline=headline(outcome.verdict), gain=gain(judged, bool(outcome.plan.holdout)),
        next_step=next_step(outcome.verdict, block is not None),
        verdict=outcome.verdict, rows=rows, command=command,
        limits=outcome.limits, records=outcome.records, held=outcome.plan.holdout,
        steps=trace.steps, angles=judged.angles_rad, unwound=judged.unwound_m,
        shifts=sorted(trace.corrections.items(), key=lambda row: row[0]),
        block=block.read_text(encoding="utf-8") if block else "",
        amended=amended.name if amended else "",
        overlay=overlay(judged, step_s),
        order_map=wavenumber_map(judged, step_s),
        spectra=spectrum(trace.before[0], trace.after[0], LINE_THRESHOLD),
    )  # fmt: skip
    path = outcome.plan.out / "report.html"
    path.write_text(page, encoding="utf-8")
    return path
