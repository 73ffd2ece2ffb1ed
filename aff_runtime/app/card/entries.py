"""The three kinds of entry as frozen records: begun, measured, signed; here alone their JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from aff_runtime.app.card.chain import Chain, Link
from aff_runtime.app.card.fields import Fields, plain
from aff_runtime.app.card.figures import Figure, Sample, StepResult, Verdict
from aff_runtime.base.errors import ConfigError

BEGUN, MEASURED, SIGNED = "begun", "measured", "signed"


@dataclass(frozen=True, slots=True, kw_only=True)
class Begun:
    """What the card is of.

    Attributes
    ----------
    site : path of the site file; ``site_sha256`` : of its text then.
    site_hash : of what it says. ``release`` : of the runtime. ``machine`` : as ``uname`` names it.
    """

    line: str
    site: str
    site_sha256: str
    site_hash: str
    release: str
    machine: str


UNKNOWN = "unknown"
"""In place of a response's digest: the record does not say which one ran."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Inputs:
    """What a measurement rests on; empty where it is not known.

    Attributes
    ----------
    site_hash : of what the site file says. ``config_hash`` : the revision, with what was learned.
    machine : the one that this was measured on, or is looked at on.
    parts : SHA-256 of each part of the site file by its name, see `site_parts`; empty in an entry
        of an older release.
    shapes : short digest of the learned shape that the service started with, by actuator; stated
        and never compared, as is ``config_hash``.
    plc : version of the PLC's program, typed. ``roll_id`` : the PLC's counter of rolls.
    responses : SHA-256 of the measured response by actuator; its beginning where a record says
        no more, and ``UNKNOWN`` where it says nothing.
    """

    site_hash: str = ""
    config_hash: str = ""
    plc: str = ""
    roll_id: str = ""
    responses: Mapping[str, str] = field(default_factory=dict)
    machine: str = ""
    parts: Mapping[str, str] = field(default_factory=dict)
    shapes: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """A file of a record as far as it was written then: ``sha256`` of its first ``size`` bytes."""

    name: str
    size: int
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordWindow:
    """Where in a record the figures come from; times are those of its column ``time_s``, s."""

    folder: str
    from_s: float
    to_s: float
    segments: tuple[Segment, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Typed:
    """What a person read from a display: SI ``number`` with ``unit``, NaN for a word."""

    name: str
    text: str
    number: float
    unit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """One measurement of a step.

    Attributes
    ----------
    reason : why the step does not apply. ``by`` : who ran the command, by the kernel.
    """

    step: int
    verdict: Verdict
    result: StepResult
    inputs: Inputs
    windows: tuple[RecordWindow, ...] = ()
    typed: tuple[Typed, ...] = ()
    reason: str = ""
    by: str = ""
    release: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Signed:
    """A signature below one measurement, which ``measured`` names by its hash.

    Attributes
    ----------
    not_compared : what was not known then of what the step rests on, in sentences.
    """

    step: int
    measured: str
    name: str
    reason: str
    by: str = ""
    not_compared: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CardEntry:
    """One entry of the chain, and what it holds."""

    number: int
    utc: str
    sha256: str
    content: Begun | Measured | Signed


def entries_of(chain: Chain) -> tuple[CardEntry, ...]:
    """Return what a chain that holds says.

    Raises
    ------
    ConfigError
        An entry is none of this release; the message says which, and where.
    """
    entries = tuple(
        CardEntry(number=link.number, utc=link.utc, sha256=link.sha256, content=_content(link))
        for link in chain.links
    )
    begun = [entry for entry in entries if isinstance(entry.content, Begun)]
    if not entries or begun != [entries[0]]:
        raise ConfigError("entry 1: a card begins with what it is of, once; no card of ours")
    return entries


def read_back(kind: str, body: Any) -> Begun | Measured | Signed:
    """Return what a body says.

    Raises
    ------
    ConfigError
        It is none of this release.
    """
    return _content(Link(number=0, utc="", kind=kind, body=body, sha256=""))


def _content(link: Link) -> Begun | Measured | Signed:
    fields = Fields(link.body, f"entry {link.number}")
    if link.kind == BEGUN:
        names = ("line", "site", "site_sha256", "site_hash", "release", "machine")
        return Begun(**{name: fields.text(name) for name in names})
    if link.kind == MEASURED:
        return _measured(fields)
    if link.kind == SIGNED:
        below = ("measured", "name", "reason", "by")
        return Signed(
            step=fields.whole("step"),
            not_compared=fields.texts("not_compared"),
            **{name: fields.text(name) for name in below},
        )
    raise ConfigError(f"entry {link.number}: of a kind that this release does not know")


def _measured(fields: Fields) -> Measured:
    try:
        verdict = Verdict(fields.text("verdict"))
    except ValueError:
        raise ConfigError(f"entry: {fields.text('verdict')!r} is no verdict of a step") from None
    return Measured(
        step=fields.whole("step"),
        verdict=verdict,
        result=StepResult(
            figures=fields.each("figures", _figure),
            remarks=fields.texts("remarks"),
            proposals=fields.texts("proposals"),
            samples=fields.each("samples", _sample),
            missing=fields.texts("missing"),
        ),
        inputs=_inputs(fields.inner("inputs")),
        windows=fields.each("windows", _window),
        typed=fields.each("typed", _typed),
        reason=fields.text("reason"),
        by=fields.text("by"),
        release=fields.text("release"),
    )


def _figure(fields: Fields) -> Figure:
    return Figure(
        name=fields.text("name"),
        value=fields.number("value"),
        unit=fields.text("unit"),
        low=fields.number("low"),
        high=fields.number("high"),
        limit=fields.text("limit"),
        good=fields.flag("good"),
        needed=fields.flag("needed") is not False,
    )


def _sample(fields: Fields) -> Sample:
    sample = Sample(
        kind=fields.text("kind"),
        of=fields.text("of"),
        names=fields.texts("names"),
        numbers=fields.numbers("numbers"),
        columns=fields.texts("columns"),
        rows=fields.table("rows"),
    )
    if len(sample.names) != len(sample.numbers) or any(
        len(row) != len(sample.columns) for row in sample.rows
    ):
        raise ConfigError("entry: a sample's names and numbers are not alike; no card of ours")
    return sample


def _inputs(fields: Fields) -> Inputs:
    return Inputs(
        site_hash=fields.text("site_hash"),
        config_hash=fields.text("config_hash"),
        plc=fields.text("plc"),
        roll_id=fields.text("roll_id"),
        responses=fields.named("responses"),
        machine=fields.text("machine"),
        parts=fields.named("parts"),
        shapes=fields.named("shapes"),
    )


def _window(fields: Fields) -> RecordWindow:
    return RecordWindow(
        folder=fields.text("folder"),
        from_s=fields.number("from_s"),
        to_s=fields.number("to_s"),
        segments=fields.each(
            "segments",
            lambda one: Segment(
                name=one.text("name"), size=one.whole("size"), sha256=one.text("sha256")
            ),
        ),
    )


def _typed(fields: Fields) -> Typed:
    return Typed(
        name=fields.text("name"),
        text=fields.text("text"),
        number=fields.number("number"),
        unit=fields.text("unit"),
    )


def as_plain(value: Any) -> Any:
    """Return a record as plain values for an entry; a number that is none is null."""
    if hasattr(value, "__dataclass_fields__"):
        row = {name: as_plain(getattr(value, name)) for name in value.__dataclass_fields__}
        result = row.pop("result", {}) if isinstance(value, Measured) else {}
        return {**row, **result}
    if isinstance(value, Mapping):
        return {str(key): as_plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [as_plain(inner) for inner in value]
    if isinstance(value, float):
        return plain(value)
    return str(value) if isinstance(value, Verdict) else value
