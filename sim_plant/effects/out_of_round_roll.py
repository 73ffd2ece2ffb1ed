"""A roll that is not round: its moment arm varies with its angle, and so may its balance."""

from __future__ import annotations

import cmath
import itertools
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import REWIND, UNWIND, Array, LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.profiles import Profile, Profiles
from sim_plant.base.signatures import whole
from sim_plant.effects.phasor import angle, component, phasor
from sim_plant.effects.shape_rows import add_gravity_moment, add_mean, add_shape
from sim_plant.geometry.roll_profiles import (
    ASYMMETRIC_FALL_RAD,
    ASYMMETRIC_RISE_RAD,
    asymmetric,
    bulge,
    flat_spot,
    flattened_bulge,
)
from sim_plant.geometry.shapes import MAX_ORDER, Shape, circle, ellipse, orders, require_convex
from sim_plant.geometry.wound_mass import wound_mass

GRAVITY_M_S2 = 9.80665
LARGEST_ROLL_M = 5.0
FLATTENED = "flattened_bulge"
ASYMMETRIC = "asym"
KINDS = ("flat", "bulge", ASYMMETRIC, FLATTENED, "ellipse", "orders")
"""Profiles by name; the last is none, only orders."""
SIZES = (("flat", "depth"), ("ellipse", "half the axes' spread"), ("", "height"))
TRACED_KINDS = ("flat", ASYMMETRIC, FLATTENED, "ellipse")
MOST_UNWOUND_M = 0.05
HIGHEST_ORDER = 12
TRACED_ORDER = 6
"""Orders that a roll has as numbers of its own, and those that it is looked for by."""
TRIED_SIZES_M = (0.001, 0.002, 0.004, 0.006, 0.009, 0.012, 0.016)
TRIED_WIDTHS = (2.5, 4.0, 6.5, 11.0)
"""Widths of the flat of a bulge, over its size."""
TRIED_FLANKS_RAD = np.radians((15.0, 30.0, 45.0, 60.0))
FLANK_TRIED_AT_M = 0.004
NARROWEST_FLANK_RAD = 0.05
TRIED_ANGLES_RAD = np.radians(np.arange(0.0, 360.0, 2.0))
TRACED_FINEST_ORDER = 64.0
"""A profile that is traced has no finer orders: drives and cells do not answer to them."""
PAIRS = tuple(Quadrature(cos=f"cos{n}_m", sin=f"sin{n}_m") for n in range(1, HIGHEST_ORDER + 1))


def named(
    kind: str,
    size_m: float,
    radius_m: float,
    angle_rad: float,
    flat_width_m: float = 0.0,
    flanks_rad: tuple[float, float] = (0.0, 0.0),
) -> Shape:
    """Return the named profile round ``radius_m``; size is depth, height or half axis spread."""
    return _at_angle_0(kind, size_m, radius_m, flat_width_m, flanks_rad).turned(angle_rad)


@lru_cache(maxsize=256)
def _at_angle_0(
    kind: str, size_m: float, radius_m: float, flat_width_m: float, flanks_rad: tuple[float, float]
) -> Shape:
    """Return the profile not turned, made once: a hull takes longer than a minute of line."""
    if kind not in KINDS:
        raise PlantError(f"out_of_round_roll.shape: read {kind!r}; expected one of {KINDS}")
    if size_m == 0.0 or kind == "orders":
        return circle(radius_m)
    if kind == "flat":
        return flat_spot(size_m, radius_m)
    if kind == "bulge":
        return bulge(size_m, radius_m)
    if kind == ASYMMETRIC:
        return asymmetric(size_m, radius_m, 0.0, *_flanks(flanks_rad))
    if kind == FLATTENED:
        return flattened_bulge(size_m, flat_width_m or 6.0 * size_m, radius_m)
    return ellipse(radius_m + size_m, radius_m - size_m)


def _flanks(given_rad: tuple[float, float]) -> tuple[float, float]:
    """Return the widths of both flanks, rad: 0 is the profile's own, none is a wall."""
    rise, fall = (max(NARROWEST_FLANK_RAD, w) if w > 0.0 else 0.0 for w in given_rad)
    return rise or float(ASYMMETRIC_RISE_RAD), fall or float(ASYMMETRIC_FALL_RAD)


def profile(radius_m: float, parameters: Mapping[str, Value]) -> Shape:
    """Return the named profile, rounded, plus h = sum cos_n cos(n psi) + sin_n sin(n psi).

    Winding and unwinding lead to parallel curves: a profile formed at another radius keeps its
    deviations from the round part. A profile of a finite ``finest_order`` ripples beside its
    corners; web that is laid and taken off there passes twice (``elements/span``). Of all orders
    it has to be convex.

    Raises
    ------
    PlantError
        On numbers that no roll has.
    """
    return _profile(radius_m, tuple(parameters.items()))


@lru_cache(maxsize=64)
def _profile(radius_m: float, numbers: tuple[tuple[str, Value], ...]) -> Shape:
    """Return the profile of these parameters; a search puts one on a hundred lines in turn."""
    parameters = dict(numbers)
    kind, size_m = str(parameters["shape"]), float(parameters["size_m"])
    formed_m = _formed_m(radius_m, parameters)
    angle_rad, flat_width_m = float(parameters["angle_rad"]), float(parameters["flat_width_m"])
    flanks_rad = float(parameters["rise_rad"]), float(parameters["fall_rad"])
    for name in ("size_m", "flat_width_m", "smoothing_rad", "rise_rad", "fall_rad"):
        if float(parameters[name]) < 0.0:
            raise PlantError(f"out_of_round_roll.{name}: read {parameters[name]}; expected >= 0")
    shape = named(kind, size_m, formed_m, angle_rad, flat_width_m, flanks_rad)
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
    whole_shape = Shape(mean_radius_m=shape.mean_radius_m, deviation_m=total)
    if float(parameters["finest_order"]) < MAX_ORDER:
        return whole_shape
    return require_convex(whole_shape)


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


def bounds(arrays: LineArrays, place: int) -> dict[str, tuple[float, float]]:
    """Return that a roll which unwinds was never smaller, and one which winds up never larger."""
    kind = int(arrays.bodies[place]["kind"])
    if kind == UNWIND:
        return {"unwound_m": (0.0, MOST_UNWOUND_M)}
    return {"unwound_m": (-MOST_UNWOUND_M, 0.0)} if kind == REWIND else {}


def profile_starts(
    radius_m: float, inner: Array, against: Array, amplitudes_m: Sequence[float], keep: int = 3
) -> list[Profile]:
    """Return named profiles with size and angle that explain most, best first.

    ``inner`` (2 n, 2 n) and ``against`` (2 n,) are S'PS and S'Pr of the order columns
    (cos, sin per order, columns per ``amplitudes_m``): a profile is a fixed mix of orders, so its
    gain 2 z'b - z'Gz needs no simulation. A bulge is the profile of two flanks alike.
    """
    highest = len(amplitudes_m) // 2
    found: list[tuple[float, str, dict[str, float]]] = []
    for kind in TRACED_KINDS:
        best: tuple[float, str, dict[str, float]] = (-np.inf, kind, {})
        for shape, numbers in _tried(kind, radius_m):
            turned = _turned(shape, highest)
            z = np.stack([turned.real, -turned.imag], axis=2).reshape(TRIED_ANGLES_RAD.size, -1)
            z = z / np.asarray(amplitudes_m)
            gain = 2.0 * z @ against - np.einsum("ai,ij,aj->a", z, inner, z)
            at = int(np.argmax(gain))
            if gain[at] > best[0]:
                best = (
                    float(gain[at]),
                    kind,
                    {**numbers, "angle_rad": float(TRIED_ANGLES_RAD[at])},
                )
        found.append(best)
    found.sort(key=lambda row: -row[0])
    return [_start(kind, numbers) for gain, kind, numbers in found[:keep] if gain > 0.0]


def nearest_profiles(radius_m: float, orders_m: Array) -> list[Profile]:
    """Return of each name the profile most like ``orders_m`` (n, 2), cos and sin; best first.

    Least squares over the orders given, each at its size; the size is free, the others tried.
    """
    wanted = orders_m[:, 0] - 1j * orders_m[:, 1]
    found: list[tuple[float, str, dict[str, float]]] = []
    for kind in TRACED_KINDS:
        best: tuple[float, str, dict[str, float]] = (np.inf, kind, {})
        for shape, numbers in _tried(kind, radius_m):
            turned = _turned(shape, wanted.size)
            power = np.sum(np.abs(turned[0]) ** 2)
            share = np.maximum(0.0, (turned.conj() @ wanted).real) / power
            share = share if kind == ASYMMETRIC else np.ones_like(share)
            left = np.sum(np.abs(share[:, None] * turned - wanted) ** 2, axis=1)
            at = int(np.argmin(left))
            if left[at] < best[0] and share[at] > 0.0:
                size = {"size_m": float(share[at]) * numbers["size_m"]}
                angle = {"angle_rad": float(TRIED_ANGLES_RAD[at])}
                best = (float(left[at]), kind, {**numbers, **size, **angle})
        found.append(best)
    found.sort(key=lambda row: row[0])
    return [_start(kind, numbers) for left, kind, numbers in found if np.isfinite(left)]


def _turned(shape: NDArray[np.complex128], count: int) -> NDArray[np.complex128]:
    """Return the first orders of a shape at every angle that is tried (angles, count), m."""
    h = np.zeros(count, dtype=np.complex128)
    h[: min(count, shape.size)] = shape[:count]
    turns = np.exp(-1j * np.outer(TRIED_ANGLES_RAD, np.arange(1, count + 1)))
    found: NDArray[np.complex128] = h[None, :] * turns
    return found


def profile_orders(radius_m: float, values: Mapping[str, Value], count: int) -> Array:
    """Return cos and sin (count, 2), m, of the first orders of a profile."""
    own = profile(radius_m, {**EFFECT.parameters, **values}).deviation_m[:count]
    return np.stack([own.real, -own.imag], axis=1)


def _tried(
    kind: str, radius_m: float
) -> Iterator[tuple[NDArray[np.complex128], dict[str, float]]]:
    """Return the deviations of a profile of each size that is tried, m, with its numbers.

    Those of flanks of each width are of one size, the others follow from it: a start is enough.
    """
    if kind == FLATTENED:
        for size_m, width in itertools.product(TRIED_SIZES_M, TRIED_WIDTHS):
            width_m = width * size_m
            deviation_m = named(kind, size_m, radius_m, 0.0, width_m).deviation_m
            yield deviation_m, {"size_m": size_m, "flat_width_m": width_m}
        return
    if kind != ASYMMETRIC:
        for size_m in TRIED_SIZES_M:
            yield named(kind, size_m, radius_m, 0.0).deviation_m, {"size_m": size_m}
        return
    for k, one in enumerate(TRIED_FLANKS_RAD):
        for other in TRIED_FLANKS_RAD[k:]:
            flanks = float(one), float(other)
            unit = named(kind, FLANK_TRIED_AT_M, radius_m, 0.0, 0.0, flanks).deviation_m
            unit = unit / FLANK_TRIED_AT_M
            for size_m in TRIED_SIZES_M:
                rise, fall = flanks
                yield size_m * unit, {"size_m": size_m, "rise_rad": rise, "fall_rad": fall}
                mirrored = (size_m * unit).conj()
                yield mirrored, {"size_m": size_m, "rise_rad": fall, "fall_rad": rise}


def _start(kind: str, numbers: Mapping[str, float]) -> Profile:
    """Return a profile with the numbers that it is fitted in, and where they start.

    An ellipse has no corner: to round it off and to make it smaller is the same.
    """
    start = dict(numbers)
    if kind != "ellipse":
        start["smoothing_rad"] = 0.02
    return Profile(
        choice=(("shape", kind), ("finest_order", TRACED_FINEST_ORDER)),
        names=tuple(start),
        start=tuple(start.values()),
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
        "size_m": Parameter(default=0.0, unit="m", typical=5e-3, low=0.0, high=0.05, called=SIZES),
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
        # of asym: web before and behind the top on which the radius changes; 0: 45 and 30 degrees
        "rise_rad": Parameter(
            default=0.0, unit="rad", typical=0.5, low=0.0, high=1.6, role="shape"
        ),
        "fall_rad": Parameter(
            default=0.0, unit="rad", typical=0.5, low=0.0, high=1.6, role="shape"
        ),
        "gravity": Parameter(
            default=1.0, unit="1", typical=0.0, low=0.0, high=2.0, linear=True, role="shape"
        ),
        "mean_m": Parameter(
            default=0.0, unit="m", typical=2e-4, low=-0.02, high=0.02, linear=True, role="shape"
        ),
        **_components(),
    },
    fitted=tuple(name for pair in PAIRS[:TRACED_ORDER] for name in (pair.cos, pair.sin)),
    quadratures=PAIRS,
    apply=apply,
    bounds=bounds,
    text="the roll is not round: ripple at its turning frequency and several harmonics",
    shows=whole(*range(1, TRACED_ORDER + 1)),
    remedy="look how {place} was stored and clamped; the next roll brings a shape of its own",
    profiles=Profiles(
        starts=profile_starts,
        size="size_m",
        age="unwound_m",
        age_tries=(0.006, 0.012, -0.006, -0.012),
        orders_choice=(("shape", "orders"), ("finest_order", TRACED_FINEST_ORDER)),
        nearest=nearest_profiles,
        orders=profile_orders,
    ),
    cancel_orders=(1, 2, 3, 4),
)
