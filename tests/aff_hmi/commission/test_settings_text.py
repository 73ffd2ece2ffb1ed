"""The text of the site file behind the gate: who edits it, how long it is, what is passed on."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("starlette")

from aff_runtime.config.yaml_marks import MAX_BYTES
from tests.aff_hmi.commission.test_presses import Heard, commissioned
from tests.aff_hmi.commission.test_settings_page import EDIT, SAVE, SETTLE, TRY, passed
from tests.aff_hmi.pressed import PASSWORD, Pressed, quick

TEXT = EDIT | {"former": "a: 2\n"}
EDITED = {
    "base": "1" * 64,
    "file": "a: 1\n",
    "text": "a: <b>\n",
    "said": [{"path": "a", "text": "no", "line": 1, "column": 4}],
    "sections": [{"path": "", "roll": "", "settings": [SETTLE]}],
    "clashes": [{"line": 1, "theirs": ["a: 3"]}],
}
LONGEST = "\n" * MAX_BYTES  # each is two characters of JSON


@pytest.fixture
def heard() -> Heard:
    found = Heard()
    found.answers["settings_text"] = {"ok": True, "edited": EDITED}
    return found


@pytest.fixture
def at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, heard: Heard) -> Pressed:
    quick(monkeypatch)
    return Pressed(tmp_path, commission=heard)


def test_the_text_comes_with_places_and_the_form_in_the_readers_words(
    at: Pressed, heard: Heard
) -> None:
    found = at.browser("carl").post("/settings/text?lang=de", TEXT).said["edited"]
    assert heard.said == [{"do": "settings_text", **passed(TEXT)}]
    assert {key: found[key] for key in ("file", "text", "said", "clashes")} == {
        key: EDITED[key] for key in ("file", "text", "said", "clashes")
    }
    (settle,) = found["sections"][0]["settings"]
    assert settle["does"].startswith("gilt sofort")


@pytest.mark.parametrize("who", ["", "vera", "anna"])
def test_only_who_commissions_edits_the_text(at: Pressed, heard: Heard, who: str) -> None:
    assert at.browser(who).post("/settings/text", TEXT).status in (401, 403)
    assert heard.said == []


def test_the_longest_text_passes_and_one_byte_more_is_refused_in_words(
    at: Pressed, heard: Heard
) -> None:
    carl = commissioned(at)
    assert carl.post("/settings/text", TEXT | {"text": LONGEST, "former": LONGEST}).status == 200
    assert heard.said[-1]["site_text"] == LONGEST
    asked = len(heard.said)
    carl.post("/commission/open", {"password": PASSWORD, "over": False})
    carl.take()
    for path, said in (("text", TEXT), ("diff", EDIT), ("try", TRY), ("save", SAVE)):
        for too_long in (f"{LONGEST}a", "\u00fc" * (MAX_BYTES // 2) + "a"):
            at.clock.advance_ns(10**9)
            reply = carl.post(f"/settings/{path}?lang=de", said | {"text": too_long})
            assert reply.status == 413
            assert reply.said["text"].startswith("der Text hat 257 kB; eine Anlagendatei hat höch")
    assert [one["do"] for one in heard.said[asked:]] == ["open"]


def test_half_a_character_is_no_text(at: Pressed, heard: Heard) -> None:
    reply = at.browser("carl").post("/settings/text", TEXT | {"text": "a: \ud800"})
    assert (reply.status, heard.said) == (400, [])
    assert "half a character" in reply.said["text"]


def test_a_session_that_went_idle_asks_nothing(at: Pressed, heard: Heard) -> None:
    carl = at.browser("carl")
    at.clock.advance_ns(16 * 60 * 10**9)
    assert carl.post("/settings/text", TEXT).code == "idle"
    assert heard.said == []
