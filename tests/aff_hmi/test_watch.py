"""The watch follows a real door and a real ring."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_hmi.recent_window import WINDOW_S, RecentWindow
from aff_hmi.view import FIND_IT, NO_ANSWER, ONE_RELEASE, OTHER_RELEASE, why_gone
from aff_hmi.watch import RETRY_NS, Watch
from aff_runtime.app.door.messages import PROTOCOL
from tests.aff_runtime.app.door.stand import Stand


@pytest.fixture
def stand(tmp_path: Path) -> Iterator[Stand]:
    (tmp_path / "rt").mkdir(mode=0o700)
    found = Stand(tmp_path / "rt")
    yield found
    found.close()


@pytest.fixture
def watch(stand: Stand) -> Iterator[Watch]:
    found = Watch(stand.path, stand.clock)
    found.poll()
    stand.round(stand.ring)
    found.poll()
    yield found
    found.close()


def test_a_ring_that_stands_still_has_no_age(stand: Stand, tmp_path: Path) -> None:
    stand.writer.write((1.0, 88.0))
    watch = Watch(stand.path, stand.clock)
    watch.poll()
    stand.round(stand.ring)
    watch.poll()
    seen = watch.seen()
    assert seen.row is not None
    assert seen.row.number("tension_N") == 88.0
    assert seen.tick_age_s is None
    stand.writer.write((1.005, 89.0))
    watch.poll()
    assert watch.seen().tick_age_s == 0.0
    watch.close()


def test_the_age_grows_while_no_tick_comes(stand: Stand, watch: Watch) -> None:
    for n in range(3):
        stand.writer.write((0.005 * n, 88.0))
        watch.poll()
    stand.clock.advance_ns(400_000_000)
    watch.poll()
    assert watch.seen().tick_age_s == pytest.approx(0.4)
    assert watch.seen().writer_lives


def test_a_dead_control_process_is_known_at_once(stand: Stand, watch: Watch) -> None:
    stand.writer.write((0.0, 88.0))
    watch.poll()
    stand.writer.close()
    assert not watch.seen().writer_lives


def test_a_new_ring_is_followed_from_its_beginning(stand: Stand, watch: Watch) -> None:
    stand.writer.write((0.0, 88.0))
    watch.poll()
    writer, reader = stand.new_ring()
    stand.round(reader)
    watch.poll()
    assert watch.seen().row is None
    writer.write((0.0, 1.0))
    watch.poll()
    row = watch.seen().row
    assert row is not None
    assert row.number("tension_N") == 1.0
    writer.close()
    reader.close()


def test_events_come_with_their_age_the_newest_first(stand: Stand, watch: Watch) -> None:
    stand.clock.sleep_until_ns(10_000_000_000)
    stand.writer.event(1, 4_000_000_000, 15)
    stand.writer.event(2, 9_000_000_000, 18)
    watch.poll()
    assert watch.seen().events == ((18, 0.0, 1.0), (15, 0.0, 6.0))


def test_a_door_that_closes_is_told_and_knocked_at_again(
    stand: Stand, watch: Watch, tmp_path: Path
) -> None:
    stand.door.close()
    watch.poll()
    assert "closed the door" in watch.seen().trouble
    stand.clock.advance_ns(RETRY_NS)
    watch.poll()
    assert "no service opens this door" in watch.seen().trouble
    again = Stand(tmp_path / "rt")
    stand.clock.advance_ns(RETRY_NS)
    watch.poll()
    again.round(again.ring)
    watch.poll()
    assert watch.seen().trouble == ""
    again.close()


def test_a_service_of_another_release_is_not_told_as_none(
    stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("aff_hmi.watch.PROTOCOL", PROTOCOL + 1)  # the screen is the newer one
    watch = Watch(stand.path, stand.clock)
    for _ in range(3):  # knocking again says no other thing
        watch.poll()
        stand.round(stand.ring)
        watch.poll()
        seen = watch.seen()
        assert (seen.other_protocol, why_gone(seen)) == (PROTOCOL, (OTHER_RELEASE, ONE_RELEASE))
        stand.clock.advance_ns(RETRY_NS)
    stand.door.close()
    watch.poll()
    assert why_gone(watch.seen()) == (NO_ANSWER, FIND_IT)
    watch.close()


def test_rms_needs_a_full_window_and_is_that_of_a_sine() -> None:
    np = pytest.importorskip("numpy")
    window = RecentWindow(("x", "y"), ("y",), 0.005)
    time_s = np.arange(0.0, WINDOW_S, 0.005)
    rows = [(t, 90.0 + 3.0 * np.cos(2.0 * np.pi * 0.9 * t)) for t in time_s]
    window.add(rows[: len(rows) // 2])
    assert np.isnan(window.rms("y"))
    window.add(rows[len(rows) // 2 :])
    assert window.rms("y") == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-3)
    assert window.peak("y") == pytest.approx(93.0)
    assert np.isnan(window.rms("x"))


def test_a_hole_in_the_window_is_no_number() -> None:
    window = RecentWindow(("y",), ("y",), 0.005)
    window.add([(1.0,)] * 1700 + [(float("nan"),)] * 300)
    assert window.rms("y") != window.rms("y")
    assert window.mean_now("y") != window.mean_now("y")
