"""Where the web touches two bodies, by brute force: moving circles and polygons of points.

A round body is a circle whose centre goes round with it. Any other is a polygon of thousands of
points, each pushed out along its normal as web is wound on it; the touching point is found by
walking along the polygon. Lengths of web come from arcs and edges passed, not from moment arms.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from benchmarks.campaign.jit import compiled

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


class Bodies(NamedTuple):
    """All bodies of a machine, (n,) each, metres.

    Attributes
    ----------
    x, y : axis.
    sense : +1 counter-clockwise, -1 clockwise.
    off_x, off_y : centre of the circle from the axis, in the body at angle 0.
    polygon : row of ``points``, -1 for a circle.
    points, normals : (p, vertices, 2), counter-clockwise, in the body at angle 0.
    """

    x: Array
    y: Array
    sense: Array
    off_x: Array
    off_y: Array
    polygon: IntArray
    points: Array
    normals: Array


@compiled
def turned(angle: float, other: float) -> float:
    """Return ``angle - other`` within half a turn."""
    turn = angle - other
    return turn - 2.0 * math.pi * math.floor(turn / (2.0 * math.pi) + 0.5)


@compiled
def placed(sense: float, theta: float, px: float, py: float) -> tuple[float, float]:
    """Return a body point in the world, from its axis; clockwise bodies are mirrored."""
    c, s = math.cos(theta), math.sin(theta)
    return c * px - s * py, sense * (s * px + c * py)


@compiled
def vertex(b: Bodies, k: int, at: int, out_m: float) -> tuple[float, float]:
    """Return vertex ``at`` of polygon body ``k``, pushed out by ``out_m``, in the body."""
    row = b.polygon[k]
    return (
        b.points[row, at, 0] + out_m * b.normals[row, at, 0],
        b.points[row, at, 1] + out_m * b.normals[row, at, 1],
    )


@compiled
def walk(
    b: Bodies, k: int, theta: float, direction: float, out_m: float, at: int
) -> tuple[int, float]:
    """Return the vertex farthest to the web's side, and the length of edges passed backwards."""
    count = b.points.shape[1]
    sense = b.sense[k]
    # side of the web, (sin, -cos) times the sense, seen from the body
    nx, ny = sense * math.sin(direction), -sense * math.cos(direction)
    ny *= sense
    c, s = math.cos(theta), math.sin(theta)
    qx, qy = c * nx + s * ny, -s * nx + c * ny
    here_x, here_y = vertex(b, k, at, out_m)
    here = qx * here_x + qy * here_y
    passed = 0.0
    for way in (-1, 1):
        while True:
            trial = (at + way + count) % count
            px, py = vertex(b, k, trial, out_m)
            value = qx * px + qy * py
            if value <= here:
                break
            passed -= way * math.hypot(px - here_x, py - here_y)
            at, here, here_x, here_y = trial, value, px, py
    return at, passed


@compiled
def start_vertex(b: Bodies, k: int, theta: float, direction: float, out_m: float) -> int:
    """Return the vertex farthest to the web's side, looking at all of them."""
    best, found = -1e30, 0
    for at in range(b.points.shape[1]):
        px, py = vertex(b, k, at, out_m)
        wx, wy = placed(b.sense[k], theta, px, py)
        value = b.sense[k] * (math.sin(direction) * wx - math.cos(direction) * wy)
        if value > best:
            best, found = value, at
    return found


@compiled
def touch(b: Bodies, k: int, theta: float, out_m: float, at: int) -> tuple[float, float]:
    """Return what the string is laid round: the circle's centre, or the vertex, in the world."""
    if b.polygon[k] >= 0:
        px, py = vertex(b, k, at, out_m)
    else:
        px, py = b.off_x[k], b.off_y[k]
    wx, wy = placed(b.sense[k], theta, px, py)
    return b.x[k] + wx, b.y[k] + wy


@compiled
def span_between(
    b: Bodies,
    k: int,
    radius: Array,
    out_m: Array,
    theta: Array,
    phi: Array,
    vertices: IntArray,
    result: Array,
) -> None:
    """Lay the string from body ``k`` to ``k + 1``; ``phi`` and ``vertices`` are kept up to date.

    ``result``: length, edges passed at the exit and at the entry polygon, lever arms of both.
    """
    passed_a = passed_b = 0.0
    direction = phi[k]
    ra = 0.0 if b.polygon[k] >= 0 else radius[k]
    rb = 0.0 if b.polygon[k + 1] >= 0 else radius[k + 1]
    ax = ay = bx = by = 0.0
    for _ in range(20):
        ax, ay = touch(b, k, theta[k], out_m[k], vertices[k, 0])
        bx, by = touch(b, k + 1, theta[k + 1], out_m[k + 1], vertices[k, 1])
        apart = math.hypot(bx - ax, by - ay)
        reach = b.sense[k + 1] * rb - b.sense[k] * ra
        direction = math.atan2(by - ay, bx - ax) - math.asin(reach / apart)
        settled = True
        if b.polygon[k] >= 0:
            at, gone = walk(b, k, theta[k], direction, out_m[k], vertices[k, 0])
            settled = settled and at == vertices[k, 0]
            vertices[k, 0] = at
            passed_a += gone
        if b.polygon[k + 1] >= 0:
            at, gone = walk(b, k + 1, theta[k + 1], direction, out_m[k + 1], vertices[k, 1])
            settled = settled and at == vertices[k, 1]
            vertices[k, 1] = at
            passed_b += gone
        if settled:
            break
    nx, ny = math.sin(direction), -math.cos(direction)
    leave_x, leave_y = ax + b.sense[k] * ra * nx, ay + b.sense[k] * ra * ny
    reach_x, reach_y = bx + b.sense[k + 1] * rb * nx, by + b.sense[k + 1] * rb * ny
    result[0] = math.hypot(reach_x - leave_x, reach_y - leave_y)
    result[1], result[2] = passed_a, passed_b
    result[3] = b.sense[k] * (nx * (leave_x - b.x[k]) + ny * (leave_y - b.y[k]))
    result[4] = b.sense[k + 1] * (nx * (reach_x - b.x[k + 1]) + ny * (reach_y - b.y[k + 1]))
    phi[k] += turned(direction, phi[k])
