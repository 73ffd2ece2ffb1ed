"""Criteria of the model: how well a declared number is known, and how the line is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion
from sim_plant.refine.criteria.runs import RunLineCriteria


@dataclass(frozen=True, slots=True, kw_only=True)
class StepCriteria:
    """Finite differences: by how much a number of an effect is moved to find its slope."""

    linear_share: float = criterion(
        0.25,
        "of the size, or of the start size",
        "step of a number whose response is linear",
        "any share gives the same slope, a large one stands out of the chaos of quantised loops",
    )
    curved_share: float = criterion(
        0.05, "of the size", "step of any other number", "small: the slope changes with the size"
    )
    curved_least_share: float = criterion(
        0.2, "of the start size", "a size counts as no smaller for curved_share", NOT_RECORDED
    )
    angle_rad: float = criterion(
        0.02, "rad", "step of an angle", "at order 12 a quarter of a radian, still nearly straight"
    )
    from_absence: float = criterion(
        1e-6,
        "unit of the number",
        "step of a number whose value and start are both its absence",
        "any step does",
    )
    room_parts: float = criterion(
        3.0,
        "parts",
        "of the way to where an effect leaves no trace, of which a step takes one at most",
        NOT_RECORDED,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelCriteria:
    """How well a declared number is known, what records ask of the line, and what they lack."""

    ramp_look_s: float = criterion(
        0.2,
        "s",
        "span over which a rate is taken; a reference that changes within it is a step",
        "some tens of samples; ramps of a line last seconds",
    )
    ramp_steady_share: float = criterion(
        0.03, "of a rate", "rates that differ by less are one ramp", NOT_RECORDED
    )
    ramp_slowest_share: float = criterion(
        0.002,
        "of the highest speed, per second",
        "what changes more slowly is no ramp",
        "eight minutes to full speed",
    )
    tension_step_share: float = criterion(
        0.02, "of the tension", "a reference that changes by less has no step", NOT_RECORDED
    )
    radius_change_share: float = criterion(
        0.005,
        "of the radius",
        "a roll whose radius changes by less cannot be told from a roller of its size",
        "its frequency stays to within a turn in 200",
    )
    default_tolerance: Mapping[str, float] = criterion(
        {
            "web.EA_N": 0.02,
            "web.kelvin_voigt_eta_s": 0.2,
            "web.density_kg_m3": 0.01,
            "web.thickness_m": 0.005,
            "web.wound_in_tension_N": 0.01,
            "idlers.inertia_kg_m2": 0.02,
            "friction": 0.05,
            "inertia": 0.01,
            "radius": 5e-5,
            "effective_radius": 2e-4,  # felt by the web; drive and radius sensor do not follow
            "draw": 1e-5,
            "gain": 0.001,
            "offset": 0.1,
            "corner": 0.03,
            "loop": 0.005,
            "drive": 0.005,
            "carriage_mass": 0.02,
            "carriage_load": 0.01,
            "carriage_drag": 0.2,
            "travel": 0.001,
            "heat": 0.05,
        },
        "share of the number; offset N, draw the ratio itself, travel m",
        "tolerance (two standard deviations) of a kind of declared number without one",
        NOT_RECORDED,
    )
    at_bound_share: float = criterion(
        1e-6,
        "of the way from absence to the bound",
        "a number this close to a bound is no estimate",
        NOT_RECORDED,
    )
    quick_tick_s: float = criterion(
        0.005,
        "s",
        "longest drive tick of a quick simulation, of which only differences are used",
        NOT_RECORDED,
    )
    quick_settle_s: float = criterion(
        10.0,
        "s",
        "a line runs before its record begins, at the quick tick",
        "between two rollers that hold speeds a tension rests in some 10 s at 1 m/s (ADR 0017)",
    )
    declared_settle_s: float = criterion(
        20.0,
        "s",
        "the same at the declared tick",
        "twice quick_settle_s: here the level counts, there only differences",
    )
    start_offset_share: float = criterion(
        0.02,
        "of the tension",
        "size at which what a line may begin with is simulated; the response is scaled",
        "what a probe and a step of tension leave in the drives of an S-wrap (ADR 0038)",
    )
    steps: StepCriteria = field(default_factory=StepCriteria)
    run: RunLineCriteria = field(default_factory=RunLineCriteria)
