"""What a page takes for true, by what was heard how long ago."""

from __future__ import annotations

from pathlib import Path

from tests.aff_hmi.scripts import called

SOURCES = ("hmi", "service", "plc", "supervisor", "facts")
DEAD = "given.map((one) => sources.filter((name) => of.isDead(name, of.judge(one, 0, 100))))"


def frame(**more: object) -> dict[str, object]:
    """Return a frame that came 0.1 s ago, of a line at work."""
    ages = {"facts_age_s": 0.1, "tick_age_s": 0.01, "plc_age_s": 0.01}
    return {"echo": 0, **ages, "plc_late_s": 0.05, "plc_dead_s": 0.08, **more}


def test_a_reason_outlives_the_ticks_and_nothing_outlives_who_said_it(tmp_path: Path) -> None:
    """The supervisor says that the control process begins; of no service the server says it."""
    frames = (
        frame(),
        frame(tick_age_s=None),
        frame(tick_age_s=0.7),
        frame(tick_age_s=None, facts_age_s=0.8),
        frame(tick_age_s=None, facts_age_s=None),
        frame(echo=-700),
    )
    dead = called(tmp_path, "freshness", DEAD, *frames, before=f"const sources = {list(SOURCES)};")
    of_ticks = ["service", "plc", "supervisor"]
    assert dead == [
        [],
        of_ticks,
        of_ticks,
        [*of_ticks, "facts"],
        [*of_ticks, "facts"],
        list(SOURCES),
    ]
