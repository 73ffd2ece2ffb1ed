"""A side view of the line, with the places that a verdict names."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from sim_plant.base.arrays import Array
from sim_plant.base.svg import as_written, svg
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.arrays.locations import places_of, zones
from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.verdict import Verdict

FOUND, WEB, BODY = "#b3261e", "#5f6368", "#202124"
WIDTH_IN = 10.0
"""Of the picture."""
HEIGHTS_IN = (2.0, 6.0)
"""Of the picture, at least and at most."""
LEAST_SHARE = 0.006
"""Of the line's length: the radius that a thin roller is drawn with."""
_LEFT_OF = {"ccw": -1.0, "cw": 1.0}
"""Side of the web's direction on which a body is touched, by its rotation."""


@dataclass(frozen=True, slots=True)
class Marks:
    """Indices of bodies and of spans."""

    bodies: frozenset[int] = frozenset()
    spans: frozenset[int] = frozenset()

    def __or__(self, other: Marks) -> Marks:
        return Marks(self.bodies | other.bodies, self.spans | other.spans)

    def __sub__(self, other: Marks) -> Marks:
        return Marks(self.bodies - other.bodies, self.spans - other.spans)


def marks_of(line: Declaration, place: EffectAt) -> Marks:
    """Return where an effect sits: at bodies, or along spans."""
    effect = BY_NAME[place.effect]
    if effect.place == "number":
        return _marks_of_number(line, place.location)
    found = places_of(line, effect, place.location, "verdict")
    if effect.place == "web":
        return Marks(spans=frozenset(range(len(line.spans))))
    if effect.place == "span":
        return Marks(spans=frozenset(found))
    if effect.place == "cell":
        rollers = [sensor.roller for sensor in cell_sensors(line)]
    elif effect.place == "loop":
        rollers = [loop.acts_on for loop in line.control.tension_pi]
    elif effect.place == "body":
        rollers = [roller.name for roller in line.rollers]
    else:
        rollers = [drive.roller for drive in line.control.drives]
    return Marks(bodies=frozenset(line.body(rollers[k]) for k in found))


def _marks_of_number(line: Declaration, number: str) -> Marks:
    """Return what a declared number is of, by its path: a roller, a cell's, or the web."""
    words = number.split(".")
    if words[0] == "web":
        return Marks(spans=frozenset(range(len(line.spans))))
    named = {s.roller for s in cell_sensors(line) if s.channel in words}
    bodies = (k for k, r in enumerate(line.rollers) if r.name in words or r.name in named)
    return Marks(bodies=frozenset(bodies))


def marks_of_verdict(line: Declaration, verdict: Verdict) -> tuple[Marks, Marks]:
    """Return what was found, and what it may be instead or where something unknown is."""
    found = _together(marks_of(line, effect.place) for effect in verdict.effects)
    also = _together(
        marks_of(line, place) for entry in verdict.ambiguous for place in entry.alternatives
    )
    by_zone = zones(line)
    for item in verdict.unknown:
        for said in item.coordinate.values():
            rolls = (k for k, body in enumerate(line.rollers) if body.name == said)
            spans = frozenset(by_zone.get(str(said), ()))
            also |= Marks(bodies=frozenset(rolls), spans=spans)
    return found, also - found


def _together(marks: Iterable[Marks]) -> Marks:
    whole = Marks()
    for one in marks:
        whole |= one
    return whole


def web_path_m(line: Declaration) -> Array:
    """Return (spans, 2, 2): where each free span leaves a body and meets the next, x and y, m.

    A body that turns counterclockwise is touched on the right of the web's direction, one that
    turns clockwise on the left.
    """
    ends = np.empty((len(line.spans), 2, 2))
    for k, span in enumerate(line.spans):
        angle = radians(span.direction_deg)
        left = np.array([-sin(angle), cos(angle)])
        for end, name in enumerate((span.start, span.end)):
            body = line.rollers[line.body(name)]
            side = _LEFT_OF[body.rotation] * body.radius_m
            ends[k, end] = np.array([body.center_x_m, body.center_y_m]) + side * left
    return ends


def sketch(line: Declaration, verdict: Verdict) -> str:
    """Return the side view as SVG; empty where the verdict names no place."""
    found, also = marks_of_verdict(line, verdict)
    if found == also == Marks():
        return ""
    path = web_path_m(line)
    low, high = _extent_m(line)
    size = high - low
    height = float(np.clip(WIDTH_IN * size[1] / size[0], *HEIGHTS_IN))
    figure = Figure(figsize=(WIDTH_IN, height))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    for k, ends in enumerate(path):
        is_found, is_open = k in found.spans, k in also.spans
        axes.plot(
            *ends.T,
            color=FOUND if is_found or is_open else WEB,
            lw=2.5 if is_found else 1.8 if is_open else 1.0,
            ls="--" if is_open else "-",
            zorder=1,
        )
    _draw_bodies(axes, line, found, also, LEAST_SHARE * float(size[0]))
    return svg(figure, tight=False, letters=True)


def _extent_m(line: Declaration) -> tuple[Array, Array]:
    """Return the lower left and upper right corners, m, with room for the names."""
    centres = np.array([[body.center_x_m, body.center_y_m] for body in line.rollers])
    radii = np.array([[body.radius_m] for body in line.rollers])
    low, high = (centres - radii).min(axis=0), (centres + radii).max(axis=0)
    room = 0.04 * float(np.max(high - low))
    return low - room, high + room


def _draw_bodies(
    axes: Axes, line: Declaration, found: Marks, also: Marks, least_radius_m: float
) -> None:
    """Draw the bodies: driven ones with a heavy rim, load cells as triangles below theirs."""
    cells = {sensor.roller for sensor in cell_sensors(line)}
    driven = {drive.roller for drive in line.control.drives}
    for k, (body, free_side) in enumerate(zip(line.rollers, _free_sides(line), strict=True)):
        x, y, r = body.center_x_m, body.center_y_m, max(body.radius_m, least_radius_m)
        is_found, is_open = k in found.bodies, k in also.bodies
        colour = FOUND if is_found or is_open else BODY
        rim = 3.0 if body.name in driven else 2.0 if is_open else 1.0
        fill = FOUND if is_found else "white"
        axes.add_patch(Circle((x, y), r, facecolor=fill, edgecolor=colour, lw=rim, zorder=2))
        if body.name in cells:
            axes.plot(x, y - r, "^", color=WEB, markersize=6, zorder=3)
        away = (r + 1.2 * least_radius_m) * free_side
        axes.text(
            x + away[0],
            y + away[1],
            as_written(body.name),
            ha="left" if free_side[0] > 0.0 else "right",
            va="bottom" if free_side[1] > 0.0 else "top",
            fontsize=8,
            color=colour,
            fontweight="bold" if is_found or is_open else "normal",
        )


def _free_sides(line: Declaration) -> Array:
    """Return per body (n, 2) a direction away from the web on it: there is room for its name."""
    sides = np.zeros((len(line.rollers), 2))
    for span, ends in zip(line.spans, web_path_m(line), strict=True):
        for name, touched in zip((span.start, span.end), ends, strict=True):
            body = line.rollers[line.body(name)]
            centre = np.array([body.center_x_m, body.center_y_m])
            sides[line.body(name)] -= (touched - centre) / body.radius_m
    lengths: Array = np.maximum(np.linalg.norm(sides, axis=1, keepdims=True), 1e-9)
    return np.asarray(sides / lengths)
