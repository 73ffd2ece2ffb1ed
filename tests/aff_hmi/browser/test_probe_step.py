"""The probe's step of the page Commissioning: its bounds first, and louder where it was faint."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pyarrow")

from aff_runtime.app.commission.link.answers import Answer, LineShown
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.views import of_line as views
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import PASSWORD, Stage
from tests.aff_hmi.browser.told import Told

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
ROW = views.ProbeRow(
    actuator="unwind",
    amplitude=0.02,
    limit=0.05,
    unit="m/s",
    signal="unwind_tension_N",
    signal_unit="N",
    ripple=2.5,
    is_chosen=True,
    bound_share=0.1,
    sent=0.004,
    louder=0.008,
)
RESPONSE = views.ResponseView(
    actuator="unwind",
    unit="N/(m/s)",
    measured_at="2026-11-27T03:00:00Z",
    speed_m_s=1.0,
    radius_m=0.2,
    delay_s=0.04,
    points=(views.PointView(1.0, 40.0, -57.3, 31.0, 0.91),),
    drive=(),
    repeat_sigmas=1.25,
    repeat_most=2.0,
)


class Probed(Told):
    """A commissioner that also tells of the line."""

    row = ROW
    response = RESPONSE

    async def _ask(self, asked: Request) -> Answer:
        if asked.do != "line":
            return await super()._ask(asked)
        probe = views.ProbeView(duration_s=25.0, rows=(self.row,))
        return LineShown(
            line=views.LineView(
                errors=(), warnings=(), drives=(), probe=probe, responses=(self.response,)
            )
        )


@pytest.fixture
def told() -> Probed:
    return Probed()


@pytest.fixture
def page(told: Probed, chromium: Any, tmp_path: Path) -> Iterator[Any]:
    stage = Stage(tmp_path, commission=told)
    screen = Page(chromium, f"{stage.url}login", "")
    screen.page.fill("#name", "carl")
    screen.page.fill("#password", PASSWORD)
    screen.page.press("#password", "Enter")
    screen.await_selector("#arm")
    screen.page.goto(f"{stage.url}commission?lang=en")
    if screen.page.is_visible("#take"):
        screen.page.click("#take")
        screen.page.wait_for_timeout(300)
        screen.page.goto(f"{stage.url}commission?lang=en")
    screen.page.wait_for_selector("#bounds li", state="attached")
    yield screen.page
    stage.close()


def test_bounds_and_the_difference_of_two_probes_stand_there_in_units_of_the_plant(
    page: Any,
) -> None:
    said = page.text_content("#bounds li")
    for part in ("at most 0.02 m/s", "chosen from the noise", "by 2.5 N at most", "by 10 %"):
        assert part in said
    assert "louder: 0.008 m/s" in said
    assert "1.25 of the stated errors" in page.text_content("#found")
    assert "40 N/(m/s)" in page.text_content("#found table")


def test_a_louder_probe_is_offered_where_one_was_faint_and_the_bound_lets_more(
    page: Any, told: Probed
) -> None:
    page.wait_for_selector("#probe-louder", state="visible")
    told.row = replace(ROW, louder=None, bound_share=None, bound_N=3.0)
    page.reload()
    page.wait_for_selector("#bounds li", state="attached")
    page.wait_for_function("() => document.getElementById('louder').hidden")
    assert "moves by 3 N" in page.text_content("#bounds li")
