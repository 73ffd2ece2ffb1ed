"""The service in numbers: names, values, and what is left out when it is old."""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from aff_runtime.app.report.alarm_table import EVENTS, PRIORITIES
from aff_runtime.app.report.command_counts import CommandCount
from aff_runtime.app.report.line_facts import LineFacts, line_facts
from aff_runtime.app.report.metrics.catalogue import (
    BY_NAME,
    CATALOGUE,
    COUNTER,
    HISTOGRAM,
    INFO,
    OF_SCREEN,
    OF_SERVICE,
)
from aff_runtime.app.report.metrics.exposition import exposition
from aff_runtime.app.report.metrics.readings import TICK_PATIENCE_S, MetricHistogram, readings
from aff_runtime.app.report.probe_facts import probes_of
from aff_runtime.app.report.status import live_status
from aff_runtime.app.report.status_answer import ComingMeeting, StatusAnswer, read_answer
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.errors import AffError, ConfigError
from aff_runtime.base.events import TABLE
from aff_runtime.base.signals import State, Status
from aff_runtime.cli.main import main
from aff_runtime.cli.metrics import write
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.telemetry.header import Right, RunMeta
from aff_runtime.telemetry.recorder_messages import RecorderReport
from tests import quick_yaml
from tests.aff_runtime.app.report.test_status import SHAPE_SITE, shape_record
from tests.each_case import each_case

ROOT = Path(__file__).parents[5]
START_NS = 5_000_000_000
NEED = ["LINE_RUN", "WEB_INTACT"]
UNITS = ("newtons", "meters", "meters_per_second", "radians_per_second", "radians", "hertz")
UNITS += ("seconds", "newton_meters", "ratio", "bytes")
UNITLESS = {
    "up",
    "state",
    "active",
    "ok",
    "resting",
    "granted",
    "differs",
    "sessions",
    "sockets",
    "notes",
}


def answer(*, age_s: float = 0.004, state: State = State.ACTIVE) -> StatusAnswer:
    row: dict[str, float] = {
        "time_s": 10.0,
        "tick": 1999.0,
        "state": state,
        "status": Status.LINE_RUN,
        "alarm": 0,
        "outcome": 0,
        "fresh": 1.0,
        "age_s": age_s,
        "missed_count": 3.0,
        "unwind_tension_N": 88.25,
        "tension_ref_N": 90.0,
        "line_speed_m_s": 1.016,
        "unwind_radius_m": 0.2,
        "correction_unwind_m_s": 0.0125,
        "applied_ratio_unwind_m_s": 0.75,
        "limit_ratio_unwind_m_s": 1.0,
        "unwind.omega_rad_s": 5.0,
    }

    tick = TickRow(row | shape_record("unwind_3x", OrderState.CLAMPED))
    _, live = live_status(tick, NEED, SHAPE_SITE)
    meta = RunMeta(start_ns=START_NS, rights=(Right(granted=False, text="SCHED_FIFO 80: no"),))
    meeting = ComingMeeting(
        actuator="unwind",
        time_s=90.0,
        roll="a",
        order=4,
        other_roll="b",
        other_order=1,
        radius_m=1,
    )
    return StatusAnswer(
        line="L",
        state=state.name,
        config_hash="ab" * 32,
        recorder=RecorderReport(
            folder="/r",
            rows=10,
            rows_lost=2,
            ring_overruns=1,
            alive=True,
            kept_bytes=70,
            max_bytes=100,
            free_bytes=900,
        ),
        control_restarts=1,
        audit_records=8123,
        audit_ok=0,
        commands=(CommandCount(action="arm", via="hmi", result="late", count=3),),
        probes=tuple(probes_of({"unwind": response(measured_at="2026-01-02T03:04:05+00:00")})),
        meetings=(meeting,),
        facts=line_facts(SHAPE_SITE, NEED),
        live=replace(live, meta=meta),
    )


def response(**about: str) -> str:
    points = [
        ResponsePoint(
            frequency_Hz=f, gain=900.0, phase_rad=-0.2 * f, relative_error=e, coherence=c
        )
        for f, e, c in ((0.5, 0.01, 0.99), (4.0, 0.05, 0.83), (9.0, 0.02, 0.97))
    ]
    provenance = Provenance(actuator="unwind", signal="unwind_tension_N", **about)
    return Response(points=points, delay_s=0.03, provenance=provenance).to_json()


def values(given: StatusAnswer | None, tick_age_s: float = 0.0) -> dict[tuple[str, ...], float]:
    now_ns = START_NS + int((10.0 + tick_age_s) * 1e9)
    return {(s.metric, *s.labels): s.value for s in readings(given, now_ns)}


@each_case("metric", CATALOGUE, ids=lambda m: m.name)
def test_a_name_says_its_unit_and_kind(metric) -> None:
    name = metric.name
    assert re.fullmatch(r"aff(_[a-z]+)+", name)
    assert name.endswith("_total") == (metric.kind == COUNTER)
    assert name.endswith("_info") == (metric.kind == INFO)
    assert not re.search(r"_(ms|us|mm|deg|dB|percent|pct)(_|$)", name)
    if metric.kind not in (COUNTER, INFO):
        assert name.endswith(UNITS) or name.rpartition("_")[2] in UNITLESS
    assert all(re.fullmatch(r"[a-z]+", label) for label in metric.labels)


def test_every_name_stands_once_and_in_the_document() -> None:
    page = (ROOT / "docs/technician/metrics.md").read_text()
    assert len(BY_NAME) == len(CATALOGUE)
    assert set(re.findall(r"^\| `(aff_\w+)`", page, re.MULTILINE)) == set(BY_NAME)


def test_every_sample_is_of_the_catalogue_with_its_labels() -> None:
    of_service = {metric.name for metric in OF_SERVICE}
    for sample in readings(answer(), START_NS + 10_000_000_000):
        assert len(sample.labels) == len(BY_NAME[sample.metric].labels), sample
        assert sample.metric in of_service
    assert not of_service & {metric.name for metric in OF_SCREEN}


def test_numbers_are_those_of_the_tick_in_SI() -> None:
    said = values(answer())
    assert said["aff_tension_newtons", "unwind_tension_N"] == 88.25
    assert said["aff_tension_reference_newtons", "tension_ref_N"] == 90.0
    assert ("aff_tension_newtons", "tension_ref_N") not in said
    assert said["aff_speed_meters_per_second", "line_speed_m_s"] == 1.016
    assert said["aff_roll_radius_meters", "unwind"] == 0.2
    assert said["aff_correction_meters_per_second", "unwind"] == 0.0125
    limit_m_s = SHAPE_SITE.actuators["unwind"].limit_m_s
    assert said["aff_correction_limit_meters_per_second", "unwind"] == limit_m_s
    assert said["aff_ticks_total",] == 2000.0
    assert said["aff_permissive_ok", "LINE_RUN"] == 1.0
    assert said["aff_permissive_ok", "WEB_INTACT"] == 0.0
    assert said["aff_guard_state", "ACTIVE"] == 1.0
    assert sum(v for k, v in said.items() if k[0] == "aff_guard_state") == 1.0
    assert said["aff_next_order_meeting_seconds", "unwind"] == 90.0
    assert said["aff_realtime_right_granted", "SCHED_FIFO 80"] == 0.0
    when = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC).timestamp()
    assert said["aff_probe_timestamp_seconds", "unwind"] == when
    assert said["aff_probe_coherence_lowest_ratio", "unwind"] == 0.83
    of_worst = Response.from_json(response()).phase_error_bound_rad(4.0)
    assert said["aff_probe_phase_error_highest_radians", "unwind"] == of_worst
    assert said["aff_recordings_bytes",] == 70.0
    assert said["aff_recordings_limit_bytes",] == 100.0
    assert said["aff_disk_free_bytes",] == 900.0
    assert said["aff_control_restarts_total",] == 1.0
    assert said["aff_audit_records_total",] == 8123.0
    assert said["aff_audit_chain_ok",] == 0.0
    assert said["aff_commands_total", "arm", "hmi", "late"] == 3.0
    (block,) = answer().blocks
    of = ("unwind", block.roll, str(block.order))
    assert block.amplitude is not None
    assert said["aff_roll_deviation_meters", *of] == pytest.approx(1e-3 * block.amplitude)
    assert said["aff_order_resting", *of, "limit"] == 1.0


def test_a_service_that_does_not_tick_has_no_line() -> None:
    alive = values(answer(), TICK_PATIENCE_S - 0.1)
    dead = values(answer(), TICK_PATIENCE_S + 0.1)
    assert alive["aff_control_up",] == 1.0
    assert dead["aff_control_up",] == 0.0
    of_line = ("tension", "order", "guard", "permissive", "correction", "ticks", "roll", "alarm")
    assert not [name for name, *_ in dead if name.split("_")[1] in of_line]
    assert dead["aff_recorder_rows_total",] == 10


def test_what_a_silent_plc_said_last_is_left_out() -> None:
    said = values(answer(age_s=0.5, state=State.FAULT))
    assert said["aff_plc_heartbeat_age_seconds",] == 0.5
    assert said["aff_correction_applied_ratio", "unwind"] == 0.75
    names = {name for name, *_ in said}
    assert not names & {"aff_tension_newtons", "aff_permissive_ok", "aff_roll_radius_meters"}


def test_no_service_is_told_as_not_up() -> None:
    assert {name for name, *_ in values(None)} == {"aff_build_info", "aff_control_up"}
    assert values(None)["aff_control_up",] == 0.0


def test_what_is_not_known_is_no_sample() -> None:
    given = answer()
    assert given.live is not None
    lacks = {**given.live.signals, "unwind_tension_N": None}
    said = values(replace(given, live=replace(given.live, signals=lacks)))
    assert ("aff_tension_newtons", "unwind_tension_N") not in said
    assert all(math.isfinite(value) for value in said.values())


@pytest.mark.parametrize("about", [{}, {"measured_at": "last week"}])
def test_a_response_that_does_not_say_when_has_no_time_and_a_spoilt_one_no_number(about) -> None:
    texts = {"unwind": response(**about), "follower": "{", "pull": "[]"}
    (probe,) = probes_of(texts)
    assert (probe.actuator, probe.measured_utc_s) == ("unwind", None)
    said = values(replace(answer(), probes=(probe,)))
    assert ("aff_probe_timestamp_seconds", "unwind") not in said
    assert ("aff_probe_coherence_lowest_ratio", "unwind") in said


def test_what_an_older_service_does_not_say_is_no_sample() -> None:
    said = answer().to_json()
    for name in ("control_restarts", "audit_records", "audit_ok", "commands", "probes"):
        del said[name]
    said["recorder"] = {"rows": 10, "alive": True}
    names = {name for name, *_ in values(read_answer(json.loads(json.dumps(said))))}
    assert "aff_recorder_rows_total" in names
    assert not [
        name for name in names if re.search("restarts|audit|commands|recordings|disk|probe", name)
    ]


def test_facts_and_meetings_pass_the_request_socket() -> None:
    given = answer()
    assert given.facts is not None
    assert read_answer(json.loads(json.dumps(given.to_json()))) == given
    assert LineFacts.from_json(json.loads(json.dumps(given.to_json()))["facts"]) == given.facts


def test_the_text_is_read_back_by_prometheus_own_parser() -> None:
    parser = pytest.importorskip("prometheus_client.parser")
    text = exposition(readings(answer(), START_NS + 10_000_000_000))
    families = {f.name: f for f in parser.text_string_to_metric_families(text)}
    assert families["aff_tension_newtons"].samples[0].value == 88.25
    assert families["aff_ticks"].type == "counter"
    read = {
        (s.name, *(s.labels[label] for label in BY_NAME[s.name].labels)): s.value
        for family in families.values()
        for s in family.samples
    }
    assert read == values(answer())


def test_without_prometheus_own_package_the_numbers_are_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A gateway without the screen has no package of Prometheus."""
    told = exposition(readings(answer(), START_NS + 10_000_000_000))
    monkeypatch.setitem(sys.modules, "prometheus_client", None)
    assert exposition(readings(answer(), START_NS + 10_000_000_000)) == told
    assert 'aff_tension_newtons{channel="unwind_tension_N"} 88.25\n' in told
    with pytest.raises(AffError, match="install aff-runtime"):
        exposition([], has_process=True)


def test_two_lines_of_one_gateway_are_told_apart_by_a_label() -> None:
    parser = pytest.importorskip("prometheus_client.parser")
    histogram = MetricHistogram("aff_tick_duration_seconds", ((math.inf, 6.0),), 0.25)
    samples = (*readings(answer(), START_NS + 10_000_000_000), histogram)
    seen = set()
    for line in ("film1", "film2"):
        for family in parser.text_string_to_metric_families(exposition(samples, line=line)):
            for one in family.samples:
                assert one.labels["line"] == line
                key = (one.name, *sorted(one.labels.items()))
                assert key not in seen
                seen.add(key)
    assert "line=" not in exposition(samples)


def test_a_histogram_has_its_sum_its_count_and_every_edge() -> None:
    parser = pytest.importorskip("prometheus_client.parser")
    name = "aff_tick_duration_seconds"
    text = exposition([MetricHistogram(name, ((0.001, 2.0), (0.01, 5.0), (math.inf, 6.0)), 0.25)])
    (family,) = parser.text_string_to_metric_families(text)
    assert (family.name, family.type) == (name, HISTOGRAM)
    read = {
        (one.name.removeprefix(name), one.labels.get("le")): one.value for one in family.samples
    }
    assert read == {
        ("_bucket", "0.001"): 2.0,
        ("_bucket", "0.01"): 5.0,
        ("_bucket", "+Inf"): 6.0,
        ("_count", None): 6.0,
        ("_sum", None): 0.25,
    }


def test_a_hostile_name_stays_inside_its_label() -> None:
    given = answer()
    assert given.live is not None
    name = 'x"} 1\naff_control_up 1\\_N'
    signals = {**given.live.signals, name: 5.0}
    spoiled = replace(given, live=replace(given.live, signals=signals))
    lines = exposition(readings(spoiled, START_NS + 10_000_000_000)).splitlines()
    assert len([line for line in lines if line.startswith("aff_control_up")]) == 1


def test_a_file_is_replaced_whole_and_a_bad_place_is_named(tmp_path: Path) -> None:
    path = tmp_path / "aff.prom"
    write(path, "a 1\n")
    write(path, "a 2\n")
    assert path.read_text() == "a 2\n"
    assert [one.name for one in tmp_path.iterdir()] == ["aff.prom"]
    (tmp_path / "f").touch()
    with pytest.raises(ConfigError, match="name another --out"):
        write(tmp_path / "f" / "aff.prom", "a 1\n")


def test_without_a_service_the_file_says_so(tmp_path: Path) -> None:
    out = tmp_path / "aff.prom"
    (tmp_path / "rt").mkdir(mode=0o700)
    assert main(["metrics", "--runtime-dir", str(tmp_path / "rt"), "--out", str(out)]) == 3
    assert "aff_control_up 0.0" in out.read_text()
    command = ["metrics", "--runtime-dir", str(tmp_path / "rt"), "--line", "film2"]
    assert main([*command, "--out", str(out)]) == 3
    assert 'aff_control_up{line="film2"} 0.0' in out.read_text()


def test_every_event_is_an_alarm_with_a_priority_or_none() -> None:
    assert set(PRIORITIES) | EVENTS == {event.name for event in TABLE}
    assert not set(PRIORITIES) & EVENTS


def test_alerts_and_dashboard_name_what_there_is() -> None:
    folder = ROOT / "deploy/observability"
    alerts = quick_yaml.safe_load((folder / "alerts.yaml").read_text())
    board = json.loads((folder / "dashboard.json").read_text())
    rules = [rule for group in alerts["groups"] for rule in group["rules"]]
    exprs = [rule["expr"] for rule in rules]
    exprs += [target["expr"] for panel in board["panels"] for target in panel["targets"]]
    named = {name for expr in exprs for name in re.findall(r"\baff_\w+", expr)}
    known = set(BY_NAME) | {f"{one.name}_bucket" for one in CATALOGUE if one.kind == HISTOGRAM}
    assert named <= known
    assert all(rule["annotations"]["do"] for rule in rules)
