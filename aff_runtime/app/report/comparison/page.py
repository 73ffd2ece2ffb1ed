"""A comparison as one self-contained page, as JSON and as a few lines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from html import escape
from typing import Any

from aff_runtime.app.report.comparison.comparing import Comparison, Facts, OrderRow
from aff_runtime.app.report.comparison.outcome import NO_CHANGE, change_text, outcome
from aff_runtime.app.report.comparison.turns import Change, Estimate
from aff_runtime.base.numbers import finite_or_none
from aff_runtime.base.printable import printable

VERSION = 1
STYLE = (
    "body{font:15px sans-serif;margin:1.5em}table{border-collapse:collapse;margin:1em 0}"
    "td,th{padding:.15em .7em;text-align:right;border-bottom:1px solid #ddd;white-space:nowrap}"
    "td:first-child,th:first-child,td:last-child{text-align:left}.odd{color:#a40}"
    "td:last-child{white-space:normal}"
)
HEAD = (
    *("order", "Hz", "before N", "95 %", "after N", "95 %", "change dB", "95 %"),
    *("noise N", "turns", ""),
)
# of a chart, pixels: width of a bar, height of the axis, room at its left and above it
BAR, AXIS, LEFT, TOP = 14, 120, 30, 10


def _shown(text: str) -> str:
    """Return text of a run as HTML; no character of it turns or hides the text around it."""
    return escape(printable(text))


def as_json(comparison: Comparison) -> dict[str, Any]:
    """Return the comparison for programs, SI; what is not known is null. ``VERSION`` of keys."""
    return {"version": VERSION, **dict(_plain(asdict(comparison)))}


def _plain(value: Any) -> Any:
    """Return a value as JSON has it: seven digits, null for what is no number."""
    if isinstance(value, dict):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float):
        return finite_or_none(value, 7)
    return value


def page(comparison: Comparison) -> str:
    """Return a self-contained HTML page."""
    parts = [f"<h1>{_shown(comparison.line)}: before and after</h1>", _warnings(comparison.labels)]
    parts += [_outcome(comparison), _facts(comparison.windows)]
    parts.append(_differences(comparison.differences))
    parts += [
        f"<h2>{_shown(signal)}, orders of {_shown(roll)}</h2>{_chart(rows)}{_table(rows)}"
        for (signal, roll), rows in _groups(comparison.rows).items()
    ]
    if not comparison.rows:
        parts.append("<p>No roll and tension is known in both windows.</p>")
    parts.append(
        "<p>Amplitudes are means over whole turns; intervals come from how turns differ, taken "
        "together in batches. Noise: what chance alone exceeds once in 20 windows. A change "
        "with &le; or &ge; is a bound: one of the two is in the noise.</p>"
    )
    body = "\n".join(part for part in parts if part)
    return (
        f'<!doctype html><meta charset="utf-8"><title>{_shown(comparison.line)}: compare</title>'
        f"<style>{STYLE}</style>\n{body}\n"
    )


def lines(comparison: Comparison) -> Iterator[str]:
    """Yield the comparison for a terminal; what it comes to is last."""
    for row in comparison.rows:
        yield (
            f"{row.signal} {row.roll} {row.order}x: {_size(row.before)} -> {_size(row.after)} N, "
            f"{change_text(row.change)}" + "".join(f" ({label})" for label in row.labels)
        )
    for text in comparison.differences:
        yield f"site file: {text}"
    for label in comparison.labels:
        yield f"not comparable: {label}"
    for which, window in zip(("before", "after"), comparison.windows, strict=True):
        for label in window.labels:
            yield f"{which}: {label}"
    yield from outcome(comparison)


def _size(estimate: Estimate) -> str:
    return f"{estimate.amplitude:.3g}"


def _warnings(labels: Sequence[str]) -> str:
    return "".join(f'<p class="odd">Not comparable: {_shown(text)}.</p>' for text in labels)


def _outcome(comparison: Comparison) -> str:
    return "<ul>" + "".join(f"<li>{_shown(text)}</li>" for text in outcome(comparison)) + "</ul>"


def _groups(rows: Sequence[OrderRow]) -> dict[tuple[str, str], list[OrderRow]]:
    groups: dict[tuple[str, str], list[OrderRow]] = {}
    for row in rows:
        groups.setdefault((row.signal, row.roll), []).append(row)
    return groups


def _table(rows: Sequence[OrderRow]) -> str:
    head = "".join(f"<th>{_shown(text)}</th>" for text in HEAD)
    return f"<table><tr>{head}</tr>{''.join(map(_row, rows))}</table>"


def _row(row: OrderRow) -> str:
    f0, f1 = row.frequency_Hz
    cells = [
        f"{row.order}x",
        f"{f0:.3g}" if abs(f0 - f1) < 0.02 * max(f0, f1) else f"{f0:.3g}, {f1:.3g}",
        _size(row.before),
        _span(row.before.low, row.before.high),
        _size(row.after),
        _span(row.after.low, row.after.high),
        *_change_cells(row.change),
        f"{row.before.floor:.2g}, {row.after.floor:.2g}",
        f"{row.before.turns}, {row.after.turns}",
    ]
    shown = "".join(f"<td>{_shown(cell)}</td>" for cell in cells)
    return f'<tr>{shown}<td class="odd">{_shown("; ".join(row.labels))}</td></tr>'


def _change_cells(change: Change) -> tuple[str, str]:
    if change.bound in NO_CHANGE:
        return NO_CHANGE[change.bound], ""
    sign = {"at_most": "\u2264 ", "at_least": "\u2265 "}.get(change.bound, "")
    return f"{sign}{change.value_dB:+.1f}", _span(change.low_dB, change.high_dB)


def _span(low: float, high: float) -> str:
    return "" if math.isnan(low) or math.isnan(high) else f"{low:.3g} to {high:.3g}"


def _chart(rows: Sequence[OrderRow]) -> str:
    """Return bars of both windows with their intervals, one pair per order."""
    sizes = [e.high if math.isfinite(e.high) else e.amplitude for r in rows for e in _pair(r)]
    full = max([size for size in sizes if math.isfinite(size)], default=0.0)
    if full <= 0.0:
        return ""
    parts = []
    for k, row in enumerate(rows):
        for side, (end, colour) in enumerate(zip(_pair(row), ("#999", "#06c"), strict=True)):
            x = LEFT + k * 3 * BAR + side * BAR
            height = AXIS * (end.amplitude if math.isfinite(end.amplitude) else 0.0) / full
            parts.append(
                f'<rect x="{x}" y="{AXIS - height + TOP:.1f}" width="{BAR - 2}" '
                f'height="{height:.1f}" fill="{colour}"/>'
            )
            if math.isfinite(end.low):
                y = [AXIS * (1.0 - value / full) + TOP for value in (end.low, end.high)]
                middle = x + BAR / 2 - 1
                parts.append(
                    f'<path d="M{middle} {y[0]:.1f}V{y[1]:.1f}" stroke="#000" fill="none"/>'
                )
        parts.append(f'<text x="{LEFT + k * 3 * BAR}" y="{AXIS + TOP + 14}">{row.order}x</text>')
    width = LEFT + 10 + len(rows) * 3 * BAR
    return (
        f'<svg width="{width}" height="{AXIS + TOP + 20}" font-size="12">{"".join(parts)}</svg>'
        f"<p>grey: before, blue: after; the full height is {full:.3g} N</p>"
    )


def _pair(row: OrderRow) -> tuple[Estimate, Estimate]:
    return row.before, row.after


def _facts(windows: tuple[Facts, Facts]) -> str:
    rows = [("", [_shown(w.name) for w in windows])]
    rows.append(("length", [f"{w.seconds:.1f} s" for w in windows]))
    rows.append(
        ("line speed", ["{:.4g} m/s ({:.4g} to {:.4g})".format(*w.speed_m_s) for w in windows])
    )
    for roll in _names(windows, "radius_m"):
        ends = [w.radius_m.get(roll, (math.nan, math.nan)) for w in windows]
        rows.append((f"radius of {roll}", [f"{1e3 * a:.2f} to {1e3 * b:.2f} mm" for a, b in ends]))
    for name in _names(windows, "mean_N"):
        rows.append((f"mean {name}", [f"{w.mean_N.get(name, math.nan):.4g} N" for w in windows]))
    for name in _names(windows, "corrections"):
        rows.append((f"correction {name}", [_used(w, name) for w in windows]))
    states = [", ".join(f"{s} {100 * x:.1f} %" for s, x in w.states.items()) for w in windows]
    rows.append(("states", states))
    for name in _names(windows, "times_us"):
        times = [w.times_us.get(name, (math.nan,) * 4) for w in windows]
        text = ["{:.0f}, {:.0f}, {:.0f}, {:.0f}".format(*t) for t in times]
        rows.append((f"{name}: median, 99 %, 99.9 %, largest", text))
    rows.append(("ticks missed", [str(w.missed) for w in windows]))
    rows.append(("rows lost from the record", [str(w.rows_lost) for w in windows]))
    rows.append(("", ["<br>".join(_shown(x) for x in w.labels) for w in windows]))
    body = "".join(
        f"<tr><td>{_shown(name)}</td>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
        for name, cells in rows
    )
    return f"<table><tr><th></th><th>before</th><th>after</th></tr>{body}</table>"


def _names(windows: tuple[Facts, Facts], part: str) -> list[str]:
    return list(dict.fromkeys(name for w in windows for name in getattr(w, part)))


def _used(window: Facts, name: str) -> str:
    rms, largest, share = window.corrections.get(name, (math.nan,) * 3)
    unit = "N m" if name.endswith("_N_m") else "m/s"
    of_limit = "" if math.isnan(share) else f", {100 * share:.0f} % of its limit"
    return f"rms {rms:.3g}, largest {largest:.3g} {unit}{of_limit}"


def _differences(texts: Sequence[str]) -> str:
    if not texts:
        return "<p>The site files say the same.</p>"
    return "<h2>Site file</h2><ul>" + "".join(f"<li>{_shown(t)}</li>" for t in texts) + "</ul>"
