"""One self-contained page of a fleet: which line first, and what to do there."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from jinja2 import Environment, PackageLoader

from aff_runtime.base.files import replace_text
from sim_plant.fleet.findings import Finding

NONE = "–"


def write_page(
    findings: Sequence[Finding], answers: Sequence[str], reports: Mapping[str, str], path: Path
) -> None:
    """Write the page.

    Parameters
    ----------
    answers : verdict of every look, in a word.
    reports : the last report of each line that has one, relative to the page.
    """
    environment = Environment(autoescape=True, loader=PackageLoader("sim_plant.fleet", "."))
    text = environment.get_template("page.html.j2").render(
        lines=len({f.line for f in findings}),
        looks=len(answers),
        verdicts=Counter(answers).most_common(),
        findings=by_urgency(findings),
        reports=reports,
        size=_size,
        change=_change,
        number=_number,
    )
    replace_text(path, text)


def by_urgency(findings: Sequence[Finding]) -> list[Finding]:
    """Return lines that failed first, then by the error that is there; a line stays together."""
    worst: dict[str, float] = {}
    for f in findings:
        error = math.inf if f.verdict == "failed" else f.error_before
        worst[f.line] = max(worst.get(f.line, 0.0), 0.0 if math.isnan(error) else error)
    latest_first = sorted(findings, key=lambda f: f.recorded, reverse=True)
    return sorted(latest_first, key=lambda f: (-worst[f.line], f.line))


def _number(value: float) -> str:
    return NONE if math.isnan(value) else f"{value:.3g}"


def _size(f: Finding) -> str:
    if math.isnan(f.size):
        return NONE
    unit = "" if f.unit in {"1", ""} else f" {f.unit}"
    return f"{f.size:.4g}{unit} ({f.size_low:.4g} to {f.size_high:.4g})"


def _change(f: Finding) -> str:
    if math.isnan(f.trend):
        return NONE
    return f"{f.trend:+.3g} ({f.trend_low:+.3g} to {f.trend_high:+.3g})"
