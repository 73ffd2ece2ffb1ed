"""What the service says of its wire is told in German, each with its own advice."""

from __future__ import annotations

import errno
import math
import os
import re
import socket

import pytest

pytest.importorskip("starlette")

from aff_hmi.notices import notices_of
from aff_hmi.see.alarm_part import event_line
from aff_hmi.see.events import Wanted, select
from aff_hmi.see.kept import Kept
from aff_hmi.wire_sentences import (
    CHECK_CABLE,
    CHECK_NODE,
    MEND_RADIUS,
    OF_SYSTEM,
    OTHER,
    TROUBLES,
    told,
)
from aff_hmi.words import say_in
from aff_runtime.base.early_wrap import EarlyWrap
from aff_runtime.base.errors import WireError
from aff_runtime.core.params import RollParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.fieldbus.modbus.frames import exception_text
from aff_runtime.fieldbus.modbus.tcp_wire import resolved
from tests.aff_hmi.moments import facts, seen
from tests.doubles.virtual_clock import VirtualClock
from tests.each_case import each_case

STANDARD = (1, 2, 3, 4, 5, 6, 8, 10, 11)  # MODBUS Application Protocol V1.1b3, section 7


def shown(sentence: str, language: str = "de") -> tuple[str, str, str]:
    (one,) = notices_of(seen(facts=facts(wire=(sentence,))), "ACTIVE", say_in(language))
    return one.name, one.text, one.to_do


@each_case("function", [3, 16, 23])
@each_case("code", [*STANDARD, 7, 9, 171])
def test_every_exception_of_the_service_has_its_words_its_code_and_its_advice(
    code: int, function: int
) -> None:
    sentence = exception_text(code, function)
    name, text, to_do = shown(sentence)
    assert name == "WIRE"
    assert f"Funktion {function}" in text
    assert re.findall(r"Ausnahme (\d+)", text) == [str(code)]
    assert to_do not in ("", say_in("de")(CHECK_CABLE))
    generic = "im Handbuch des Geräts nachsehen"
    assert (to_do == generic) == (code not in STANDARD or (code == 1 and function != 23))
    assert f"function {function}" in shown(sentence, "en")[1]


def radius_note(read_m: float, known_m: float | None) -> str:
    """Return what the service's own phase says of a reading."""
    roll = RollParams(name="unwind", radius="unwind_radius_m", radius_min_m=0.1, radius_max_m=0.3)
    phase = RollPhase(roll, {"unwind_radius_m": 0})
    for radius_m in (known_m, read_m):
        if radius_m is not None:
            phase.step((radius_m,), 0.005, True)
    return phase.radius_note()


BELOW, ABOVE = "liegt unter radius_min_m 0,1 m", "liegt über radius_max_m 0,3 m"
STAYS, NONE = "es bleibt der letzte im Bereich, 0,25 m", "es ist kein Radius bekannt"


@each_case(
    ("read_m", "known_m", "where", "what"),
    [
        (0.09, 0.25, BELOW, STAYS),
        (0.31, 0.25, ABOVE, STAYS),
        (0.09, None, BELOW, NONE),
        (0.31, None, ABOVE, NONE),
    ],
)
def test_a_radius_outside_its_range_is_no_fault_of_a_cable(
    read_m: float, known_m: float | None, where: str, what: str
) -> None:
    german = f"unwind: unwind_radius_m {where}: nicht übernommen, {what}"
    assert shown(radius_note(read_m, known_m)) == ("RADIUS", german, say_in("de")(MEND_RADIUS))


def test_a_count_that_starts_over_early_is_told_with_what_its_word_lacks() -> None:
    early = EarlyWrap(range_rad=0.5 * math.tau, off_rad=0.2, seen=4)
    said = f"unwind: unwind_angle_rad: {early.words(16.0 * math.tau, 65536)}"
    name, text, to_do = shown(said)
    assert (name, text.rpartition(" ")[2]) == ("COUNT", "2048")
    assert "beginnt zu früh von vorn" in text
    assert "Anlagendatei" in to_do


@pytest.mark.parametrize(
    ("device", "said", "german"),
    [
        ("drive", "no answer to SDO 0x6007:00", "keine Antwort auf SDO 0x6007:00"),
        ("a (node 1)", "heartbeat lost", "Lebenszeichen verloren"),
        (
            "pull",
            "SDO 0x1017:00 refused with 0x06090030",
            "SDO 0x1017:00 abgelehnt mit 0x06090030",
        ),
    ],
)
def test_a_node_that_is_missing_is_named_with_what_it_lacks(
    device: str, said: str, german: str
) -> None:
    sentence = f"{device} (node 3): {said}"
    assert shown(sentence) == ("WIRE", f"{device} (Knoten 3): {german}", say_in("de")(CHECK_NODE))


def test_what_is_in_no_pattern_stays_whole_as_a_wires() -> None:
    said = "192.168.7.10:502: Protocol error"
    assert shown(said) == ("WIRE", said, say_in("de")(CHECK_CABLE))
    assert told(said).trouble is OTHER


def test_every_text_keeps_only_values_that_its_pattern_brings() -> None:
    places = re.compile(r"\{(\w+)\}")
    for one in TROUBLES:
        assert set(places.findall(one.text)) <= set(places.findall(one.heard or one.text))


def test_the_events_tell_it_in_the_readers_language_too() -> None:
    kept = Kept(None, VirtualClock(1))
    kept.journal.look(seen(facts=facts()))
    kept.journal.look(seen(facts=facts(wire=(radius_note(0.31, 0.25),))))
    entries = kept.store.now(lambda c: select(c, Wanted()))
    found = [event_line(one, say_in("de")) for one in entries]
    kept.close()
    (line,) = [one for one in found if one.name == "RADIUS"]
    assert "liegt über radius_max_m 0,3 m" in line.text


@each_case("number", OF_SYSTEM, ids=errno.errorcode.__getitem__)
def test_what_the_system_says_of_a_socket_is_told_in_german_with_the_place(number: int) -> None:
    sentence = f"192.0.2.7:502: {os.strerror(number)}"
    name, text, to_do = shown(sentence)
    assert name == "WIRE"
    assert text.startswith("192.0.2.7:502: ")
    assert os.strerror(number) not in text
    assert to_do == say_in("de")(OF_SYSTEM[number][1])


def test_a_serial_line_that_may_not_be_opened_is_no_firewalls() -> None:
    device = "/dev/ttyUSB0"
    sentence = f"the serial line {device} does not open: {os.strerror(errno.EACCES)}"
    name, text, to_do = shown(sentence)
    german = f"die serielle Leitung {device} lässt sich nicht öffnen"
    assert (name, text) == ("WIRE", f"{german}: {os.strerror(errno.EACCES)}")
    assert to_do == say_in("de")("is the adapter plugged in, and may the service use it?")


def test_a_name_without_an_address_has_its_own_advice() -> None:
    with pytest.raises(WireError) as told_it:
        resolved("plc.invalid.", 502, socket.SOCK_STREAM)
    name, text, to_do = shown(str(told_it.value))
    assert (name, text) == ("WIRE", "plc.invalid.:502: zu diesem Namen gibt es keine Adresse")
    assert to_do == "die IP-Adresse schreiben oder DNS prüfen"


def test_what_the_loss_of_the_plc_began_with_has_a_name_of_its_own_and_the_same_advice() -> None:
    name, text, to_do = shown("PLC_STALE began with: closed by the other side")
    assert (name, text) == ("BEFORE PLC_STALE", "von der Gegenseite geschlossen")
    assert to_do == shown("closed by the other side")[2]
    name, text, _ = shown(
        "PLC_STALE began with: no trouble of the wire: its heartbeat did not move"
    )
    assert (name, text) == (
        "BEFORE PLC_STALE",
        "keine Störung der Leitung: ihr Lebenszeichen stand still",
    )
