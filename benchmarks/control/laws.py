"""Every law of the bench by name, each with its one setting."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from aff_runtime.core.bank import Bank
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import ActuatorLaw, Inputs
from aff_runtime.core.params import (
    ActuatorParams,
    BlockParams,
    DriveParams,
    LawKind,
    ShapeParams,
)
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.printed import PrintedLaw
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.core.shape_law import ShapeLaw
from aff_runtime.core.shape_profile import ShapeProfile
from benchmarks.control.lines import nominal
from benchmarks.control.lockstep import LIMIT_M_S, LawBuilder
from benchmarks.control.nominal_loop import nominal_loop
from benchmarks.control.rivals_blocks import AngleBlocks
from benchmarks.control.rivals_filtered import FxLms
from benchmarks.control.rivals_repetitive import Repetitive

ORDERS = 24
SHAPE = ShapeParams()


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """A law's name in the tables and the words for how it was tuned."""

    name: str
    tuning: str


SETTINGS = (
    Setting(name="shape-KF", tuning="24 orders and S-wrap 1x, memory 6 turns, one setting"),
    Setting(name="plain blocks", tuning="8 orders, settle 6 s, P at 8 in, not swept"),
    Setting(name="printed (5.14)", tuning="4 orders, v/R, g1 0.0005, gain not swept"),
    Setting(name="angle, no phase", tuning="4 orders, same g1, encoder angle"),
    Setting(name="resonators", tuning="8 orders, P phase, 1/|P|, 0.3 1/s, gain not swept"),
    Setting(
        name="FxLMS",
        tuning="24 orders to 14-16 Hz, same P and S-wrap, 3 turns, not swept",
    ),
    Setting(name="repetitive", tuning="angle table, inverse of P, Q 8 Hz, gain 0.4, not swept"),
)
RIVALS = tuple(s.name for s in SETTINGS[1:])


def drive_of(material: str) -> DriveParams:
    """Return the unwind drive as its owner declares it."""
    line = nominal(material, 0.2032)
    drive = line.control.drives[0]
    return DriveParams(
        roll="unwind",
        K_ref_rad_s=drive.K_ref_rad_s,
        zeta=drive.zeta,
        inertia_kg_m2=line.inertia_kg_m2.unwind_core_and_drive,
        web_density_kg_m3=line.web.density_kg_m3,
        web_width_m=line.web.width_m,
        core_radius_m=line.initial_radii_m.core,
        tension_N=line.operating_point.tension_N,
    )


def unwind_params(
    material: str, cycle_s: float, orders: int = ORDERS, swrap: bool = True
) -> ActuatorParams:
    """Return the unwind actuator of the shape law."""
    blocks = [
        BlockParams(
            roll="unwind", orders=tuple(range(1, orders + 1)), settle_s=6.0, amp_limit=LIMIT_M_S
        )
    ]
    if swrap:
        blocks.append(
            BlockParams(roll="swrap_follower", orders=(1,), settle_s=6.0, amp_limit=LIMIT_M_S)
        )
    return ActuatorParams(
        name="unwind", signal="unwind_tension_N", reference="tension_ref_N",
        transport_s=cycle_s, law=LawKind.SHAPE, drive=drive_of(material), shape=SHAPE,
        blocks=tuple(blocks),
    )  # fmt: skip


def shape_law(
    material: str,
    cycle_s: float = 0.005,
    *,
    profile: ShapeProfile | None = None,
    swrap: bool = True,
    orders: int = ORDERS,
) -> LawBuilder:
    """Return a builder of the shape law, from a saved profile when one is given."""
    params = unwind_params(material, cycle_s, orders, swrap)
    loop = nominal_loop(material, cycle_s=cycle_s)

    def build(phases: Mapping[str, RollPhase], cycle: float) -> ActuatorLaw:
        assert params.drive is not None
        law = ShapeLaw(params, drive=params.drive, phases=phases, loop=loop, cycle_s=cycle)
        if profile is not None:
            law.start_from(profile)
        return law

    return build


class Frozen:
    """A law that never learns: fixed weights, found elsewhere."""

    def __init__(self, law: ShapeLaw) -> None:
        self._law = law
        self.reset_roll = law.reset_roll
        self.weights = law.weights
        self.adopt = law.adopt
        self.objections = law.objections
        self.ripple = law.ripple
        self.telemetry = law.telemetry
        self.telemetry_names = law.telemetry_names

    def step(self, inputs: Inputs):  # type: ignore[no-untyped-def]
        """Advance with adaptation off."""
        adapt, inputs.adapt = inputs.adapt, False
        try:
            return self._law.step(inputs)
        finally:
            inputs.adapt = adapt


def oracle(material: str, cycle_s: float, profile: ShapeProfile) -> LawBuilder:
    """Return a builder of fixed weights."""
    inner = shape_law(material, cycle_s, profile=profile)

    def build(phases: Mapping[str, RollPhase], cycle: float) -> ActuatorLaw:
        law = inner(phases, cycle)
        assert isinstance(law, ShapeLaw)
        return Frozen(law)

    return build


def rival(name: str, material: str, cycle_s: float = 0.005) -> LawBuilder:
    """Return the builder of a rival by its name in ``SETTINGS``."""
    loop = nominal_loop(material, cycle_s=cycle_s)
    builders: dict[str, LawBuilder] = {
        "shape-KF": shape_law(material, cycle_s),
        "plain blocks": lambda ph, c: Bank(
            _plain(cycle_s, 8), phases=ph, response=measured(loop, cycle_s), cycle_s=c
        ),
        "printed (5.14)": lambda ph, _c: PrintedLaw(
            replace(_plain(cycle_s, 4), printed_gain=5e-4), phases=ph
        ),
        "angle, no phase": lambda ph, c: AngleBlocks(ph, c, orders=4, gain=5e-4),
        "resonators": lambda ph, c: AngleBlocks(ph, c, orders=8, gain=0.3, loop=loop),
        "FxLMS": lambda ph, c: FxLms(
            ph, c, loop,
            columns=[*(("unwind", n) for n in range(1, ORDERS + 1)), ("swrap_follower", 1)],
            turns=3.0,
        ),
        "repetitive": lambda ph, c: Repetitive(ph, c, loop, gain=0.4, q_Hz=8.0),
    }  # fmt: skip
    return builders[name]


def _plain(cycle_s: float, orders: int) -> ActuatorParams:
    return ActuatorParams(
        name="unwind", signal="unwind_tension_N", reference="tension_ref_N", transport_s=cycle_s,
        blocks=(
            BlockParams(
                roll="unwind", orders=tuple(range(1, orders + 1)), settle_s=6.0, amp_limit=0.1
            ),
        ),
    )  # fmt: skip


def measured(loop: LoopModel, cycle_s: float) -> Response:
    """Return P of a loop model at 8 in as a probe would have measured it, without noise."""
    points = []
    for frequency_Hz in np.geomspace(0.15, 20.0, 60):
        p = loop.response(float(frequency_Hz), cycle_s, 0.2032)
        points.append(
            ResponsePoint(
                frequency_Hz=float(frequency_Hz),
                gain=abs(p),
                phase_rad=float(np.angle(p)),
                relative_error=0.01,
                coherence=0.99,
            )
        )
    provenance = Provenance(actuator="unwind", signal="unwind_tension_N")
    return Response(points=points, delay_s=0.05, provenance=provenance)


def follower_law(material: str, cycle_s: float = 0.005, *, velocity: bool = False) -> LawBuilder:
    """Return the shape law on the S-wrap follower: pull-roll tension, or its own speed (5.10)."""
    line = nominal(material, 0.2032)
    drive = DriveParams(
        roll="swrap_follower", K_ref_rad_s=20.0, zeta=1.1, inertia_kg_m2=0.35,
        tension_N=1.016 if velocity else line.operating_point.tension_N,
        torque_term=False, imbalance=False,
    )  # fmt: skip
    channel = "swrap_follower_speed_m_s" if velocity else "pullroll_tension_N"
    loop = nominal_loop(
        material, "swrap_follower", channel, cycle_s, 4.0 if velocity else 12.0, (0.2032,)
    )
    params = ActuatorParams(
        name="swrap_follower", signal=channel, transport_s=cycle_s, law=LawKind.SHAPE, drive=drive,
        shape=ShapeParams(signal_sd=2e-4 if velocity else 0.6),
        blocks=(
            BlockParams(
                roll="swrap_follower", orders=(1, 2, 3, 4), settle_s=6.0, amp_limit=LIMIT_M_S
            ),
        ),
    )  # fmt: skip
    return lambda phases, cycle: ShapeLaw(
        params, drive=drive, phases=phases, loop=loop, cycle_s=cycle
    )
