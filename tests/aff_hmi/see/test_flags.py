"""Flags over the curves: what explains a step, inside the window, in the reader's language."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from aff_hmi.see.events import SCHEMA, KeptEvent, Kind, insert
from aff_hmi.see.flags import FLAGGED, MOST_FLAGS, Flag, flags
from aff_hmi.see.store import Store
from aff_hmi.words import say_in


def entry(utc_s: float, name: str, kind: Kind = Kind.SERVICE, text: str = "t") -> KeptEvent:
    return KeptEvent(utc_s=utc_s, kind=kind, name=name, text=text)


@pytest.fixture
def store() -> Iterator[Store]:
    made = Store(None, SCHEMA)
    yield made
    made.close()


def found(store: Store, from_s: float, to_s: float, language: str = "en") -> list[Flag]:
    return store.now(lambda c: flags(c, from_s, to_s, say_in(language)))


@pytest.mark.parametrize("name", FLAGGED)
def test_what_moves_a_curve_is_a_flag(store: Store, name: str) -> None:
    store.put(lambda c: insert(c, [entry(5.0, name)]))
    assert [one.name for one in found(store, 0.0, 10.0)] == [name]


def test_every_change_of_settings_is_a_flag_and_a_state_is_none(store: Store) -> None:
    tried, state = entry(5.0, "TRY", Kind.SETTINGS), entry(6.0, "ACTIVE", Kind.STATE)
    store.put(lambda c: insert(c, [tried, state, entry(7.0, "WIRE")]))
    assert [one.name for one in found(store, 0.0, 10.0)] == ["TRY"]


def test_only_the_window_counts_and_the_oldest_comes_first(store: Store) -> None:
    store.put(lambda c: insert(c, [entry(t, "SPLICE") for t in (9.0, 1.0, 3.0, 11.0)]))
    assert [one.utc_s for one in found(store, 2.0, 10.0)] == [3.0, 9.0]


def test_of_very_many_the_newest_are_shown(store: Store) -> None:
    store.put(lambda c: insert(c, [entry(float(t), "SPLICE") for t in range(2 * MOST_FLAGS)]))
    times = [one.utc_s for one in found(store, 0.0, 1e9)]
    assert times == [float(t) for t in range(MOST_FLAGS, 2 * MOST_FLAGS)]


def test_flags_speak_the_language_of_the_reader(store: Store) -> None:
    text = "another roll: number {number}"
    roll = KeptEvent(utc_s=1.0, kind=Kind.ROLL, name="ROLL", text=text, values={"number": "7"})
    store.put(lambda c: insert(c, [roll]))
    assert found(store, 0.0, 2.0)[0].text == "another roll: number 7"
    german = found(store, 0.0, 2.0, "de")[0].text
    assert german.endswith("7")
    assert german != "another roll: number 7"
