"""What a probe found of the drive itself: numbers with intervals, kept in a response file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from aff_runtime.base.errors import ConfigError

Plain = str | float | Mapping[str, float]
WIDEST = 1.7
"""High end over low end of an interval that the law can still work with: 30 % each way."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A number and its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def is_sure(self) -> bool:
        """Whether the interval is narrow enough for the law; only numbers above zero can be."""
        return self.low > 0.0 and self.high <= WIDEST * self.low

    def __str__(self) -> str:
        """Return value and interval, three digits each; the interval alone where it is wide."""
        if self.is_sure:
            return f"{self.value:.3g} ({self.low:.3g} to {self.high:.3g})"
        return f"not shown by this probe, between {self.low:.3g} and {self.high:.3g}"


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifiedDrive:
    """The drive as seen from the roll.

    Attributes
    ----------
    roll, radius_m : which roll, and its radius while it was probed.
    speed_gain_rad_s, integral_time_s : of the speed loop.
    inertia_kg_m2 : all that turns, wound web included, at ``radius_m``.
    friction_N_m_s : viscous.
    delay_s : from a snapshot to its correction at the drive.
    stiffness_N_m : of the web from this roll to the next driven one.
    misfit : squared error of the model over that which noise alone leaves; 1 when it is right.
    band_Hz, tones : up to where the model was fitted, and to how many tones.
    """

    roll: str
    radius_m: float
    speed_gain_rad_s: Estimate
    integral_time_s: Estimate
    inertia_kg_m2: Estimate
    friction_N_m_s: Estimate
    delay_s: Estimate
    stiffness_N_m: Estimate
    misfit: float
    band_Hz: float
    tones: int

    def to_plain(self) -> dict[str, Plain]:
        """Return plain values for JSON."""
        return asdict(self)

    @classmethod
    def from_plain(cls, said: Mapping[str, Plain]) -> IdentifiedDrive:
        """Read ``to_plain``'s values back.

        Raises
        ------
        ConfigError
            When they are none, or no drive can have them.
        """
        kept: dict[str, str | float | Estimate] = {}
        for entry in fields(cls):
            value = said[entry.name]
            if isinstance(value, Mapping):
                numbers = {key: float(value[key]) for key in ("value", "low", "high")}
                kept[entry.name] = _checked(entry.name, Estimate(**numbers))
            elif entry.name == "roll":
                kept[entry.name] = str(value)
            else:
                kept[entry.name] = _number(entry.name, value)
        kept["tones"] = int(_number("tones", kept["tones"]))
        return cls(**kept)  # type: ignore[arg-type]


def _number(name: str, value: Plain | Estimate) -> float:
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise ConfigError(f"{name} of the identified drive is {value!r}, expected a number")
    return float(value)


def _checked(name: str, found: Estimate) -> Estimate:
    """Return an estimate whose interval holds its value."""
    if not -math.inf < found.low <= found.value <= found.high < math.inf:
        raise ConfigError(f"{name} of the identified drive is {found}, expected low, value, high")
    return found
