"""Card and commissioning behind the gate: who looks, who presses, and what is passed on."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette")

from aff_hmi.commission.link import Commission
from aff_runtime.app.commission.link.answers import Answer, decode
from aff_runtime.app.commission.link.messages import Request, encode
from aff_runtime.app.hand.may import Place, Role
from aff_runtime.app.hand.messages import Welcome
from aff_runtime.base.signals import State, Status
from tests.aff_hmi.pressed import PASSWORD, Pressed, quick

STEP = {"step": 4, "typed": "reaction=ramp", "plc": "", "leave_out": ""}
SIGN = {"step": 4, "measured": "0" * 64, "reason": "seen there", "password": PASSWORD}
ENTRY = {
    "number": 2,
    "utc": "u",
    "sha256": "0" * 64,
    "by": "root; carl",
    "release": "1",
    "reason": "",
    "figures": [],
    "waits_for": [],
    "proposals": [],
    "remarks": [],
    "typed": ["reaction = ramp"],
    "windows": [],
}
CARD = {
    "line": "<script>",
    "first": "0" * 64,
    "newest": "0" * 64,
    "entries": 2,
    "utc": "u",
    "remarks": [],
    "undone": [],
    "proof": None,
    "steps": [
        {
            "number": 4,
            "stand": "pass",
            "title": "Trips",
            "measured": "reaction and its time, typed",
            "limit": "zero or ramp, at most 300 ms",
            "seconds": 0.0,
            "why": [],
            "typed_names": ["reaction"],
            "earlier": 0,
            "can_sign": True,
            "entry": ENTRY,
            "signed": None,
        }
    ],
}
ASK = {"number": 3, "name": "host", "text": "Port", "default": "", "rows": [], "choices": ["no"]}
JOB = {"do": "words", "step": -1, "said": [{"kind": "say", "text": "stopped"}], "ask": ASK}
STATE = {
    "ok": True,
    "protocol": 1,
    "by": "",
    "service": {"answers": False, "trouble": "none listens"},
    "card": True,
    "job": JOB,
    "last": None,
}
SITE = {"path": "/home/line/site.yaml", "there": True, "sha256": "0" * 64}


class Heard(Commission):
    """In place of a commissioner: what was asked, and the answers."""

    def __init__(self) -> None:
        super().__init__(Path("/nowhere"))
        self.said: list[dict[str, Any]] = []
        self.answers: dict[str, Any] = {
            "card": {"ok": True, "card": CARD},
            "page": {"ok": True, "html": "<!doctype html>"},
            "state": STATE | {"site": SITE},
            "open": {"ok": True, "key": "k" * 43},
        }

    async def _ask(self, asked: Request) -> Answer:
        self.said.append(json.loads(encode(asked)))
        return decode(asked.do, json.dumps(self.answers.get(asked.do, {"ok": True})).encode())


@pytest.fixture
def heard() -> Heard:
    return Heard()


@pytest.fixture
def at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, heard: Heard) -> Pressed:
    quick(monkeypatch)
    return Pressed(tmp_path, commission=heard)


OF_CARD = ("/data/card", "/data/card.html", "/data/commissioning", "/data/line")
OF_RUNS = ("/data/refining", "/data/refined", "/data/refined.html", "/data/maintenance")
OF_SETTINGS_PAGE = ("/data/settings", "/data/settings/version")


@pytest.mark.parametrize("path", [*OF_CARD, *OF_RUNS, *OF_SETTINGS_PAGE])
def test_who_has_not_logged_in_sees_nothing_of_it(at: Pressed, heard: Heard, path: str) -> None:
    assert at.browser().get(path).status == 401
    assert heard.said == []


def test_who_may_look_sees_the_card_in_his_language_and_figures_as_they_are(at: Pressed) -> None:
    vera = at.browser("vera")
    found = vera.get("/data/card?lang=de").said["card"]["steps"][0]
    assert (found["title"], found["stand_word"]) == ("Abschaltungen", "bestanden")
    assert found["typed_labels"] == [
        "was der Antrieb tat: zero (null), ramp (Rampe) oder hold (halten)"
    ]
    assert found["entry"] == ENTRY
    reply = vera.get("/data/card.html?paper=letter")
    assert reply.headers["content-disposition"].startswith("attachment")
    assert reply.headers["content-security-policy"].startswith("default-src 'none'")


def test_what_a_person_answers_is_shown_to_who_may_commission_alone(at: Pressed) -> None:
    seen = at.browser("anna").get("/data/commissioning").said
    assert (seen["job"]["said"], seen["job"]["ask"], seen["may"]) == ([], None, False)
    assert "path" not in seen["site"]
    seen = at.browser("carl").get("/data/commissioning?lang=de").said
    assert seen["job"]["said"] == [{"kind": "say", "text": "angehalten", "lang": ""}]
    assert seen["job"]["ask"]["choices"] == [["no", "nein"]]
    assert seen["site"] == SITE


def test_every_press_carries_the_key_and_place_of_its_session_and_what_was_said(
    at: Pressed, heard: Heard
) -> None:
    carl = at.browser("carl")
    person = {"key": "k" * 43, "place": "panel"}
    assert carl.post("/commission/open", {"password": PASSWORD, "over": False}).status == 200
    carl.post("/commission/do", {"do": "begin", "again": ""})
    carl.post("/commission/do", {"do": "words", "again": "host"})
    carl.post("/commission/answer", {"number": 3, "text": "no"})
    carl.post("/card/step", STEP)
    carl.post("/card/sign", SIGN)
    said = {"account": "carl", "password": PASSWORD, "place": "panel", "over": False}
    assert heard.said == [
        {"do": "open", **said},
        {"do": "begin", **person},
        {"do": "words", **person, "again": "host"},
        {"do": "answer", **person, "number": 3, "text": "no"},
        {"do": "step", **person, **STEP},
        {"do": "sign", **person, **SIGN},
    ]


def test_the_key_of_one_session_is_no_other_ones(at: Pressed, heard: Heard) -> None:
    first, second = at.browser("carl"), at.browser("carl")
    first.post("/commission/open", {"password": PASSWORD, "over": False})
    second.post("/card/sign", SIGN)
    assert heard.said[-1]["key"] == ""
    heard.answers["state"]["by"] = "carl"
    assert first.get("/data/commissioning").said["is_open"] is True
    assert second.get("/data/commissioning").said["is_open"] is False


@pytest.mark.parametrize("do", ["arm", "open", "sign", "state", "", "step"])
def test_no_word_but_its_own_is_passed_on(at: Pressed, heard: Heard, do: str) -> None:
    reply = at.browser("carl").post("/commission/do", {"do": do, "again": ""})
    assert (reply.status, reply.code) == (409, "no sense")
    assert heard.said == []


def commissioned(at: Pressed, **more: float) -> Any:
    """Return a browser of who commissions, of a service that lets screens do it."""
    at.service.rules = Welcome(version="1", ceiling=Role.COMMISSION, arms_from=Place.PANEL)
    at.show(State.READY, **more)
    return at.browser("carl")


def test_a_search_needs_the_hand(at: Pressed, heard: Heard) -> None:
    carl = commissioned(at)
    assert carl.post("/card/step", STEP | {"step": 9}).said["text"] == "take the hand first"
    assert heard.said == []
    carl.take()
    assert carl.post("/card/step", STEP | {"step": 9}).status == 200


@pytest.mark.parametrize(
    ("do", "passed"),
    [
        ("try", {"step": 9, "measured": "0" * 64, "seconds": 120, "reason": "it is better"}),
        ("keep", {"measured": "0" * 64, "reason": "it is better"}),
        ("undo", {"measured": "0" * 64, "reason": "it is better"}),
    ],
)
def test_what_is_proposed_is_tried_kept_or_taken_back_with_the_hand(
    at: Pressed, heard: Heard, do: str, passed: dict[str, Any]
) -> None:
    carl = commissioned(at)
    at.tries(do != "try")
    said = {"do": do, "step": 9, "measured": "0" * 64, "seconds": 120, "reason": "it is better"}
    assert carl.post("/card/settings", said).said["text"] == "take the hand first"
    assert heard.said == []
    carl.take()
    assert carl.post("/card/settings", said).status == 200
    assert heard.said == [{"do": do, "key": "", "place": "panel", **passed}]
    assert carl.post("/card/settings", said | {"do": "history"}).code == "no sense"


REFINED = {"number": 1, "measured": "0" * 64, "seconds": 120, "reason": "it is better"}


@pytest.mark.parametrize("lang", ["", "?lang=de"])
def test_what_may_refuses_of_settings_is_not_passed_on(
    at: Pressed, heard: Heard, lang: str
) -> None:
    carl = commissioned(at, status=float(int(Status.REMOTE)))
    carl.take()
    card = {"do": "try", "step": 9} | {k: v for k, v in REFINED.items() if k != "number"}
    presses = {
        f"/refine/try{lang}": REFINED,
        f"/card/settings{lang}": card,
        f"/card/step{lang}": STEP | {"step": 9},
    }
    remote = "die Anlage ist auf Fern" if lang else "the line is in remote"
    for path, said in presses.items():
        reply = carl.post(path, said)
        assert (reply.status, reply.code) == (409, "remote")
        assert reply.said["text"].startswith(remote), reply.said
    at.show(State.READY)
    at.tries(True)
    for path, said in presses.items():
        assert carl.post(path, said).code == "trying"
    at.tries(False)
    assert carl.post("/card/settings", card | {"do": "keep"}).code == "no try"
    at.service.rules = Welcome(version="1", ceiling=Role.OPERATE, arms_from=Place.PANEL)
    assert carl.post("/refine/try", REFINED).code == "no settings"
    assert heard.said == []


def test_a_refusal_is_said_in_the_readers_language(at: Pressed, heard: Heard) -> None:
    carl = at.browser("carl")
    heard.answers["begin"] = {"ok": False, "why": "running", "name": "step 4"}
    reply = carl.post("/commission/do?lang=de", {"do": "begin", "again": ""})
    assert reply.said["text"] == "einen Schritt messen läuft; anhalten oder warten"
    heard.answers["begin"] = {"ok": False, "why": "no such reason", "name": "<b>"}
    assert carl.post("/commission/do", {"do": "begin", "again": ""}).code == "no such reason"


def test_pages_of_card_and_commissioning_are_there_where_there_is_a_commissioner(
    at: Pressed, keeping: Pressed
) -> None:
    for path in ("/card", "/commission", "/refine", "/maintenance", "/settings"):
        assert at.browser().get(path).status == 200
        assert keeping.browser().get(path).status == 404
        assert f"{path}?" not in keeping.browser().get("/").said["text"]
    carl = keeping.browser("carl")
    assert {carl.get(path).status for path in (*OF_CARD, *OF_RUNS, *OF_SETTINGS_PAGE)} == {404}


def test_nothing_of_it_is_done_by_a_session_that_went_idle(at: Pressed, heard: Heard) -> None:
    carl = at.browser("carl")
    at.clock.advance_ns(16 * 60 * 10**9)
    assert carl.post("/card/sign", SIGN).status == 403
    assert heard.said == []
