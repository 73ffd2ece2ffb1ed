"""Refining and maintenance behind the gate: who looks, who presses, and what is passed on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette")

from tests.aff_hmi.commission.test_presses import SITE, STATE, Heard, commissioned
from tests.aff_hmi.pressed import PASSWORD, Pressed, quick

WINDOWS = {"windows": "a@0..60\nb", "holdout": "c@2:00..", "without": "roll_bounce"}
TRY = {"number": 3, "measured": "0" * 64, "seconds": 120, "reason": "the idler is named"}
EXCHANGE = {"roll": "r6", "on": "2026-03-02T14:30:00.000Z", "reason": "serial 4711"}
ASKED = {"windows": ["a"], "holdout": [], "without": [], "by": "carl", "utc": "u"}
ROW = {"number": 3, "asked": ASKED, "kind": "set", "text": "Traced: <b>"}
LACKS = {
    "name": "a",
    "is_held": False,
    "refused": "",
    "length_s": 60.0,
    "speed_m_s": [0.9, 1.2],
    "tension_N": [89.0, 89.0],
    "radius_m": 0.2,
    "lacks": ["one speed only: a line in time and a line in travel look the same"],
    "said": ["AFF on 12 s, off 48 s"],
}
LACKING = {"version": 1, "records": [LACKS], "together": []}
REFINING = {
    "missing": ["/l.yaml: the line file is not there; copy yours there"],
    "folder": "/runs",
    "line": "/l.yaml",
    "command": "sim-plant refine",
    "runs": [],
    "lacking": {"asked": ASKED, "found": LACKING},
    "refined": [ROW],
}
TREND = {
    "roll": "r6",
    "order": 1,
    "signal": "unwind_tension_N",
    "quantity": "stroke",
    "unit": "um",
    "life": 1,
    "count": 2,
    "left_out": 0,
    "speed_m_s": 1.0,
    "now": 47.4,
    "limit": 60.0,
    "stands_out": True,
    "per_1000_km": {"value": 7.5, "low": 6.4, "high": 8.6},
    "line": {"from_size": 40.0, "to_size": 47.4},
    "reached": {"at_s": 3.0, "early_s": 2.0, "late_s": None},
    "jump_s": None,
    "readings": [[1.0, 40.0, 0.5], [2.0, 47.0, 0.5]],
}
SUPPLIERS = {
    "roll": "unwind",
    "by": "shape",
    "unit": "um",
    "orders": [1, 2, 3],
    "suppliers": [
        {
            "number": 9,
            "rolls": 2,
            "medians": [{"order": 1, "size": 500.0, "low": None, "high": None}],
            "worst_roll": 44,
            "worst": {"order": 1, "size": 900.0, "error": 10.0, "unit": "um"},
        }
    ],
    "unknown": 1,
}
MAINTENANCE = {"store": "/watch", "line": "Euclid", "trends": [TREND], "suppliers": [SUPPLIERS]}


@pytest.fixture
def heard() -> Heard:
    found = Heard()
    found.answers |= {
        "refining": {"ok": True, "refining": REFINING},
        "maintenance": {"ok": True, "maintenance": MAINTENANCE},
        "refined": {"ok": False, "why": "refused", "name": "it has come to no verdict"},
        "refined_page": {"ok": True, "html": "<!doctype html>"},
    }
    return found


@pytest.fixture
def at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, heard: Heard) -> Pressed:
    quick(monkeypatch)
    return Pressed(tmp_path, commission=heard)


def test_who_may_look_sees_what_lacks_in_his_language_and_effects_as_they_are(at: Pressed) -> None:
    found = at.browser("vera").get("/data/refining?lang=de").said["refining"]
    assert found["missing"] == ["/l.yaml: die Modelldatei ist nicht da; Ihre dorthin kopieren"]
    (record,) = found["lacking"]["found"]["records"]
    assert record["lacks"][0].startswith("nur eine Geschwindigkeit")
    assert record["said"] == LACKS["said"]
    (row,) = found["refined"]
    assert (row["mark"], row["word"], row["text"]) == (
        "\u25d0",
        "eines von mehreren",
        "Traced: <b>",
    )


def test_a_trend_is_told_in_the_readers_words_with_its_day(at: Pressed) -> None:
    (trend,) = at.browser("vera").get("/data/maintenance?lang=de").said["maintenance"]["trends"]
    assert (trend["quantity"], trend["unit"]) == ("Hub", "\u00b5m")
    assert trend["reached"] == TREND["reached"]
    assert trend["readings"] == TREND["readings"]


def test_suppliers_by_rank_are_told_in_the_readers_words(at: Pressed) -> None:
    (place,) = at.browser("vera").get("/data/maintenance?lang=de").said["maintenance"]["suppliers"]
    assert (place["by"], place["unit"], place["unknown"]) == ("Form", "\u00b5m", 1)
    (who,) = place["suppliers"]
    assert (who["number"], who["worst_roll"], who["worst"]["unit"]) == (9, 44, "\u00b5m")


@pytest.mark.parametrize("number", ["", "x", "-1", "\u0663", "9" * 40])
def test_what_is_no_number_of_a_refinement_asks_for_none(
    at: Pressed, heard: Heard, number: str
) -> None:
    reply = at.browser("vera").get(f"/data/refined?number={number}&lang=de")
    assert reply.said == {"ok": False, "text": "es kam zu keinem Urteil"}
    assert heard.said == [{"do": "refined", "number": 0}]


def test_the_page_of_refine_comes_as_a_file_and_never_as_a_page_of_ours(at: Pressed) -> None:
    reply = at.browser("vera").get("/data/refined.html?number=3")
    assert reply.headers["content-disposition"] == 'attachment; filename="aff-refine.html"'
    assert reply.headers["content-security-policy"].startswith("default-src 'none'")


def test_every_press_is_passed_on_with_key_and_place_and_no_more(
    at: Pressed, heard: Heard
) -> None:
    carl = commissioned(at)
    carl.post("/commission/open", {"password": PASSWORD, "over": False})
    carl.take()
    for path, said in (
        ("/refine/lacks", WINDOWS),
        ("/refine/start", WINDOWS),
        ("/refine/try", TRY),
        ("/refine/stop", {}),
        ("/maintenance/read", {}),
        ("/maintenance/exchange", EXCHANGE),
    ):
        assert carl.post(path, said).status == 200, path
    person = {"key": "k" * 43, "place": "panel"}
    assert heard.said[1:] == [
        {"do": "lacks", **person, **WINDOWS},
        {"do": "refine", **person, **WINDOWS},
        {"do": "try_refined", **person, **TRY},
        {"do": "stop_long", **person},
        {"do": "add_runs", **person},
        {"do": "exchange", **person, **EXCHANGE},
    ]


def test_a_try_of_what_refine_proposes_needs_the_hand(at: Pressed, heard: Heard) -> None:
    carl = commissioned(at)
    assert carl.post("/refine/try", TRY).said["text"] == "take the hand first"
    assert heard.said == []


def test_what_runs_for_hours_is_shown_beside_the_other_job_and_in_short_to_who_may_not(
    at: Pressed, heard: Heard
) -> None:
    job: dict[str, Any] = {"do": "refine", "step": -1, "ask": None, "seconds": 61.0}
    said = [{"kind": "say", "text": "simulating the declared line", "lang": "en"}]
    job["said"] = [{key: one[key] for key in ("kind", "text")} for one in said]
    heard.answers["state"] = STATE | {"site": SITE, "long": job}
    seen = at.browser("carl").get("/data/commissioning").said["long"]
    assert (seen["name"], seen["said"], seen["seconds"]) == ("refine", said, 61.0)
    seen = at.browser("anna").get("/data/commissioning").said["long"]
    assert (seen["name"], seen["said"], seen["seconds"]) == ("refine", [], 61.0)
