"""History has a bound, is kept over a restart, and its failures disturb nobody."""

from __future__ import annotations

import asyncio
import sqlite3
import threading
from pathlib import Path

import pytest

from aff_hmi.see import events
from aff_hmi.see.events import SCHEMA, KeptEvent, Kind, Wanted, insert, newest, prune, select
from aff_hmi.see.store import FILE, MOST_ASKED, PAGE_BYTES, Store
from aff_runtime.base.errors import ConfigError


def entry(name: str = "A", **more: object) -> KeptEvent:
    return KeptEvent(**{"utc_s": 1.0, "kind": Kind.STATE, "name": name, "text": "t"} | more)  # type: ignore[arg-type]


def test_what_was_kept_is_there_after_a_restart(tmp_path: Path) -> None:
    store = Store(tmp_path / "state", SCHEMA)
    kept = entry(values={"why": "ä{}"}, roll="unwind", tick=7, who="anna", kind=Kind.ROLL)
    store.put(lambda c: insert(c, [kept]))
    store.close()
    again = Store(tmp_path / "state", SCHEMA)
    (found,) = again.now(lambda c: select(c, Wanted()))
    again.close()
    assert (found.roll, found.tick, found.who, found.kind) == ("unwind", 7, "anna", Kind.ROLL)
    assert found.values == {"why": "ä{}"}
    assert (tmp_path / "state").stat().st_mode & 0o077 == 0


def test_an_event_of_the_ring_is_kept_once_however_often_it_is_read(tmp_path: Path) -> None:
    store = Store(None, SCHEMA)
    for _ in range(3):
        store.put(lambda c: insert(c, [entry(unique_key="ring 1 15"), entry("B"), entry("B")]))
    found = store.now(lambda c: select(c, Wanted()))
    store.close()
    assert [one.name for one in found].count("A") == 1
    assert [one.name for one in found].count("B") == 6


def test_kind_roll_and_older_ones_are_asked_for(tmp_path: Path) -> None:
    store = Store(None, SCHEMA)
    many = [entry(str(n), roll="swrap" if n % 2 else "", kind=Kind.ROLL) for n in range(250)]
    store.put(lambda c: insert(c, [*many, entry("state")]))
    ask = lambda **w: [e.name for e in store.now(lambda c: select(c, Wanted(**w)))]  # noqa: E731
    assert ask()[:2] == ["state", "249"]
    assert ask(kind="state") == ["state"]
    assert ask(roll="swrap") == [str(n) for n in range(249, 49, -2)]
    last = store.now(lambda c: select(c, Wanted(roll="swrap")))[-1]
    assert ask(roll="swrap", before=last.number) == [str(n) for n in range(49, 0, -2)]
    assert ask(roll="x' OR '1'='1") == []
    store.close()


def test_the_oldest_go_when_there_is_no_room_and_the_file_has_a_bound(tmp_path: Path) -> None:
    bound = 400_000
    store = Store(tmp_path, SCHEMA, most_bytes=bound)
    for n in range(60):
        store.put(lambda c, n=n: insert(c, [entry(f"{n}", text="x" * 300)] * 50))
        store.put(lambda c: prune(c, 2.0, is_full=store.is_full(c)))
        store.now(newest)  # the disk keeps up
    names = [e.name for e in store.now(lambda c: select(c, Wanted()))]
    assert names[0] == "59"
    assert (tmp_path / FILE).stat().st_size <= bound
    assert store.lost_count == 0
    store.close()


def test_what_a_year_ends_does_not_count_against_the_most(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events, "MOST_EVENTS", 10)
    store = Store(None, SCHEMA)
    old = [entry(f"old {n}", utc_s=0.0) for n in range(6)]
    new = [entry(f"new {n}", utc_s=2.0 * events.YEAR_S) for n in range(10)]
    store.put(lambda c: insert(c, [*old, *new]))
    store.put(lambda c: prune(c, 2.0 * events.YEAR_S, is_full=False))
    kept = store.now(lambda c: select(c, Wanted()))
    store.close()
    assert [one.name for one in kept] == [f"new {n}" for n in range(9, -1, -1)]


def test_a_full_disk_costs_history_and_is_told_until_it_is_over(tmp_path: Path) -> None:
    store = Store(tmp_path, SCHEMA, most_bytes=64 * 4096)
    for _ in range(20):
        store.put(lambda c: insert(c, [entry(text="x" * 3000)] * 20))
        store.now(newest)
    assert "full" in store.trouble
    assert store.lost_count > 0
    store.put(lambda c: prune(c, 1e12, is_full=True))  # all are older than a year
    store.put(lambda c: insert(c, [entry("again")]))
    assert [e.name for e in store.now(lambda c: select(c, Wanted()))] == ["again"]
    assert store.trouble == ""
    store.close()


def test_a_second_screen_is_told_to_take_another_folder(tmp_path: Path) -> None:
    store = Store(tmp_path, SCHEMA)
    with pytest.raises(ConfigError, match="--state"):
        Store(tmp_path, SCHEMA)
    store.close()


def test_a_damaged_file_is_put_aside_and_told(tmp_path: Path) -> None:
    (tmp_path / FILE).write_bytes(b"no database " * 1000)
    store = Store(tmp_path, SCHEMA)
    assert "begun anew" in store.trouble
    assert store.now(newest) == 0
    store.close()
    assert (tmp_path / FILE).with_suffix(".damaged").exists()


@pytest.mark.parametrize("name", ["events", "events_at"])
def test_one_damaged_page_puts_the_file_aside_too(tmp_path: Path, name: str) -> None:
    store = Store(tmp_path, SCHEMA)
    store.put(lambda c: insert(c, [entry()]))
    ask = "SELECT rootpage FROM sqlite_schema WHERE name = ?"
    (page,) = store.now(lambda c: c.execute(ask, (name,)).fetchone())
    store.close()
    with (tmp_path / FILE).open("r+b") as file:
        file.seek((page - 1) * PAGE_BYTES)
        file.write(bytes(PAGE_BYTES))
    again = Store(tmp_path, SCHEMA)
    assert "begun anew" in again.trouble
    assert again.now(newest) == 0
    again.close()
    assert (tmp_path / FILE).with_suffix(".damaged").exists()


def test_who_asks_too_much_at_once_is_sent_away(tmp_path: Path) -> None:
    store = Store(None, SCHEMA)

    async def flood() -> list[object]:
        asked = [store.ask(newest) for _ in range(200)]
        return await asyncio.gather(*asked, return_exceptions=True)

    found = asyncio.run(flood())
    store.close()
    assert 0 in found
    assert any(isinstance(one, BlockingIOError) for one in found)
    assert not any(isinstance(one, sqlite3.Error) for one in found)


def test_those_who_ask_leave_room_for_what_is_written() -> None:
    store, go_on = Store(None, SCHEMA), threading.Event()
    store.put(lambda c: go_on.wait())

    async def flood() -> list[object]:
        asked = [asyncio.create_task(store.ask(newest)) for _ in range(200)]
        await asyncio.sleep(0)
        store.put(lambda c: insert(c, [entry()]))
        go_on.set()
        return await asyncio.gather(*asked, return_exceptions=True)

    found = asyncio.run(flood())
    assert [e.name for e in store.now(lambda c: select(c, Wanted()))] == ["A"]
    assert store.lost_count == 0
    assert found.count(0) == MOST_ASKED
    assert asyncio.run(store.ask(newest)) == 1  # their places are free again
    store.close()
