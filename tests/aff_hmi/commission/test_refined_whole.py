"""From recorded runs to a verdict on the screen: real commissioner, jobs and `sim-plant refine`.

The runs are of plant, PLC and runtime in virtual time; the library is cut to one effect. Half a
minute of a processor.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

pytest.importorskip("starlette")
pytest.importorskip("numba")

from aff_hmi.commission.link import Commission
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.records import refine_program
from aff_runtime.app.hand.audit import verify
from sim_plant.effects.catalogue import BY_NAME
from tests.aff_hmi.commission.serving import Serving
from tests.aff_hmi.pressed import PASSWORD, Browser, Pressed, quick
from tests.doubles.recorded_run import LINE_FILE, RecordedRun, files

pytestmark = [pytest.mark.long, pytest.mark.timeout(900)]
PATIENCE_S = 500.0
KEPT = "roll_bounce"
WITHOUT = " ".join(sorted(set(BY_NAME) - {KEPT}))
SECONDS = 21.0


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Paths:
    """Two short runs of the Euclid line, its site file, and the line as its owner declares it."""
    folder = tmp_path_factory.mktemp("line")
    made = files(folder)
    for minute, speed_m_s in enumerate((0.9, 1.15)):
        begun = f"2026-01-02T03:0{minute}:00.000+00:00"
        run = RecordedRun(made, folder / "runs", line_speed_m_s=speed_m_s, start_utc=begun)
        run.bench.run(SECONDS)
        run.end()
    line = folder / "owner.yaml"
    declared = yaml.safe_load(LINE_FILE.read_text()) | {"tolerances": {"*": 0.0}}
    line.write_text(yaml.safe_dump(declared, sort_keys=False))
    (folder / "rt").mkdir(mode=0o700)
    return Paths(
        site=made.site,
        state=folder,
        socket=folder / "rt" / "control.sock",
        card=folder / "card",
        line=line,
        runs=folder / "runs",
    )


@pytest.fixture
def at(
    recorded: Paths, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[tuple[Pressed, Serving]]:
    quick(monkeypatch)
    pressed = Pressed(tmp_path, commission=Commission(recorded.socket.parent / "commission.sock"))
    serving = Serving(recorded, pressed.file, tmp_path)
    yield pressed, serving
    serving.close()


def ended(at: Pressed, browser: Browser) -> dict[str, Any]:
    """Return what has become of the long job."""
    give_up_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < give_up_s:
        at.clock.advance_ns(10**9)
        state = browser.get("/data/commissioning").said
        if state["long"] is None:
            return dict(state["long_last"])
        time.sleep(0.2)
    raise AssertionError(state)


def test_recorded_runs_are_refined_from_the_screen_to_a_verdict(
    at: tuple[Pressed, Serving], recorded: Paths
) -> None:
    pressed, serving = at
    assert refine_program.program() is not None
    carl = pressed.browser("carl")
    assert carl.post("/commission/open", {"password": PASSWORD, "over": False}).status == 200
    view = carl.get("/data/refining").said["refining"]
    assert view["missing"] == []
    second, first = (run["name"] for run in view["runs"])
    assert view["runs"][1]["start_utc"] == "2026-01-02T03:00:00.000+00:00"

    windows = {"windows": f"{first}@0..", "holdout": second, "without": WITHOUT}
    looked = windows | {"windows": f"{first}@0..5\n{first}@0.."}
    assert carl.post("/refine/lacks", looked).status == 200
    assert ended(pressed, carl)["text"] == "looked at; not every window can be used"
    lacking = carl.get("/data/refining").said["refining"]["lacking"]["found"]
    short, fitted, held = lacking["records"]
    assert "no 20 s of the running line" in short["refused"]
    assert (fitted["refused"], held["refused"], held["is_held"]) == ("", "", True)
    assert fitted["speed_m_s"] == pytest.approx([0.9, 0.9], abs=0.01)
    assert held["speed_m_s"] == pytest.approx([1.15, 1.15], abs=0.01)
    assert any(text.startswith("one speed only") for text in fitted["lacks"])

    assert carl.post("/refine/start", windows).status == 200
    again = carl.post("/refine/start", windows)
    assert (again.status, again.code) == (409, "running")
    told = ended(pressed, carl)
    assert told["ok"], told
    found = carl.get("/data/refined?number=1").said["refined"]
    summary = found["summary"]
    assert summary["kind"] in ("nothing", "traced", "unknown", "event", "set")
    assert summary["headline"] in told["text"]
    assert (summary["held_out"], summary["judged_on"]) == (True, second)
    error = next(one for one in summary["errors"] if one["channel"] == "unwind_tension_N")
    assert 0.0 < error["floor"] <= error["before"] * 1.5
    assert WITHOUT.split()[0] in found["command"]
    page = carl.get("/data/refined.html?number=1")
    assert "<h1>What the line model lacks</h1>" in page.said["text"]
    rows = map(json.loads, serving.audit.path.read_text().splitlines())
    said = [row["result"] for row in rows if row["what"] == "commissioning: refine"]
    assert said == ["asked", "done"]
    assert verify(serving.audit.path).wrong == ""
