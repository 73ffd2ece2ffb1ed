"""The shape law as the site file assembles it, on the whole runtime and the real line."""

from __future__ import annotations

import cmath
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest

from aff_runtime.app.control.shape_keeper import ShapeKeeper
from aff_runtime.app.wiring.shape_file import ShapeFile
from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.base.signals import State
from aff_runtime.config.loader import load_site
from aff_runtime.core.controller import Controller
from aff_runtime.loop.messages import Arm, Bypass
from aff_runtime.loop.record import HEAD
from sim_plant.base.order_tracking import order_amplitudes, reduction_dB
from tests.lockstep.bench import Bench, Setup
from tests.lockstep.known_response import ROOT
from tests.lockstep.silent import SKIPPED_S, silent_rows, watched
from tests.parameter_records import record_of

pytestmark = pytest.mark.timeout(300)
SITE = ROOT / "config" / "euclid.yaml"
ORDERS = tuple(range(1, 13))
ARMED_S, JUDGED_S = 30.0, 20.0
NOISE_FLOOR_N = 3.0 * 0.25 * (2.0 * 0.005 / JUDGED_S) ** 0.5
TURN_S = 1.26


@dataclass
class Shop:
    """A bench with a keeper of shapes, as the control process has one."""

    bench: Bench
    keeper: ShapeKeeper
    said: list[str] = field(default_factory=list)
    kept: dict[str, str] = field(default_factory=dict)
    rows: list[tuple[float, ...]] = field(default_factory=list)


def shop(responses, shapes=None, site_file=SITE, fresh_every=1) -> Shop:
    """Return a bench on the line, with what was kept before."""
    site = load_site(site_file)
    bench = Bench(Setup(site=site_file, responses=responses, soft_start_s=1.5))
    texts = {name: found.to_json() for name, found in responses.items()}
    record = record_of(site, shapes=shapes or {}, responses=texts)
    made = Shop(bench=bench, keeper=None, rows=watched(bench))  # type: ignore[arg-type]
    made.keeper = ShapeKeeper(
        record,
        tell=lambda actuator, text: made.said.append(f"{actuator}: {text}"),
        keep=made.kept.__setitem__,
    )
    channels = len(site.gateway.read.channels)
    fresh = HEAD.index("fresh")

    def publish(row: Sequence[float]) -> None:
        assert isinstance(bench.law, Controller)
        values = row[len(HEAD) : len(HEAD) + channels]
        guard = bench.guard
        is_new = bool(row[fresh]) and int(row[1]) % fresh_every == 0
        made.keeper.feed_trials(bench.law, values, fresh=is_new, quiet=guard.quiet)
        made.keeper.save_when_closed(
            bench.law,
            active=guard.state is State.ACTIVE,
            quiet=guard.quiet,
            unbelieved=frozenset(),
            elapsed_s=0.005,
        )

    bench.outside.watchers.append(publish)
    return made


def ripple(rows: list[tuple[float, ...]]) -> tuple[np.ndarray, float, float]:
    """Return |ripple| of the unwind's orders, of the follower's first, and the unwind's rms, N."""
    unwind_N, pullroll_N, unwind_rad, follower_rad = np.array(rows).T
    orders = order_amplitudes(unwind_N, unwind_rad, ORDERS, {"f": follower_rad})
    follower = order_amplitudes(pullroll_N, follower_rad, (1,), {"u": unwind_rad})
    return np.abs(orders), float(abs(follower[0])), float(np.std(unwind_N))


def learned_in(responses, armed_s: float, judged_s: float):
    """Return ripple before and after, and what was kept at bypass; 200 FPM, the shipped file."""
    made = shop(responses)
    made.bench.run(SKIPPED_S)
    made.bench.arm(armed_s)
    made.rows.clear()
    made.bench.run(judged_s)
    after = ripple(made.rows)
    limits = [a.limit_m_s for a in load_site(SITE).actuators.values()]
    for _, applied in made.bench.applied:
        assert all(abs(v) <= limit + 1e-12 for v, limit in zip(applied, limits, strict=True))
    made.bench.say(Bypass())
    made.bench.run(0.5)
    return ripple(silent_rows()), after, made.kept


@pytest.fixture(scope="module")
def learned(responses):
    """After ten turns: what a service knows when it is started anew."""
    return learned_in(responses, 12.5, 5.0)


@pytest.fixture(scope="module")
def learned_for_long(responses):
    return learned_in(responses, ARMED_S, JUDGED_S)


@pytest.mark.long  # quick: the total falls to a tenth, below
def test_orders_up_to_the_resonance_fall_by_30_dB_or_to_the_noise(learned_for_long):
    (before_N, _, _), (after_N, _, _), _ = learned_for_long
    for order, b, a in zip(ORDERS, before_N, after_N, strict=True):
        assert reduction_dB(b, a) >= 30.0 or a < NOISE_FLOOR_N, f"{order}x: {b:.3f} -> {a:.4f} N"


def test_the_unwinds_total_ripple_falls_to_a_tenth(learned):
    (_, _, before_N), (_, _, after_N), _ = learned
    assert after_N <= 0.1 * before_N


def test_the_followers_first_order_falls_by_20_dB_beside_it(learned):
    (_, before_N, _), (_, after_N, _), _ = learned
    assert reduction_dB(before_N, after_N) >= 20.0


def test_the_shape_is_kept_in_mm_at_the_encoders_zero(learned):
    *_, kept = learned
    data = json.loads(kept["unwind"])
    assert (data["roll_id"], data["format"]) == (1, "aff-learned-shape-1")
    first = next(r for r in data["orders"] if (r["roll"], r["order"]) == ("unwind", 1))
    assert 0.2 < first["deviation_mm"] < 2.0  # a 12 mm flat spot has a first order of this size
    assert data["imbalance"][0]["roll"] == "unwind"
    assert set(kept) == {"unwind"}  # the follower runs the plain blocks


def at_full_radius(kept: dict[str, str]) -> dict[str, str]:
    """Return what was kept as if at the radius where the line begins.

    Winding off leaves every deviation of this roll what it is, so the line that begins anew
    turns the same roll.
    """
    data = json.loads(kept["unwind"])
    data["radius_m"]["unwind"] = 0.2032
    return {"unwind": json.dumps(data)}


def started(responses, kept, listen_s=9.0) -> Shop:
    """Return a new service on the same roll, after it has listened and armed for two turns."""
    made = shop(responses, at_full_radius(kept))
    made.bench.run(listen_s)
    made.bench.say(Arm())
    made.bench.run(1.5 + 2.0 * TURN_S)
    made.rows.clear()
    made.bench.run(2.0 * TURN_S)
    return made


def turned(text: str, angle_rad: float) -> str:
    """Return a shape file whose encoder has its zero elsewhere."""
    data = json.loads(text)
    for row in data["orders"]:
        if row["roll"] == "unwind":
            row["angle_deg"] += math.degrees(row["order"] * angle_rad)
    return json.dumps(data)


@pytest.mark.long  # quick: on a line of its own, app/control/test_saved_shape.py
def test_the_next_start_is_at_20_dB_within_two_turns(responses, learned):
    (_, _, before_N), _, kept = learned
    made = started(responses, kept)
    assert any("unwind: starts from the shape saved" in text for text in made.said), made.said
    assert ripple(made.rows)[2] <= 0.1 * before_N


@pytest.mark.long  # quick: on a line of its own, app/control/test_saved_shape.py
def test_an_encoder_whose_origin_moved_is_found_out_before_anything_goes_out(responses, learned):
    (_, _, before_N), _, kept = learned
    made = started(responses, {"unwind": turned(kept["unwind"], 0.6)})
    assert any("turned by" in text for text in made.said), made.said
    assert ripple(made.rows)[2] <= 0.12 * before_N


@pytest.mark.long  # quick: on a line of its own, app/control/test_saved_shape.py
def test_the_shape_of_another_roll_is_not_used(responses, learned):
    *_, kept = learned
    other = {**json.loads(kept["unwind"]), "roll_id": 7}
    made = shop(responses, {"unwind": json.dumps(other)})
    made.bench.run(9.0)
    assert any("it is of roll 7, now there is roll 1" in text for text in made.said), made.said
    assert any("swrap_follower: starts from" in text for text in made.said)  # rollers are kept
    weights = made.bench.law.shape_laws()["unwind"].weights()
    assert all(w == 0j for (roll, _), w in weights.items() if roll == "unwind")
    assert weights["swrap_follower", 1] != 0j


@pytest.mark.long  # quick: on a line of its own, app/control/test_saved_shape.py
def test_a_shape_that_is_not_the_rolls_is_refused_by_the_ripple(responses, learned):
    *_, kept = learned
    file = ShapeFile.from_json(kept["unwind"])
    data = json.loads(kept["unwind"])
    mirrored = {
        key: w.conjugate() * cmath.exp(1.3j * key[1] ** 2)
        for key, w in file.profile.weight_m.items()
    }
    for row in data["orders"]:
        w = mirrored[row["roll"], row["order"]]
        row["angle_deg"] = math.degrees(cmath.phase(w))
    made = shop(responses, at_full_radius({"unwind": json.dumps(data)}))
    made.bench.run(9.0)
    assert any("unwind: the shape saved" in t and "not used" in t for t in made.said), made.said


def test_the_follower_stands_on_its_blocks_as_long_as_it_has_no_drive():
    params = site_params(load_site(SITE))
    assert [a.law for a in params.actuators] == ["shape", "blocks"]


@pytest.mark.long
def test_repeated_readings_lengthen_a_trial_and_do_not_end_it(responses, learned):
    *_, kept = learned
    made = shop(responses, at_full_radius(kept), fresh_every=2)
    made.bench.run(9.0)
    (waits,) = made.said
    assert "4 s and 3 turns of every roll with the line running; arm after that" in waits
    made.bench.run(9.0)
    assert any("unwind: starts from the shape saved" in text for text in made.said), made.said


def test_a_roll_exchanged_while_the_output_closes_is_said_and_not_saved_under_the_new_ones_name(
    responses,
):
    made = shop(responses)
    made.bench.run(2.0)
    made.bench.arm(6.0)
    law = made.bench.law
    assert isinstance(law, Controller)
    law.phases.roll_id = 2  # seen by the tick that also closes the output
    made.keeper.save_when_closed(
        law, active=False, quiet=True, unbelieved=frozenset(), elapsed_s=0.0
    )
    assert made.said == ["unwind: roll 2 in the place of roll 1: the shape of unwind is forgotten"]
    data = json.loads(made.kept["unwind"])
    assert {row["roll"] for row in data["orders"]} == {"swrap_follower"}
    assert not data["imbalance"]


@pytest.mark.long
def test_who_arms_before_the_trial_is_over_is_told_what_it_costs(responses, learned):
    *_, kept = learned
    made = shop(responses, at_full_radius(kept))
    made.bench.run(1.0)
    made.bench.say(Arm())
    made.bench.run(4.0)
    waits, dropped = made.said
    assert "waits for its trial" in waits
    assert "learning began before its trial was over; the roll is learned anew" in dropped
    made.keeper.follow(record_of(load_site(SITE)))
    made.bench.run(1.0)
    assert len(made.said) == 2  # an edit of the file repeats neither


@pytest.mark.long
def test_a_roll_that_is_forgotten_before_its_trial_is_not_tried(responses, learned):
    *_, kept = learned
    made = shop(responses, at_full_radius(kept))
    made.bench.run(2.0)
    made.keeper.forget(made.bench.law)
    made.bench.run(9.0)
    weights = made.bench.law.shape_laws()["unwind"].weights()
    assert all(w == 0j for (roll, _), w in weights.items() if roll == "unwind")
    assert weights["swrap_follower", 1] != 0j


def test_a_shape_learned_with_another_drive_is_refused_and_said_once(responses, learned):
    *_, kept = learned
    other = {**json.loads(kept["unwind"]), "belongs_to": "another"}
    made = shop(responses, {"unwind": json.dumps(other)})
    made.bench.run(3.0)
    assert len(made.said) == 1
    assert "another encoder, drive or signal" in made.said[0]
    assert not any(made.bench.law.shape_laws()["unwind"].weights().values())
