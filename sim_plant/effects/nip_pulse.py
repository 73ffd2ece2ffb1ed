"""A nip roller that presses unevenly on its driven roller, once per turn of its own."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import DRIVEN, RIPPLE, LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.signatures import once_per_turn_of
from sim_plant.effects.phasor import amplitude, angle, component, phasor

PAIR = Quadrature(
    cos="cos_N", sin="sin_N", amplitude="amplitude_N", angle="angle_rad", against=True
)
TRIED_RADII_M = (0.03, 0.04, 0.05, 0.06, 0.075)
"""Nip rollers are made in these; ground to 0.1 mm they begin within a third of a turn in 60 m."""


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Let the force of a nip on drive ``place`` vary by f(psi), psi = theta R / r its own angle.

    A cover that is pressed by F and rolls gives back less than it takes: F acts the lever b ahead
    of the line of centres, on either roller. Moments about the axis of the nip roller, which
    nothing else turns: S r = F b, with S the pull between both; about that of the driven roller:
    M = F b + S R. So F = F0 + f_c cos psi + f_s sin psi brakes the drive by

        M = b (1 + R / r) (F0 + f_c cos psi + f_s sin psi)

    [own; rolling resistance as a lever of the normal force]. What F0 does is friction and stands
    in the declared one; f fills a ripple term of the drive, at R / r per turn. Only the product
    of lever and force is told, so the lever is assumed. Not modelled: the web's own gain of speed
    in the nip, for no slot speeds it up on both sides of a roller at once.
    """
    force_N = phasor(parameters, PAIR)
    if force_N == 0.0:
        return arrays
    body = arrays.bodies[int(arrays.drives["body"][place])]
    if int(body["kind"]) != DRIVEN:
        raise PlantError("nip_pulse.location: on a roll the ratio changes; name a driven roller")
    nip_radius_m = float(parameters["nip_radius_m"])
    if nip_radius_m <= 0.0:
        raise PlantError(f"nip_pulse.nip_radius_m: read {nip_radius_m:g}; expected more than 0")
    ratio = float(body["radius_m"]) / nip_radius_m
    brake_N_m = float(parameters["lever_m"]) * (1.0 + ratio) * force_N
    row = np.zeros(1, RIPPLE)
    row["drive"], row["order"] = place, ratio
    row["cos_N_m"], row["sin_N_m"] = -brake_N_m.real, -brake_N_m.imag
    return arrays._replace(ripples=np.concatenate((arrays.ripples, row)))


def experiment(place: str, _other: Effect, there: str) -> str:
    """Return what tells the nip from anything else at its roller."""
    if place != there:
        return ""
    return f"open the nip of {place} and record again: the line goes only if the nip makes it"


EFFECT = Effect(
    name="nip_pulse",
    place="drive",
    candidates="driven",
    accepts={
        "nip_radius_m": Parameter(
            default=0.05,
            unit="m",
            typical=0.05,
            low=0.01,
            high=0.5,
            role="shape",
            step=2e-6,
            tries=TRIED_RADII_M,
        ),
        "lever_m": Parameter(
            default=1e-3, unit="m", typical=1e-3, low=1e-5, high=0.02, role="option", tries=(1e-3,)
        ),
        "cos_N": component("N", 30.0, 5000.0),
        "sin_N": component("N", 30.0, 5000.0),
        "amplitude_N": amplitude("N", 30.0, 5000.0),
        "angle_rad": angle(),
    },
    fitted=("cos_N", "sin_N", "nip_radius_m"),
    quadratures=(PAIR,),
    apply=apply,
    text="a nip roller presses unevenly: its driven roller is braked once per turn of the nip",
    shows=once_per_turn_of("nip_radius_m"),
    remedy="put a dial gauge on the nip roller of {place}, look at cover and closing cylinders",
    experiment=experiment,
)
