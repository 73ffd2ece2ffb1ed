"""Settings behind the gate: who looks, in which words, and what a press passes on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette")

from aff_runtime.app.hand.may import WORDS, Code, Place, Role
from aff_runtime.app.hand.messages import Welcome
from aff_runtime.app.link.settings_answer import SAVED_MEANWHILE
from aff_runtime.app.link.settings_request import reason_of
from aff_runtime.app.supervisor.settings.desk import ANOTHER_TRY, TAKEN_BACK
from aff_runtime.app.supervisor.settings.text_checks import BEING_CHECKED
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.signals import State, Status
from tests.aff_hmi.commission.test_presses import SITE, STATE, Heard, commissioned
from tests.aff_hmi.pressed import PASSWORD, Pressed, quick

HELP = (
    "Time in which the ripple settles. Start at 60; shorten until it stops improving, then double "
    "it. Too short amplifies noise and hunts."
)
SETTLE = {
    "path": "actuators.unwind.blocks[0].settle_s",
    "name": "settle_s",
    "kind": "number",
    "unit": "s",
    "allowed": "1 to 300 s",
    "choices": [],
    "default": "required",
    "shown": "6 s",
    "written": "6",
    "live": True,
    "can_edit": True,
    "help": HELP,
}
WAITS = SETTLE | {"path": "line.name", "live": False, "help": "<b>"}
ABSENT = SETTLE | {"path": "a.settle_s", "written": "", "can_edit": False}
VERSION = {
    "number": 4,
    "when": "2026-01-05T06:00:00.000Z",
    "who": "tech1",
    "verb": "returned",
    "why": "its time is up",
    "sha256": "0" * 64,
    "run": "",
}
VIEW = {
    "site": "/site.yaml",
    "sha256": "1" * 64,
    "running": "1" * 64,
    "against": "the site file is not what runs: look at the alarms, or wait",
    "said": [{"path": "line.name", "text": "<script>"}],
    "sections": [{"path": "", "roll": "", "settings": [SETTLE, WAITS, ABSENT]}],
    "versions": [VERSION],
}
CHANGE = "actuators.unwind.blocks[0].orders: [1, 2] -> [1, 2, 3]"
DIFFERENCE = {
    "sha256": "2" * 64,
    "changes": [f"{CHANGE} (applies at once)", "line.cycle_ms: 5 ms -> 10 ms (waits for bypass)"],
    "said": [],
    "refused": False,
    "waits": True,
    "lines": ["-a", "+b"],
}
EDIT = {"base": "1" * 64, "edits": f"{SETTLE['path']}: 12", "text": "a: 1\n"}
TRY = EDIT | {"measured": "2" * 64, "seconds": 60, "reason": "hunting at 1x"}
SAVE = EDIT | {"measured": "2" * 64, "reason": "the PLC is slow"}
BACK = {"number": 3, "base": "1" * 64, "measured": "2" * 64, "reason": "as in spring"}


def passed(said: dict[str, Any]) -> dict[str, Any]:
    """Return what the commissioner is told of a press."""
    return {("site_text" if key == "text" else key): value for key, value in said.items()}


@pytest.fixture
def heard() -> Heard:
    found = Heard()
    back = {
        "version": VERSION,
        "lines": [],
        "back": DIFFERENCE,
        "running": "1" * 64,
        "against": "",
    }
    found.answers |= {
        "settings": {"ok": True, "settings": VIEW},
        "settings_diff": {"ok": True, "difference": DIFFERENCE},
        "settings_version": {"ok": True, "version": back},
    }
    return found


@pytest.fixture
def at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, heard: Heard) -> Pressed:
    quick(monkeypatch)
    return Pressed(tmp_path, commission=heard)


def test_a_setting_says_in_the_readers_words_what_changing_it_does(at: Pressed) -> None:
    view = at.browser("vera").get("/data/settings?lang=de").said["settings"]
    settle, waits, absent = view["sections"][0]["settings"]
    assert settle["does"].startswith("gilt sofort")
    assert settle["help"].startswith("Zeit, in der sich die Welligkeit beruhigt")
    assert (settle["is_english"], settle["kind_word"]) == (False, "eine Zahl")
    assert waits["does"].startswith("gilt ab dem nächsten Bypass")
    assert (waits["help"], waits["is_english"]) == ("<b>", True)
    assert absent["does"].startswith("steht nicht als ein Wert")
    assert view["against"].startswith("die Anlagendatei ist nicht, was läuft")
    (row,) = view["versions"]
    assert (row["verb_word"], row["why"]) == (
        "nach einem Versuch zurückgekehrt",
        "die Zeit ist um",
    )
    english = at.browser("vera").get("/data/settings?lang=en").said["settings"]
    assert english["sections"][0]["settings"][0]["help"] == HELP


def test_what_an_edit_would_do_is_told_with_units_and_passed_on_without_a_key(
    at: Pressed, heard: Heard
) -> None:
    found = at.browser("carl").post("/settings/diff?lang=de", EDIT).said["difference"]
    assert found["changes"] == [
        f"{CHANGE} (gilt sofort)",
        "line.cycle_ms: 5 ms -> 10 ms (wartet auf Bypass)",
    ]
    assert heard.said == [{"do": "settings_diff", **passed(EDIT)}]


def test_another_persons_edit_is_told_in_place_of_a_difference(at: Pressed, heard: Heard) -> None:
    heard.answers["settings_diff"] = {"ok": False, "why": "changed", "name": ""}
    reply = at.browser("carl").post("/settings/diff?lang=de", EDIT)
    assert (reply.status, reply.code) == (409, "changed")
    assert "jemand hat es geändert" in reply.said["text"]


@pytest.mark.parametrize("number", ["", "x", "-1", "9" * 40])
def test_what_is_no_number_of_a_version_asks_for_none(
    at: Pressed, heard: Heard, number: str
) -> None:
    reply = at.browser("vera").get(f"/data/settings/version?number={number}&lang=de")
    assert heard.said == [{"do": "settings_version", "number": 0, "back": False}]
    assert reply.said["version"]["back"]["changes"][0].endswith("(gilt sofort)")


@pytest.mark.parametrize(("who", "back"), [("vera", False), ("anna", False), ("carl", True)])
def test_what_going_back_would_change_is_asked_of_the_service_for_who_commissions(
    at: Pressed, heard: Heard, who: str, back: bool
) -> None:
    assert at.browser(who).get("/data/settings/version?number=3").status == 200
    assert heard.said == [{"do": "settings_version", "number": 3, "back": back}]


def test_a_try_and_a_way_back_carry_key_place_base_and_what_was_seen(
    at: Pressed, heard: Heard
) -> None:
    carl = commissioned(at)
    carl.post("/commission/open", {"password": PASSWORD, "over": False})
    carl.take()
    assert carl.post("/settings/try", TRY).status == 200
    assert carl.post("/settings/save", SAVE).status == 200
    assert carl.post("/settings/back", BACK).status == 200
    person = {"key": "k" * 43, "place": "panel"}
    assert heard.said[1:] == [
        {"do": "try_settings", **person, **passed(TRY)},
        {"do": "save_settings", **person, **passed(SAVE)},
        {"do": "go_back", **person, **BACK},
    ]


PRESSES: list[tuple[str, dict[str, Any]]] = [
    ("/settings/try", TRY),
    ("/settings/save", SAVE),
    ("/settings/back", BACK),
]


@pytest.mark.parametrize(("path", "said"), PRESSES)
def test_what_may_refuses_is_not_passed_on(
    at: Pressed, heard: Heard, path: str, said: dict[str, Any]
) -> None:
    carl = commissioned(at)
    assert carl.post(path, said).code == "no hand"
    carl.take()
    at.show(State.READY, status=float(int(Status.REMOTE)))
    reply = carl.post(f"{path}?lang=de", said)
    assert (reply.status, reply.code) == (409, "remote")
    assert reply.said["text"].startswith("die Anlage ist auf Fern")
    at.show(State.READY)
    at.service.rules = Welcome(version="1", ceiling=Role.OPERATE, arms_from=Place.PANEL)
    assert carl.post(path, said).code == "no settings"
    assert heard.said == []


def test_nothing_else_is_tried_while_something_is(at: Pressed, heard: Heard) -> None:
    carl = commissioned(at)
    carl.take()
    at.tries(True)
    assert carl.post("/settings/try", TRY).code == "trying"
    assert carl.post("/settings/save", SAVE).code == "trying"
    assert heard.said == []


def test_a_session_that_went_idle_asks_nothing(at: Pressed, heard: Heard) -> None:
    carl = at.browser("carl")
    at.clock.advance_ns(16 * 60 * 10**9)
    assert carl.post("/settings/diff", EDIT).code == "idle"
    assert heard.said == []


@pytest.mark.parametrize(
    ("trying", "left_s", "left"),
    [
        ("", -1, None),
        ("settings 0123 by carl: at 9 s left", 54.6, 55),
        ("settings 0123 by carl", 0.0, 0),
        ("settings 0123 by carl", -1, None),
    ],
)
def test_the_seconds_that_are_left_are_counted_for_everybody(
    at: Pressed, heard: Heard, trying: str, left_s: float, left: int | None
) -> None:
    service = {
        "answers": True,
        "state": "ACTIVE",
        "heard": True,
        "blocked": "",
        "probing": False,
        "probed": "",
        "trying": trying,
        "trying_left_s": left_s,
        "tried": "0" * 64 if trying else "",
        "differs": [],
        "learned": [],
    }
    heard.answers["state"] = STATE | {"site": SITE, "service": service}
    assert at.browser("anna").get("/data/commissioning").said["left_s"] == left


def too_short() -> str:
    with pytest.raises(RefusedError) as refused:
        reason_of(" seven77 ")
    return str(refused.value)


@pytest.mark.parametrize(
    "text",
    [
        ANOTHER_TRY,
        BEING_CHECKED,
        SAVED_MEANWHILE,
        TAKEN_BACK,
        *(WORDS[code] for code in (Code.NO_TRY, Code.TRYING, Code.REMOTE, Code.SETTINGS_ROLE)),
        too_short(),
    ],
)
def test_what_the_service_says_against_a_press_is_told_in_german(
    at: Pressed, heard: Heard, text: str
) -> None:
    heard.answers["settings"] = {"ok": True, "settings": VIEW | {"against": text}}
    vera = at.browser("vera")
    assert vera.get("/data/settings?lang=en").said["settings"]["against"] == text
    german = vera.get("/data/settings?lang=de").said["settings"]["against"]
    assert german != text
    assert "{" not in german
