"""Every law of the bench by name, each with its one setting."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from aff_runtime.core.blocks.bank import Bank
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import ActuatorLaw, Inputs
from aff_runtime.core.params import ActuatorParams, BlockParams, DriveParams, ShapeParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.core.shape.law import ShapeLaw
from aff_runtime.core.shape.profile import ShapeProfile
from benchmarks.control.lines import nominal
from benchmarks.control.lockstep import LIMIT_M_S, LawBuilder
from benchmarks.control.nominal_loop import FILM_RADII_M, nominal_loop
from benchmarks.control.printed import PrintedLaw
from benchmarks.control.rivals_blocks import AngleBlocks
from benchmarks.control.rivals_filtered import FxLms
from benchmarks.control.rivals_repetitive import Repetitive
from sim_plant.line.declared.declaration import Declaration

ORDERS = 24
FILM_MEMORY_S = 2.0
SHAPE = ShapeParams()
OWN = "shape-KF"
TUNED = json.loads((Path(__file__).parent / "tuned.json").read_text())
RIVALS = ("plain blocks", "printed (5.14)", "angle, no phase", "resonators", "FxLMS", "repetitive")


def tuning(law: str) -> str:
    """Return a law's one setting in words, for the page."""
    if law == OWN:
        return f"{ORDERS} orders and S-wrap 1x, memory {SHAPE.memory_turns:g} turns"
    found = TUNED[law]
    setting = ", ".join(f"{key} {value}" for key, value in found["setting"].items())
    return f"{setting}; best of {found['tried']} settings, ripple {found['score']:.3f} of PI alone"


def drive_of(material: str) -> DriveParams:
    """Return the unwind drive as its owner declares it."""
    return drive_in(nominal(material, 0.2032))


def drive_in(line: Declaration) -> DriveParams:
    """Return the unwind drive that a line file has."""
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
        web_leaves_rad=web_leaves_rad(line) % math.tau,
    )


def web_leaves_rad(line: Declaration) -> float:
    """Return where the web leaves the unwind, from its highest point in the sense of rotation."""
    direction = math.radians(line.spans[0].direction_deg)
    return direction - math.pi if line.rollers[0].rotation == "ccw" else -direction


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
        name="unwind",
        signal="unwind_tension_N",
        reference="tension_ref_N",
        transport_s=cycle_s,
        law="shape",
        drive=drive_of(material),
        shape=SHAPE,
        blocks=tuple(blocks),
    )


def loop_of(material: str, cycle_s: float) -> LoopModel:
    """Return P of the unwind; the film line forgets within a second."""
    if material == "film":
        return nominal_loop(
            material, cycle_s=cycle_s, memory_s=FILM_MEMORY_S, radii_m=FILM_RADII_M
        )
    return nominal_loop(material, cycle_s=cycle_s)


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
    loop = loop_of(material, cycle_s)

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


def rival(
    name: str, material: str, cycle_s: float = 0.005, setting: Mapping[str, Any] | None = None
) -> LawBuilder:
    """Return the builder of a law by its name, with its tuned setting or the one given."""
    if name == OWN:
        return shape_law(material, cycle_s)
    loop = nominal_loop(material, cycle_s=cycle_s)
    chosen = dict(TUNED[name]["setting"] if setting is None else setting)
    if name == "plain blocks":
        return plain_blocks(material, cycle_s, chosen["orders"], chosen["settle_s"])
    if name == "printed (5.14)":
        params = _plain(cycle_s, chosen["orders"])
        return lambda ph, _c: PrintedLaw(params, phases=ph, gain=chosen["gain"])
    if name == "angle, no phase":
        return lambda ph, c: AngleBlocks(ph, c, **chosen)
    if name == "resonators":
        return lambda ph, c: AngleBlocks(ph, c, loop=loop, **chosen)
    kinds: dict[str, Any] = {"FxLMS": FxLms, "repetitive": Repetitive}
    return lambda ph, c: kinds[name](ph, c, loop, **chosen)


def plain_blocks(material: str, cycle_s: float, orders: int, settle_s: float) -> LawBuilder:
    """Return a builder of the runtime's plain blocks with P as probed at 8 in, without noise."""
    params = _plain(cycle_s, orders, settle_s=settle_s)
    response = measured(nominal_loop(material, cycle_s=cycle_s), cycle_s)
    return lambda ph, c: Bank(params, phases=ph, response=response, cycle_s=c)


def _plain(cycle_s: float, orders: int, settle_s: float = 6.0) -> ActuatorParams:
    return ActuatorParams(
        name="unwind",
        signal="unwind_tension_N",
        reference="tension_ref_N",
        transport_s=cycle_s,
        blocks=(
            BlockParams(
                roll="unwind", orders=tuple(range(1, orders + 1)), settle_s=settle_s, amp_limit=0.1
            ),
        ),
    )


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
        roll="swrap_follower",
        K_ref_rad_s=20.0,
        zeta=1.1,
        inertia_kg_m2=0.35,
        tension_N=1.016 if velocity else line.operating_point.tension_N,
        torque_term=False,
        imbalance=False,
    )
    channel = "swrap_follower_speed_m_s" if velocity else "pullroll_tension_N"
    loop = nominal_loop(
        material, "swrap_follower", channel, cycle_s, 4.0 if velocity else 12.0, (0.2032,)
    )
    params = ActuatorParams(
        name="swrap_follower",
        signal=channel,
        transport_s=cycle_s,
        law="shape",
        drive=drive,
        shape=ShapeParams(signal_sd=2e-4 if velocity else 0.6),
        blocks=(
            BlockParams(
                roll="swrap_follower", orders=(1, 2, 3, 4), settle_s=6.0, amp_limit=LIMIT_M_S
            ),
        ),
    )
    return lambda phases, cycle: ShapeLaw(
        params, drive=drive, phases=phases, loop=loop, cycle_s=cycle
    )
