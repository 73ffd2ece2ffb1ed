"""A line over weeks for a screen: the same numbers as in the store, and lives that begin there."""

import math
import shutil
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("pyarrow")

from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.records.maintenance_jobs import (
    MOST_READINGS,
    add_runs,
    exchange,
    maintenance,
    maintenance_view,
    store_of,
)
from aff_runtime.app.report.watching.findings import QUANTITIES, findings
from aff_runtime.app.report.watching.store import load_store, save_store
from aff_runtime.base.errors import ConfigError, RefusedError
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE
from tests.aff_runtime.app.report.watching.made_store import (
    GROWS_M_A_DAY,
    HOUR_M,
    LIMIT_M,
    made_store,
)
from tests.aff_runtime.app.report.watching.test_suppliers import store as supplied_store

DAYS = 30


class Talk:
    def __init__(self):
        self.said = []

    def say(self, text):
        self.said.append(text)

    complain = say


@pytest.fixture
def where(tmp_path):
    site = tmp_path / "site.yaml"
    shutil.copyfile(SITE_FILE, site)
    return Paths(
        site=site,
        state=tmp_path,
        socket=tmp_path / "none",
        card=tmp_path / "card",
        runs=tmp_path / "runs",
    )


@pytest.fixture
def kept(where):
    """Return a store of thirty days that is kept."""
    store = made_store(DAYS)
    folder = store_of(where)
    folder.mkdir(parents=True)
    save_store(folder, store)
    return store


def view(where):
    return maintenance(where, Request(do="maintenance"), Talk()).maintenance


def test_a_growing_stroke_is_told_with_slope_interval_and_day_as_the_store_has_it(where, kept):
    shown = view(where)
    trend = shown.trends[0]
    (found,) = [one for one in findings(kept) if one.readings.quantity.name == "stroke_m"]
    assert (trend.roll, trend.order, trend.quantity, trend.unit) == ("r6", 1, "stroke", "um")
    assert trend.stands_out
    per_km = 1e6 * GROWS_M_A_DAY / (1e-3 * HOUR_M)  # an hour of web a day
    assert trend.per_1000_km.value == pytest.approx(1e3 * per_km, rel=0.05)
    assert trend.per_1000_km.low < 1e3 * per_km < trend.per_1000_km.high
    assert trend.limit == pytest.approx(1e6 * LIMIT_M)
    assert trend.reached.at_s == pytest.approx(trend.readings[-1].at_s + 604800 * found.weeks[0])
    assert trend.reached.early_s < trend.reached.at_s < trend.reached.late_s
    assert shown.notes[0].startswith("r6 1x stroke grows")
    assert (shown.hours, shown.nothing) == (DAYS, "")
    assert shown.web_km == pytest.approx(DAYS * HOUR_M / 1e3)


def test_what_turned_too_little_is_named_with_what_it_lacks(where):
    """As the console says it: of eight whole turns at one speed it has four, at 2 s a turn."""
    made = made_store(3)
    orders, ones = made.orders, np.ones(made.orders["turns"].size)
    lacking = {one.name: math.nan * ones for one in QUANTITIES if one.name in orders}
    turns = {"turns": 4 * ones.astype(int), "frequency_Hz": 0.5 * orders["order"]}
    folder = store_of(where)
    folder.mkdir(parents=True)
    save_store(folder, replace(made, orders={**orders, **lacking, **turns}))
    lacks = "no line, 4 whole turns in its longest steady stretch, 8 are needed, 20 s at one speed"
    assert view(where).without_a_line == (f"r6: {lacks}", f"unwind: {lacks}")
    save_store(folder, made)
    assert view(where).without_a_line == ()


def test_many_readings_are_shown_as_means_of_neighbours(where):
    folder = store_of(where)
    folder.mkdir(parents=True)
    save_store(folder, made_store(3 * MOST_READINGS))
    readings = view(where).trends[0].readings
    assert len(readings) == MOST_READINGS
    assert [one.at_s for one in readings] == sorted(one.at_s for one in readings)


def test_an_exchange_that_somebody_notes_begins_a_life_with_his_name(where, kept):
    said = Request(
        do="exchange",
        roll="r6",
        on="2026-01-25T06:00:00.000Z",
        reason="serial 4711",
        account="carl",
    )
    assert exchange(where, said, Talk()).text == "r6: a new life from 2026-01-25 06:00 UTC"
    first, second = view(where).lives
    assert (second.number, second.why) == (2, "serial 4711 (carl at the screen)")
    assert first.until_s == second.since_s
    assert load_store(store_of(where)).exchanges["roll"].tolist() == ["r6"]


@pytest.mark.parametrize(
    ("roll", "on", "says"),
    [
        ("unwind", "2026-01-25", "roll of web"),
        ("r99", "2026-01-25", "knows no such roller"),
        ("r6", "yesterday", "expected a date"),
    ],
)
def test_an_exchange_that_cannot_be_is_refused_and_nothing_is_changed(where, kept, roll, on, says):
    with pytest.raises(ConfigError, match=says):
        exchange(where, Request(do="exchange", roll=roll, on=on, account="carl"), Talk())
    assert not load_store(store_of(where)).exchanges["roll"].size


def test_suppliers_are_ranked_as_the_console_does_in_the_unit_of_the_screen(tmp_path):
    (place,) = maintenance_view(tmp_path, supplied_store()).suppliers
    assert (place.roll, place.by, place.unit, place.unknown) == ("unwind", "shape", "um", 1)
    first, second = place.suppliers
    assert [(one.number, one.rolls) for one in (first, second)] == [(9, 2), (7, 3)]
    assert [(m.order, m.size, m.low) for m in second.medians] == [
        (1, pytest.approx(400.0), None),
        (2, pytest.approx(200.0), None),
    ]
    assert first.worst_roll == 44
    assert (first.worst.order, first.worst.size) == (1, pytest.approx(900.0))


def test_rolls_without_a_suppliers_number_leave_their_place_without_a_row(tmp_path):
    (place,) = maintenance_view(tmp_path, supplied_store([(0, 1e-4), (0, 2e-4)])).suppliers
    assert (place.suppliers, place.unknown) == ((), 2)


def test_without_a_store_it_says_so_and_what_begins_one(where):
    shown = view(where)
    assert "`aff-runtime watch add STORE RUN_DIR` begins one" in shown.nothing
    assert (shown.trends, shown.lives, shown.rankings) == ((), (), ())


def test_without_runs_nothing_is_read(where):
    with pytest.raises(RefusedError, match="runs"):
        add_runs(where, Request(do="add_runs"), Talk())
    where.runs.mkdir()
    with pytest.raises(RefusedError, match="holds no run yet"):
        add_runs(where, Request(do="add_runs"), Talk())


def test_a_run_that_cannot_be_read_is_named_and_left_out(where):
    broken = where.runs / "20260102T030405Z_Euclid"
    broken.mkdir(parents=True)
    (broken / "run.yaml").write_text("name: Euclid\n")
    talk = Talk()
    assert add_runs(where, Request(do="add_runs"), talk).text == "runs tried: 1, left out: 1"
    assert talk.said[0].startswith("left out: ")
