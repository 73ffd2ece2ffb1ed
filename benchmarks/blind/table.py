"""Every effect that is drawn, and how: the one list of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from benchmarks.blind import effects as e
from benchmarks.blind.effects import CELLS, IDLERS, ZONES, DrawableEffect, Hidden, Parameters, Rng

OUTSIDE = "unknown"
IDLERS_INSIDE = tuple(r for r in IDLERS if r not in CELLS)


def _log(rng: Rng, low: float, high: float) -> float:
    """Return a number drawn evenly on a logarithmic scale, of five digits."""
    return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.5g}")


def _either(rng: Rng, low: float, high: float) -> float:
    return _log(rng, low, high) * float(rng.choice([-1.0, 1.0]))


def _moments(rng: Rng) -> dict[str, float]:
    """Return when something begins in either record, s."""
    return {name: round(float(rng.uniform(24.0, 54.0)), 2) for name in "ab"}


def _begins(rng: Rng, numbers: Parameters) -> Parameters:
    """Return the numbers, half of the time with the moments from which they hold."""
    later = {"from_record_time_s": _moments(rng)} if rng.random() < 0.5 else {}
    return {**numbers, **later}


def _profile(rng: Rng) -> Parameters:
    sizes = {"flat": (5e-3, 1.2e-2), "bulge": (1.5e-3, 5e-3), "asym": (2e-3, 6e-3)}
    kind = str(rng.choice([*sizes, "ellipse"]))
    return {"shape": kind, "size_m": _log(rng, *sizes.get(kind, (3e-4, 1.2e-3)))}


def _warmth(rng: Rng) -> Parameters:
    return {
        "strain": _either(rng, 2.5e-4, 6e-4),
        "rise_s": _log(rng, 0.5, 1.5),
        "from_record_time_s": _moments(rng),
        "hold_s": _log(rng, 10.0, 15.0),
    }


TABLE: dict[str, DrawableEffect] = {
    "eccentric_roller": DrawableEffect(
        places=(*IDLERS, "swrap_lead", "pull_roll"),
        draw=lambda r: {"eccentricity_m": _log(r, 8e-5, 3e-4)},
        put=e.eccentric,
    ),
    "out_of_round_roll": DrawableEffect(places=("unwind",), draw=_profile, put=e.out_of_round),
    "unbalanced_roller": DrawableEffect(
        places=IDLERS_INSIDE,
        draw=lambda r: {"imbalance_kg_m": _log(r, 5e-4, 1.5e-3)},
        put=e.unbalanced,
    ),
    "bearing_drag": DrawableEffect(
        places=("R4", "R5", "R6", "R7", "R8", "R13", "R14"),
        draw=lambda r: _begins(r, {"added_torque_N_m": _log(r, 0.04, 0.065)}),
        put=e.drag,
    ),
    "torque_ripple": DrawableEffect(
        places=("unwind", "swrap_lead", "swrap_follower", "pull_roll"),
        draw=lambda r: {"amplitude_N_m": _log(r, 0.5, 1.4), "order": int(r.choice([6, 9, 12]))},
        put=e.ripple,
    ),
    "slip": DrawableEffect(
        places=("swrap",),
        draw=lambda r: {"creep_per_m_s": _log(r, 1e-3, 3.5e-3), "above_m_s": _log(r, 0.6, 0.95)},
        put=e.slip,
        accept=("swrap_lead", "swrap_follower"),
    ),
    "thermal_strain": DrawableEffect(
        places=("unwind_zone", "pull_roll_zone"), draw=_warmth, put=e.warm
    ),
    "splice": DrawableEffect(
        places=("web",),
        draw=lambda r: {
            "step_m": _log(r, 4e-4, 6e-4),
            "length_m": _log(r, 0.05, 0.1),
            "record_time_s": _moments(r),
        },
        put=e.seam,
    ),
    "rate_limit": DrawableEffect(
        places=("unwind",),
        draw=lambda r: {
            "limit_m_s2": _log(r, 0.17, 0.25),
            "of": str(r.choice(["reference", "correction", "correction"])),
        },
        put=e.ramped,
    ),
    "loop_delay": DrawableEffect(
        places=("unwind", "rewind"),
        draw=lambda r: {"delay_s": 0.01 * int(r.integers(3, 9))},
        put=e.late,
    ),
    "load_cell_filter": DrawableEffect(
        places=("all",),
        draw=lambda r: {"corner_Hz": _log(r, 2.4, 6.0)},
        put=e.slow_cell,
        accept=CELLS,
    ),
    "load_cell_calibration": DrawableEffect(
        places=("R3", "R9"),
        draw=lambda r: {
            "gain": round(1.0 + _either(r, 0.02, 0.06), 5),
            "offset_N": _either(r, 0.8, 2.5),
        },
        put=e.wrong_scale,
    ),
    "load_cell_resonance": DrawableEffect(
        places=("R3", "R15"),  # in a loop the line swings up
        draw=lambda r: {"frequency_Hz": _log(r, 2.5, 4.5), "damping_ratio": _log(r, 0.008, 0.02)},
        put=e.ringing,
    ),
    "mains_hum": DrawableEffect(
        places=("all",),
        draw=lambda r: {
            "amplitude_N": _log(r, 0.7, 1.2),
            "frequency_Hz": float(r.choice([49.7, 99.7])),
        },
        put=e.hum,
        accept=CELLS,
    ),
    "radius_error": DrawableEffect(
        places=("unwind",), draw=lambda r: {"relative": _either(r, 2e-3, 8e-3)}, put=e.wrong_radius
    ),
    "wound_in_strain": DrawableEffect(
        places=("unwind",),
        draw=lambda r: {"factor": round(1.0 + _either(r, 0.3, 0.6), 5)},
        put=e.wound,
    ),
    "web_modulus": DrawableEffect(
        places=("web",),
        draw=lambda r: {"factor": round(1.0 + _either(r, 0.1, 0.3), 5)},
        put=e.stiffer,
    ),
    "viscoelastic_web": DrawableEffect(
        places=("web",),
        draw=lambda r: {"branch_fraction": _log(r, 0.2, 0.45), "relaxation_s": _log(r, 0.15, 0.4)},
        put=e.relaxing,
        accept=("web_modulus",),
    ),
    "roll_bounce": DrawableEffect(
        places=("unwind",),
        draw=lambda r: {
            "frequency_Hz": _log(r, 2.2, 4.0),
            "mass_kg": _log(r, 15.0, 26.0),
            "order": int(r.choice([2, 3, 4])),
            "damping": _log(r, 0.04, 0.08),
            "unbalance_kg_m": _log(r, 0.02, 0.06),
        },
        put=e.bouncing,
    ),
    "shaft_compliance_backlash": DrawableEffect(
        places=("unwind", "swrap_follower"),
        draw=lambda r: {
            "stiffness_N_m_rad": _log(r, 70.0, 300.0),
            "gap_rad": float(r.choice([0.0, 0.004])),
        },
        put=e.soft_shaft,
    ),
}


def hide(rng: Rng, name: str) -> Hidden:
    """Return an effect of the table at one of its places with drawn numbers."""
    row = TABLE[name]
    return Hidden(
        effect=name,
        location=str(rng.choice(row.places)),
        parameters=row.draw(rng),
        angle=float(rng.uniform(0.0, 2.0 * math.pi)),
        accept=row.accept,
    )


def hide_outside(rng: Rng) -> Hidden:
    """Return something that no library has."""
    numbers = _outside(rng)
    return Hidden(effect=OUTSIDE, location=_place_of(rng, numbers), parameters=numbers)


def _outside(rng: Rng) -> Parameters:
    """Return a thing by lot; what tells which is the name of its numbers."""
    kinds: tuple[Parameters, ...] = (
        {
            "what": "correction words stand still periodically",
            "every_s": _log(rng, 0.9, 1.6),
            "hold_s": _log(rng, 0.4, 0.55),
        },
        {"what": "sticking load-cell mounts (play)", "band_N": _log(rng, 0.8, 1.6)},
        {
            "what": "support vibration bursts",
            "velocity_m_s": _log(rng, 0.02, 0.04),
            "frequency_Hz": _log(rng, 6.0, 8.0),
            "every_s": _log(rng, 2.0, 3.0),
        },
        {
            "what": "air-bar pulsation",
            "strain": _log(rng, 1e-4, 2.5e-4),
            "frequency_Hz": _log(rng, 1.2, 2.2),
        },
    )
    return kinds[int(rng.integers(len(kinds)))]


def _place_of(rng: Rng, numbers: Mapping[str, Any]) -> str:
    """Return where a thing outside the library is."""
    if "hold_s" in numbers:
        return "unwind"
    if "band_N" in numbers:
        return "all"
    return str(rng.choice(list(ZONES)[:2] if "strain" in numbers else ["R5", "R6", "R13"]))
