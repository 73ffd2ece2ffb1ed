"""What a served plant answers on its control socket: records, and the one place of their JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, TypeAlias


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """It was done; plant time in s: of a fault's begin, of the rolls' exchange, and now."""

    start_s: float | None = None
    change_s: float | None = None
    time_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Value:
    """One channel, true or measured, at a plant time; None where it is not a number."""

    time_s: float
    value: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """It was not done; ``error`` says why."""

    error: str


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """The last samples, oldest first: plant time, and a correction per actuator, m/s."""

    actuators: Sequence[str]
    time_s: Sequence[float]
    applied_m_s: Sequence[Sequence[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class WebReport:
    """The end of the web: how much is left, None for a line without end, and what to do."""

    left_m: float | None
    state: str
    say: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Counts:
    """What was counted since the start; ``wire`` : by the wire itself, by name."""

    scans: int
    late_samples: int
    skipped_samples: int
    watchdog_trips: int
    reads: int
    writes: int
    foreign_reads: int
    foreign_writes: int
    wire: Mapping[str, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantStatus:
    """What the plant does now; a number that is none is None.

    Attributes
    ----------
    applied_m_s, max_abs_applied_m_s : correction in force and the largest seen, by actuator.
    counts_now : whether the PLC takes the correction; ``refusal`` : why not.
    true_tension_N, measured : true tensions, and what the PLC reads, by channel.
    status : bits that are set. ``web`` : its end.
    aff : words of the runtime as the PLC has them; ``aff_bits`` : of its state.
    realtime : whether the rights were granted; ``stepped`` where time is virtual.
    """

    time_s: float
    applied_m_s: Mapping[str, float]
    max_abs_applied_m_s: Mapping[str, float]
    counts_now: bool
    refusal: str
    true_tension_N: Mapping[str, float | None]
    measured: Mapping[str, float | None]
    status: Sequence[str]
    roll_id: int
    web: WebReport
    aff: Mapping[str, int]
    aff_bits: Sequence[str]
    faults: Sequence[str]
    counts: Counts
    realtime: str

    @classmethod
    def from_json(cls, said: Any) -> PlantStatus:
        """Read ``to_json``'s values back.

        Raises
        ------
        KeyError, TypeError
            When they are no status.
        """
        own = {one.name for one in fields(Counts)}
        counts, aff = said["counts"], dict(said["aff"])
        wire = {name: count for name, count in counts.items() if name not in own}
        known = {name: count for name, count in counts.items() if name in own}
        bits = aff.pop("state_bits")
        rest = {key: said[key] for key in _PLAIN}
        return cls(
            **rest,
            web=WebReport(**said["web"]),
            aff=aff,
            aff_bits=bits,
            counts=Counts(**known, wire=wire),
        )


_NESTED = ("web", "aff", "aff_bits", "counts")
_PLAIN = tuple(one.name for one in fields(PlantStatus) if one.name not in _NESTED)
Answer: TypeAlias = Done | Value | Refused | History | PlantStatus


def to_json(answer: Answer) -> dict[str, Any]:
    """Return plain values for JSON."""
    said = asdict(answer)
    match answer:
        case Done():
            return {"ok": True, **{key: value for key, value in said.items() if value is not None}}
        case PlantStatus():
            said["aff"]["state_bits"] = said.pop("aff_bits")
            said["counts"] |= said["counts"].pop("wire")
    return said
