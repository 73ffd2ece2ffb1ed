"""Whether the machine kept both processes running while the demo measured."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.demo.runtime_status import RuntimeStatus
from sim_plant.servers.answers import PlantStatus

MOST_MISSED_TICKS = 4  # 20 ms at 5 ms: less hardly shows in twenty seconds


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """What both processes have lost to pauses of the machine since they started.

    Attributes
    ----------
    missed_ticks : grid points of the runtime's cycle without a tick.
    skipped_samples : samples of the plant that never happened.
    """

    missed_ticks: int
    skipped_samples: int

    def lost_since(self, before: Pace) -> str:
        """Return what was lost since ``before`` in words; empty when it hardly matters.

        It looks at the clockwork alone, never at the result: a window is measured again because
        the machine paused in it, not because its figures are poor.
        """
        missed = self.missed_ticks - before.missed_ticks
        skipped = self.skipped_samples - before.skipped_samples
        if missed <= MOST_MISSED_TICKS and skipped == 0:
            return ""
        return f"{missed} ticks of the runtime and {skipped} samples of the plant were lost"


def pace_of(runtime: RuntimeStatus, plant: PlantStatus) -> Pace:
    """Return the counts of the two status answers."""
    return Pace(
        missed_ticks=runtime.missed_ticks or 0, skipped_samples=plant.counts.skipped_samples
    )
