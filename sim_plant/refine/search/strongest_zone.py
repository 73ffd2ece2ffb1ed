"""Where what has a frequency in time is strongest: the load cell, and the zone that it reads."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.search.unknown_event import zone_of


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Heard:
    """What channels of one record leave, in standard deviations of their noise.

    Attributes
    ----------
    names : of the channels. ``left`` : (channels, samples). ``time_s`` : (samples,).
    """

    line: Declaration
    names: Sequence[str]
    left: Array
    time_s: Array


def channels_of_zones(line: Declaration, names: Sequence[str]) -> list[int]:
    """Return which channels tell a zone: the load cells, without any all of them.

    A drive between two zones answers to both.
    """
    cells = {sensor.channel for sensor in cell_sensors(line)} & {*names} or {*names}
    return [k for k, name in enumerate(names) if name in cells]


def strongest_zone(records: Sequence[Heard], frequency_Hz: float) -> Mapping[str, str]:
    """Return ``zone`` and ``channel`` in which a line in time is strongest; empty where two are.

    Equation: D = 2/N |sum_n x_n exp(-2 pi j f t_n)|^2 per channel, added over the records; of
    noise sqrt(D) has a standard deviation of 1 in each phase. Two zones are told apart where it
    differs by more than ``zone_sd``  [own].
    """
    power: dict[str, float] = {}
    zones: dict[str, str] = {}
    for one in records:
        wave = np.exp(-2j * np.pi * frequency_Hz * one.time_s)
        for k in channels_of_zones(one.line, one.names):
            name = one.names[k]
            found = 2.0 / one.time_s.size * abs(complex(one.left[k] @ wave)) ** 2
            power[name] = power.get(name, 0.0) + found
            zones[name] = zone_of(one.line, name)
    best = max(power, key=lambda name: power[name])
    beside = max((power[n] for n in power if zones[n] != zones[best]), default=0.0)
    if math.sqrt(power[best]) - math.sqrt(beside) <= CRITERIA.search.unexplained.zone_sd:
        return {}
    return {"zone": zones[best], "channel": best}
