"""What a screen is shown of card, line and commissioner, as frozen records.

Their names and order are those of the JSON that passes through ``commission.sock``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple


@dataclass(frozen=True, slots=True, kw_only=True)
class ProofTimes:
    """How long each part of the proof takes at this speed, s.

    Attributes
    ----------
    off_s : twenty whole turns of the largest corrected roll, and the broken ones at both ends.
    on_s : the same, after it has settled.
    """

    off_s: float
    on_s: float


# --- the card ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureView:
    """One number of a measurement in words; ``good`` None: it cannot be said, or has no limit."""

    name: str
    value: str
    span: str
    limit: str
    good: bool | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentView:
    """A file of a record: ``sha256`` of its first ``size`` bytes."""

    name: str
    size: int
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class WindowView:
    """Where in a record figures come from, s of its column ``time_s``."""

    folder: str
    from_s: float
    to_s: float
    segments: tuple[SegmentView, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class EntryView:
    """The measurement that counts.

    Attributes
    ----------
    sha256 : what a signature below it names. ``by`` : who had it made. ``reason`` : why the step
        does not apply. ``waits_for`` : in sentences.
    typed : values read from displays.
    """

    number: int
    utc: str
    sha256: str
    by: str
    release: str
    reason: str
    figures: tuple[FigureView, ...]
    waits_for: tuple[str, ...]
    proposals: tuple[str, ...]
    remarks: tuple[str, ...]
    typed: tuple[str, ...]
    windows: tuple[WindowView, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SignatureView:
    """The signature below a measurement."""

    name: str
    reason: str
    by: str
    utc: str
    number: int
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StepView:
    """One step of the card.

    Attributes
    ----------
    measured, limit : what comes out, in words. ``seconds`` : of the record that are looked at.
    stand : a word of ``card.standing.Stand``; ``why`` it is to be done again.
    typed_names : what may be typed. ``earlier`` : how many measurements were made before.
    """

    number: int
    title: str
    measured: str
    limit: str
    seconds: float
    stand: str
    why: tuple[str, ...]
    typed_names: tuple[str, ...]
    earlier: int
    can_sign: bool
    entry: EntryView | None
    signed: SignatureView | None


@dataclass(frozen=True, slots=True, kw_only=True)
class CardView:
    """A whole card as it stands.

    Attributes
    ----------
    first : hash of the first entry, of no other card.
    newest : hash of the last entry, made at ``utc``. ``entries`` : how many there are.
    remarks : on the comparison with what holds now. ``undone`` : a sentence a step.
    proof : None while the line stands, or no service says its speed.
    """

    line: str
    first: str
    newest: str
    entries: int
    utc: str
    remarks: tuple[str, ...]
    undone: tuple[str, ...]
    steps: tuple[StepView, ...]
    proof: ProofTimes | None


# --- the line ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeRow:
    """What a probe sends at most to one actuator, in ``unit``.

    Attributes
    ----------
    amplitude : that the site file sets, or with ``is_chosen`` the most that is chosen.
    bound_N : by how much it may move ``signal`` beyond what that does without it, N.
    bound_share : the same as a share of the signal. None: no such bound.
    ripple : of ``signal`` at that amplitude by the last probe, ``signal_unit``; None before one.
    expected_ripple_N : of ``signal`` at most, before a first one, by what the web is and
        ``speed_m_s``; None where ``lacks`` says what would tell it.
    sent : the amplitude of the last probe.
    louder : what a louder one would send; None where all is heard, or the bound is reached.
    """

    actuator: str
    amplitude: float
    limit: float
    unit: str
    signal: str
    signal_unit: str
    ripple: float | None
    expected_ripple_N: float | None = None
    speed_m_s: float | None = None
    lacks: tuple[str, ...] = ()
    is_chosen: bool = False
    bound_N: float | None = None
    bound_share: float | None = None
    sent: float | None = None
    louder: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeView:
    """The bounds of a probe."""

    duration_s: float
    rows: tuple[ProbeRow, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveRow:
    """An identified number of a drive, SI, with its 95 % interval."""

    name: str
    value: float
    low: float
    high: float
    is_sure: bool


class PointView(NamedTuple):
    """One measured frequency of a response; a row of numbers in JSON."""

    frequency_Hz: float
    gain: float
    phase_deg: float
    error_percent: float
    coherence: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseView:
    """A measured response; ``unit`` is its gain's, speed and radius None where not known.

    ``no_drive`` says why no numbers of the drive are in it where its law waits for them, else it
    is empty. ``repeat_sigmas`` is how far it is from the one before, of the same speed and radius,
    in their stated errors, ``repeat_most`` up to where those are right; None where there was none
    before.
    """

    actuator: str
    unit: str
    measured_at: str
    speed_m_s: float | None
    radius_m: float | None
    delay_s: float
    points: tuple[PointView, ...]
    drive: tuple[DriveRow, ...]
    no_drive: str = ""
    repeat_sigmas: float | None = None
    repeat_most: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LineView:
    """The site file as it was checked; no more than its errors where it is not good.

    Attributes
    ----------
    orders, limits : facts of the site, a sentence each. ``drives`` : what is said of drives.
    stands_in : actuators on which the plain law stands in for law shape, which lacks a drive.
    """

    errors: tuple[str, ...]
    warnings: tuple[str, ...]
    drives: tuple[str, ...]
    stands_in: tuple[str, ...] = ()
    orders: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    probe: ProbeView | None = None
    proof: ProofTimes | None = None
    responses: tuple[ResponseView, ...] = ()


# --- the commissioner ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class SiteView:
    """Where the site file is, and its digest as far as it can be read."""

    path: str
    there: bool
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class NoService:
    """No service answers; ``trouble`` is why, empty where none was looked for yet."""

    answers: Literal[False] = False
    trouble: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceView:
    """How the service stands.

    Attributes
    ----------
    state : of the guard. ``heard`` : whether the PLC is. ``blocked`` : what stands against arming.
    probed : what came of the last probe.
    trying : which settings are tried, and by whom. ``tried`` : sha256 of their text; both empty
        without a try. ``trying_left_s`` : until the former ones return; below 0 where none is
        counted.
    differs : why the file is not what runs. ``learned`` : digests of what was learned.
    """

    answers: Literal[True] = True
    state: str
    heard: bool
    blocked: str
    probing: bool
    probed: str
    trying: str
    trying_left_s: float
    tried: str
    differs: tuple[str, ...]
    learned: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SaidLine:
    """A line that a job has said; ``kind`` is ``say`` or ``complain``."""

    kind: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class QuestionView:
    """What a job waits for.

    Attributes
    ----------
    name : of the question. ``default`` : taken when nothing is said; None: something must be.
    choices : words that may be answered. ``rows`` : answer and text of what may be picked.
    """

    number: int
    name: str
    text: str
    default: str | None
    choices: tuple[str, ...]
    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class JobView:
    """The job that is under way; ``step`` -1 where it is of none; for ``seconds`` by now."""

    do: str
    step: int
    said: tuple[SaidLine, ...]
    ask: QuestionView | None
    seconds: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LastJob:
    """The job that ended last; ``text`` is what became of it."""

    do: str
    step: int
    ok: bool
    text: str

    @classmethod
    def of(cls, called: str, *, text: str) -> LastJob:
        """Return one that is not done, by what people call it: ``sign 4``."""
        do, _, step = called.partition(" ")
        return cls(do=do, step=int(step) if step.isdecimal() else -1, ok=False, text=text)
