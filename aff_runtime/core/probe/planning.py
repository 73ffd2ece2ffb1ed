"""Where a probe's tones stand: beside the orders, over the band that they sweep, and below it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from aff_runtime.core.params import ActuatorParams, ProbeParams, RollParams, SiteParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.probe.excitation import log_grid, place_tones

BINS_APART = 1.5
LOW_SHARE = 0.6
LOW_PERIODS = 3.0  # of the lowest tone in what is measured


class TonePlan:
    """Chooses the tones of every probed actuator by how fast the rolls turn.

    Parameters
    ----------
    rolls : present angle, speed and radius. ``step_Hz`` : every tone is a multiple of it.
    """

    def __init__(
        self,
        site: SiteParams,
        params: ProbeParams,
        probed: Sequence[ActuatorParams],
        rolls: Mapping[str, RollPhase],
        step_Hz: float,
    ) -> None:
        self._site, self._p, self._probed = site, params, probed
        self._rolls, self._step_Hz = rolls, step_Hz
        self._measured_s = params.measured_s

    def tones_Hz(self) -> list[list[float]]:
        """Return tones per actuator, clear of all ripple and of each other.

        The tones beside the orders of every actuator find their places first: these are what its
        blocks live on. The grids for other speeds and radii share what room is left; who wants
        the fewest tones chooses first.
        """
        p = self._p
        spacing_Hz = BINS_APART / self._measured_s
        turns_Hz = self._turns_Hz()
        taken = [n * f for f in turns_Hz.values() for n in range(1, p.nuisance_orders + 1)]
        plan: list[list[float]] = [[] for _ in self._probed]
        for wanted_of in (self._beside_orders_Hz, self._grid_Hz):
            wanted = [
                wanted_of(actuator, [n * turns_Hz[roll] for roll, n in actuator.orders])
                for actuator in self._probed
            ]
            for j in sorted(range(len(plan)), key=lambda j: len(wanted[j])):
                placed = place_tones(wanted[j], taken, spacing_Hz, self._step_Hz)
                taken += placed
                plan[j] += placed
        return plan

    def _beside_orders_Hz(self, _: ActuatorParams, now_Hz: list[float]) -> list[float]:
        """Return one tone beside every order, and the extra ones the site asks for."""
        offset_Hz, highest_Hz = self._p.offset_Hz, self._p.f_max_Hz
        beside = [f + offset_Hz for f in now_Hz if f + offset_Hz <= highest_Hz]
        return [*beside, *self._p.extra_frequencies_Hz]

    def _grid_Hz(self, actuator: ActuatorParams, now_Hz: list[float]) -> list[float]:
        """Return a log grid from below the lowest order to the highest it will sweep.

        The integral time of a speed loop and the inertia show below all orders, where what a
        drive does about a correction is no more hidden by what it does about the web: for them
        some tones stand there too, where the drive turns a roll whose radius is seen.
        """
        p = self._p
        low_Hz = _below(now_Hz)
        high_Hz = min(p.f_max_Hz, max([*now_Hz, *self._swept_Hz(actuator)], default=0.0))
        grid = log_grid(low_Hz, high_Hz, p.grid_points)
        turned = next((r for r in self._site.rolls if r.name == actuator.turned_roll), None)
        if turned is None or turned.radius is None:
            return grid
        lowest_Hz = max(self._step_Hz, LOW_PERIODS / self._measured_s)
        return [*log_grid(lowest_Hz, low_Hz, p.low_points + 1)[:-1], *grid]

    def lowest_Hz(self) -> list[float]:
        """Return per probed actuator from where on its tones stand where orders lie, or will."""
        turns_Hz = self._turns_Hz()
        return [_below([n * turns_Hz[roll] for roll, n in a.orders]) for a in self._probed]

    def _turns_Hz(self) -> dict[str, float]:
        """Return how often every roll turns now."""
        return {name: abs(phase.omega_rad_s) / math.tau for name, phase in self._rolls.items()}

    def _swept_Hz(self, actuator: ActuatorParams) -> list[float]:
        """Return the highest frequency of every order: smallest radius, highest speed."""
        by_name = {roll.name: roll for roll in self._site.rolls}
        return [
            n * self._p.max_speed_m_s / (math.tau * _smallest_radius_m(by_name[roll]))
            for roll, n in actuator.orders
        ]


def _below(orders_Hz: Sequence[float]) -> float:
    return LOW_SHARE * min((f for f in orders_Hz if f > 0.0), default=0.0)


def _smallest_radius_m(roll: RollParams) -> float:
    return roll.radius_min_m if roll.radius is not None else roll.radius_m or roll.radius_min_m
