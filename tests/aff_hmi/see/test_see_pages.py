"""The pages of rolls and trends: behind the same gate, of the reader, nothing off the host."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

pytest.importorskip("starlette")

from aff_hmi.gate import HEADERS
from aff_hmi.pages import SEEN
from aff_hmi.watch import News
from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import HOST, OWN_SOCKET, shake
from tests.aff_hmi.moments import row
from tests.aff_hmi.pressed import Pressed

DATA = ("/data/events", "/data/events.csv", "/data/trend")


def asked(at: Pressed, path: str, method: str = "GET") -> Any:
    return at.browser().ask(method, path, [("host", HOST)])


def play(at: Pressed) -> None:
    """Have two seconds pass in which ticks arrive."""
    assert at.kept is not None
    values = row()
    for _ in range(5):
        at.kept.listen(News(columns=tuple(values), records=[tuple(values.values())]))
        at.clock.advance_ns(500_000_000)
        at.wall_s += 0.5
        at.show(State.ACTIVE)


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("path", SEEN)
def test_every_page_has_the_headers_and_asks_for_nothing_off_the_host(
    keeping: Pressed, path: str, language: str
) -> None:
    play(keeping)
    reply = asked(keeping, f"{path}?lang={language}")
    assert reply.status == 200
    for name, value in HEADERS.items():
        assert reply.headers[name] == value
    body = reply.said["text"]
    assert f'lang="{language}"' in body
    assert f'href="{path}?lang={language}" aria-current="page"' in body
    assert not re.search(r"""(src|href)=["'](?!/)(?!#)""", body)
    assert not re.search(r"\son\w+=|\sstyle=|javascript:", body)
    assert not re.search(r"<script(?![^>]*src)", body)


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH", "OPTIONS"])
@pytest.mark.parametrize("path", [*SEEN, *DATA])
def test_history_is_for_looking(keeping: Pressed, path: str, method: str) -> None:
    assert asked(keeping, path, method).status in (403, 405)


@pytest.mark.parametrize("path", [*SEEN, *DATA])
def test_a_name_that_is_not_ours_is_refused(keeping: Pressed, path: str) -> None:
    reply = keeping.browser().ask("GET", path, [("host", "evil.example")])
    assert reply.status == 421


def test_a_frame_carries_its_page_and_no_other(keeping: Pressed) -> None:
    play(keeping)
    assert keeping.kept is not None
    head = '{"q":1}'
    assert json.loads(keeping.hub._with_part(head, "rolls", "en"))["page"]["rolls"]
    assert json.loads(keeping.hub._with_part(head, "alarms", "en"))["page"]["alarms"] == []
    for topic in ("", "nothing", "../../etc"):
        assert keeping.hub._with_part(head, topic, "en") == head
    assert shake(keeping.gate, OWN_SOCKET, "/live?page=<script>")[0]["type"] == "websocket.accept"


def test_curves_are_asked_for_by_group_and_window(keeping: Pressed) -> None:
    play(keeping)
    reply = asked(keeping, "/data/trend?group=tension&window=10min&lang=de")
    assert reply.status == 200
    found = reply.said["trend"]
    labels = [c["label"] for c in found["curves"]]
    assert labels == ["unwind tension", "unwind tension, Sollwert"]
    assert found["curves"][0]["mean"][0] == 88.0
    assert found["to_s"] - found["from_s"] == 600.0


@pytest.mark.parametrize(
    "query", ["", "group=tension", "group=x&window=1h", "group=state&window=1h", "window=2h"]
)
def test_a_group_or_window_that_is_none_is_refused(keeping: Pressed, query: str) -> None:
    play(keeping)
    assert asked(keeping, f"/data/trend?{query}").status == 400


def test_a_page_made_before_the_line_is_known_is_told_what_there_is_once_it_is(
    keeping: Pressed,
) -> None:
    query = "/data/trend?group=&window=10min&lang=de"
    assert '<option value="tension"' not in asked(keeping, "/trends").said["text"]
    reply = asked(keeping, query)
    assert (reply.status, reply.said["ok"], reply.said["groups"]) == (200, False, [])
    play(keeping)
    body = asked(keeping, "/trends?lang=de").said["text"]
    told = asked(keeping, query).said["groups"]
    choice = body[body.index('id="group"') : body.index("</select>")]
    assert [tuple(one) for one in told] == re.findall(r'value="([^"]+)"[^>]*>([^<]+)<', choice)
    assert "tension" in [value for value, _ in told]


def test_groups_are_named_in_the_page(keeping: Pressed) -> None:
    play(keeping)
    body = asked(keeping, "/trends?lang=de").said["text"]
    assert "Ordnungen in dB: unwind" in body
    assert 'value="mm unwind"' in body
