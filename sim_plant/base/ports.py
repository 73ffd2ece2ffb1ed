"""The port between a simulated line and whatever serves it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, runtime_checkable


class SteppedLine(Protocol):
    """A line that advances by one control sample at a time."""

    @property
    def sample_time_s(self) -> float:
        """Control sample time, s."""
        ...

    def step(self, inputs: Mapping[str, float]) -> Mapping[str, float]:
        """Advance one sample under ``inputs`` (SI) and return the measured channels (SI).

        Inputs: ``line_speed_ref_m_s``, ``tension_ref_N`` and ``aff_<roller>_m_s`` per actuated
        roller; a missing one keeps its last value (corrections start at 0, references at the
        declaration's operating point). Outputs carry the declaration's channel names
        (``unwind_tension_N``, ``unwind_angle_rad`` unwrapped, ...), sensor noise and
        quantisation included, and ``true_<name>`` twins without them for judges.
        """
        ...


@runtime_checkable
class RollChanger(Protocol):
    """A line that takes new rolls while it runs."""

    def change_rolls(self) -> None:
        """Put full rolls on at both ends, their rims at the web's speed."""
        ...


@runtime_checkable
class TravelDriver(Protocol):
    """A line with accumulators that have a drive of their own."""

    @property
    def driven_travels(self) -> tuple[str, ...]:
        """Their names; ``travel_<name>_m_s`` is an input of ``step``, 0 at the start."""
        ...


@runtime_checkable
class TorqueReader(Protocol):
    """A line that tells the torques of its drives."""

    def torque_N_m(self, roller: str) -> float:
        """Return what the drive of a roller gives now, N m; above 0 where it drives it on.

        Raises
        ------
        PlantError
            The roller has no drive.
        """
        ...


@runtime_checkable
class WebSupply(Protocol):
    """A line that tells how much web its unwind roll still holds."""

    @property
    def web_left_m(self) -> float:
        """Length of the web on the unwind roll down to its core, m; below 0 when run out."""
        ...
