"""From the declaration to one true machine: every number somewhere within its tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.campaign.contact import Array, Bodies
from benchmarks.campaign.line import CORE_M, LOOP_SIGNS
from benchmarks.campaign.state import Machine

# two standard deviations, as the owner of a line knows it; relative unless a unit is named
TOLERANCE = {
    "EA_N": 0.02,
    "eta": 0.2,
    "density": 0.01,
    "thickness": 0.005,
    "wound_in": 0.01,
    "idler_inertia": 0.02,
    "friction": 0.05,
    "inertia": 0.01,
    "radius": 5e-5,
    "draw": 1e-5,
    "gain": 0.001,
    "offset_N": 0.1,
    "corner": 0.03,
    "loop": 0.005,
    "drive": 0.005,
}
IDLER_ECCENTRICITY_M = 5e-7
CENTRE_M = 3e-4


class Scatter:
    """Draws numbers within tolerance; ``size`` 0 draws the declared ones.

    The draw ``nudged`` (from 0; -1 none) comes out one standard deviation higher. ``widths`` has
    the two standard deviations of every draw so far.
    """

    def __init__(self, rng: np.random.Generator, size: float, nudged: int = -1) -> None:
        self._rng, self._size, self._nudged = rng, size, nudged
        self.widths: list[float] = []

    def near(self, value: float, kind: str) -> float:
        """Return ``value`` times a factor drawn evenly within the tolerance of its kind."""
        return value * (1.0 + self.spread(TOLERANCE[kind]))

    def spread(self, width: float) -> float:
        """Return a number drawn evenly within plus and minus ``width``."""
        more = 0.5 * width if len(self.widths) == self._nudged else 0.0
        self.widths.append(width)
        return float(self._size * width * self._rng.uniform(-1.0, 1.0)) + more


def round_bodies(line: dict[str, Any], scatter: Scatter) -> Bodies:
    """Return the bodies of a declaration as circles, a little off their places and centres."""
    rollers = line["rollers"]
    count = len(rollers)
    axes = np.array([[r["center_x_m"], r["center_y_m"]] for r in rollers])
    axes += np.array([[scatter.spread(CENTRE_M), scatter.spread(CENTRE_M)] for _ in rollers])
    off = np.array([[scatter.spread(IDLER_ECCENTRICITY_M)] * 2 for _ in rollers])
    off[:, 1] = [scatter.spread(IDLER_ECCENTRICITY_M) for _ in rollers]
    return Bodies(
        x=axes[:, 0].copy(),
        y=axes[:, 1].copy(),
        sense=np.array([1.0 if r["rotation"] == "ccw" else -1.0 for r in rollers]),
        off_x=off[:, 0].copy(),
        off_y=off[:, 1].copy(),
        polygon=np.full(count, -1, dtype=np.int64),
        points=np.zeros((0, 1, 2)),
        normals=np.zeros((0, 1, 2)),
    )


def machine_of(line: dict[str, Any], rng: np.random.Generator, size: float = 1.0) -> Machine:
    """Return a machine of this declaration with scatter of ``size`` times the tolerances."""
    return scattered(line, Scatter(rng, size))


def scattered(line: dict[str, Any], s: Scatter) -> Machine:
    """Return a machine of this declaration whose numbers ``s`` draws, always in one order."""
    rollers, web, control = line["rollers"], line["web"], line["control"]
    names = [r["name"] for r in rollers]
    idlers_share = s.spread(TOLERANCE["idler_inertia"])
    cells = [r for r in line["sensors"] if "low_pass_Hz" in r]
    cell_names = [r["roller"] for r in cells]
    loops, drives = control["tension_pi"], control["drives"]
    modulus_N = s.near(web["EA_N"], "EA_N")
    wound_N = s.near(web["wound_in_tension_N"], "wound_in")
    inertia = [
        r["inertia_kg_m2"] * (1.0 + idlers_share)
        if r["kind"] == "idler"
        else s.near(r["inertia_kg_m2"], "inertia")
        for r in rollers
    ]
    acts = [t["acts_on"] for t in loops]
    radius = _of(s.near(r["radius_m"], "radius") for r in rollers)
    driven = [names.index(d["roller"]) for d in drives]
    # a drive divides by the radius that was typed in; that of a roll is measured
    believed = [
        rollers[k]["radius_m"] / radius[k] if rollers[k]["kind"] == "driven" else 1.0
        for k in driven
    ]
    none = np.zeros(len(drives))
    flat = np.zeros(len(cells))
    return Machine(
        bodies=round_bodies(line, s),
        radius=radius,
        inertia=np.array(inertia),
        drag=_of(s.near(r["friction_constant_N_m"], "friction") for r in rollers),
        viscous=_of(s.near(r["friction_viscous_N_m_s"], "friction") for r in rollers),
        gravity_moment=np.zeros(len(rollers)),
        gravity_moment_angle=np.zeros(len(rollers)),
        web=np.array(
            [
                s.near(web["kelvin_voigt_eta_s"], "eta"),
                s.near(web["density_kg_m3"], "density"),
                s.near(web["thickness_m"], "thickness"),
                web["width_m"],
                wound_N / modulus_N,
                CORE_M,
                0.0,
                1.0,
                0.0,
                0.0,
                1.0,
            ]
        ),
        modulus=np.full(len(rollers) - 1, modulus_N),
        free=np.zeros(len(rollers) - 1),
        drive_body=_at(names, [d["roller"] for d in drives]),
        drive_inertia=_of(rollers[names.index(d["roller"])]["inertia_kg_m2"] for d in drives),
        drive_gain=_of(s.near(d["K_ref_rad_s"], "drive") for d in drives),
        drive_zeta=_of(s.near(d["zeta"], "drive") for d in drives),
        drive_draw=_of(
            control["pull_roll_draw"] + s.spread(TOLERANCE["draw"])
            if "draw" in d["speed_reference"]
            else 0.0
            for d in drives
        ),
        drive_loop=np.array(
            [acts.index(d["roller"]) if d["roller"] in acts else -1 for d in drives]
        ),
        drive_ratio=np.array(believed),
        drive_delay=np.zeros(len(drives), dtype=np.int64),
        drive_slew=none.copy(),
        drive_ramp=none.copy(),
        shaft=np.zeros((len(drives), 4)),
        encoder=none.copy(),
        encoder_angle=none.copy(),
        encoder_share=none.copy(),
        slip=np.zeros(len(rollers)),
        slip_speed=np.zeros(len(rollers)),
        ripple=np.zeros((0, 4)),
        cell_body=_at(names, cell_names),
        cell_Hz=_of(s.near(c["low_pass_Hz"], "corner") for c in cells),
        cell_gain=_of(s.near(1.0, "gain") for c in cells),
        cell_offset=_of(s.spread(TOLERANCE["offset_N"]) for c in cells),
        cell_ring_Hz=flat.copy(),
        cell_ring_damping=flat + 0.05,
        cell_unbalance=flat.copy(),
        cell_unbalance_angle=flat.copy(),
        cell_hum=flat.copy(),
        cell_hum_Hz=flat.copy(),
        cell_hum_phase=flat.copy(),
        cell_drift=flat.copy(),
        loop_cell=_at(cell_names, [t["load_cell"] for t in loops]),
        loop_gain=_of(s.near(t["gain_m_s_per_N"], "loop") for t in loops),
        loop_corner=_of(s.near(t["corner_rad_s"], "loop") for t in loops),
        loop_sign=_of(LOOP_SIGNS[t["loop"]] for t in loops),
        shake=np.zeros((0, 5)),
        gust=np.array([-1.0, 0.0]),
        axle=np.zeros(8),
        seam=np.array([-1.0, 1.0, 1.0, 0.0, 0.0]),
        change=np.zeros((0, 6)),
    )


def _of(values: Any) -> Array:
    return np.array(list(values), dtype=np.float64)


def _at(names: Sequence[str], wanted: Sequence[str]) -> Any:
    return np.array([names.index(name) for name in wanted], dtype=np.int64)
