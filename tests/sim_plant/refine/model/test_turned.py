"""Turned further on: what a body did later, from the start; the line says where it stood."""

import math
from functools import cache

import numpy as np
import pytest

from sim_plant.base.signatures import Frequency
from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.line.arrays.locations import candidate_locations
from sim_plant.refine.fit.turning import turns_with
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.turned import turned
from sim_plant.refine.model.twin import Added, Case, Twin, modelled_channels
from tests.sim_plant.effects.tracing import settling
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
    pytest.param(e, marks=pytest.mark.long if e.name in LIKE_ANOTHER else ()) for e in ROTATING
]


NAMES = [c for c in CHANNELS if c.endswith(("_N", "_speed_rad_s", "_speed_m_s"))]


@pytest.fixture(autouse=True, scope="module")
def settled_shortly():
    with settling(8.0):
        yield


@cache
def simulated(*effects):
    """Return tensions and speeds of rollers with effects, and the angles of bodies, rad."""
    run = TWIN.line(Case(effects=effects, quick=False))
    run.settle(Case().settle_s, quiet=True)
    out = run.simulate(TWIN.speed_m_s, TWIN.tension_N, {})
    return np.stack([out[name] for name in NAMES]), out["body_angle_rad"]


def response(*effects):
    """Return what effects add to tensions and speeds of rollers, and the angles of bodies, rad."""
    with_them, angles = simulated(*effects)
    return with_them - simulated()[0], angles


def started(effect, place):
    """Return an effect of typical size with components of its own at every pair that it has."""
    h = hypothesis(effect, place, line=LINE)
    tries = {name: row.tries[0] for name, row in effect.accepts.items() if row.tries}
    values = tries | dict(h.added(h.start).parameters)
    for pair in effect.quadratures[:2]:
        values[pair.cos] = effect.accepts[pair.cos].typical
        values[pair.sin] = 0.5 * effect.accepts[pair.sin].typical
    return values


PARTS = [
    # effect, what names its order, names of the two parts, order, against the angle
    ("out_of_round_roll", {}, ("cos1_m", "sin1_m"), 1, False),
    ("out_of_round_roll", {}, ("cos3_m", "sin3_m"), 3, False),
    ("out_of_round_roll", {}, ("cos12_m", "sin12_m"), 12, False),
    ("roll_bounce", {"order": 4.0}, ("cos1_kg_m", "sin1_kg_m"), 1, True),
    ("roll_bounce", {"order": 4.0}, ("cosn_kg_m", "sinn_kg_m"), 4, True),
    ("torque_ripple", {"order": 6.0}, ("cos_N_m", "sin_N_m"), 6, True),
    ("encoder_eccentricity", {}, ("cos", "sin"), 1, True),
]


@pytest.mark.parametrize(("name", "given", "parts", "order", "against"), PARTS)
def test_each_part_of_a_body_further_on_is_the_same_shape_seen_from_there(
    name, given, parts, order, against
):
    """A part of order n alone is cos n x - sin n x around the body, or plus against the angle."""
    further_rad, around_rad = 0.7, np.linspace(0.0, math.tau, 97)

    def shape(at_rad, cos, sin):
        sign = 1.0 if against else -1.0
        return cos * np.cos(order * at_rad) + sign * sin * np.sin(order * at_rad)

    values = {**given, parts[0]: 2.0, parts[1]: -0.5}
    again = turned(BY_NAME[name], values, further_rad)
    assert again.keys() == values.keys()
    now = shape(around_rad, *(again[part] for part in parts))
    np.testing.assert_allclose(now, shape(around_rad + further_rad, 2.0, -0.5), atol=1e-12)


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


def test_turning_a_body_turns_its_phasor():
    effect = BY_NAME["eccentric_roller"]
    out = turned(effect, {"cos_m": 1.0, "sin_m": 0.0}, 0.5)
    assert out["cos_m"] == pytest.approx(math.cos(0.5))
    assert out["sin_m"] == pytest.approx(math.sin(0.5))


def test_turning_a_roll_turns_order_n_by_n_times_the_angle():
    effect = BY_NAME["out_of_round_roll"]
    out = turned(effect, {"cos3_m": 1.0, "sin3_m": 0.0, "angle_rad": 0.1}, 0.2)
    assert math.atan2(out["sin3_m"], out["cos3_m"]) == pytest.approx(0.6)
    assert out["angle_rad"] == pytest.approx(0.3)


def test_the_unbalance_of_a_bouncing_roll_turns_by_the_order_it_names():
    values = {"cosn_kg_m": 1.0, "sinn_kg_m": 0.0, "order": 4.0}
    out = turned(BY_NAME["roll_bounce"], values, 0.2)
    assert math.atan2(out["sinn_kg_m"], out["cosn_kg_m"]) == pytest.approx(-0.8)
