"""The scope over HTTP: ticks by GET, windows kept by who may, and what strangers try."""

from __future__ import annotations

import asyncio
import json
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from urllib.parse import quote

import pytest

pytest.importorskip("starlette")

from aff_hmi.gate import HEADERS
from aff_hmi.scope.shot import SECONDS
from aff_hmi.watch import News
from aff_hmi.windows.desk import FULL, LONGEST_NOTE, MOST_S, NO_NAME, NO_TICKS, NOT_THERE
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import HOST, scope
from tests.aff_hmi.pressed import Browser, Pressed
from tests.aff_hmi.scope.played import CYCLE_S, news
from tests.aff_hmi.scope.test_picture import read

HOSTILE = "<img src=x onerror=alert(1)>\u202e=1+1\r\nset-cookie: x=1"
DATA = ("/data/scope", "/data/scope.csv", "/data/windows", "/data/support.zip")


def play(at: Pressed, count: int = 1000, **more: float) -> None:
    """Have ticks 0 ... count - 1 arrive."""
    assert at.hub.sources is not None
    at.hub.sources.listen(news([]))
    at.show(State.ACTIVE)
    at.hub.sources.listen(news(range(count), **more))


def raw(at: Pressed, path: str) -> tuple[int, dict[str, str], bytes]:
    """Return status, headers and body of one GET."""
    said: list[Any] = []

    async def receive() -> Any:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Any) -> None:
        said.append(message)

    asyncio.run(at.gate(scope(path, [("host", HOST)], "http", "GET"), receive, send))
    start, *rest = said
    headers = {k.decode(): v.decode() for k, v in start["headers"]}
    return start["status"], headers, b"".join(one.get("body", b"") for one in rest)


def ident(at: Pressed) -> str:
    assert at.hub.sources is not None
    return at.hub.sources.scope.ticks.ident


def keep(browser: Browser, **more: Any) -> Any:
    said = {"first": 100, "last": 299, "ring": ident(browser.at), "name": "a splice", "note": ""}
    return browser.post("/keep", said | more)


def windows(at: Pressed) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(raw(at, "/data/windows")[2])["windows"]
    return found


def test_ticks_are_asked_for_by_signal_length_and_end(keeping: Pressed) -> None:
    play(keeping)
    path = "/data/scope?signals=unwind_tension_N,tick_us&seconds=1&roll=unwind&end=499"
    status, headers, body = raw(keeping, path)
    assert status == 200
    assert headers["content-type"] == "application/octet-stream"
    head, (_, tension, tick, _) = read(body)
    assert tension == list(range(300, 500))
    assert tick == pytest.approx([0.9] * 200)
    assert head["ring"] == ident(keeping)


def test_a_trigger_is_waited_for_and_found(keeping: Pressed) -> None:
    play(keeping)
    path = "/data/scope?signals=unwind_tension_N&seconds=1&on=rise&of=unwind_tension_N"
    assert read(raw(keeping, f"{path}&level=5000&pre=20")[2])[0]["n"] == -1
    head, _ = read(raw(keeping, f"{path}&level=500&pre=20")[2])
    assert (head["trigger_tick"], head["first"], head["last"]) == (500, 460, 659)


def test_the_strongest_frequencies_come_where_they_are_asked_for(keeping: Pressed) -> None:
    """The angle of the played roll is a saw tooth of 0.1 rad a tick: 20 rad/s."""
    play(keeping, 1000)
    path = "/data/scope?signals=unwind.theta_rad&seconds=5"
    assert read(raw(keeping, path)[2])[0]["lines"] == []
    ((first, second, *_),) = read(raw(keeping, f"{path}&lines=1")[2])[0]["lines"]
    turn_Hz = 0.1 / CYCLE_S / (2.0 * math.pi)
    assert first[0] == pytest.approx(turn_Hz, abs=0.01)
    assert first[1] == pytest.approx(360.0 / math.pi, rel=0.02)  # of a saw tooth from 0 to 360 deg
    assert second[0] == pytest.approx(2.0 * turn_Hz, abs=0.01)
    assert second[1] == pytest.approx(180.0 / math.pi, rel=0.02)


def test_a_trigger_on_one_event_lets_all_others_go_by(keeping: Pressed) -> None:
    play(keeping, 1)
    sources = keeping.hub.sources
    assert sources is not None
    told = [(400, "SPLICE"), (500, "BYPASSED"), (600, "SPLICE")]
    events = [(tick, 0.0, float(BY_NAME[name].code), 0.0) for tick, name in told]
    sources.listen(replace(news(range(1, 1000)), events=events))
    path = "/data/scope?signals=unwind_tension_N&seconds=1&on=event&pre=20"
    for event, tick in (("", 400), ("SPLICE", 400), ("BYPASSED", 500)):
        head, _ = read(raw(keeping, f"{path}&event={event}")[2])
        assert head["trigger_tick"] == tick
    assert read(raw(keeping, f"{path}&event=RIPPLE_ROSE")[2])[0]["n"] == -1
    head, _ = read(raw(keeping, f"{path}&event=SPLICE&after=400")[2])
    assert head["trigger_tick"] == 600


@pytest.mark.parametrize(
    "query",
    [
        "signals=nothing",
        "signals=../../etc/passwd",
        "signals=__class__",
        "signals=unwind_tension_N&roll=swrap",
        "signals=unwind_tension_N&on=rise&of=nothing",
        "signals=" + ",".join(f"s{n}" for n in range(9)),
        "seconds=7",
        "seconds=1e9",
        "end=9" + "9" * 30,
        "level=nan&on=rise&of=unwind_tension_N",
        "kept=-",
        "pre=99",
        "on=%00",
        "on=event&event=BOMB",
        "signals=%ff%fe",
    ],
)
@pytest.mark.parametrize("path", ["/data/scope", "/data/scope.csv"])
def test_what_is_no_request_of_ours_is_refused(keeping: Pressed, path: str, query: str) -> None:
    play(keeping, 10)
    status, _, body = raw(keeping, f"{path}?{query}")
    assert status == 400
    assert len(body) < 300


def test_a_window_that_is_not_there_is_told(keeping: Pressed) -> None:
    play(keeping)
    for number in ("1", "-1", "999999999999999"):
        status, _, body = raw(keeping, f"/data/scope?kept={number}")
        assert (status, json.loads(body)["text"]) == (404, NOT_THERE)


def test_the_largest_picture_has_a_bound(keeping: Pressed) -> None:
    play(keeping, 6000)
    assert keeping.hub.sources is not None
    names = ",".join(one.name for one in keeping.hub.sources.scope.signals[:8])
    body = raw(keeping, f"/data/scope?signals={names}&seconds={max(SECONDS)}&roll=unwind")[2]
    ticks = round(max(SECONDS) / CYCLE_S)
    assert ticks * (8 + 4 * 7) < len(body) < ticks * (8 + 4 * 9) + 8000


@pytest.mark.parametrize("path", DATA)
def test_every_answer_has_the_headers_and_other_methods_none(keeping: Pressed, path: str) -> None:
    play(keeping, 10)
    _, headers, _ = raw(keeping, path)
    for name, value in HEADERS.items():
        assert headers[name] == value
    browser = keeping.browser("anna")
    for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS"):
        headers = browser.headers(b"{}")  # type: ignore[assignment]
        assert browser.ask(method, path, headers, b"{}").status in (403, 405)  # type: ignore[arg-type]
    assert browser.ask("GET", path, [("host", "evil.example")]).status == 421


def test_a_file_name_is_ours_whatever_is_asked(keeping: Pressed) -> None:
    play(keeping)
    path = "/data/scope.csv?signals=unwind_tension_N&roll=unwind&lang=%0d%0aset-cookie:%20x=1"
    status, headers, body = raw(keeping, path)
    assert status == 200
    assert headers["content-disposition"] == 'attachment; filename="aff-ticks.csv"'
    assert "set-cookie" not in headers
    assert body.decode().splitlines()[0].startswith("utc,tick,time_s,state,unwind_tension_N [N]")


def test_a_window_is_kept_shown_and_let_go(keeping: Pressed) -> None:
    play(keeping)
    anna = keeping.browser("anna")
    assert keep(anna, note="second shift").status == 200
    (one,) = windows(keeping)
    assert (one["name"], one["note"], one["who"]) == ("a splice", "second shift", "anna")
    assert (one["first"], one["last"], one["seconds"]) == (100, 299, pytest.approx(0.995))
    assert (one["run"], one["config"], one["line"]) == ("r", "3f9a3f9a", "Euclid")
    play(keeping, 10)
    path = f"/data/scope?kept={one['number']}&signals=unwind_tension_N&seconds=1&end=299"
    head, (_, tension) = read(raw(keeping, path)[2])
    assert tension == list(range(100, 300))
    assert head["ring"] == ""
    assert anna.post("/let-go", {"number": one["number"]}).status == 200
    assert windows(keeping) == []
    assert anna.post("/let-go", {"number": one["number"]}).said["text"] == NOT_THERE
    assert keeping.service.notices[-2:] == ["window kept anna", "window let go anna"]


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ({"first": 299, "last": 100}, NO_TICKS),
        ({"first": -5, "last": 10}, NO_TICKS),
        ({"first": 5000, "last": 5100}, NO_TICKS),
        ({"first": 0, "last": 2**53 - 1}, NO_TICKS),
        ({"first": 0, "last": round(MOST_S / CYCLE_S) + 1}, NO_TICKS),
        ({"ring": "another"}, NO_TICKS),
        ({"ring": ""}, NO_TICKS),
        ({"name": " "}, NO_NAME),
        ({"name": "\n\n"}, NO_NAME),
    ],
    ids=str,
)
def test_what_cannot_be_kept_is_told(keeping: Pressed, more: dict[str, Any], why: str) -> None:
    play(keeping)
    reply = keep(keeping.browser("anna"), **more)
    assert (reply.status, reply.said["text"]) == (409, why)
    assert windows(keeping) == []


def test_a_tenth_of_what_is_asked_for_may_be_gone(keeping: Pressed) -> None:
    play(keeping, 0)
    assert keeping.hub.sources is not None
    keeping.hub.sources.listen(news(range(500, 1000)))
    anna = keeping.browser("anna")
    assert keep(anna, first=0, last=502).said["text"] == NO_TICKS  # three ticks of 503 are left
    assert keep(anna, first=459, last=859).said["text"] == NO_TICKS  # 41 of 401 are gone
    assert keep(anna, first=460, last=859).status == 200  # 40 of 400
    assert keep(anna, first=990, last=5000).said["text"] == NO_TICKS  # ten of 4011 are there
    assert keep(anna, first=901, last=1011).said["text"] == NO_TICKS  # 12 of 111 are to come
    assert keep(anna, first=901, last=1010).status == 200  # 11 of 110
    found = sorted((one["first"], one["last"]) for one in windows(keeping))
    assert found == [(500, 859), (901, 999)]


@pytest.mark.parametrize(
    "spoil",
    [
        lambda said: said | {"first": True},
        lambda said: said | {"first": 1.5},
        lambda said: said | {"first": "1"},
        lambda said: said | {"first": 2**60},
        lambda said: said | {"more": 1},
        lambda said: {key: said[key] for key in ("first", "last")},
        lambda said: said | {"name": None},
        lambda said: [said],
    ],
)
def test_a_body_of_another_shape_is_refused(keeping: Pressed, spoil: Callable[[Any], Any]) -> None:
    play(keeping)
    said = {"first": 1, "last": 9, "ring": ident(keeping), "name": "a b", "note": ""}
    assert keeping.browser("anna").post("/keep", spoil(said)).status == 400


def test_hostile_names_are_text_of_one_line_and_bounded(keeping: Pressed) -> None:
    play(keeping)
    anna = keeping.browser("anna")
    assert keep(anna, name=HOSTILE, note=HOSTILE * 10).status == 200
    (one,) = windows(keeping)
    for text in (one["name"], one["note"]):
        assert text.isprintable()
    assert len(one["note"]) <= LONGEST_NOTE
    page = keeping.browser().get("/scope").said["text"]
    assert "<img src=x" not in page  # names come by data alone, and go in as text


def test_a_column_with_a_hostile_name_is_text_on_the_page_and_in_the_file(
    keeping: Pressed,
) -> None:
    assert keeping.hub.sources is not None
    name = "=1+1<img src=x onerror=alert(1)>{{7*7}}\u202e\n_tension_N"
    columns = ("time_s", "tick", "state", name)
    records = [(n * CYCLE_S, float(n), 3.0, float(n)) for n in range(10)]
    for brought in ([], records):
        keeping.hub.sources.listen(News(ring="one", columns=columns, records=brought))
        keeping.show(State.ACTIVE)
    page = keeping.browser().get("/scope").said["text"]
    assert "<img" not in page
    assert "{{7*7}}" in page
    body = raw(keeping, f"/data/scope.csv?signals={quote(name)}")[2].decode()
    head = body.splitlines()[0]
    assert head.startswith("utc,tick,time_s,state,'=1+1<img")
    assert "\u202e" not in head
    assert len(body.splitlines()) == 11


def test_a_full_share_is_told_and_nothing_is_pushed_out(keeping: Pressed) -> None:
    play(keeping)
    assert keeping.kept is not None
    keeping.kept.store.most_bytes = 40_000
    anna = keeping.browser("anna")
    kept = 0
    while (reply := keep(anna)).status == 200:
        kept += 1
        keeping.clock.advance_ns(10**9)
        assert kept < 20
    assert (reply.status, reply.said["text"]) == (409, FULL)
    assert 0 < kept == len(windows(keeping))


def test_who_waits_for_another_login_keeps_nothing(keeping: Pressed) -> None:
    play(keeping)
    anna = keeping.browser("anna")
    keeping.clock.advance_ns(61 * 60 * 10**9)
    keeping.show(State.ACTIVE)
    assert keep(anna).status == 403
    assert windows(keeping) == []
