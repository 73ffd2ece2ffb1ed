"""The shape of a rotating body: its support function as Fourier data round a mean radius."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aff_runtime.base.errors import PlantError

MAX_ORDER = 256
_CHECK_POINTS = 4096

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shape:
    """A closed profile given by h(psi) = R + Re sum_n h_n exp(j n psi), n = 1..N.

    h is the support function: the distance from the rotation centre to the tangent whose outward
    normal stands at the body angle psi. psi is counted in the sense of transport (a clockwise
    body is mirrored), so one shape means the same disturbance on either side of a web.
    R is perimeter / 2 pi, which for a convex profile is the mean of h; it is not the radius of
    the round part (a 12 mm flat spot on an 8 in roll has R 0.22 % below it).

    Attributes
    ----------
    mean_radius_m : R, m.
    deviation_m : h_n, m, complex, index 0 holds order 1; at most ``MAX_ORDER`` orders.

    Raises
    ------
    PlantError
        When the mean radius is not positive or an entry is not finite.
    """

    mean_radius_m: float
    deviation_m: NDArray[np.complex128]

    def __post_init__(self) -> None:
        orders = np.array(self.deviation_m, dtype=np.complex128, copy=True).reshape(-1)
        if not (np.isfinite(self.mean_radius_m) and self.mean_radius_m > 0.0):
            raise PlantError(f"mean radius must be positive, got {self.mean_radius_m} m")
        if orders.size > MAX_ORDER or not np.all(np.isfinite(orders)):
            raise PlantError(f"shape needs at most {MAX_ORDER} finite orders, got {orders.size}")
        orders.setflags(write=False)
        object.__setattr__(self, "deviation_m", orders)

    def evaluate(self, psi_rad: ArrayLike) -> tuple[Floats, Floats, Floats]:
        """Return support h, its slope h' and the radius of curvature h + h'', m.

        Parameters
        ----------
        psi_rad : body angles of the outward normal, any shape; the results have the same shape.
        """
        turn = np.exp(1j * np.asarray(psi_rad, dtype=np.float64))
        value, first, second = (np.zeros_like(turn) for _ in range(3))
        for order in range(_highest_order(self.deviation_m), 0, -1):
            h_n = self.deviation_m[order - 1]
            value = (value + h_n) * turn
            first = (first + 1j * order * h_n) * turn
            second = (second - order * order * h_n) * turn
        support = self.mean_radius_m + value.real
        return support, first.real, support + second.real

    def boundary(self, psi_rad: ArrayLike) -> NDArray[np.complex128]:
        """Return the contact points x + j y in the body frame, m: (h + j h') exp(j psi)."""
        support, slope, _ = self.evaluate(psi_rad)
        points: NDArray[np.complex128] = (support + 1j * slope) * np.exp(1j * np.asarray(psi_rad))
        return points

    def at_radius(self, mean_radius_m: float) -> Shape:
        """Return the parallel curve of another mean radius: winding keeps every h_n.

        Unwinding below ``least_convex_radius_m`` leaves a curve that no web can follow.
        """
        return Shape(mean_radius_m=mean_radius_m, deviation_m=self.deviation_m)

    def turned(self, angle_rad: float) -> Shape:
        """Return the same shape mounted ``angle_rad`` further on in the sense of transport."""
        order = np.arange(1, self.deviation_m.size + 1)
        return Shape(
            mean_radius_m=self.mean_radius_m,
            deviation_m=self.deviation_m * np.exp(-1j * order * angle_rad),
        )

    def smoothed(self, std_rad: float) -> Shape:
        """Return the profile rounded by a Gaussian of ``std_rad`` in psi.

        The kernel is nowhere negative, so convexity and perimeter are kept. Widths add as squares:
        ``flat_spot(...).smoothed(radians(1.87))`` has 2 degrees with the 0.7 of the hull.
        """
        order = np.arange(1, self.deviation_m.size + 1)
        return Shape(
            mean_radius_m=self.mean_radius_m,
            deviation_m=self.deviation_m * np.exp(-0.5 * (order * std_rad) ** 2),
        )

    def up_to(self, order: int) -> Shape:
        """Return the shape without orders above ``order``; beside a corner it is not convex."""
        return Shape(mean_radius_m=self.mean_radius_m, deviation_m=self.deviation_m[:order])

    @property
    def perimeter_m(self) -> float:
        """Length of web that one turn delivers, m (Cauchy: 2 pi times the mean support)."""
        return 2.0 * np.pi * self.mean_radius_m

    @property
    def least_convex_radius_m(self) -> float:
        """Smallest mean radius, m, at which the curvature measure h + h'' is nowhere negative."""
        *_, rho = self.evaluate(np.linspace(0.0, 2.0 * np.pi, _CHECK_POINTS, endpoint=False))
        return self.mean_radius_m - float(np.min(rho))

    @property
    def is_convex(self) -> bool:
        """Whether a taut web touches the profile everywhere (1 nm of radius is rounding)."""
        return self.least_convex_radius_m <= self.mean_radius_m + 1e-9


def _highest_order(deviation_m: NDArray[np.complex128]) -> int:
    """Return the highest order that is not zero."""
    used = np.flatnonzero(deviation_m)
    return int(used[-1]) + 1 if used.size else 0


def circle(radius_m: float) -> Shape:
    """Return an ideal body."""
    return Shape(mean_radius_m=radius_m, deviation_m=np.zeros(0, dtype=np.complex128))


def eccentric(radius_m: float, eccentricity_m: float, angle_rad: float = 0.0) -> Shape:
    """Return a round body whose geometric centre lies off the rotation centre (source 3.9).

    h = R + e cos(psi - angle): order 1 alone, and h + h'' = R stays constant.
    """
    h_1 = eccentricity_m * np.exp(-1j * angle_rad)
    return Shape(mean_radius_m=radius_m, deviation_m=np.array([h_1]))


def ellipse(semi_axis_a_m: float, semi_axis_b_m: float) -> Shape:
    """Return an ellipse with semi-axis a along psi = 0 (source 4.1, 4.6: a and b are semi-axes).

    h = sqrt(a^2 cos^2 psi + b^2 sin^2 psi), which is smooth: its Fourier data need no smoothing.
    """
    psi = np.linspace(0.0, 2.0 * np.pi, 16 * MAX_ORDER, endpoint=False)
    support = np.hypot(semi_axis_a_m * np.cos(psi), semi_axis_b_m * np.sin(psi))
    spectrum = np.fft.rfft(support) / psi.size
    return Shape(
        mean_radius_m=float(spectrum[0].real), deviation_m=2.0 * spectrum[1 : MAX_ORDER + 1]
    )


def orders(radius_m: float, rows: Sequence[tuple[int, float, float]]) -> Shape:
    """Return h = R + sum amplitude cos(n psi + phase) from (order, amplitude_m, phase_rad).

    Raises
    ------
    PlantError
        When an order is outside 1..MAX_ORDER or the sum is not convex at ``radius_m``.
    """
    deviation = np.zeros(max((row[0] for row in rows), default=0), dtype=np.complex128)
    for order, amplitude_m, phase_rad in rows:
        if not 1 <= order <= MAX_ORDER:
            raise PlantError(f"shape order must be 1..{MAX_ORDER}, got {order}")
        deviation[order - 1] += amplitude_m * np.exp(1j * phase_rad)
    return require_convex(Shape(mean_radius_m=radius_m, deviation_m=deviation))


def require_convex(shape: Shape) -> Shape:
    """Return ``shape``, or raise PlantError naming the radius from which it would be convex."""
    if not shape.is_convex:
        raise PlantError(
            f"profile is not convex at mean radius {shape.mean_radius_m:.6g} m; "
            f"it is from {shape.least_convex_radius_m:.6g} m on"
        )
    return shape
