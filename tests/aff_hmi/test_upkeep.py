"""What the gateway itself needs is an alarm, with what to do, in both languages."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from aff_hmi.notices import conditions_of, notices_of
from aff_hmi.see.alarm_book import AlarmBook
from aff_hmi.watch import Observed
from aff_hmi.words import say_in
from aff_runtime.telemetry.recorder_messages import RecorderReport
from tests.aff_hmi.moments import facts, seen
from tests.doubles.virtual_clock import VirtualClock
from tests.each_case import each_case

DAY_S = 86_400.0
MB = 1_000_000
ROOM: dict[str, Any] = {"kept_bytes": 100 * MB, "max_bytes": 500 * MB, "disk_bytes": 8000 * MB}


def recorded(**more: Any) -> Observed:
    report = RecorderReport(folder="/r", rows=1, alive=True, **{**ROOM, **more})
    return seen(facts=facts(recorder=report))


def names(moment: Observed) -> list[str]:
    return [one.name for one in conditions_of(moment, "READY")]


@each_case(
    ("free", "more", "expected"),
    [
        (500 * MB, {}, []),
        (399 * MB, {}, ["DISK"]),  # the records may take 400 MB more
        (401 * MB, {}, []),
        (401 * MB, {"disk_bytes": 8040 * MB}, ["DISK"]),  # under 5 % of 8040 MB are 402 MB
        (300 * MB, {"kept_bytes": -1, "disk_bytes": 5000 * MB}, []),
        (300 * MB, {"kept_bytes": 500 * MB, "disk_bytes": 5000 * MB}, []),
        (10 * MB, {"kept_bytes": -1, "disk_bytes": -1}, []),  # an older recorder does not say
        (-1, {}, []),
    ],
)
def test_a_disk_is_nearly_full_where_records_will_be_lost_or_a_twentieth_is_left(
    free: int, more: dict[str, int], expected: list[str]
) -> None:
    assert names(recorded(free_bytes=free, **more)) == expected


def test_a_disk_says_what_is_left_and_what_may_come() -> None:
    (notice,) = notices_of(recorded(free_bytes=123 * MB), "READY", say_in("en"))
    assert notice.text == ("123 MB are left on the disk of the records, which may grow by 400 MB")


@each_case(
    ("left_s", "text"),
    [
        (None, None),
        (31 * DAY_S, None),
        (29.5 * DAY_S, "the certificate of this screen ends in 29 days"),
        (0.5 * DAY_S, "the certificate of this screen ends in 0 days"),
        (-1.0, "the certificate of this screen has ended: browsers refuse it"),
    ],
)
def test_a_certificate_is_an_alarm_a_month_before_its_end(
    left_s: float | None, text: str | None
) -> None:
    told = notices_of(seen(certificate_s=left_s), "READY", say_in("en"))
    assert [one.text for one in told] == ([] if text is None else [text])


def test_a_clock_that_was_set_is_told_with_its_sign() -> None:
    (notice,) = notices_of(seen(clock_step_s=-3600.04), "READY", say_in("en"))
    assert notice.name == "CLOCK"
    assert "by -3600.0 s" in notice.text


@pytest.mark.parametrize(("audit_ok", "expected"), [(-1, []), (1, []), (0, ["AUDIT"])])
def test_an_audit_that_does_not_hold_is_of_high_priority(
    audit_ok: int, expected: list[str]
) -> None:
    found = conditions_of(seen(facts=facts(audit_ok=audit_ok)), "READY")
    assert [one.name for one in found] == expected
    assert [one.rank for one in found] == [1] * len(expected)


def test_each_has_its_step_in_the_readers_language_and_stays_until_it_was_seen() -> None:
    report = RecorderReport(folder="/r", rows=1, alive=True, **ROOM, free_bytes=MB)
    told = facts(recorder=report, audit_ok=0)
    moment = seen(facts=told, clock_step_s=5.0, certificate_s=DAY_S)
    english = notices_of(moment, "READY", say_in("en"))
    german = notices_of(moment, "READY", say_in("de"))
    assert {one.name for one in english} == {"AUDIT", "DISK", "CLOCK", "CERTIFICATE"}
    for one, other in zip(english, german, strict=True):
        assert one.name == other.name
        assert one.to_do != other.to_do
        assert one.text != other.text
    clock = VirtualClock(1)
    book = AlarmBook(clock, lambda: 1.8e9, can_be_seen=True)
    book.look(conditions_of(replace(moment, facts=facts()), "READY"), is_known=True)
    book.look((), is_known=True)
    assert {one.condition.name for one in book.shown()} == {"CLOCK", "CERTIFICATE"}
    book.acknowledge("CLOCK", "anna")
    assert {one.condition.name for one in book.shown()} == {"CERTIFICATE"}
