"""The answer to ``status`` as a frozen record: the one place of the service that knows its JSON.

The demo reads a few of its keys on its own (``sim_plant/demo/runtime_status.py``): the plant takes
the service's ``base`` words alone. ``tests/sim_plant/demo/test_runtime_status.py`` holds both
together.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from aff_runtime.app.report.block_status import BlockStatus
from aff_runtime.app.report.command_counts import CommandCount
from aff_runtime.app.report.line_facts import LineFacts
from aff_runtime.app.report.probe_facts import ProbeFacts
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RecorderReport

NOT_SAID = -1
SILENT = "SILENT"
"""In the place of a state: the control process runs and gives no tick."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Alarm:
    """The alarm that stands, as text; code 0: none."""

    code: int = 0
    name: str = ""
    text: str = ""
    action: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComingMeeting:
    """Orders of two rolls that one actuator corrects will have one frequency.

    Attributes
    ----------
    time_s : until then, at this speed. ``radius_m`` : of ``roll`` then.
    """

    actuator: str
    time_s: float
    roll: str
    order: int
    other_roll: str
    other_order: int
    radius_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Live:
    """What the newest tick says; there is none before the first.

    Attributes
    ----------
    signals : every column of the record by name, None for NaN.
    blocks : every order of every law.
    comm : outcome of the last exchange, ``SILENT`` where no fresh tick says it. ``wire`` : what is
        wrong with the wire.
    blocked_by : what stands against an armed output; ``also_blocking`` : what else does.
    meta : what the control process says of itself (versions, rights, start).
    """

    alarm: Alarm = Alarm()
    comm: str = ""
    signals: Mapping[str, float | None] = field(default_factory=dict)
    blocks: tuple[BlockStatus, ...] = ()
    wire: tuple[str, ...] = ()
    blocked_by: str = ""
    also_blocking: tuple[str, ...] = ()
    meta: RunMeta = field(default_factory=RunMeta)

    @property
    def tick(self) -> TickRow:
        """The newest tick as objects."""
        return TickRow(self.signals)


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorNote:
    """What somebody commanded on the console, and who; ``utc_s`` : wall time, s since 1970."""

    utc_s: float
    did: str
    who: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StatusAnswer:
    """How the service stands.

    Attributes
    ----------
    state : of the guard, ``STARTING`` before its first tick, ``SILENT`` where no fresh one comes.
    config_hash, site_hash : of the running configuration with what was learned, and without.
    config_differs : why the file is not what runs. ``learned`` : digests of what was learned.
    control_pid : 0 while no control process runs, `NOT_SAID` in an answer that leaves it open.
    probed : what came of the last probe; empty before one.
    trying : which other settings are tried, and by whom; empty without a try. ``tried`` : sha256
        of their text. ``trying_left_s`` : until the former ones return; `NOT_SAID` where none is
        counted.
    control_restarts : how often a control process that had died was started anew; `NOT_SAID` in
        an answer of an older service.
    audit_records : number of the newest line of the audit; `NOT_SAID` where none is kept.
    audit_ok : 1 while its chain holds and has or counts every line, else 0; `NOT_SAID` where no
        screen may do anything. ``commands`` : what was commanded since the service began.
    operators : the last commands of the console with their time, the newest last.
    probes : how good and how old the responses in force are.
    shapes : what became of shapes, as sentences. ``meeting_sentences`` : when orders of two rolls
        will meet, key ``crossings`` of the answer. ``meetings`` : the same as numbers.
    facts : what a screen needs of the site.
    live : None while there is no record yet. ``tick_age_s`` : of the tick that it is; `NOT_SAID`
        without one.
    """

    line: str
    state: str
    config_hash: str = ""
    site_hash: str = ""
    learned: tuple[str, ...] = ()
    config_differs: tuple[str, ...] = ()
    control_pid: int = 0
    probing: bool = False
    probed: str = ""
    trying: str = ""
    trying_left_s: float = NOT_SAID
    tried: str = ""
    recorder: RecorderReport | None = None
    control_restarts: int = NOT_SAID
    audit_records: int = NOT_SAID
    audit_ok: int = NOT_SAID
    commands: tuple[CommandCount, ...] = ()
    operators: tuple[OperatorNote, ...] = ()
    probes: tuple[ProbeFacts, ...] = ()
    shapes: tuple[str, ...] = ()
    meeting_sentences: tuple[str, ...] = ()
    meetings: tuple[ComingMeeting, ...] = ()
    facts: LineFacts | None = None
    tick_age_s: float = NOT_SAID
    live: Live | None = None

    @property
    def blocks(self) -> tuple[BlockStatus, ...]:
        """Every order of every law; empty before the first record."""
        return self.live.blocks if self.live is not None else ()

    @property
    def try_sentence(self) -> str:
        """How a try stands, in words; empty without one."""
        if not self.trying:
            return ""
        is_counted = self.trying_left_s >= 0.0
        left = f"{self.trying_left_s:.0f} s left, then the former return"
        return f"{self.trying}: {left if is_counted else 'not yet'}"

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON: what is live is added to the rest."""
        plain = asdict(self)
        live = plain.pop("live")
        plain["crossings"] = plain.pop("meeting_sentences")
        plain["recorder"] = plain["recorder"] or {}
        return {"ok": True, **plain, **(live or {})}


def read_answer(said: Any) -> StatusAnswer:
    """Return the record of an answer; what an older or newer service says besides is left out."""
    recorder, facts = said.get("recorder") or None, said.get("facts")
    return StatusAnswer(
        line=said.get("line", ""),
        state=said.get("state", ""),
        config_hash=said.get("config_hash", ""),
        site_hash=said.get("site_hash", ""),
        learned=tuple(said.get("learned", ())),
        config_differs=tuple(said.get("config_differs", ())),
        control_pid=said.get("control_pid", NOT_SAID),
        probing=said.get("probing", False),
        probed=said.get("probed", ""),
        trying=said.get("trying", ""),
        trying_left_s=said.get("trying_left_s", NOT_SAID),
        tried=said.get("tried", ""),
        recorder=RecorderReport.from_json(recorder) if recorder else None,
        control_restarts=said.get("control_restarts", NOT_SAID),
        audit_records=said.get("audit_records", NOT_SAID),
        audit_ok=said.get("audit_ok", NOT_SAID),
        commands=tuple(CommandCount(**one) for one in said.get("commands", ())),
        operators=tuple(OperatorNote(**one) for one in said.get("operators", ())),
        probes=tuple(ProbeFacts(**one) for one in said.get("probes", ())),
        shapes=tuple(said.get("shapes", ())),
        meeting_sentences=tuple(said.get("crossings", ())),
        meetings=tuple(ComingMeeting(**one) for one in said.get("meetings", ())),
        facts=LineFacts.from_json(facts) if facts else None,
        tick_age_s=said.get("tick_age_s", NOT_SAID),
        live=_live(said) if said.get("signals") else None,
    )


def _live(said: Any) -> Live:
    return Live(
        alarm=_alarm(said.get("alarm", {})),
        comm=said.get("comm", ""),
        signals=said["signals"],
        blocks=tuple(_block(block) for block in said.get("blocks", ())),
        wire=tuple(said.get("wire", ())),
        blocked_by=said.get("blocked_by", ""),
        also_blocking=tuple(said.get("also_blocking", ())),
        meta=RunMeta.from_json(said.get("meta", {})),
    )


def _alarm(said: Any) -> Alarm:
    return Alarm(**{one.name: said[one.name] for one in fields(Alarm) if one.name in said})


def _block(said: Any) -> BlockStatus:
    return BlockStatus(**{one.name: said.get(one.name) for one in fields(BlockStatus)})
