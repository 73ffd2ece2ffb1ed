"""The hull beside that of Qhull, on clouds, outlines, and points that are there twice."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from sim_plant.geometry.convex_hull import hull, shape_of_points

ANGLES = 2.0 * np.pi * np.arange(600) / 600.0
CIRCLE = np.exp(1j * ANGLES)
GRID = (np.arange(9)[:, None] + 1j * np.arange(7)).ravel()


def cloud(count):
    return np.random.default_rng(count).standard_normal((count, 2)) @ np.array([1.0, 1j])


@pytest.mark.parametrize(
    "points",
    [
        cloud(5),
        cloud(1000),
        np.concatenate([GRID, GRID[::-1]]),
        np.concatenate([CIRCLE, [1.05 - 0.1j, 1.05 + 0.1j]]),
        CIRCLE * (1.0 + 0.2 * np.cos(3.0 * ANGLES)),
    ],
    ids=["a few", "a cloud", "a grid twice", "pressed flat", "three lobes"],
)
def test_the_hull_has_the_vertices_of_qhull_counterclockwise(points):
    found = hull(points)
    theirs = points[ConvexHull(np.column_stack([points.real, points.imag])).vertices]
    assert set(found.tolist()) == set(theirs.tolist())
    assert found.size == theirs.size
    first, second = np.roll(found, -1) - found, np.roll(found, -2) - np.roll(found, -1)
    assert np.all((np.conj(first) * second).imag > 0.0)
    assert np.sum(np.angle(second / first)) == pytest.approx(2.0 * np.pi)


def test_dents_do_not_change_the_shape():
    dented = CIRCLE * (1.0 - 0.3 * (np.arange(600) % 100 > 90))
    bare = CIRCLE[np.arange(600) % 100 <= 90]
    shapes = [shape_of_points(points) for points in (dented, bare)]
    assert shapes[0].mean_radius_m == pytest.approx(shapes[1].mean_radius_m, rel=1e-14)
    assert np.abs(shapes[0].deviation_m - shapes[1].deviation_m).max() < 1e-14
