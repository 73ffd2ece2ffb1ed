"""Declared lines of the bench: material, roll radius, what is wrong with them, what is hidden."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from sim_plant.line.declared.declaration import Declaration, EffectEntry, LoadCell, SpanEntry
from sim_plant.line.reading.load import load_declaration

SPIKE_READINGS = 400
ROOT = Path(__file__).resolve().parents[2]
EUCLID = ROOT / "config" / "lines" / "euclid.yaml"
FILM = ROOT / "config" / "lines" / "film.yaml"
INCH_M = 0.0254
FPM_M_S = 0.3048 / 60.0

# Found by scanning P(jw) of this line; see docs/notes/polyethylene-and-shape-weights.md
POLYETHYLENE = {"EA_N": 3960.0, "density_kg_m3": 920.0}
SHAPES = {"flat": 0.012, "bulge": 0.005, "asym": 0.006}
FILM_SHARE = 0.25  # of these sizes: a roll of film is rounder
SHAPE_ANGLE_RAD = 0.7
LEAD_ANGLE_RAD = 2.6
FOLLOWER_ANGLE_RAD = 1.9


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """What differs on the line from what its declaration says, without anyone telling the law."""

    delay_s: float = 0.0
    cell_Hz: float | None = None
    EA_ratio: float = 1.0
    radius_tag_ratio: float = 1.0
    wound_in_ratio: float = 1.0
    word_bits: int | None = None
    spike_N: float = 0.0  # on every ``SPIKE_READINGS``-th reading of the unwind's cell


ALL_FIVE = Hidden(
    delay_s=0.05, cell_Hz=3.0, EA_ratio=0.7, radius_tag_ratio=1.02, wound_in_ratio=0.5
)


def with_radius(line: Declaration, radius_m: float) -> Declaration:
    """Return the line with another unwind radius; length and direction of its span re-derived.

    The common tangent of two circles at signed radii: n.(C_B - C_A) = -(s_B R_B - s_A R_A).
    """
    roll = line.rollers[0].model_copy(update={"radius_m": radius_m})
    after = line.rollers[1]
    dx, dy = after.center_x_m - roll.center_x_m, after.center_y_m - roll.center_y_m
    reach = _signed(after.rotation) * after.radius_m - _signed(roll.rotation) * radius_m
    distance = math.hypot(dx, dy)
    span = SpanEntry(
        start=roll.name,
        end=after.name,
        length_m=math.sqrt(distance**2 - reach**2),
        direction_deg=math.degrees(math.atan2(dy, dx) - math.asin(reach / distance)),
    )
    return line.model_copy(
        update={
            "rollers": (roll, *line.rollers[1:]),
            "spans": (span, *line.spans[1:]),
            "initial_radii_m": line.initial_radii_m.model_copy(update={"unwind": radius_m}),
        }
    )


def _signed(rotation: str) -> float:
    return 1.0 if rotation == "ccw" else -1.0


def nominal(material: str, radius_m: float) -> Declaration:
    """Return the line as its owner declares it: no effects, nothing hidden."""
    line = load_declaration(FILM if material == "film" else EUCLID)
    if material == "pe":
        line = line.model_copy(update={"web": line.web.model_copy(update=POLYETHYLENE)})
    return with_radius(line, radius_m)


def spoilt(
    line: Declaration,
    *,
    shape: str | None,
    lead_m: float,
    follower_m: float,
    gravity: float = 1.0,
    share: float = 1.0,
) -> Declaration:
    """Return the line with an out-of-round unwind roll and eccentric S-wrap rollers."""
    effects: list[EffectEntry] = []
    if shape is not None:
        effects.append(
            EffectEntry(
                effect="out_of_round_roll",
                location="unwind",
                parameters={
                    "shape": shape,
                    "size_m": share * SHAPES[shape],
                    "angle_rad": SHAPE_ANGLE_RAD,
                    "gravity": gravity,
                },
            )
        )
    turned = (
        ("swrap_lead", lead_m, LEAD_ANGLE_RAD),
        ("swrap_follower", follower_m, FOLLOWER_ANGLE_RAD),
    )
    for roller, size_m, angle_rad in turned:
        if size_m > 0.0:
            parameters = {"eccentricity_m": size_m, "angle_rad": angle_rad}
            effects.append(
                EffectEntry(effect="eccentric_roller", location=roller, parameters=parameters)
            )
    return line.model_copy(update={"effects": tuple(effects)})


def with_hidden(line: Declaration, hidden: Hidden) -> Declaration:
    """Return the line as it really is; delay, radius tag and word length are the harness's."""
    web = line.web.model_copy(
        update={
            "EA_N": line.web.EA_N * hidden.EA_ratio,
            # line strain grows as 1/EA, so the same tension keeps the ratio of the two strains
            "wound_in_tension_N": line.web.wound_in_tension_N * hidden.wound_in_ratio,
        }
    )
    sensors = tuple(
        s.model_copy(update={"low_pass_Hz": hidden.cell_Hz})
        if hidden.cell_Hz is not None and isinstance(s, LoadCell)
        else s
        for s in line.sensors
    )
    return line.model_copy(update={"web": web, "sensors": sensors})
