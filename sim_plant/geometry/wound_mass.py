"""Mass, centre of gravity and inertia of the web wound on a core, from the roll's shape."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.shapes import Shape

_POINTS = 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class WoundMass:
    """What gravity and the drive feel of the wound web.

    Attributes
    ----------
    mass_kg : mass between core and profile, kg.
    offset_m : distance rotation centre to centre of gravity, m.
    offset_angle_rad : body angle of the centre of gravity (sense of transport), rad.
    inertia_kg_m2 : inertia about the rotation centre, kg m^2, core and shaft not included.
    """

    mass_kg: float
    offset_m: float
    offset_angle_rad: float
    inertia_kg_m2: float


@lru_cache(maxsize=64)
def wound_mass(
    shape: Shape, *, core_radius_m: float, density_kg_m3: float, width_m: float
) -> WoundMass:
    """Return mass properties of the web between a centred core and ``shape`` (source 4.38, 4.39).

    Corrections: (4.38) and (4.39) lack the width in places, call the centre of gravity C_R, and
    hold only for an origin at the rotation centre, which is what the shape is given round. The
    area integrals are taken along the profile: with normal psi and contact point x(psi),
    A = 1/2 int h rho, first moment 1/3 int x h rho, polar moment 1/4 int |x|^2 h rho.
    Of the same shape object it is taken once.

    Raises
    ------
    PlantError
        When the core does not fit inside the profile.
    """
    psi = np.linspace(0.0, 2.0 * np.pi, _POINTS, endpoint=False)
    support, slope, rho = shape.evaluate(psi)
    if core_radius_m > float(np.min(support)):
        raise PlantError(f"core radius {core_radius_m} m does not fit inside the roll's profile")
    points = (support + 1j * slope) * np.exp(1j * psi)
    weight = support * rho * (2.0 * np.pi / _POINTS)
    area = 0.5 * float(np.sum(weight)) - np.pi * core_radius_m**2
    first = complex(np.sum(points * weight)) / 3.0
    polar = 0.25 * float(np.sum(np.abs(points) ** 2 * weight)) - 0.5 * np.pi * core_radius_m**4
    per_area = density_kg_m3 * width_m
    center = first / area if area > 0.0 else 0j
    return WoundMass(
        mass_kg=per_area * area,
        offset_m=abs(center),
        offset_angle_rad=float(np.angle(center)),
        inertia_kg_m2=per_area * polar,
    )


def gravity_torque_N_m(
    mass: WoundMass, theta_rad: float, rotation: int, gravity_m_s2: float = 9.80665
) -> float:
    """Return the torque of gravity on the body, positive in the direction of transport, N m.

    -sigma m g e cos(gamma) with gamma = sigma (theta + offset angle) the global angle of the
    centre of gravity from the horizontal. Correction of (3.17) and (4.37): both write sin(theta)
    with an angle counted from elsewhere, of opposite signs, without the offset angle.
    """
    gamma = rotation * (theta_rad + mass.offset_angle_rad)
    return -rotation * mass.mass_kg * gravity_m_s2 * mass.offset_m * float(np.cos(gamma))
