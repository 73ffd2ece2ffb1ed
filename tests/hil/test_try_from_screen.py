"""What a refinement proposes, tried, taken back and kept from the screen: plant, service,
commissioner and its jobs are the real ones, as processes; the browser's part is a request.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("starlette")

from aff_hmi.commission.link import Commission
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.records.refine_shelf import OUT, PROPOSED, Shelf
from aff_runtime.app.commission.views.of_refining import AskedOf
from aff_runtime.app.hand.may import Place, Role
from aff_runtime.app.hand.messages import Welcome
from aff_runtime.base.signals import State
from aff_runtime.base.text_digest import text_digest
from tests.aff_hmi.commission.serving import Serving
from tests.aff_hmi.pressed import PASSWORD, Browser, Pressed, quick
from tests.hil.live_line import LiveLine
from tests.processes import until

pytestmark = [pytest.mark.long, pytest.mark.timeout(600)]
REASON = "it hunts at 1x"
PATIENCE_S = 60.0  # of a job in a process of its own on a busy machine


class Stand:
    """A line that runs, its commissioner, and a browser of who commissions."""

    def __init__(self, line: LiveLine, folder: Path) -> None:
        self.line = line
        self.former = line.bench.site.read_text()
        self.text = self.former.replace("settle_s: 6,", "settle_s: 12,", 1)
        assert self.text != self.former
        where = Paths(
            site=line.bench.site,
            state=folder,
            socket=line.runtime_dir / "control.sock",
            card=folder / "card",
            line=None,
            runs=line.bench.folder / "runs",
        )
        asked = AskedOf(windows=(), holdout=(), without=(), by="carl", utc="")
        refined = Shelf(where.site, where.state).begin(asked, self.former)
        (refined / OUT).mkdir(exist_ok=True)
        (refined / OUT / PROPOSED).write_text(self.text)
        at = Pressed(folder, commission=Commission(line.runtime_dir / "commission.sock"))
        at.service.rules = Welcome(version="1", ceiling=Role.COMMISSION, arms_from=Place.PANEL)
        at.show(State.ACTIVE)
        self.at, self.serving = at, Serving(where, at.file, folder)
        self.carl: Browser = at.browser("carl")
        opened = self.carl.post("/commission/open", {"password": PASSWORD, "over": False})
        assert opened.status == 200, opened.said
        self.carl.take()

    @property
    def tried(self) -> str:
        return str(self.line.status().get("trying", ""))

    def press_try(self, measured: str = "") -> tuple[int, str]:
        said = {"number": 1, "measured": measured or text_digest(self.text), "seconds": 300}
        reply = self.carl.post("/refine/try", {**said, "reason": REASON})
        return reply.status, str(reply.said["text"])

    def end(self, do: str) -> None:
        """Press keep or undo, as of a frame that shows the try."""
        self.at.tries(True)
        tried = self.line.status()["tried"]
        assert tried == text_digest(self.text)
        said = {"do": do, "step": 0, "measured": tried, "seconds": 0, "reason": REASON}
        reply = self.carl.post("/card/settings", said)
        assert reply.status == 200, reply.said
        until(f"{do} is done", lambda: not self.tried, PATIENCE_S)
        self.at.tries(False)
        until("the job has ended", self.rests, PATIENCE_S)

    def rests(self) -> bool:
        return self.carl.get("/data/commissioning").said["job"] is None


@pytest.fixture
def stand(
    tmp_path_factory: pytest.TempPathFactory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Stand]:
    quick(monkeypatch)
    line = LiveLine(tmp_path_factory.mktemp("try"))
    try:
        line.ensure_active()
        made = Stand(line, tmp_path)
        try:
            yield made
        finally:
            made.serving.close()
    finally:
        line.close()


def test_a_proposal_is_tried_taken_back_tried_again_and_kept(stand: Stand) -> None:
    site = stand.line.bench.site
    assert stand.press_try(measured="0" * 64)[0] in (200, 409)
    until("the job has ended", stand.rests, PATIENCE_S)
    assert not stand.tried  # another text than was looked at

    assert stand.press_try() == (200, "done")
    until("it is tried", lambda: bool(stand.tried), PATIENCE_S)
    assert text_digest(stand.text)[:12] in stand.tried
    assert site.read_text() == stand.former
    until("the job has ended", stand.rests, PATIENCE_S)
    stand.end("undo")
    assert site.read_text() == stand.former

    assert stand.press_try()[0] == 200
    until("it is tried", lambda: bool(stand.tried), PATIENCE_S)
    until("the job has ended", stand.rests, PATIENCE_S)
    stand.end("keep")
    assert site.read_text() == stand.text
    assert stand.line.state == "ACTIVE"  # live keys: the correction went on all the while
    said = [(v["verb"], v["who"]) for v in stand.line.ask("settings", act="history")["versions"]]
    assert [verb for verb, _ in said] == ["started", "tried", "returned", "tried", "kept"]
