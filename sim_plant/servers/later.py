"""How a wire puts something off: in real time, or in the time of a plant that is stepped."""

from __future__ import annotations

import asyncio
import heapq
from collections.abc import Callable
from itertools import count
from typing import Protocol

from sim_plant.servers.plant import Plant

_TOLERANCE_S = 1e-9


class Appointment(Protocol):
    """Something put off that can still be called off."""

    def cancel(self) -> None:
        """Call it off; once it was done this does nothing."""
        ...


class Later(Protocol):
    """Puts ``then`` off by ``delay_s``."""

    def __call__(self, delay_s: float, then: Callable[[], None]) -> Appointment:
        """Return what can be called off."""
        ...


def in_real_time(delay_s: float, then: Callable[[], None]) -> Appointment:
    """Put ``then`` off by ``delay_s`` of the running loop's clock."""
    return asyncio.get_running_loop().call_later(delay_s, then)


class _Due:
    """One appointment in plant time; without ``then`` it was called off."""

    def __init__(self, then: Callable[[], None]) -> None:
        self.then: Callable[[], None] | None = then

    def cancel(self) -> None:
        self.then = None


class PlantTimers:
    """Appointments in plant time: each is kept at the end of the first sample not before it.

    Parameters
    ----------
    plant : whose samples count; what is due at one sample is done in the order of its times.
    """

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        self._order = count()
        self._due: list[tuple[float, int, _Due]] = []
        plant.observers.append(self._keep)

    def later(self, delay_s: float, then: Callable[[], None]) -> Appointment:
        """Put ``then`` off by ``delay_s`` of plant time."""
        due = _Due(then)
        heapq.heappush(self._due, (self._plant.time_s + delay_s, next(self._order), due))
        return due

    def _keep(self, plant: Plant) -> None:
        while self._due and self._due[0][0] <= plant.time_s + _TOLERANCE_S:
            _, _, due = heapq.heappop(self._due)
            if due.then is not None:
                due.then()
