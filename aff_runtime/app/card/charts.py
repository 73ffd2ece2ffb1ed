"""Charts of a card as SVG within the page: figures with their intervals, a measured response."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from html import escape

from aff_runtime.app.card.figures import Figure, Sample
from aff_runtime.base.printable import printable

ROW, LEFT, WIDE, HIGH = 18, 330, 640, 120  # pixels: height of a row, width of its name, a chart
MOST = 40  # rows
COURSE = ("time_s", "amplitude")
BODE = ("frequency_Hz", "gain", "phase_rad", "relative_error")


def intervals(figures: Sequence[Figure]) -> str:
    """Return dB figures as dots with whiskers; empty where there are fewer than two."""
    shown = [one for one in figures if one.unit == "dB" and math.isfinite(one.value)][:MOST]
    if len(shown) < 2:
        return ""
    ends = [end for one in shown for end in (one.value, one.low, one.high) if math.isfinite(end)]
    first, last = min([*ends, 0.0]), max([*ends, 1.0])
    place = _Scale(first, last, LEFT, WIDE - 20)
    parts = [f'<path d="M{place(0.0):.1f} 0V{ROW * len(shown)}" stroke="#888"/>']
    for k, one in enumerate(shown):
        y = ROW * k + ROW / 2
        parts.append(f'<text x="0" y="{y + 4}">{_text(one.name)}</text>')
        if math.isfinite(one.low) and math.isfinite(one.high):
            parts.append(
                f'<path d="M{place(one.low):.1f} {y}H{place(one.high):.1f}" stroke="#06c"/>'
            )
        parts.append(f'<circle cx="{place(one.value):.1f}" cy="{y}" r="3" fill="#06c"/>')
    return (
        f'<svg viewBox="0 0 {WIDE} {ROW * len(shown)}" font-size="11" role="img" '
        f'aria-label="reductions in dB">{"".join(parts)}</svg>'
        f"<p>reduction with its 95 % interval, {first:.0f} to {last:.0f} dB; line: 0 dB</p>"
    )


def bode(sample: Sample) -> str:
    """Return gain with its error and phase of a response; empty for any other sample."""
    if not set(BODE) <= set(sample.columns) or len(sample.rows) < 2:
        return ""
    at = [sample.columns.index(name) for name in BODE]
    rows = [tuple(row[k] for k in at) for row in sample.rows]
    if any(not math.isfinite(x) for row in rows for x in row) or min(r[0] for r in rows) <= 0.0:
        return ""
    rows = [row for row in rows if row[1] > 0.0]
    if len(rows) < 2:
        return ""
    return (
        f'<svg viewBox="0 0 {WIDE} {2 * HIGH + 40}" font-size="11" role="img" '
        f'aria-label="response">{"".join(_bode(rows))}</svg>'
        f"<p>response of {_text(sample.of)}: gain (log) with its error, phase in degrees</p>"
    )


def course(sample: Sample) -> str:
    """Return an amplitude over the time from arming on; empty for any other sample."""
    if sample.columns != COURSE or len(sample.rows) < 2:
        return ""
    times, sizes = zip(*sample.rows, strict=True)
    if not all(math.isfinite(value) for value in (*times, *sizes)):
        return ""
    x, y = _Scale(min(times), max(times), 50, WIDE - 20), _Scale(0.0, max(sizes), HIGH, 10)
    line = "L".join(f"{x(t):.1f} {y(size):.1f}" for t, size in sample.rows)
    return (
        f'<svg viewBox="0 0 {WIDE} {HIGH + 20}" font-size="11" role="img" '
        f'aria-label="ripple over time"><path d="M{line}" stroke="#06c" fill="none"/>'
        f'<path d="M{x(0.0):.1f} 10V{HIGH}" stroke="#888"/>'
        f'<text x="0" y="18">{max(sizes):.3g}</text></svg>'
        f"<p>{_text(sample.of)}: amplitude turn by turn, {min(times):.0f} s to {max(times):.0f} s "
        "from arming on</p>"
    )


def _bode(rows: Sequence[tuple[float, ...]]) -> Iterator[str]:
    low, high = math.log(rows[0][0]), math.log(rows[-1][0])
    x = _Scale(low, high, 50, WIDE - 20)
    gains = [math.log10(row[1]) for row in rows]
    gain_y = _Scale(min(gains) - 0.2, max(gains) + 0.2, HIGH, 10)
    phase_y = _Scale(-180.0, 180.0, 2 * HIGH + 10, HIGH + 20)
    for row, gain in zip(rows, gains, strict=True):
        across = x(math.log(row[0]))
        above, below = (math.log10(max(1e-3, 1.0 + s * row[3])) for s in (1.0, -1.0))
        phase = math.degrees(math.remainder(row[2], math.tau))
        yield (
            f'<path d="M{across:.1f} {gain_y(gain + above):.1f}V{gain_y(gain + below):.1f}" '
            f'stroke="#06c"/><circle cx="{across:.1f}" cy="{gain_y(gain):.1f}" r="2" fill="#06c"/>'
            f'<circle cx="{across:.1f}" cy="{phase_y(phase):.1f}" r="2" fill="#a40"/>'
        )
    for angle in (-180, -90, 0, 90, 180):
        yield f'<text x="0" y="{phase_y(angle) + 4:.1f}">{angle} deg</text>'
    for size in (min(gains), max(gains)):
        yield f'<text x="0" y="{gain_y(size) + 4:.1f}">{10.0**size:.3g}</text>'
    for frequency in (rows[0][0], rows[-1][0]):
        yield (
            f'<text x="{x(math.log(frequency)) - 15:.1f}" y="{2 * HIGH + 34}">'
            f"{frequency:.3g} Hz</text>"
        )


class _Scale:
    """From numbers to places on the paper."""

    def __init__(self, first: float, last: float, at_first: float, at_last: float) -> None:
        self._first, self._at = first, at_first
        self._per_one = (at_last - at_first) / ((last - first) or 1.0)

    def __call__(self, value: float) -> float:
        return self._at + (value - self._first) * self._per_one


def _text(text: str) -> str:
    return escape(printable(text, 56))
