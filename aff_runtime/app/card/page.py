"""A card as one self-contained page that prints: A4 or Letter, pages numbered, hash below each."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from html import escape

from aff_runtime.app.card.charts import bode, course, intervals
from aff_runtime.app.card.entries import Measured, RecordWindow, Signed, Typed
from aff_runtime.app.card.figures import Figure
from aff_runtime.app.card.standing import Card, Stand, StepStanding
from aff_runtime.base.printable import printable

SIZES = {"a4": "A4", "letter": "Letter"}
_HASH_ROW = 32  # hex digits of the hash in a printed row
ROUNDING = 1e-9  # a smaller value is shown as 0
STYLE = (
    "body{font:10.5pt/1.35 sans-serif;margin:1.5em;color:#111;max-width:60em}"
    "h1{font-size:16pt;margin:0 0 .3em}h2{font-size:12.5pt;margin:1.2em 0 .2em}"
    "table{border-collapse:collapse;width:100%;margin:.4em 0}"
    "td,th{padding:.12em .5em;text-align:left;border-bottom:1px solid #bbb;vertical-align:top}"
    "td.n{text-align:right;white-space:nowrap}code{font-size:8.5pt;overflow-wrap:anywhere}"
    "section{break-inside:avoid-page}thead{display:table-header-group}tr{break-inside:avoid}"
    ".fail,.again,.open,.emphasis{font-weight:bold}.fail{color:#a00}.again,.open{color:#840}"
    "svg{max-width:100%;height:auto}li{margin:.1em 0}p{margin:.3em 0}"
)
SYMBOLS = {
    Stand.PASS: "\u2713 pass",
    Stand.FAIL: "\u2717 fail",
    Stand.OPEN: "\u2026 open",
    Stand.AGAIN: "\u21bb again",
    Stand.NOT_MEASURED: "\u2014 not measured",
    Stand.NOT_APPLICABLE: "n/a",
}


def page(card: Card, size: str = "a4", remarks: Sequence[str] = ()) -> str:
    """Return the page.

    Parameters
    ----------
    size : of the paper, one of `SIZES`. ``remarks`` : on the comparison with what holds now.
    """
    title = f"{card.begun.line}: commissioning card"
    body = "\n".join(
        part
        for part in (
            f"<h1>{_shown(title)}</h1>",
            _about(card),
            *(f'<p class="emphasis">{_shown(one)}</p>' for one in remarks),
            _overview(card),
            _not_done(card),
            *(_step(one) for one in card.steps if one.measured is not None),
            _end(card),
        )
        if part
    )
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{_shown(title)}</title>'
        f"<style>{STYLE}{_paper(card.newest, size)}</style>\n<body>\n{body}\n</body></html>\n"
    )


def _paper(newest: str, size: str) -> str:
    """Return the rules of the paper; the hash is hex digits, nothing else gets into them."""
    halves = f'"{newest[:_HASH_ROW]}\\a {newest[_HASH_ROW:]}"'
    return (
        f"@page{{size:{SIZES[size]};margin:16mm 14mm 20mm;"
        f"@bottom-left{{content:{halves};font:7pt monospace;white-space:pre}}"
        '@bottom-right{content:"page " counter(page) " of " counter(pages);font:8pt sans-serif}}'
        "@media print{body{margin:0;max-width:none}}"
    )


def _shown(text: object) -> str:
    return escape(printable(str(text)))


def _about(card: Card) -> str:
    begun = card.begun
    rows = (
        ("line", begun.line),
        ("site file", begun.site),
        ("its SHA-256 when the card was begun", begun.site_sha256),
        ("its hash in the service then", begun.site_hash),
        ("runtime", begun.release),
        ("machine", begun.machine),
        ("entries, newest", f"{card.entry_count}, {card.utc}"),
    )
    cells = "".join(f"<tr><th>{_shown(a)}</th><td>{_shown(b)}</td></tr>" for a, b in rows)
    return f"<table>{cells}</table>"


def _overview(card: Card) -> str:
    head = "<tr><th>step</th><th></th><th>stands</th><th>signed</th></tr>"
    rows = "".join(
        f"<tr><td>{one.step.number}</td><td>{_shown(one.step.title)}</td>"
        f'<td class="{_class(one)}">{_shown(SYMBOLS[one.stand])}</td>'
        f"<td>{_shown(_signed_by(one))}</td></tr>"
        for one in card.steps
    )
    return f"<h2>Steps</h2><table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def _class(one: StepStanding) -> str:
    """Return the class in the page's style; of *not applicable* ``not``, which has no rule."""
    return "emphasis" if one.stand is Stand.NOT_MEASURED else str(one.stand).split(" ", 1)[0]


def _signed_by(one: StepStanding) -> str:
    if one.signed is None or one.signature_entry is None:
        return ""
    return f"{one.signed.name}, {one.signature_entry.utc}"


def unfinished(card: Card) -> Iterator[str]:
    """Yield a sentence for every step that is not passed and signed."""
    for one in card.unfinished:
        stands = str(one.stand)
        if one.stand in (Stand.PASS, Stand.NOT_APPLICABLE):
            stands = f"{stands}, not signed"
        why = [*one.why]
        if one.stand is Stand.OPEN and one.measured is not None:
            why += one.measured.result.waits_for
        yield f"step {one.step.number}, {one.step.title}: {stands}" + (
            f" ({'; '.join(why)})" if why else ""
        )


def _not_done(card: Card) -> str:
    sentences = list(unfinished(card))
    if not sentences:
        return "<h2>What is left to do</h2><p>Every step is passed and signed.</p>"
    return f"<h2>What is left to do</h2>{_list(sentences)}"


def _step(one: StepStanding) -> str:
    measurement, entry = one.measured, one.last
    assert measurement is not None
    assert entry is not None
    result = measurement.result
    parts = [
        f"<h2>{one.step.number}. {_shown(one.step.title)}: "
        f'<span class="{_class(one)}">{_shown(SYMBOLS[one.stand])}</span></h2>',
        f"<p>{_shown(one.step.measured)}; good when: {_shown(one.step.limit)}</p>",
        _paragraphs("does not apply", [measurement.reason] if measurement.reason else []),
        _paragraphs("to be done again, since it has changed", one.why),
        _figures(result.figures),
        intervals(result.figures),
        # of a response its Bode plot, of ripple since arming its course; empty for any other
        *(bode(sample) or course(sample) for sample in result.samples),
        _paragraphs("still missing", result.waits_for),
        _paragraphs("proposed, and not applied", result.proposals),
        _paragraphs("remarks", result.remarks),
        _typed(measurement.typed),
        _windows(measurement.windows),
        _rests(measurement),
        f"<p>Measured {_shown(entry.utc)} by {_shown(measurement.by)}, "
        f"{_shown(measurement.release)}; entry {entry.number} <code>{entry.sha256}</code>; "
        f"{one.earlier} earlier on this card.</p>",
        _signed(one),
    ]
    return f"<section>{''.join(parts)}</section>"


def _figures(figures: Sequence[Figure]) -> str:
    if not figures:
        return ""
    head = "<tr><th>figure</th><th>value</th><th>95 %, or error</th><th>limit</th><th></th></tr>"
    rows = "".join(
        f'<tr><td>{_shown(one.name)}</td><td class="n">{_shown(value_text(one))}</td>'
        f'<td class="n">{_shown(interval_text(one))}</td><td>{_shown(one.limit)}</td>'
        f"<td>{_good(one)}</td></tr>"
        for one in figures
    )
    return f"<table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def value_text(figure: Figure) -> str:
    """Return a value with its unit, a dash where it is none."""
    if not math.isfinite(figure.value):
        return "\u2014"
    return f"{_number(figure.value)} {figure.unit}".rstrip()


def interval_text(figure: Figure) -> str:
    """Return the interval, empty where it is not known."""
    if not (math.isfinite(figure.low) and math.isfinite(figure.high)):
        return ""
    return f"{_number(figure.low)} to {_number(figure.high)}"


def _number(value: float) -> str:
    """Return four significant digits; what rounding alone has left is 0."""
    return f"{value if abs(value) > ROUNDING else 0.0:.4g}"


def _good(figure: Figure) -> str:
    if figure.good is None:
        return "missing" if figure.is_missing else ""
    return "\u2713" if figure.good else '<span class="fail">\u2717</span>'


def _typed(values: Sequence[Typed]) -> str:
    texts = [f"{one.name} = {one.text}" for one in values]
    return _paragraphs("typed by hand", texts)


def _windows(windows: Iterable[RecordWindow]) -> str:
    texts = []
    for one in windows:
        texts.append(f"{one.folder}, {one.from_s:.10g} s to {one.to_s:.10g} s")
        texts += [f"{s.name}, first {s.size} bytes: SHA-256 {s.sha256}" for s in one.segments]
    return f"<p>record:</p><code>{_list(texts)}</code>" if texts else ""


def _rests(measurement: Measured) -> str:
    inputs = measurement.inputs
    texts = [
        f"{name} {value}"
        for name, value in (
            ("site file, hash in the service", inputs.site_hash),
            ("revision (site file, responses, shapes)", inputs.config_hash),
            ("PLC program", inputs.plc),
            ("roll", inputs.roll_id),
            ("machine", inputs.machine),
            *((f"response of {name}", digest) for name, digest in inputs.responses.items()),
            *((f"{name} started with shape", text) for name, text in inputs.shapes.items()),
        )
        if value
    ]
    return f"<p>rests on:</p><code>{_list(texts)}</code>" if texts else ""


def _signed(one: StepStanding) -> str:
    if one.signed is None or one.signature_entry is None:
        return "<p>Not signed.</p>"
    return (
        f"<p>Signed {_shown(one.signature_entry.utc)} as <b>{_shown(one.signed.name)}</b> "
        f"({_shown(one.signed.by)}): {_shown(signed_reason(one.signed))}; "
        f"entry {one.signature_entry.number} <code>{one.signature_entry.sha256}</code></p>"
    )


def signed_reason(signed: Signed) -> str:
    """Return why somebody has signed, and what could not be compared then."""
    return "; ".join((signed.reason, *signed.not_compared))


def _end(card: Card) -> str:
    return (
        f"<h2>Newest entry</h2><p><code>{card.newest}</code></p><p>`aff-runtime card verify "
        "card.jsonl --newest HASH` says whether the file still is what was printed here.</p>"
    )


def _paragraphs(title: str, texts: Sequence[str]) -> str:
    return f"<p>{_shown(title)}:</p>{_list(texts)}" if texts else ""


def _list(texts: Iterable[str]) -> str:
    return f"<ul>{''.join(f'<li>{_shown(text)}</li>' for text in texts)}</ul>"
