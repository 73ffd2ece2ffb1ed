"""The page of alarms and events: what it shows, who may acknowledge, what is asked of history."""

from __future__ import annotations

import csv
import io
import json
from typing import Any
from urllib.parse import unquote

import pytest

pytest.importorskip("starlette")

from aff_hmi.gate import HEADERS
from aff_hmi.notices import conditions_of
from aff_hmi.see.data_routes import harmless
from aff_hmi.see.events import Kind
from aff_hmi.see.rolls_part import rolls_part
from aff_hmi.watch import News
from aff_hmi.words import say_in
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from aff_runtime.telemetry.recorder_messages import RecorderReport
from tests.aff_hmi.asgi import HOST
from tests.aff_hmi.moments import facts, row, seen
from tests.aff_hmi.pressed import Pressed, onlooker

STALE = {"alarm": float(BY_NAME["PLC_STALE"].code)}
ROSE = {"alarm": float(BY_NAME["RIPPLE_ROSE"].code)}
SHELVE = {"key": "PLC_STALE", "minutes": 30, "reason": "cable ordered"}


def show(at: Pressed, **more: float) -> None:
    at.clock.advance_ns(500_000_000)
    at.wall_s += 0.5
    at.show(State.FAULT, **more)


def part(at: Pressed, language: str = "en") -> Any:
    assert at.kept is not None
    return json.loads(at.kept.part("alarms", language))


def asked(at: Pressed, path: str) -> Any:
    return at.browser().ask("GET", path, [("host", HOST)])


def test_an_alarm_says_what_since_when_and_what_to_do_in_the_readers_language(
    keeping: Pressed,
) -> None:
    show(keeping, **STALE)
    (alarm,) = part(keeping)["alarms"]
    event = BY_NAME["PLC_STALE"]
    assert (alarm["text"], alarm["to_do"]) == (event.text, event.action)
    assert (alarm["rank"], alarm["life"], alarm["since_s"]) == (2, "active", keeping.wall_s)
    german = part(keeping, "de")["alarms"][0]
    assert german["text"] != event.text
    assert german["life_word"] == "aktiv"


def test_who_operates_sees_an_alarm_without_the_hand_and_it_is_written_down(
    keeping: Pressed,
) -> None:
    show(keeping, **STALE)
    browser = keeping.browser("anna")
    assert browser.post("/acknowledge", {"key": "PLC_STALE"}).status == 200
    show(keeping, **STALE)
    assert part(keeping)["alarms"][0]["seen_by"] == "anna"
    assert "alarm seen anna" in keeping.service.notices
    assert keeping.service.commands == []
    found = asked(keeping, "/data/events?kind=alarm").said["events"]
    assert [(e["text"], e["who"]) for e in found] == [("PLC_STALE was seen", "anna")]


@pytest.mark.parametrize(("name", "status"), [("", 401), ("vera", 403), ("carl", 200)])
def test_who_may_not_acknowledges_nothing(keeping: Pressed, name: str, status: int) -> None:
    show(keeping, **STALE)
    browser = keeping.browser(name)
    assert browser.post("/acknowledge", {"key": "PLC_STALE"}).status == status
    assert browser.post("/shelve", SHELVE).status == status
    show(keeping, **STALE)
    assert (part(keeping)["alarms"][0]["life"] == "active") is (status != 200)


def test_an_alarm_is_put_aside_with_a_reason_and_taken_back(keeping: Pressed) -> None:
    show(keeping, **STALE)
    browser = keeping.browser("anna")
    assert browser.post("/shelve", {**SHELVE, "reason": "  x "}).status == 409
    assert browser.post("/shelve", SHELVE).status == 200
    show(keeping, **STALE)
    (alarm,) = part(keeping)["alarms"]
    assert (alarm["life"], alarm["shelved"]) == ("shelved", "by anna: cable ordered")
    assert browser.post("/shelve", {**SHELVE, "minutes": 0, "reason": ""}).status == 200
    show(keeping, **STALE)
    assert part(keeping)["alarms"][0]["life"] == "active"


def heard(at: Pressed, name: str, *, tick: int, ago_s: float) -> None:
    assert at.kept is not None
    t_ns = at.clock.now_ns() - round(ago_s * 1e9)
    at.kept.listen(News(ring="r", events=[(float(tick), t_ns, float(BY_NAME[name].code), 0.0)]))


def test_an_alarm_of_the_ring_leads_to_its_ticks_five_seconds_before_and_after(
    keeping: Pressed,
) -> None:
    heard(keeping, "PLC_STALE", tick=4000, ago_s=0.0)
    show(keeping, **STALE)
    (alarm,) = part(keeping)["alarms"]
    assert alarm["page"] == f"/scope?end=5000&tick=4000&at={alarm['since_s']:.3f}"


def test_an_order_that_rests_leads_to_its_roll_and_a_lost_record_to_the_machine() -> None:
    resting = row() | {"unwind.unwind_2x.state": float(OrderState.CLAMPED)}
    lossy = RecorderReport(folder="/r", rows=5, rows_lost=3, alive=True)
    moment = seen(resting, facts=facts(recorder=lossy))
    pages = {one.key.partition(":")[0]: one.page for one in conditions_of(moment, "ACTIVE")}
    assert pages == {"unwind": "/rolls#unwind%20unwind", "RECORDER": "/timing"}
    assert unquote(pages["unwind"]).partition("#")[2] in [
        roll.key for roll in rolls_part(moment, say_in("en")).rolls
    ]


def test_the_overview_has_the_alarms_of_the_book_and_not_what_comes_and_goes(
    keeping: Pressed,
) -> None:
    keeping.hub._viewers.add(onlooker())
    resting = {"unwind.unwind_2x.state": float(OrderState.CLAMPED)}

    def told(**more: float) -> list[str]:
        keeping.clock.advance_ns(500_000_000)
        keeping.show(State.ACTIVE, **more)
        frame = json.loads("{" + keeping.hub._frames["en", ""])
        return [one["name"] for one in frame["alarms"]]

    assert told(**resting) == []
    for _ in range(120):
        names = told(**resting)
    assert names == ["unwind: unwind_2x"]
    assert told() == []


def test_a_permissive_that_went_first_is_told_to_have_taken_the_correction_out(
    keeping: Pressed,
) -> None:
    heard(keeping, "PERMISSIVE_LOST", tick=3900, ago_s=0.5)
    heard(keeping, "PLC_STALE", tick=4000, ago_s=0.0)
    for _ in range(6):
        show(keeping, **STALE)
    (alarm,) = part(keeping)["alarms"]
    assert not alarm["is_first"]
    assert alarm["led_by"] == (
        "the correction was taken out before it, by PERMISSIVE_LOST, 0.500 s earlier"
    )
    assert part(keeping, "de")["alarms"][0]["led_by"] != alarm["led_by"]
    found = asked(keeping, "/data/events?kind=alarm").said["events"]
    firsts = [(e["name"], e["tick"], e["text"]) for e in found if "took" in e["text"]]
    with_it = "took the correction out; with it: PLC_STALE 0.500 s"
    assert firsts == [("PERMISSIVE_LOST", 3900, with_it)]


def test_what_took_the_correction_out_is_kept_as_an_event_once(keeping: Pressed) -> None:
    heard(keeping, "PLC_STALE", tick=4000, ago_s=0.0)
    heard(keeping, "TENSION_IMPLAUSIBLE", tick=4007, ago_s=-0.035)
    for _ in range(6):
        show(keeping, **STALE)
    keeping.browser("anna").post("/acknowledge", {"key": "PLC_STALE"})
    show(keeping)
    assert part(keeping)["alarms"] == []
    found = asked(keeping, "/data/events?kind=alarm").said["events"]
    firsts = [(e["name"], e["tick"], e["text"]) for e in found if "took" in e["text"]]
    with_it = "took the correction out; with it: TENSION_IMPLAUSIBLE 0.035 s"
    assert firsts == [("PLC_STALE", 4000, with_it)]


def test_high_priority_is_not_put_aside(keeping: Pressed) -> None:
    show(keeping, **ROSE)
    browser = keeping.browser("anna")
    reply = browser.post("/shelve", {**SHELVE, "key": "RIPPLE_ROSE"})
    assert (reply.status, "high priority" in reply.said["text"]) == (409, True)
    assert part(keeping)["alarms"][0]["can_shelve"] is False


HOSTILE = "<script>window.owned=1</script>\u202e{alarm}{0}"


def test_a_hostile_reason_stays_text(keeping: Pressed) -> None:
    show(keeping, **STALE)
    keeping.browser("anna").post("/shelve", {**SHELVE, "reason": HOSTILE})
    show(keeping, **STALE)
    shown = part(keeping)["alarms"][0]["shelved"]
    assert "\u202e" not in shown
    assert "{0}" in shown
    texts = [e["text"] for e in asked(keeping, "/data/events").said["events"]]
    assert any("{0}" in text and "\u202e" not in text for text in texts)


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_page_is_of_the_reader_and_behind_the_same_gate(
    keeping: Pressed, language: str
) -> None:
    reply = asked(keeping, f"/alarms?lang={language}")
    assert reply.status == 200
    for name, value in HEADERS.items():
        assert reply.headers[name] == value
    body = reply.said["text"]
    assert f'lang="{language}"' in body
    assert 'data-page="alarms"' in body
    assert ('<option value="unwind"' in body) is True
    assert f'href="/alarms?lang={"de" if language == "en" else "en"}"' in body


BAD = ["kind=x", "before=-1", "before=1e9", "before=" + "9" * 40, "before=٣", "roll=" + "x" * 100]


@pytest.mark.parametrize("query", BAD)
@pytest.mark.parametrize("path", ["/data/events", "/data/events.csv"])
def test_what_is_no_question_is_refused(keeping: Pressed, path: str, query: str) -> None:
    assert asked(keeping, f"{path}?{query}").status == 400


def test_the_file_is_utc_and_no_formula(keeping: Pressed) -> None:
    assert keeping.kept is not None
    keeping.kept.journal.add(Kind.PERSON, "PERSON", "{said}", said='=cmd|"/c calc"!A1')
    show(keeping)
    reply = asked(keeping, "/data/events.csv?kind=person")
    assert reply.headers["content-disposition"].startswith("attachment")
    (line,) = csv.DictReader(io.StringIO(reply.said["text"]))
    assert line["utc"] == "2027-01-15T08:00:00.000+00:00"
    assert line["text"].startswith("'=")
    assert [harmless(c) for c in ("=1", "+1", "-1", "@x", "90 N")] == [
        *("'=1", "'+1", "'-1", "'@x", "90 N")
    ]


def test_a_flood_of_refused_logins_does_not_push_out_the_rest(keeping: Pressed) -> None:
    assert keeping.kept is not None
    for _ in range(500):
        keeping.kept.person("login refused", "nobody")
    show(keeping)
    assert len(asked(keeping, "/data/events?kind=person").said["events"]) == 10


def test_a_screen_that_keeps_nothing_has_no_such_page(at: Pressed) -> None:
    assert at.browser().get("/alarms").status == 404
    assert at.browser().get("/data/events").status == 404
