"""The operator's page: rolls as polar plots in mm, and per order its benefit and its state."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from html import escape

from aff_runtime.app.report.block_status import BlockStatus
from aff_runtime.app.report.status import headline
from aff_runtime.app.report.status_answer import StatusAnswer

FEWEST_ORDERS = 3  # that a plot needs
POINTS = 360  # of an outline, one a degree
# Of a plot in pixels: its side, the radius of a round roll, the room for the largest deviation.
SIDE, ROUND, ROOM = 470, 110.0, 60.0
CENTRE = SIDE / 2
HEAD = ("order", "Hz", "mm", "deg", "out", "ripple without", "ripple now", "dB", "state", "why")
STYLE = (
    "body{font:15px sans-serif;margin:1.5em}table{border-collapse:collapse;margin:1em 0}"
    "td,th{padding:.15em .7em;text-align:right;border-bottom:1px solid #ddd}"
    "td,th{white-space:nowrap}td:last-child{white-space:normal}"
    "th:first-child,th:nth-last-child(-n+2),td:first-child,td:nth-last-child(-n+2)"
    "{text-align:left}svg text{font:12px sans-serif}"
)


def page(answer: StatusAnswer) -> str:
    """Return a self-contained HTML page of a ``status`` answer."""
    blocks = answer.blocks
    shapes = [b for b in blocks if b.law == "shape" and b.amplitude is not None]
    parts = [f"<h1>{escape(answer.line)}: {escape(headline(answer))}</h1>"]
    parts += [f"<p>next: {escape(text)}</p>" for text in answer.meeting_sentences]
    parts += [
        plot(actuator, roll, rows)
        for (actuator, roll), rows in _by_roll(shapes).items()
        if len(rows) >= FEWEST_ORDERS
    ]
    if not shapes:
        parts.append("<p>No roll is known in mm: no actuator runs law shape, or no probe yet.</p>")
    parts += _tables(blocks)
    parts += [f"<p>{escape(text)}</p>" for text in answer.shapes]
    body = "\n".join(parts)
    return (
        f'<!doctype html><meta charset="utf-8"><title>{escape(answer.line)}</title>'
        f"<style>{STYLE}</style>\n{body}\n"
    )


def _by_roll(blocks: Sequence[BlockStatus]) -> dict[tuple[str, str], list[BlockStatus]]:
    rolls: dict[tuple[str, str], list[BlockStatus]] = {}
    for block in blocks:
        if block.unit == "mm":  # an imbalance is a torque and no part of the outline
            rolls.setdefault((block.actuator, block.roll), []).append(block)
    return rolls


def outline_mm(blocks: Sequence[BlockStatus]) -> list[float]:
    """Return the deviation of the moment arm at whole degrees of the roll's angle, mm."""
    weights = [
        (b.order, cmath.rect(b.amplitude or 0.0, math.radians(_angle_deg(b)))) for b in blocks
    ]
    return [
        sum((w * cmath.exp(1j * n * math.radians(at))).real for n, w in weights)
        for at in range(POINTS)
    ]


def _angle_deg(block: BlockStatus) -> float:
    known = block.encoder_deg if block.encoder_deg is not None else block.phase_deg
    return float(known or 0.0)


def plot(actuator: str, roll: str, blocks: Sequence[BlockStatus]) -> str:
    """Return one roll as SVG, the deviation enlarged, angles counter-clockwise from the right."""
    outline = outline_mm(blocks)
    size = max(1e-3, *map(abs, outline))

    def at(degrees: float, mm: float) -> tuple[float, float]:
        radius, turn = ROUND + ROOM * mm / size, math.radians(degrees)
        return CENTRE + radius * math.cos(turn), CENTRE - radius * math.sin(turn)

    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(at, range(POINTS), outline))
    rings = ""
    for share in (-1.0, 0.0, 1.0):
        radius = ROUND + ROOM * share
        line = "#ddd" if share else "#888"
        rings += f'<circle cx="{CENTRE}" cy="{CENTRE}" r="{radius}" fill="none" stroke="{line}"/>'
        height = CENTRE - radius - 3
        rings += f'<text x="{CENTRE + 4}" y="{height}">{share * size:+.2f} mm</text>'
    marks = ""
    for degrees in (0, 90, 180, 270):
        x, y = at(degrees, 1.45 * size)
        marks += f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="middle">{degrees} deg</text>'
    sure = all(b.encoder_deg is not None for b in blocks)
    zero = "where the encoder reads zero" if sure else "where the service began to count"
    return (
        f"<h2>{escape(roll)}, as learned for {escape(actuator)}</h2>"
        f"<p>Deviation of the moment arm over the roll's angle; 0 deg is {zero}.</p>"
        f'<svg width="{SIDE}" height="{SIDE}" role="img">{rings}{marks}'
        f'<polygon points="{path}" fill="none" stroke="#06c" stroke-width="2"/></svg>'
    )


def _tables(blocks: Sequence[BlockStatus]) -> Iterator[str]:
    for actuator in dict.fromkeys(b.actuator for b in blocks):
        rows = "".join(_row(b) for b in blocks if b.actuator == actuator)
        head = "".join(f"<th>{name}</th>" for name in HEAD)
        yield f"<h2>{escape(str(actuator))}</h2><table><tr>{head}</tr>{rows}</table>"


def _row(block: BlockStatus) -> str:
    """Return one order: with law shape in mm, with the plain law in mm/s."""
    speed = block.unit == "m/s"
    unit = "mm/s" if speed else block.unit
    size = _shown(block.amplitude, 1e3 if speed else 1.0)
    share = block.out
    ripple = block.ripple_unit
    cells = (
        block.name,
        _shown(block.frequency_Hz),
        size if unit == "mm" else f"{size} {unit}",
        _shown(block.phase_deg if block.encoder_deg is None else block.encoder_deg),
        "-" if share is None else f"{100 * share:.0f} %",
        f"{_shown(block.ripple_before)} {ripple}",
        f"{_shown(block.ripple)} {ripple}",
        _shown(block.benefit_dB),
        block.state,
        block.why,
    )
    return "<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in cells) + "</tr>"


def _shown(value: float | None, factor: float = 1.0) -> str:
    return "-" if value is None else f"{value * factor + 0.0:.3g}"
