"""How good and how old the responses in force are, as numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache

from aff_runtime.base.errors import ConfigError
from aff_runtime.core.response import Response


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeFacts:
    """One measured response.

    Attributes
    ----------
    measured_utc_s : when, s since 1970; None where the file does not say.
    coherence_lowest : of all its points, 0 to 1.
    phase_error_highest_rad : largest bound of the error of arg P at its points, rad.
    """

    actuator: str
    measured_utc_s: float | None
    coherence_lowest: float
    phase_error_highest_rad: float


def probes_of(responses: Mapping[str, str]) -> Iterator[ProbeFacts]:
    """Yield the facts of every response, texts of response files by actuator."""
    for actuator, text in responses.items():
        found = _facts(actuator, text)
        if found is not None:
            yield found


@lru_cache(maxsize=32)
def _facts(actuator: str, text: str) -> ProbeFacts | None:
    """Return the facts of one response file; None of what is none. Asked twice a second."""
    try:
        response = Response.from_json(text)
    except ConfigError:
        return None
    bounds = (response.phase_error_bound_rad(point.frequency_Hz) for point in response.points)
    return ProbeFacts(
        actuator=actuator,
        measured_utc_s=_utc_s(response.provenance.measured_at),
        coherence_lowest=min(point.coherence for point in response.points),
        phase_error_highest_rad=max(bounds),
    )


def _utc_s(text: str) -> float | None:
    """Return a time in ISO 8601, of UTC where it names no zone; None of what is none."""
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        return None
    return (found if found.tzinfo is not None else found.replace(tzinfo=UTC)).timestamp()
