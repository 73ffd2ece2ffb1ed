"""What the words of a verdict need beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sim_plant.refine.report.tables import ShiftRow


@dataclass(frozen=True, slots=True, kw_only=True)
class RefineFacts:
    """What is known of line and records; empty where it is not.

    Attributes
    ----------
    along : bodies of the line in the order of its web.
    without : effects that were left out of the library on request.
    sample_time_s : of the records fitted; 0: not known.
    shifts : declared numbers as estimated anew.
    tolerances : of declared numbers, as their corrections count them.
    is_proposed : the site file with the AFF blocks in their places was written.
    near_steps : sentences on moments that fall on a step of a reference.
    loudest : where and when most is left on the record judged, as text.
    """

    along: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    sample_time_s: float = 0.0
    shifts: tuple[ShiftRow, ...] = ()
    tolerances: Mapping[str, float] = field(default_factory=dict)
    is_proposed: bool = False
    near_steps: tuple[str, ...] = ()
    loudest: str = ""

    @property
    def far(self) -> tuple[ShiftRow, ...]:
        """Declared numbers that are surely beyond their tolerance."""
        return tuple(row for row in self.shifts if row.is_far)


NOTHING_KNOWN = RefineFacts()
