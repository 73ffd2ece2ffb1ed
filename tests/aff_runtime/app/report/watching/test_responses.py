"""Responses that probes measured: kept at fixed frequencies, followed at like speed and radius."""

import cmath
import math
from dataclasses import replace
from datetime import UTC, datetime

import duckdb
import numpy as np
import pandas as pd
import pyarrow.parquet
import pytest

from aff_runtime.app.report.parquet import table, write_parquet
from aff_runtime.app.report.watching import sentences
from aff_runtime.app.report.watching.findings import findings
from aff_runtime.app.report.watching.response_rows import errors_at, measured_responses
from aff_runtime.app.report.watching.run_hours import HourRead, run_hours
from aff_runtime.app.report.watching.store import VERSION, Store, load_store, save_store
from aff_runtime.app.report.watching.tables import HOUR_FIELDS, RESPONSE_FIELDS, ResponseRow
from aff_runtime.base.runs.responses import response_file, with_units
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from tests.aff_runtime.app.report.watching.made_store import BEGAN, DAY, HOUR_M, hour
from tests.doubles.virtual_weeks import Weeks, write_weeks

TONES_HZ, ERROR, DELAY_S, GAIN, LAG_S = (0.9, 1.1, 1.7, 2.3, 3.1, 6.9), 0.02, 0.03, 300.0, 0.05
DAYS = 20


def line_at(f, gain=GAIN):
    """Return a drive that lags, behind a pure delay."""
    w = math.tau * f
    return gain / (1.0 + 1j * w * LAG_S) * cmath.exp(-1j * w * DELAY_S)


def response(at, tones=TONES_HZ, gain=GAIN):
    points = [
        ResponsePoint(
            frequency_Hz=f,
            gain=abs(line_at(f, gain)),
            phase_rad=cmath.phase(line_at(f, gain)),
            relative_error=ERROR,
            coherence=0.99,
        )
        for f in tones
    ]
    about = Provenance(
        actuator="unwind",
        signal="unwind_tension_N",
        measured_at=at.isoformat(),
        line_speed_m_s=1.0,
        radius_m=0.2,
    )
    return Response(points=points, delay_s=DELAY_S, provenance=about)


def row(day, gain, phase_rad=-0.5, **more):
    made = ResponseRow(
        run_id=f"run-{day}",
        hour=0,
        time_utc=BEGAN + day * DAY,
        signal="unwind_tension_N",
        actuator="unwind",
        roll="unwind",
        is_roll=True,
        travelled_km=1e-3 * HOUR_M * (day + 0.5),
        frequency_Hz=2.0,
        gain=gain,
        gain_error=3.0,
        gain_unit="N/(m/s)",
        phase_rad=phase_rad,
        phase_error_rad=0.01,
        speed_m_s=1.0,
        radius_m=0.2,
    )
    return replace(made, **more)


def store_of(rows):
    count = 1 + max(int((one.time_utc - BEGAN) / DAY) for one in rows)
    return Store(
        line="Euclid",
        hours=table(HOUR_FIELDS, [hour(day) for day in range(count)]),
        responses=table(RESPONSE_FIELDS, rows),
    )


def found_in(rows):
    return {one.readings.quantity.name: one for one in findings(store_of(rows))}


OFF = np.random.default_rng(3).standard_normal((2, DAYS))


def test_a_gain_that_falls_is_told_in_percent_and_a_phase_that_stays_is_not():
    falls = 1.0 - 0.01 * np.arange(DAYS)
    found = found_in([row(d, 300.0 * falls[d] + 3.0 * OFF[0, d]) for d in range(DAYS)])
    assert found["gain"].per_day.low < -3.0 < found["gain"].per_day.high
    assert (found["gain"].stands_out, found["phase_rad"].stands_out) == (True, False)
    (told,) = sentences.notes(found.values())
    assert told.startswith("unwind gain at 2 Hz falls: -")
    assert told.endswith("; the line answers unwind 19 % less at 2 Hz than on 2026-01-05")


def test_a_response_that_only_scatters_is_not_told():
    rows = [row(d, 300.0 + 3.0 * OFF[0, d], 0.01 * OFF[1, d]) for d in range(DAYS)]
    assert list(sentences.notes(found_in(rows).values())) == []


def test_a_phase_that_passes_half_a_turn_goes_on_and_is_told_in_degrees():
    """0.02 rad a day later, from 0.1 rad short of -pi on: in all 0.38 rad, 21.8 degrees."""
    at = -math.pi + 0.1 - 0.02 * np.arange(DAYS)
    rows = [row(d, 300.0, math.remainder(at[d] + 1e-3 * OFF[1, d], math.tau)) for d in range(DAYS)]
    found = found_in(rows)
    assert np.ptp(found["phase_rad"].readings.size) == pytest.approx(0.38, abs=0.01)
    (told,) = sentences.notes(found.values())
    assert told.endswith("; the line answers unwind 22 deg later at 2 Hz than on 2026-01-05")


def test_probes_at_another_speed_or_radius_are_left_out():
    """The gain of an unwind depends on its radius: rolls that end would look like a drive."""
    rows = [row(d, 300.0) for d in range(10)]
    rows += [row(d, 200.0, radius_m=0.1) for d in range(10, 14)]
    rows += [row(d, 100.0, speed_m_s=2.0) for d in range(14, 17)]
    readings = found_in(rows)["gain"].readings
    assert (readings.size.tolist(), readings.left_out) == ([pytest.approx(300.0)] * 10, 7)


def test_a_fixed_frequency_is_known_between_close_tones_alone():
    one = response(datetime(2026, 1, 5, tzinfo=UTC))
    known = [f for f in (0.5, 1.0, 2.0, 4.0, 8.0) if errors_at(one, f) is not None]
    assert known == [1.0, 2.0]  # 0.5 and 8 outside the band, 4 between 3.1 and 6.9
    gain, phase = errors_at(one, 2.0)
    assert min(gain, phase) >= ERROR / math.sqrt(2.0)  # never better than its tones
    assert abs(math.log(abs(one.at(2.0) / line_at(2.0)))) < gain
    assert abs(cmath.phase(one.at(2.0) / line_at(2.0))) < phase
    on_a_tone = response(datetime(2026, 1, 5, tzinfo=UTC), (1.0, 2.0))
    assert errors_at(on_a_tone, 2.0) == (pytest.approx(ERROR / math.sqrt(2.0)),) * 2
    assert errors_at(on_a_tone, 1.5) is None


def test_add_takes_the_responses_of_a_run_once_and_others_read_them(tmp_path):
    (run,) = write_weeks(Weeks(r6_m=lambda km, _: 4e-5), tmp_path / "runs", range(1))
    before = Store()
    before.add(run_hours(run))
    assert before.responses["hour"].size == 0
    text = with_units(response(datetime(2026, 1, 5, 6, 0, 30, tzinfo=UTC)).to_json(), "N/(m/s)")
    (run / response_file("unwind", text)).write_text(text)
    (run / response_file("rewind", "{}")).write_text("{}")
    store = Store()
    store.add(run_hours(run))
    store.add(run_hours(run))
    assert sum("response-rewind" in one for one in run_hours(run).lost) == 1
    save_store(tmp_path / "store", store)
    path = tmp_path / "store" / "responses.parquet"
    sql = f"select frequency_Hz, gain, phase_rad, gain_unit, hour from '{path}' order by 1"
    rows = duckdb.sql(sql).fetchall()
    assert [(one[0], one[3], one[4]) for one in rows] == [(1.0, "N/(m/s)", 0), (2.0, "N/(m/s)", 0)]
    assert cmath.rect(rows[1][1], rows[1][2]) == pytest.approx(line_at(2.0), rel=0.02)
    assert pd.read_parquet(path)["radius_m"].tolist() == [0.2, 0.2]
    schema = pyarrow.parquet.read_schema(path)
    units = {name: schema.field(name).metadata[b"unit"].decode() for name in ("gain", "phase_rad")}
    assert units == {"gain": "as gain_unit says", "phase_rad": "rad"}


def test_a_response_of_a_run_that_was_altered_or_copied_is_named_and_left_out(tmp_path):
    """Its name has the hash of its text: the gain of a copy had counted twice."""
    text = with_units(response(datetime(2026, 1, 5, 6, 0, 30, tzinfo=UTC)).to_json(), "N/(m/s)")
    name = response_file("unwind", text)
    (tmp_path / name).write_text(text)
    (tmp_path / name.replace("unwind", "rewind")).write_text(text)
    found, lost = measured_responses(tmp_path)
    assert len(found) == 1
    assert [one.partition(": is not the response")[0] for one in lost] == [
        name.replace("unwind", "rewind")
    ]
    (tmp_path / name).write_text(text.replace('"gain"', ' "gain"'))
    found, lost = measured_responses(tmp_path)
    assert (len(found), len(lost)) == (0, 2)


def test_a_response_whose_hour_was_deleted_since_counts_once():
    """It is the nearest hour's; that was another one when the run was read for the first time."""
    store = store_of([row(0, 300.0)])
    later = replace(hour(0), hour=9)
    read = HourRead(hour=later, orders=(), responses=(row(0, 300.0, hour=9),))
    store._replace("run-0", [read])
    assert store.responses["hour"].tolist() == [9]


def test_a_store_without_responses_is_read_on(tmp_path):
    store = store_of([row(0, 300.0)])
    save_store(tmp_path, store)
    about = {"line": store.line, "version": VERSION, "tables": "orders drives"}
    write_parquet(tmp_path / "hours.parquet", HOUR_FIELDS, store.hours, about)
    (tmp_path / "responses.parquet").unlink()
    again = load_store(tmp_path)
    assert (again.hours["hour"].size, again.responses["hour"].size) == (1, 0)
