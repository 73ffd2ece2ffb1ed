"""In place of a commissioner: what a page is told of a card, a line, and how it stands."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from aff_hmi.commission.in_language import card_in
from aff_hmi.words import say_in
from aff_runtime.app.commission.views import of_line as views
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.test_not_known import JOB, QUESTION, STATE

ENTRY = views.EntryView(
    number=4,
    utc="2026-01-05T06:00:00",
    sha256="4" * 64,
    by="carl",
    release="1",
    reason="",
    figures=(views.FigureView(name="share", value="1 %", span="", limit="", good=None),),
    waits_for=("a longer record",),
    proposals=("settle_s: 6 -> 5",),
    remarks=("one remark",),
    typed=(),
    windows=(),
)
STEP = views.StepView(
    number=12,
    title="Proof on the running web",
    measured="ripple",
    limit="promised",
    seconds=0.0,
    stand="again",
    why=("machine: pc 1, now pc 2",),
    typed_names=("promised", "settle"),
    earlier=0,
    can_sign=True,
    entry=ENTRY,
    signed=None,
)
CARD = views.CardView(
    line="Euclid",
    first="1" * 64,
    newest="3" * 64,
    entries=3,
    utc="2026-01-05T06:00:00",
    remarks=(),
    undone=(),
    steps=(STEP,),
    proof=views.ProofTimes(off_s=25.0, on_s=43.0),
)
PROBE_ROWS = (
    views.ProbeRow(
        actuator="unwind",
        amplitude=0.008,
        limit=0.05,
        unit="m/s",
        signal="unwind_tension_N",
        signal_unit="N",
        ripple=None,
        is_chosen=False,
        bound_N=None,
        bound_share=None,
        lacks=(),
        expected_ripple_N=2.0,
        speed_m_s=1.0,
        sent=None,
        louder=None,
    ),
)
LINE_VIEW = views.LineView(
    errors=(),
    warnings=(),
    drives=(),
    probe=views.ProbeView(duration_s=25.0, rows=PROBE_ROWS),
    responses=(
        views.ResponseView(
            actuator="unwind",
            unit="N/(m/s)",
            measured_at="2026-01-05T06:00:00",
            speed_m_s=1.0,
            radius_m=None,
            delay_s=0.04,
            points=(views.PointView(1.0, 40.0, -57.3, 2.0, 0.99),),
            drive=(),
        ),
    ),
)
NOW_OPEN = {**STATE, "job": None}


class Desk:
    """What the commissioner tells a page: a card and how it stands; None: nothing comes."""

    def __init__(self, page: Page, language: str = "en") -> None:
        self._say = say_in(language)
        self._page = page
        self.card: views.CardView = CARD
        self.state: dict[str, Any] | None = NOW_OPEN
        page.page.route("**/data/commissioning?*", self._tell_state)
        page.page.route("**/data/card?*", self._tell_card)

    def _tell_state(self, route: Any) -> None:
        if self.state is None:
            route.abort()
        else:
            route.fulfill(json=self.state)

    def _tell_card(self, route: Any) -> None:
        route.fulfill(json={"ok": True, "card": asdict(card_in(self.card, self._say))})

    def run(self, ended: dict[str, Any]) -> None:
        """Have a job seen that runs, and then what became of it."""
        job = {"do": ended["do"], "step": ended["step"], "name": "now", "seconds": 1.0}
        self.state = {**NOW_OPEN, "job": {**job, "said": [], "ask": None}}
        self._page.await_selector("#job:not([hidden])")
        self.state = {**NOW_OPEN, "last": ended}
        self._page.await_selector("#job[hidden]")
        self._page.page.wait_for_timeout(300)  # what the page does with it


def last(do: str, step: int, *, is_ok: bool) -> dict[str, Any]:
    """Return how a job has ended."""
    text = "" if is_ok else "12,5: a point, not a comma"
    return {"do": do, "step": step, "ok": is_ok, "text": text, "name": "measure a step"}


def asking(number: int, **more: Any) -> dict[str, Any]:
    """Return the interview at a question."""
    return {**JOB, "ask": {**QUESTION, "number": number, **more}}
