"""A learned shape across a restart of the service: real processes, a real socket."""

from __future__ import annotations

import json

import pytest

from sim_plant.demo.processes import runtime_command
from tests.hil.live_line import LiveLine
from tests.processes import until

pytestmark = [pytest.mark.hil, pytest.mark.wire, pytest.mark.timeout(240)]
LEARN_S = 14.0
LISTEN_S = 30.0
ATTEMPTS = 4


def _shape_blocks(line: LiveLine) -> dict[str, dict]:
    rows = line.status().get("blocks", [])
    return {row["name"]: row for row in rows if row.get("law") == "shape"}


def _learn(line: LiveLine) -> dict[str, dict]:
    """Work until the first orders gain 15 dB; a pause of the machine may end an attempt."""
    for _ in range(ATTEMPTS):
        line.ensure_active()
        line.wait_plant(line.now_s() + LEARN_S)
        blocks = _shape_blocks(line)
        gains = [blocks[f"unwind_{n}x"]["benefit_dB"] or 0.0 for n in (1, 2, 3)]
        if line.state == "ACTIVE" and min(gains) > 15.0:
            return blocks
    raise AssertionError(f"not learned: {line.status()}")


@pytest.mark.long
def test_a_shape_is_kept_at_bypass_and_starts_the_next_service(tmp_path):
    line = LiveLine(tmp_path, site_file="euclid.yaml")
    try:
        blocks = _learn(line)
        assert 0.3 < blocks["unwind_2x"]["amplitude"] < 2.0
        assert blocks["unwind_2x"]["unit"] == "mm"
        line.ask("bypass")
        path = tmp_path / "learned" / "euclid_unwind.shape.json"
        until("a shape file", path.exists)
        kept = json.loads(path.read_text())
        assert {row["roll"] for row in kept["orders"]} == {"unwind", "swrap_follower"}

        line.start_again()
        until("the service sees the PLC", lambda: line.status().get("comm") == "OK")
        until("a trial", lambda: len(line.status().get("shapes", [])) >= 2, LISTEN_S)
        words = " | ".join(line.status()["shapes"])
        assert "unwind: starts from the shape saved" in words
        before = _shape_blocks(line)["unwind_2x"]
        assert before["amplitude"] == pytest.approx(blocks["unwind_2x"]["amplitude"], rel=0.3)

        # a trial without the follower's own correction may refuse its shape: the ripple is another
        roller = _shape_blocks(line)["swrap_follower_1x"]["amplitude"]
        text = runtime_command(line.bench, "forget")
        assert "forgotten: unwind; kept: swrap_follower" in text
        until("a forgotten roll", lambda: _shape_blocks(line)["unwind_2x"]["amplitude"] == 0.0)
        assert _shape_blocks(line)["swrap_follower_1x"]["amplitude"] == roller
        left = {row["roll"] for row in json.loads(path.read_text())["orders"]}
        assert left == {"swrap_follower"}
    finally:
        line.close()
