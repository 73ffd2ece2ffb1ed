"""The verdict on records without a line declaration, and version 1 of it as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sim_plant.refine.report.plain import plain
from sim_plant.refine.report.verdict import VERSION, ChannelError, rms_rows
from sim_plant.refine.report.wording import coordinate_text
from sim_plant.refine.without_line.free_lines import SpectralLine


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordVerdict:
    """What lines the records hold.

    Attributes
    ----------
    unknown : lines that the machine may make, strongest first.
    clocks : lines of the recording, the excitation or the mains.
    not_claimed : what cannot be claimed, as sentences.
    residual_rms : error by output on ``holdout``, the path of a record.
    """

    unknown: tuple[SpectralLine, ...]
    clocks: tuple[SpectralLine, ...]
    not_claimed: tuple[str, ...]
    residual_rms: Mapping[str, ChannelError]
    holdout: str

    @property
    def word(self) -> str:
        """Whether there is a line that nothing explains: ``unknown``, else ``nothing``."""
        return "unknown" if self.unknown else "nothing"

    def to_json(self) -> str:
        """Return version 1, one key a line."""
        data = {
            "version": VERSION,
            "verdict": self.word,
            "effects": [],
            "unknown": [_row(x) for x in self.unknown],
            "clocks": [{**_row(x), "why": x.clock} for x in self.clocks],
            "not_claimed": self.not_claimed,
            "residual_rms": rms_rows(self.residual_rms),
            "holdout": self.holdout,
        }
        return json.dumps(plain(data), indent=1) + "\n"


def _row(spectral: SpectralLine) -> dict[str, Any]:
    return {
        "class": spectral.kind,
        "coordinate": spectral.where,
        "per_record": spectral.per_record,
        "strength": spectral.strength,
    }


def headline(verdict: RecordVerdict) -> str:
    """Return the verdict as sentences."""
    if not verdict.unknown:
        return "Nothing found: what the declared filter leaves of the outputs holds no line."
    said = [coordinate_text(x.kind, x.where) for x in verdict.unknown]
    return f"Unknown, strongest first: {'; '.join(said)}."


def next_step(verdict: RecordVerdict, *, travel: bool) -> str:
    """Return what the reader may do now; ``travel``: a column is the web's absolute speed."""
    if verdict.unknown:
        return (
            "Look for what turns or swings so; the rms below says what it is worth. A line "
            "declaration (config/lines/euclid.yaml) would name the place."
        )
    more = "" if travel else "a column with the web's absolute speed (travel_speed), or "
    return f"Nothing to do. To have rollers looked for, give {more}a line declaration."
