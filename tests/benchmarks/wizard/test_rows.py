"""What the wizard's technician answers, which plants are played again, and the page of rows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from aff_runtime.app.card.figures import Figure
from aff_runtime.config.loader import load_site
from benchmarks.rows import write_row
from benchmarks.setup_console.at_the_machine import MOST_TRIES, StuckError
from benchmarks.wizard import __main__ as wizard
from benchmarks.wizard import fresh_line, row
from benchmarks.wizard.answers import Answers, by_files, by_words
from benchmarks.wizard.judging import card_says, judged
from benchmarks.wizard.page import page
from benchmarks.wizard.playing import Pair
from sim_plant.demo.unusual_plants import PLANTS
from sim_plant.servers.map_file import load_plc_map
from tests.aff_runtime.app.card.made import add, book, measured

ROW: dict[str, Any] = {
    "plant": "CAN by DBC", "measured": "2026-11-28T06:00:00", "stage": "card", "site_min": 1.26,
    "active_min": 3.04, "card_min": 11.5, "questions": 60, "typed": ["name", "second"],
    "by_enter": ["a"], "by_moving": ["b"], "by_manual": ["c", "d"], "wrong_words": None,
    "probes": 1, "pairs_begun": 3, "signed": [0, 3, 4, 12], "wrong_in_card": [],
    "stands": {"0": "fail", "3": "pass", "4": "pass", "10": "open", "12": "pass"},
    "ripple": {"unwind_tension_N": {"off_N": 2.0, "on_N": 0.02, "dB": 40.0, "card_dB": 38.96}},
}  # fmt: skip
CUT = {key: ROW[key] for key in ("measured", "questions", "typed", "wrong_words")} | {
    "plant": "no encoder", "stage": "site", "site_min": 2.0, "failed": "Timeout 240000ms",
    "by_enter": [], "by_moving": [], "by_manual": [],
}  # fmt: skip


class AtADisplay(Answers):
    """Displays that stand still; nothing is moved."""

    def mean(self, channel: str) -> float:
        return {"unwind_tension_N": 88.9644, "line_speed_m_s": 1.016}[channel]

    def move(self, channel: str) -> None:
        self.typed.append(f"moved {channel}")


def at_the_screen(name: str, folder: Path) -> AtADisplay:
    words = load_plc_map(PLANTS[name].plc_map(folder))
    return AtADisplay(Path(), PLANTS[name], words, by_words(words, "5021"))


def test_words_come_from_the_manual_displays_from_the_line_and_sure_rows_from_setup(
    tmp_path: Path,
) -> None:
    who = at_the_screen("status bits of its own", tmp_path)
    asked = {
        "port": "5021",
        "count": "33",
        "status.word": "1",
        "bits.WEB_INTACT": "1.12 inverted",
        "applied.swrap_follower": "17",
        "unwind_tension_N.display": "20.0 lbf",
        "unwind_tension_N.pick": "move",
        "unwind_tension_N.rest2": "",
        "unwind_tension_N.move2": "",
        "line_speed_m_s.display3": "200.0 FPM",
        "line_speed_m_s.pick3": "w5",
        "line_speed_ref_m_s.display": "",  # not among the PLC's words
        "unwind_angle_rad.display": "",
        "speed_max": "300 FPM",
    }
    assert {name: who(name, False) for name in asked} == asked
    assert who("unwind_tension_N.pick2", True) == ""
    assert (who.by_moving, who.by_manual) == (["unwind_tension_N"], ["line_speed_m_s"])
    assert who.questions == len(asked) + 1
    assert at_the_screen("no encoder", tmp_path)("unwind_angle_rad.display", True) == "skip"
    for _ in range(MOST_TRIES):
        who("signal.x", False)
    with pytest.raises(StuckError, match=r"signal\.x"):
        who("signal.x", False)


def test_on_a_bus_files_and_channel_are_said_and_a_display_only_where_a_scale_is_asked() -> None:
    plant = PLANTS["CANopen"]
    who = AtADisplay(Path(), plant, None, by_files(plant.wire, "/run/can.sock"))
    said = [who(name, False) for name in ("wire", "channel", "node.2", "line_speed_m_s.display")]
    nodes = "unwind_drive 3 euclid_drive.eds"
    assert said == ["canopen_402", "/run/can.sock", nodes, "200.0 FPM"]


def test_a_plant_is_played_again_unless_its_row_came_to_the_stage_that_is_wanted(
    tmp_path: Path,
) -> None:
    folder = wizard.folder_of(tmp_path, "low words first, against the web")
    assert folder.name == "low-words-first-against-the-web"
    assert not wizard.is_whole(wizard.kept(tmp_path, "CAN by DBC"), "site")
    for one in (ROW, CUT):
        path = wizard.folder_of(tmp_path, one["plant"])
        path.mkdir()
        write_row(path / "row.json", one)
    assert wizard.is_whole(wizard.kept(tmp_path, "CAN by DBC"), "card")
    assert not wizard.is_whole(wizard.kept(tmp_path, "no encoder"), "site")
    assert wizard.main(["--report-only", "--plant", "CAN by DBC", "--out", str(tmp_path)]) == 0
    assert wizard.main(["--report-only", "--plant", "no encoder", "--out", str(tmp_path)]) == 1
    text = (tmp_path / "wizard.md").read_text()
    assert (
        "| CAN by DBC | 1.3 | 3.0 | 11.5 | 60 | 2 | 1 | 1 | 2 | - | 1 | 3 | 4 | yes | 2026-11-28 |"
        in text
    )
    assert "| no encoder | 2.0 | - | - | 60 | 2 | 0 | 0 | 0 | - | - | - | - | - |" in text
    assert "| CAN by DBC | unwind_tension_N | 2.000 | 0.0200 | 40.0 | 39.0 |" in text
    assert "| CAN by DBC | fail | pass | pass | open | pass |" in text
    assert "- no encoder, behind site: Timeout 240000ms" in text


def test_the_page_without_a_row_says_so() -> None:
    assert "No plant has been played" in page([])
    assert "|" not in page([])


def test_ripple_is_that_of_the_corrected_orders_at_the_plant_off_over_on() -> None:
    """Of the unwind in its tension 1x and 2x, 3 N and 4 N; a tenth of both when on."""
    site = load_site(Path("config/euclid_blocks.yaml"))
    time_s = np.arange(0.0, 40.0, 0.01)
    unwind, follower = 5.0 * time_s, 6.6 * time_s
    size = np.where(time_s < 20.0, 1.0, 0.1)
    swing = 3.0 * np.cos(unwind) + 4.0 * np.sin(2.0 * unwind) + np.cos(3.3 * time_s)
    record = {
        "time_s": time_s,
        "true_unwind_angle_rad": unwind,
        "true_swrap_follower_angle_rad": follower,
        "true_unwind_tension_N": 90.0 + size * swing,
        "true_pullroll_tension_N": 60.0 + size * np.cos(follower),
    }
    found = judged(record, [Pair(off=(0.0, 20.0), on=(20.0, 40.0))] * 2, site)
    unwind_N = found["unwind_tension_N"]
    assert unwind_N["off_N"] == pytest.approx(5.0, rel=0.02)
    assert unwind_N["dB"] == pytest.approx(20.0, abs=0.1)
    assert found["pullroll_tension_N"]["off_N"] == pytest.approx(1.0, rel=0.02)


def test_the_card_says_by_tension_what_its_last_proof_measured(tmp_path: Path) -> None:
    card = book(tmp_path)
    assert card_says(tmp_path) == {}
    for value in (12.0, 20.0):
        together = Figure(
            name="unwind_tension_N: all corrected orders together, reduction", value=value
        )
        other = Figure(name="unwind_tension_N, unwind 1x: reduction", value=1.0)
        add(card, measured(12, (together, other)))
    add(card, measured(0))
    assert card_says(tmp_path) == {"unwind_tension_N": 20.0}


def test_a_line_that_does_not_start_is_a_row_that_failed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fresh_line, "PLANT", ("/bin/echo", "no room on the disk:"))
    found = row.played("shipped", tmp_path, lambda _: None)
    assert found["failed"].startswith("the line did not start: no room on the disk: live --fresh")
    assert "- shipped, before the site file: the line did not start" in page([found])
