"""The verdict on records without a line declaration, and its JSON.

A schema of its own: `report.verdict.Verdict.from_json` does not read it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sim_plant.refine.report.plain import plain
from sim_plant.refine.report.verdict import VERSION, Answer, effects_word
from sim_plant.refine.without_line.free_spectral_lines import SpectralLine
from sim_plant.refine.without_line.general.catalogue import SHIFT
from sim_plant.refine.without_line.general.findings import Delay, Finding
from sim_plant.refine.without_line.general.judging import JudgedTrial
from sim_plant.refine.without_line.spectral_line_presence import ONE_SPEED
from sim_plant.refine.without_line.wording import effect_text, spectral_line_text

SCHEMA = "record-verdict/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputRms:
    """Error of one output, rms in its unit: of the declared filter, and of all that is used.

    No noise is declared without a line: there is no noise floor to compare it with.
    """

    before: float
    after: float


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputModel:
    """What explains one output in the end, and what else was tried.

    Attributes
    ----------
    filter : used in the end, as the page says it: ``41 taps, 20 ahead and 20 back``.
    fell_back : plain least squares took the place of the model chosen.
    plain_rms, chosen_rms : of plain least squares and of the model chosen, spectral lines
        left out.
    with_spectral_lines : the error after has the spectral lines taken out too; False where
        there are none, and where that would make it larger.
    tried : everything that was tried, with what it gave.
    delays : by input: how far the output is behind it by a gain alone.
    at_stamps : rms on the readings as they came, where stamps are uneven: ``declared``,
        ``plain``, ``chosen``.
    """

    filter: str
    fell_back: bool
    plain_rms: float
    chosen_rms: float
    with_spectral_lines: bool
    tried: tuple[JudgedTrial, ...]
    delays: Mapping[str, Delay]
    at_stamps: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordVerdict:
    """What the records hold beyond their declared filter.

    Attributes
    ----------
    unknown : spectral lines that the machine may make, strongest first.
    clocks : spectral lines of the recording, the excitation or the mains.
    not_claimed : what cannot be claimed, as sentences.
    residual_rms : error by output on ``holdout``, the path of a record: of the declared filter
        and of all that is used in the end.
    holdout : the record judged.
    general_effects : of the general catalogue, those that are claimed.
    models : by output.
    """

    unknown: tuple[SpectralLine, ...]
    clocks: tuple[SpectralLine, ...]
    not_claimed: tuple[str, ...]
    residual_rms: Mapping[str, OutputRms]
    holdout: str
    general_effects: tuple[Finding, ...] = ()
    models: Mapping[str, OutputModel] = field(default_factory=dict)

    @property
    def answer(self) -> Answer:
        """``unknown`` with a spectral line, ``traced`` with general effects alone, or ``nothing``.

        ``not_identifiable`` never: no place on a line is claimed.
        """
        if self.unknown:
            return "unknown"
        return "traced" if self.general_effects else "nothing"

    def to_json(self) -> str:
        """Return it with its schema, one key a line."""
        data = {
            "schema": SCHEMA,
            "version": VERSION,
            "verdict": self.answer,
            "effects": [],  # of a line alone; there for who reads both schemas
            "unknown": [_spectral_line_row(x) for x in self.unknown],
            "clocks": [{**_spectral_line_row(x), "why": x.clock} for x in self.clocks],
            "not_claimed": self.not_claimed,
            "residual_rms": {
                name: {"before": e.before, "after": e.after}
                for name, e in self.residual_rms.items()
            },
            "holdout": self.holdout,
            "general_effects": [_finding_row(x) for x in self.general_effects],
            "models": {name: _model_row(x) for name, x in self.models.items()},
        }
        return json.dumps(plain(data), indent=1) + "\n"


def _spectral_line_row(spectral: SpectralLine) -> dict[str, Any]:
    row: dict[str, Any] = {
        "class": spectral.axis,
        "coordinate": spectral.where,
        "per_record": spectral.per_record,
        "strength": spectral.chi2_reduction,
    }
    presence = spectral.presence
    if presence is not None:
        row["seen_at"] = presence.scope
        row["present"] = presence.present
        row["speeds_m_s"] = presence.speeds_m_s
        if presence.other_frequency:
            row["or_else"] = (
                {"wavenumber_1_m": presence.other_frequency}
                if spectral.axis == "time"
                else {"frequency_Hz": presence.other_frequency}
            )
        if presence.order:
            row["order"] = presence.order
            row["fundamental_1_m"] = presence.fundamental
    return row


def _finding_row(x: Finding) -> dict[str, Any]:
    return {
        "effect": x.effect,
        "output": x.output,
        "place": x.place,
        "numbers": x.numbers,
        "interval95": x.interval95,
        "rms_without": x.before_rms,
        "rms_with": x.after_rms,
        "text": x.text,
    }


def _model_row(x: OutputModel) -> dict[str, Any]:
    return {
        "filter": x.filter,
        "fell_back": x.fell_back,
        "plain_least_squares_rms": x.plain_rms,
        "chosen_rms": x.chosen_rms,
        "with_lines": x.with_spectral_lines,
        "delay_s": {
            name: {"value": d.value_s, "interval95": (d.low_s, d.high_s)}
            for name, d in x.delays.items()
        },
        "rms_at_stamps": x.at_stamps,
        "tried": [
            {
                "effect": row.effect,
                "what": row.what,
                "left_out_rms": row.left_out_rms,
                "held_out_rms": row.held_out_rms,
                "taken": row.taken,
            }
            for row in x.tried
        ],
    }


def headline(verdict: RecordVerdict) -> str:
    """Return the verdict as sentences."""
    sentences = []
    if verdict.general_effects:
        effects = "; ".join(effect_text(x) for x in verdict.general_effects)
        sentences.append(f"{effects_word(verdict.answer)}: {effects}.")
    if verdict.unknown:
        spectral_lines = "; ".join(spectral_line_text(x) for x in verdict.unknown)
        sentences.append(f"Unknown, strongest first: {spectral_lines}.")
    return " ".join(sentences) or (
        "Nothing found: what the declared filter leaves of the outputs holds no spectral line."
    )


def next_step(verdict: RecordVerdict, *, has_travel: bool) -> str:
    """Return what the reader may do now; ``has_travel``: a column is the web's absolute speed."""
    sentences = []
    is_shifted = any(x.effect == SHIFT for x in verdict.general_effects)
    if is_shifted:
        sentences.append(
            "Give all channels one clock, or take the shift out before anything else is fitted."
        )
    if any(x.presence and x.presence.scope == ONE_SPEED for x in verdict.unknown):
        sentences.append(
            "Record at another speed: what was seen at one speed only may be a frequency or a "
            "part that turns."
        )
    if verdict.unknown:
        sentences.append(
            "Look for what repeats there; the rms below says what it is worth. A line declaration "
            "(config/lines/euclid.yaml) would name the place."
        )
    elif verdict.general_effects and not is_shifted:  # beside a shift no other number is sure yet
        sentences.append("Look for it at the place named; the rms below says what it is worth.")
    if sentences:
        return " ".join(sentences)
    more = "" if has_travel else "a column with the web's absolute speed (travel_speed), or "
    return f"Nothing to do. To have rollers looked for, give {more}a line declaration."
