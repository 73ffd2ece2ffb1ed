"""The answer to ``status`` as a frozen record: the one place that knows its JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from aff_runtime.app.report.block_status import BlockStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class Alarm:
    """The alarm that stands, in words; code 0: none."""

    code: int = 0
    name: str = ""
    text: str = ""
    action: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderReport:
    """How recording goes; rows count from the beginning of its run folder."""

    folder: str = ""
    rows: int = 0
    rows_lost: int = 0
    ring_overruns: int = 0
    error: str = ""
    alive: bool = False

    @property
    def lost(self) -> int:
        """Rows that are in no file."""
        return self.rows_lost + self.ring_overruns


@dataclass(frozen=True, slots=True, kw_only=True)
class Live:
    """What the newest tick says; there is none before the first.

    Attributes
    ----------
    signals : every column of the record by name, None for NaN.
    blocks : every order of every law.
    comm : outcome of the last exchange. ``wire`` : what ails the wire.
    meta : what the control process says of itself (versions, rights, start).
    """

    alarm: Alarm = Alarm()
    comm: str = ""
    signals: Mapping[str, float | None] = field(default_factory=dict)
    blocks: tuple[BlockStatus, ...] = ()
    wire: tuple[str, ...] = ()
    blocked_by: str = ""
    meta: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class StatusAnswer:
    """How the service stands.

    Attributes
    ----------
    state : of the guard, or ``STARTING``.
    config_hash, site_hash : of the running configuration with what was learned, and without.
    config_differs : why the file is not what runs. ``learned`` : digests of what was learned.
    shapes, crossings : what became of shapes; when orders of two rolls will meet.
    live : None while there is no record yet.
    """

    line: str
    state: str
    config_hash: str = ""
    site_hash: str = ""
    learned: tuple[str, ...] = ()
    config_differs: tuple[str, ...] = ()
    control_pid: int = 0
    probing: bool = False
    recorder: RecorderReport | None = None
    shapes: tuple[str, ...] = ()
    crossings: tuple[str, ...] = ()
    live: Live | None = None

    @property
    def blocks(self) -> tuple[BlockStatus, ...]:
        """Every order of every law; empty before the first record."""
        return self.live.blocks if self.live is not None else ()

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON: what is live stands beside the rest."""
        found = asdict(self)
        live = found.pop("live")
        found["recorder"] = found["recorder"] or {}
        return {"ok": True, **found, **(live or {})}


def read_answer(said: Mapping[str, Any]) -> StatusAnswer:
    """Return the record of an answer; what an older or newer service says besides is left out."""
    recorder = said.get("recorder") or None
    live = None
    if said.get("signals"):
        live = Live(
            alarm=Alarm(**_known(Alarm, said.get("alarm", {}))),
            blocks=tuple(_block(block) for block in said.get("blocks", ())),
            wire=tuple(said.get("wire", ())),
            **{k: said[k] for k in ("comm", "signals", "blocked_by", "meta") if k in said},
        )
    told: dict[str, Any] = {
        name: tuple(said.get(name, ()))
        for name in ("learned", "config_differs", "shapes", "crossings")
    }
    plain = ("line", "state", "config_hash", "site_hash", "control_pid", "probing")
    told |= {name: said[name] for name in plain if name in said}
    report = RecorderReport(**_known(RecorderReport, recorder)) if recorder else None
    return StatusAnswer(**told, recorder=report, live=live)


def recorder_report(said: Mapping[str, Any], *, alive: bool) -> RecorderReport:
    """Return the report that a recorder has written."""
    return RecorderReport(**{**_known(RecorderReport, said), "alive": alive})


def _known(kind: Any, said: Mapping[str, Any]) -> dict[str, Any]:
    names = {one.name for one in fields(kind)}
    return {name: value for name, value in said.items() if name in names}


def _block(said: Mapping[str, Any]) -> BlockStatus:
    return BlockStatus(**{one.name: said.get(one.name) for one in fields(BlockStatus)})  # type: ignore[arg-type]
