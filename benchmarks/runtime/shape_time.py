"""Time of the shape law's tick, by numpy and by the binary in turns: back to back and paced."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from aff_runtime.core.compiled.binary import COMPILED, NUMPY, VARIABLE, chosen
from aff_runtime.core.impulse import from_taps
from aff_runtime.core.law import Inputs
from aff_runtime.core.params import ActuatorParams, BlockParams, DriveParams
from aff_runtime.core.phase import Quality, RollPhase
from aff_runtime.core.shape.law import ShapeLaw
from benchmarks.runtime.facts import FactRow, Section, quantiles_us, timing_row
from benchmarks.runtime.paced import PERIOD_NS, in_child

CYCLE_S = PERIOD_NS * 1e-9
ORDERS = (16, 24)
ROUNDS = 3
TAPS = 800
GAIN, KEEP = 20.0, math.exp(-1.0 / 60.0)  # the line: of the first order, N per m/s and tick
DRIVE = DriveParams(roll="unwind", K_ref_rad_s=15.0, zeta=1.1, inertia_kg_m2=0.4, tension_N=90.0)


@dataclass(slots=True)
class Turning:
    """A roll that turns steadily, as a law sees it."""

    omega_rad_s: float
    radius_m: float
    theta_rad: float = 0.0
    quality: Quality = Quality.GOOD

    def lead(self, lead_s: float) -> float:
        """Return its angle when a command acts, rad."""
        return self.theta_rad + self.omega_rad_s * lead_s


def shape_law(orders: int, rolls: Mapping[str, Turning]) -> ShapeLaw:
    """Return a law of 1x to ``orders`` of the unwind, its imbalance, and S-wrap 1x."""
    blocks = [
        BlockParams(
            roll="unwind", orders=tuple(range(1, orders + 1)), settle_s=8.0, amp_limit=0.3
        ),
        BlockParams(roll="swrap", orders=(1,), settle_s=8.0, amp_limit=0.3),
    ]
    params = ActuatorParams(
        name="unwind", signal="tension_N", law="shape", drive=DRIVE, blocks=tuple(blocks)
    )
    loop = from_taps((0.2,), [GAIN * np.power(KEEP, np.arange(TAPS, dtype=np.float64))])
    phases = cast("Mapping[str, RollPhase]", rolls)
    return ShapeLaw(params, drive=DRIVE, phases=phases, loop=loop, cycle_s=CYCLE_S)


Work = Callable[[int], None]


def shape_work(orders: int) -> tuple[ShapeLaw, Work, Work]:
    """Return a law, one tick of a line that answers it, and one of the law, which learns."""
    rolls = {"unwind": Turning(5.0, 0.2), "swrap": Turning(5.0 * 0.2 / 0.09, 0.09)}
    law, given = shape_law(orders, rolls), Inputs()
    given.dt_s, given.fresh, given.adapt = CYCLE_S, True, True
    given.applied_ratio = given.limit_ratio = 1.0
    given.reference, given.line_speed_m_s = 90.0, 1.0
    corrected_N = sent_m_s = 0.0

    def line(_tick: int) -> None:
        nonlocal corrected_N
        for roll in rolls.values():
            roll.theta_rad += roll.omega_rad_s * CYCLE_S
        corrected_N = KEEP * corrected_N + GAIN * sent_m_s
        given.signal = 90.0 + math.cos(rolls["unwind"].theta_rad) + corrected_N

    def step(_tick: int) -> None:
        nonlocal sent_m_s
        sent_m_s = law.step(given).value

    return law, line, step


def shape_time(seconds: float) -> list[Section]:
    """Measure each for ``seconds``, numpy and the binary in turns."""
    ways = (NUMPY, COMPILED) if chosen() is not None else (NUMPY,)
    sections = []
    for kind, title in (("shape-hot", "back to back"), ("shape", "paced at 5 ms")):
        found: dict[tuple[str, int], list[int]] = {}
        for _ in range(ROUNDS):
            for orders in ORDERS:
                for way in ways:
                    took = in_child(kind, str(orders), str(seconds / ROUNDS), **{VARIABLE: way})
                    found.setdefault((way, orders), []).extend(took["work_ns"])
        rows = [timing_row(f"{n} orders by {way}", ns) for (way, n), ns in found.items()]
        sections.append(
            Section(
                title=f"Tick of the shape law, {title}",
                note=f"{seconds:g} s each in {ROUNDS} turns, the law alone, {TAPS} taps; S-wrap "
                "1x and imbalance besides; everything adapts.",
                rows=(*rows, *ratios(found)),
            )
        )
    return sections


def ratios(found: Mapping[tuple[str, int], list[int]]) -> list[FactRow]:
    """Return numpy over binary for each number of orders, and more orders over fewer."""
    rows = []
    for n in ORDERS if (COMPILED, ORDERS[0]) in found else ():
        one, other = (quantiles_us(found[way, n]) for way in (NUMPY, COMPILED))
        value = f"p50 {one[0] / other[0]:.1f}, p99 {one[1] / other[1]:.1f}"
        rows.append(FactRow(name=f"{n} orders", value=value, remark="numpy over binary"))
    few, many = ORDERS
    for way in dict.fromkeys(way for way, _ in found):
        more, fewer = (quantiles_us(found[way, n])[0] for n in (many, few))
        remark = f"{many} orders over {few}, by {way}"
        rows.append(FactRow(name="p50", value=f"{more / fewer:.2f}", remark=remark))
    return rows
