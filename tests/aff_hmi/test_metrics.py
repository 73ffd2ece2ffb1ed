"""``/metrics`` of the screen: the names and numbers of ``aff-runtime metrics``, over a socket."""

from __future__ import annotations

import asyncio
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("starlette")
pytest.importorskip("prometheus_client")

from prometheus_client import parser

from aff_hmi.count_middleware import CountMiddleware
from aff_hmi.gate import BURST, Gate, Rates
from aff_hmi.hub import Hub
from aff_hmi.metrics import FACTS_PATIENCE_S, KEPT_NS, Metrics, answer_of
from aff_hmi.pages import Pages
from aff_hmi.watch import Watch
from aff_runtime.app.door.messages import Facts
from aff_runtime.app.report.metrics.catalogue import BY_NAME, OF_SCREEN
from aff_runtime.app.report.metrics.exposition import CONTENT_TYPE, exposition
from aff_runtime.app.report.metrics.readings import readings
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import HOST, get, screen
from tests.aff_hmi.moments import facts, row, seen
from tests.aff_hmi.served import asked, served
from tests.aff_runtime.app.door.stand import Stand
from tests.aff_runtime.app.report.metrics.test_metrics import START_NS, answer
from tests.doubles.virtual_clock import VirtualClock

pytestmark = pytest.mark.processes

NOW_NS = START_NS + 10_000_000_000


def moment(state: State = State.ACTIVE):
    """Return the moment of a screen, and what the service answers to ``status`` then."""
    said = answer(state=state)
    assert said.live is not None
    values = {name: math.nan if v is None else v for name, v in said.live.signals.items()}
    told = Facts(status=replace(said, live=None, state="STARTING"))
    return seen(values, facts=told, meta=said.live.meta), said


@pytest.mark.parametrize("state", [State.ACTIVE, State.FAULT, State.BYPASS])
def test_the_screen_tells_what_the_command_tells(state: State) -> None:
    looked, said = moment(state)
    ours = readings(answer_of(looked), NOW_NS)
    assert ours == readings(said, NOW_NS)
    assert len({sample.metric for sample in ours}) > 25


@pytest.mark.parametrize(
    "gone", [{"facts_age_s": FACTS_PATIENCE_S + 0.1}, {"facts": None}], ids=["hangs", "never"]
)
def test_a_service_that_is_not_heard_is_not_up(gone: dict[str, object]) -> None:
    looked = replace(moment()[0], **gone)  # type: ignore[arg-type]
    told = {sample.metric: sample.value for sample in readings(answer_of(looked), NOW_NS)}
    assert set(told) == {"aff_build_info", "aff_control_up"}
    assert told["aff_control_up"] == 0.0


@pytest.mark.parametrize("gone", [{"row": None}, {"meta": None}, {"writer_lives": False}])
def test_without_a_control_process_only_the_service_is_told(gone: dict[str, object]) -> None:
    looked = replace(moment()[0], **gone)  # type: ignore[arg-type]
    told = {sample.metric: sample.value for sample in readings(answer_of(looked), NOW_NS)}
    assert told["aff_control_up"] == 0.0
    assert told["aff_recorder_rows_total"] == 10.0
    assert "aff_guard_state" not in told


def test_the_text_is_worked_out_twice_a_second_whoever_asks() -> None:
    clock = VirtualClock(1)
    clock.sleep_until_ns(NOW_NS)
    metrics, (looked, _) = Metrics(clock), moment()
    first = metrics.text(looked)
    other = replace(looked, facts=None)
    clock.advance_ns(KEPT_NS - 1)
    assert metrics.text(other) is first
    clock.advance_ns(1)
    assert "aff_control_up 0.0" in metrics.text(other)


def test_a_flood_of_scrapes_is_told_to_wait(tmp_path: Path) -> None:
    app, _ = screen(tmp_path, VirtualClock(1))
    codes = [get(app, "/metrics").status for _ in range(int(BURST) + 3)]
    assert codes == [200] * int(BURST) + [429] * 3


def test_a_scrape_of_another_name_is_refused_and_has_no_number(tmp_path: Path) -> None:
    app, _ = screen(tmp_path, VirtualClock(1))
    refused = get(app, "/metrics", headers=[("host", "evil.example:8480")])
    assert refused.status == 421
    assert "aff_" not in refused.body


def test_hostile_names_stay_inside_their_labels() -> None:
    hostile = '<b>"} 1\naff_control_up 9\\\u202e_tension_N'
    values = row() | {hostile: 5.0}
    looked = replace(seen(values, facts=facts(line=hostile)), meta=moment()[0].meta)
    text = exposition(readings(answer_of(looked), NOW_NS))
    up = [line for line in text.splitlines() if line.startswith("aff_control_up")]
    assert up == ["aff_control_up 1.0"]
    families = {family.name: family for family in parser.text_string_to_metric_families(text)}
    channels = {
        one.labels["channel"]: one.value for one in families["aff_tension_newtons"].samples
    }
    assert channels[hostile] == 5.0
    assert "Euclid" not in text  # the line's own name is no label


def test_every_answer_is_counted_by_route_and_status_and_no_path_is_a_label() -> None:
    clock = VirtualClock(1)
    hub = Hub(Watch(Path("/nowhere"), clock), clock)
    gate = Gate(Pages(hub, "en", clock).app(), [HOST], Rates(clock))
    app = CountMiddleware(gate, hub.counts, clock)
    for path in ("/", "/", "/static/icon.svg", "/static/x", "/<script>", "/admin"):
        get(app, path)
    get(app, "/", headers=[("host", "evil.example")])
    assert hub.counts.answers == {
        ("/", "200"): 2,
        ("/static/{name}", "200"): 1,
        ("/static/{name}", "404"): 1,
        ("none", "404"): 2,
        ("none", "421"): 1,
    }
    own = {sample.metric for sample in hub.counts.samples(None)}
    assert own <= {metric.name for metric in OF_SCREEN}
    assert "process_resident_memory_bytes" in hub.metrics()


async def look_until_told(stand: Stand) -> tuple[str, dict[str, str], str]:
    """Serve a screen of a door that is served beside it; return the first scrape of its line."""
    async with served(Watch(stand.path, MonotonicClock())) as (port, _):
        while True:
            stand.round(stand.ring)
            found = await asked(port, "/metrics")
            if "aff_tension_newtons" in found[2]:
                return found
            await asyncio.sleep(0.05)


@pytest.mark.wire
def test_prometheus_reads_the_line_over_a_socket(tmp_path: Path) -> None:
    (tmp_path / "rt").mkdir(mode=0o700)
    _, said = moment()
    assert said.live is not None
    values = {name: math.nan if v is None else v for name, v in said.live.signals.items()}
    ahead_ns = MonotonicClock().now_ns() + 3600_000_000_000  # not old, however slow the machine
    stand = Stand(
        tmp_path / "rt",
        columns=tuple(values),
        meta=replace(said.live.meta, start_ns=ahead_ns),
        said=Facts(status=replace(said, live=None, state="STARTING")),
        time=MonotonicClock(),
    )
    stand.writer.write(tuple(values.values()))
    try:
        status, headers, body = asyncio.run(look_until_told(stand))
    finally:
        stand.close()
    assert status == "HTTP/1.1 200 OK"
    assert headers["content-type"] == CONTENT_TYPE
    assert headers["cache-control"] == "no-store"
    families = list(parser.text_string_to_metric_families(body))
    named = {
        re.sub(r"_(bucket|sum|count)$", "", one.name)
        for family in families
        for one in family.samples
    }
    own = {name for name in named if name.startswith("aff_hmi_")}
    counted = ("sockets", "frames_total", "frames_skipped_total")
    counted += ("frame_delay_seconds", "http_duration_seconds")
    first = {"aff_hmi_http_requests_total"}  # the scrape itself is counted when it is answered
    assert own - first == {f"aff_hmi_{name}" for name in counted}
    of_process = {name for name in named if name.startswith("process_")}
    assert named - own - of_process == {sample.metric for sample in readings(said, NOW_NS)}
    assert named - of_process <= set(BY_NAME)
    (tension,) = [one for one in families if one.name == "aff_tension_newtons"]
    assert tension.samples[0].value == 88.25
