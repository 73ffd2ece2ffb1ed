"""A roll that is not round: its moment arm varies with its angle, and so may its balance."""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import REWIND, UNWIND, Array, LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.profiles import Profile, Profiles
from sim_plant.base.signatures import whole
from sim_plant.effects.phasor import angle, component, phasor
from sim_plant.effects.shape_rows import add_gravity_moment, add_mean, add_shape
from sim_plant.geometry.roll_profiles import asymmetric, bulge, flat_spot, flattened_bulge
from sim_plant.geometry.shapes import MAX_ORDER, Shape, circle, ellipse, orders, require_convex
from sim_plant.geometry.wound_mass import wound_mass

GRAVITY_M_S2 = 9.80665
LARGEST_ROLL_M = 5.0
FLATTENED = "flattened_bulge"
KINDS = ("flat", "bulge", "asym", FLATTENED, "ellipse", "orders")
"""Profiles by name; the last is none, only orders."""
MOST_UNWOUND_M = 0.05
HIGHEST_ORDER = 6
TRIED_SIZES_M = (0.001, 0.002, 0.004, 0.006, 0.009, 0.012, 0.016)
TRIED_ANGLES_RAD = np.radians(np.arange(0.0, 360.0, 2.0))
TRACED_FINEST_ORDER = 64.0
"""A profile that is traced has no finer orders: drives and cells do not answer to them."""
PAIRS = tuple(Quadrature(cos=f"cos{n}_m", sin=f"sin{n}_m") for n in range(1, HIGHEST_ORDER + 1))


def named(
    kind: str, size_m: float, radius_m: float, angle_rad: float, flat_width_m: float = 0.0
) -> Shape:
    """Return the named profile round ``radius_m``; size is depth, height or half axis spread."""
    return _at_angle_0(kind, size_m, radius_m, flat_width_m).turned(angle_rad)


@lru_cache(maxsize=64)
def _at_angle_0(kind: str, size_m: float, radius_m: float, flat_width_m: float) -> Shape:
    """Return the profile not turned, made once: a hull takes longer than a minute of line."""
    if kind not in KINDS:
        raise PlantError(f"out_of_round_roll.shape: read {kind!r}; expected one of {KINDS}")
    if size_m == 0.0 or kind == "orders":
        return circle(radius_m)
    if kind == "flat":
        return flat_spot(size_m, radius_m)
    if kind == "bulge":
        return bulge(size_m, radius_m)
    if kind == "asym":
        return asymmetric(size_m, radius_m)
    if kind == FLATTENED:
        return flattened_bulge(size_m, flat_width_m or 6.0 * size_m, radius_m)
    return ellipse(radius_m + size_m, radius_m - size_m)


def profile(radius_m: float, parameters: Mapping[str, Value]) -> Shape:
    """Return the named profile, rounded, plus h = sum cos_n cos(n psi) + sin_n sin(n psi).

    Winding and unwinding lead to parallel curves: a profile formed at another radius keeps its
    deviations from the round part. A profile of a finite ``finest_order`` ripples beside its
    corners; web that is laid and taken off there passes twice (``elements/span``).

    Raises
    ------
    PlantError
        On numbers that no roll has.
    """
    kind, size_m = str(parameters["shape"]), float(parameters["size_m"])
    formed_m = _formed_m(radius_m, parameters)
    angle_rad, flat_width_m = float(parameters["angle_rad"]), float(parameters["flat_width_m"])
    for name in ("size_m", "flat_width_m", "smoothing_rad"):
        if float(parameters[name]) < 0.0:
            raise PlantError(f"out_of_round_roll.{name}: read {parameters[name]}; expected >= 0")
    shape = named(kind, size_m, formed_m, angle_rad, flat_width_m)
    shape = shape.at_radius(shape.mean_radius_m + radius_m - formed_m)
    shape = shape.up_to(_finest(float(parameters["finest_order"])))
    if float(parameters["smoothing_rad"]) != 0.0:
        shape = shape.smoothed(float(parameters["smoothing_rad"]))
    rows = []
    for order, pair in enumerate(PAIRS, start=1):
        value = phasor(parameters, pair)
        if value != 0.0:
            rows.append((order, abs(value), -cmath.phase(value)))
    if not rows:
        return shape
    low_orders = orders(radius_m, rows).deviation_m
    size = max(low_orders.size, shape.deviation_m.size)
    total = np.zeros(size, dtype=np.complex128)
    total[: low_orders.size] += low_orders
    total[: shape.deviation_m.size] += shape.deviation_m
    return require_convex(Shape(mean_radius_m=shape.mean_radius_m, deviation_m=total))


def _formed_m(radius_m: float, parameters: Mapping[str, Value]) -> float:
    """Return the radius at which the profile was formed, however it is told."""
    given_m, unwound_m = float(parameters["formed_radius_m"]), float(parameters["unwound_m"])
    if given_m != 0.0 and unwound_m != 0.0:
        raise PlantError(
            f"out_of_round_roll: formed_radius_m ({given_m:g}) and unwound_m ({unwound_m:g}) say "
            "the same thing; give one of them"
        )
    formed_m = given_m or radius_m + unwound_m
    if not 0.0 < formed_m <= LARGEST_ROLL_M:
        name, value = ("formed_radius_m", given_m) if given_m else ("unwound_m", unwound_m)
        raise PlantError(
            f"out_of_round_roll.{name}: read {value:g}; a roll of {radius_m:g} m would have been "
            f"formed at {formed_m:g} m, expected more than 0 and at most {LARGEST_ROLL_M:g} m"
        )
    return formed_m


def _finest(order: float) -> int:
    if order != int(order) or not 1 <= order <= MAX_ORDER:
        raise PlantError(
            f"out_of_round_roll.finest_order: read {order:g}; expected a whole number, "
            f"1 to {MAX_ORDER}"
        )
    return int(order)


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Give body ``place`` the profile, on a roll also the gravity torque of the displaced web.

    The declared radius is that of the round part: the web feels the profile's own mean radius,
    drive and radius sensor keep the declared one. Moment arm p(theta) of the exact identity
    [source 4.46 corrected, docs/adr/0003].
    """
    body = arrays.bodies[place]
    shape = profile(float(body["radius_m"]), parameters)
    web = arrays.web[0]
    wound = int(body["kind"]) in {UNWIND, REWIND}  # only there is the shape one of wound web
    if wound and float(parameters["gravity"]) != 0.0 and np.any(shape.deviation_m):
        mass = wound_mass(
            shape,
            core_radius_m=float(web["core_radius_m"]),
            density_kg_m3=float(web["density_kg_m3"]),
            width_m=float(web["width_m"]),
        )
        gravity_moment_N_m = (
            mass.mass_kg * GRAVITY_M_S2 * mass.offset_m * float(parameters["gravity"])
        )
        add_gravity_moment(arrays, place, gravity_moment_N_m, mass.offset_angle_rad)
    mean_m = float(parameters["mean_m"])
    if shape.mean_radius_m + mean_m <= 0.0:
        raise PlantError(
            f"out_of_round_roll.mean_m: read {mean_m:g}; it leaves nothing of a mean radius of "
            f"{shape.mean_radius_m:g} m"
        )
    return add_mean(add_shape(arrays, place, shape), place, mean_m)


def limits(arrays: LineArrays, place: int) -> dict[str, tuple[float, float]]:
    """Return that a roll which unwinds was never smaller, and one which winds up never larger."""
    kind = int(arrays.bodies[place]["kind"])
    if kind == UNWIND:
        return {"unwound_m": (0.0, MOST_UNWOUND_M)}
    return {"unwound_m": (-MOST_UNWOUND_M, 0.0)} if kind == REWIND else {}


def profile_starts(
    radius_m: float, inner: Array, against: Array, amplitudes_m: Sequence[float], keep: int = 2
) -> list[Profile]:
    """Return named profiles with size and angle that explain most, best first.

    ``inner`` (2 n, 2 n) and ``against`` (2 n,) are S'PS and S'Pr of the order columns
    (cos, sin per order, columns per ``amplitudes_m``): a profile is a fixed mix of orders, so its
    gain 2 z'b - z'Gz needs no simulation.
    """
    highest = len(amplitudes_m) // 2
    number = np.arange(1, highest + 1)
    found: list[tuple[float, str, float, float]] = []
    for kind in KINDS[:-1]:
        best = (-np.inf, kind, 0.0, 0.0)
        for size in TRIED_SIZES_M:
            shape = named(kind, size, radius_m, 0.0).deviation_m
            h = np.zeros(highest, dtype=np.complex128)
            h[: min(highest, shape.size)] = shape[:highest]
            turned = h[None, :] * np.exp(-1j * np.outer(TRIED_ANGLES_RAD, number))
            z = np.stack([turned.real, -turned.imag], axis=2).reshape(TRIED_ANGLES_RAD.size, -1)
            z = z / np.asarray(amplitudes_m)
            gain = 2.0 * z @ against - np.einsum("ai,ij,aj->a", z, inner, z)
            at = int(np.argmax(gain))
            best = max(best, (float(gain[at]), kind, size, float(TRIED_ANGLES_RAD[at])))
        found.append(best)
    found.sort(reverse=True)
    return [
        _start(kind, size, angle_rad) for gain, kind, size, angle_rad in found[:keep] if gain > 0.0
    ]


def _start(kind: str, size_m: float, angle_rad: float) -> Profile:
    """Return a profile with the numbers that it is fitted in, and where they start.

    An ellipse has no corner: to round it off and to make it smaller is the same.
    """
    names: dict[str, float] = {"size_m": size_m, "angle_rad": angle_rad}
    if kind != "ellipse":
        names["smoothing_rad"] = 0.02
    if kind == FLATTENED:
        names["flat_width_m"] = 6.0 * size_m
    return Profile(
        choice=(("shape", kind), ("finest_order", TRACED_FINEST_ORDER)),
        names=tuple(names),
        start=tuple(names.values()),
    )


def _components() -> dict[str, Parameter]:
    found = {}
    for order, pair in enumerate(PAIRS, start=1):
        for name in (pair.cos, pair.sin):
            found[name] = component("m", 5e-4 / order, 0.02)
    return found


EFFECT = Effect(
    name="out_of_round_roll",
    place="body",
    candidates="roll",
    accepts={
        "shape": Parameter(default="flat", unit="", role="option", words=KINDS),
        "size_m": Parameter(default=0.0, unit="m", typical=5e-3, low=0.0, high=0.05),
        "angle_rad": angle(),
        "smoothing_rad": Parameter(
            default=0.0, unit="rad", typical=0.03, low=0.0, high=0.5, role="shape", detail=True
        ),
        "formed_radius_m": Parameter(  # 0: the radius of the roll at the start
            default=0.0, unit="m", typical=0.2, low=0.0, high=LARGEST_ROLL_M, role="shape"
        ),
        "unwound_m": Parameter(  # by this much the radius has fallen since; below 0: wound over
            default=0.0,
            unit="m",
            typical=0.01,
            low=-MOST_UNWOUND_M,
            high=MOST_UNWOUND_M,
            role="shape",
            step=0.002,
        ),
        "finest_order": Parameter(
            default=float(MAX_ORDER),
            unit="1",
            typical=64.0,
            low=1.0,
            high=float(MAX_ORDER),
            role="option",
            detail=True,
        ),
        "flat_width_m": Parameter(  # of a flattened bulge; 0: six times its size
            default=0.0, unit="m", typical=0.03, low=0.0, high=0.3, role="shape"
        ),
        "gravity": Parameter(
            default=1.0, unit="1", typical=0.0, low=0.0, high=2.0, linear=True, role="shape"
        ),
        "mean_m": Parameter(
            default=0.0, unit="m", typical=2e-4, low=-0.02, high=0.02, linear=True, role="shape"
        ),
        **_components(),
    },
    traced=tuple(name for pair in PAIRS for name in (pair.cos, pair.sin)),
    quadratures=PAIRS,
    apply=apply,
    limits=limits,
    text="the roll is not round: ripple at its turning frequency and several harmonics",
    shows=whole(*range(1, HIGHEST_ORDER + 1)),
    remedy="look how {place} was stored and clamped; the next roll brings a shape of its own",
    profiles=Profiles(
        starts=profile_starts,
        size="size_m",
        age="unwound_m",
        age_tries=(0.006, 0.012, -0.006, -0.012),
    ),
    cancel_orders=(1, 2, 3, 4),
)
