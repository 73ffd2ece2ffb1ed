"""Turned further on: what a body did later, from the start; the line says where it stood."""

import math

import numpy as np
import pytest

from sim_plant.base.signatures import Frequency
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.line.locations import candidate_locations
from sim_plant.refine.fit.turning import turns_with
from sim_plant.refine.model.hypotheses import hypothesis, turned
from sim_plant.refine.model.twin import Added, Case, Twin, modelled_channels
from tests.sim_plant.refine.small import LINE

CHANNELS = modelled_channels(LINE, [sensor.channel for sensor in LINE.sensors])
SAMPLES, FIRST, LATER, LONG = 3000, 2000, 330, 600
TWIN = Twin(
    declaration=LINE,
    channels=CHANNELS,
    speed_m_s=np.full(SAMPLES, 1.0),
    tension_N=np.full(SAMPLES, 89.0),
    aff_m_s={},
)
ROTATING = [e for e in CATALOGUE if e.quadratures and not isinstance(e.shows, Frequency)]
LIKE_ANOTHER = ("eccentric_roller", "unbalanced_measuring_roller")
"""Turned as the unbalance of a roller, and as an encoder's: against the angle."""
TRIED = [
    pytest.param(e, marks=pytest.mark.campaign if e.name in LIKE_ANOTHER else ()) for e in ROTATING
]


def response(*effects):
    """Return what effects add to tensions and speeds of rollers, and the angles of bodies, rad."""
    out = {}
    for added in (effects, ()):
        run = TWIN.line(Case(effects=added, quick=False))
        run.settle(Case().settle_s, quiet=True)
        out[bool(added)] = run.simulate(TWIN.speed_m_s, TWIN.tension_N, {})
    names = [c for c in CHANNELS if c.endswith(("_N", "_speed_rad_s", "_speed_m_s"))]
    added = np.stack([out[True][name] - out[False][name] for name in names])
    return added, out[True]["body_angle_rad"]


def started(effect, place):
    """Return an effect of typical size with components of its own at every pair that it has."""
    h = hypothesis(effect, place, line=LINE)
    tries = {name: row.tries[0] for name, row in effect.accepts.items() if row.tries}
    values = tries | dict(h.added(h.start).parameters)
    for pair in effect.quadratures[:2]:
        values[pair.cos] = effect.accepts[pair.cos].typical
        values[pair.sin] = 0.5 * effect.accepts[pair.sin].typical
    return values


@pytest.mark.parametrize("effect", TRIED, ids=lambda effect: effect.name)
def test_a_body_further_on_does_from_the_start_what_it_did_later(effect):
    places = [r for r in LINE.rollers if r.name in candidate_locations(LINE, effect)]
    places = [r for r in places if r.kind == "idler"] or places
    place = places[len(places) // 2].name
    values = started(effect, place)
    added = Added(effect.name, place, tuple(values.items()))
    if turns_with(added) != place:
        pytest.skip("turns at a ratio of its own: its angle is its own")
    seen, angles = response(added)
    body = LINE.body(place)
    further_rad = float(angles[FIRST + LATER, body] - angles[FIRST, body])
    again = turned(effect, values, math.remainder(further_rad, 2.0 * math.pi))
    ours, _ = response(Added(effect.name, place, tuple(again.items())))
    then = seen[:, FIRST + LATER : FIRST + LATER + LONG]
    now = ours[:, FIRST : FIRST + LONG]
    assert float(np.linalg.norm(then)) > 0.0
    assert float(np.linalg.norm(now - then)) < 0.5 * float(np.linalg.norm(then))
