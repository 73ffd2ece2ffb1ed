"""From an empty folder to ACTIVE and a signed card at the screen alone, on a simulated line.

No command is given but `sim-plant live --fresh`, which stands for the box: plant, service,
commissioner and screen.
What only a person sees (displays, the PLC's manual) a table has.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest

from aff_runtime.app.card.entries import Signed
from aff_runtime.app.card.verify import verify
from aff_runtime.app.card.work import CardFile
from aff_runtime.app.hand import audit
from benchmarks.wizard.fresh_line import FreshLine
from benchmarks.wizard.playing import (
    activated,
    measured,
    probed,
    proven,
    ready_to_probe,
    rest_measured,
    signed,
)
from benchmarks.wizard.technician import by_name
from tests.aff_hmi.browser.axe import grave_findings
from tests.aff_hmi.browser.commissioned import ANSWERS, Technician
from tests.aff_hmi.browser.test_looks import looked_at

pytestmark = [pytest.mark.browser, pytest.mark.timeout(2100)]
WIDTHS = {360: 740, 768: 1024, 1280: 800, 1920: 1080}
LOOKS = list(product(WIDTHS, ("en", "de")))
WORD = re.compile(r"word \d+ ")


@pytest.fixture(scope="module")
def line(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FreshLine]:
    found = FreshLine(tmp_path_factory.mktemp("fresh") / "line")
    yield found
    found.close()


def pictured(who: Technician, pictures: Path, path: str, name: str, shows: str) -> None:
    """Keep a page at four widths in both languages; nothing is cut off or lies over another."""
    for width, language in LOOKS:
        who.page.set_viewport_size({"width": width, "height": WIDTHS[width]})
        who.go(path, language)
        who.page.wait_for_selector(shows)
        looked_at(who.screen, width)
        who.screen.picture(pictures / f"{name}-{width}-{language}.png")
    who.page.set_viewport_size({"width": 1280, "height": 800})
    who.go(path)
    who.page.wait_for_selector(shows)
    assert grave_findings(who.page) == []


def test_a_line_is_commissioned_at_the_screen_alone(
    chromium, line: FreshLine, pictures: Path
) -> None:
    who = Technician(chromium, line, viewport={"width": 1280, "height": 800})
    page = who.page
    site = line.folder / "euclid.yaml"
    assert not site.exists()
    words_are_found(who, line, pictures)
    assert site.exists()
    ready_to_probe(who)
    probed(who)
    pictured(who, pictures, "commission", "commission-found", "#found .response")
    activated(who)

    stands = measured(who)
    proof = proven(who)
    stands |= {12: proof.stand, **rest_measured(who)}
    assert signed(who, stands) == [0, 3, 4, 12], (stands, proof)
    pictured(who, pictures, "card", "card", "#card:not([hidden])")
    page.pdf(path=str(pictures / "card.pdf"))

    assert not verify(line.folder / "card", records=True).wrong
    said = [one.content for one in CardFile.of(line.folder / "card").entries]
    assert sorted(one.step for one in said if isinstance(one, Signed)) == [0, 3, 4, 12]
    assert {one.name for one in said if isinstance(one, Signed)} == {"demo"}
    kept = list(line.folder.rglob("commissioning/*/audit.jsonl"))
    assert [audit.verify(path).wrong for path in kept] == [""]
    assert line.password not in kept[0].read_text()
    assert [text for text in who.screen.complaints if "409" not in text] == []


def words_are_found(who: Technician, line: FreshLine, pictures: Path) -> None:
    """Answer the interview: with pictures, a silent PLC, and a technician who leaves."""
    page = who.page
    shown = {**ANSWERS, "port": line.plc_port, "unwind_radius_m.display": line.radius_shown}
    given = by_name(shown)
    who.go("commission")
    who.open()
    page.click("#find-words")
    page.wait_for_selector("#job:not([hidden])")
    who.answers(given, until="unwind_tension_N.pick")
    load_cell_is_told_by_moving_it(who, line, pictures)
    who.answers(given, until="line_speed_m_s.pick")
    pictured(who, pictures, "commission", "commission-words", "#question:not([hidden])")
    who.answers(given, until="pullroll_tension_N.display")
    line.tell("fault", "mute:6")
    assert "retry" in who.answers(given, until="speed_max")
    page.click("#stop")
    page.wait_for_selector("#job[hidden]", state="attached")
    assert not (line.folder / "euclid.yaml").exists()
    page.click("#find-words")
    page.wait_for_selector("#job:not([hidden])")
    asked = who.answers(given)
    assert asked[0] == "speed_max"
    page.wait_for_function(
        "() => document.getElementById('job-last').textContent.includes('euclid.yaml')"
    )


def load_cell_is_told_by_moving_it(who: Technician, line: FreshLine, pictures: Path) -> None:
    """Another word reads nearly the same: Enter takes none, a hand decides."""
    page = who.page
    rows = page.locator("#rows button").all_text_contents()
    assert len(rows) > 1
    assert "word 2 " in {found for row in rows for found in WORD.findall(row)}
    who.answer("")
    page.wait_for_selector("#refused:not(:empty)")  # it is asked anew
    assert "no row is taken unasked" in str(page.text_content("#refused"))
    who.screen.picture(pictures / "commission-alike.png")
    page.click('#rows button[data-value="move"]')
    page.wait_for_selector('#question[data-name="unwind_tension_N.rest2"]:not([hidden])')
    who.answer("")
    page.wait_for_selector('#question[data-name="unwind_tension_N.move2"]:not([hidden])')
    assert "press on the roller of its load cell" in str(page.text_content("#asked"))
    who.answer("")
    line.tell("fault", "absurd=unwind_tension_N:3")  # a hand on the roller, and no light one
    page.wait_for_selector('#question[data-name="unwind_tension_N.pick2"]:not([hidden])')
    first = str(page.locator("#rows button").first.text_content())
    assert WORD.findall(first) == ["word 2 "]
    assert "changed by" in first
    assert str(page.text_content("#default")).endswith(": 1")
    who.answer("")
