"""What a technician does at the screen from the words to the signed card."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from benchmarks.wizard.technician import Answer, Technician

WHY = "seen at the simulated line"
PROMISED_DB = 3.0
UNDERSTOOD = re.compile(r"warnings_understood=(\d+)")
LIMITS = {"unwind": "0.15 m/s", "swrap_follower": "0.04 m/s"}
SIGNED = (0, 3, 4, 12)
"""Steps of a short card; the others stand on it as not measured."""
TRIES = 3
PAIRS, MOST_PAIRS, PROOFS = 2, 6, 2
"""Pairs of off and on that a proof has, most that are begun for one, and proofs that are tried."""
ROLL_S, ON_FIRST_S = 6.0, 8.0
"""What a fresh roll takes; and how long the correction is on before the first off begins."""
ENDS_S = 30.0
"""At the end of a roll the line slows down: it is changed earlier."""
LOOK_MS = 500.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """An off and the on behind it, settled, in the plant's own time, s."""

    off: tuple[float, float]
    on: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """The pairs that were made, how many were begun, and how step 12 stands."""

    pairs: tuple[Pair, ...]
    begun: int
    stand: str


def words_found(who: Technician, given: Answer) -> list[str]:
    """Answer the interview to its end; return the names of its questions."""
    who.go("commission")
    who.open()
    who.page.click("#find-words")
    who.page.wait_for_selector("#job:not([hidden])")
    names = who.answers(given)
    who.page.wait_for_function(
        "name => document.getElementById('job-last').textContent.includes(name)",
        arg=who.line.site.name,
    )
    return names


def ready_to_probe(who: Technician) -> None:
    """Wait for the first contact, and take the hand; what a probe sends at most stands there."""
    who.page.wait_for_selector('[data-stage="contact"][data-done="yes"]')
    who.take_the_hand()
    who.page.wait_for_selector("#bounds li")


def probed(who: Technician) -> int:
    """Probe until something is measured: a machine that others use too may trip it.

    Returns how many probes it took.
    """
    tried = 0
    while tried < TRIES:
        tried += 1
        who.hold("#probe")
        who.page.wait_for_selector('html[data-probed="now"]')
        who.page.wait_for_selector('html:not([data-probed="now"])')
        if who.page.get_attribute("html", "data-probed") == "yes":
            break
    who.page.wait_for_selector("html[data-probed='yes']")
    who.page.wait_for_selector("#found .response")
    return tried


def activated(who: Technician) -> None:
    """Arm until it is on: a machine that others use too may trip it."""
    for _ in range(TRIES):
        who.hold("#arm")
        who.page.wait_for_timeout(1500)
        if who.state() == "ACTIVE":
            return
    who.page.wait_for_selector("html[data-state='ACTIVE']")


def measured(who: Technician) -> dict[int, str]:
    """Begin a card and measure what needs no proof; return how each step stands."""
    who.begin_card()
    who.page.goto(f"{who.line.url}card?lang=en#9")
    who.page.wait_for_selector('details[data-step="9"][open]')
    who.step(3, LIMITS, stand="open|pass")
    asked = UNDERSTOOD.search(str(who.page.text_content('details[data-step="3"]')))
    count = {"warnings_understood": asked[1]} if asked else {}  # to be read one by one
    stands = {3: who.step(3, {**LIMITS, **count}, stand="pass")}
    stands[4] = who.step(4, {"reaction": "ramp", "time": "120 ms"}, stand="pass")
    return stands


def rest_measured(who: Technician) -> dict[int, str]:
    """Measure orders and machine; return how they stand."""
    return {
        10: who.step(10, {}, stand="pass|open|fail"),  # a fast order, known badly, is held
        0: who.step(0, {}, stand="pass|fail"),  # a machine that others use may wake up late
    }


def proven(who: Technician) -> Proof:
    """Off, on, off, on by hand, each as long as the page says; then step 12.

    What is cut short is made again: see :func:`_pairs`. Open in spite of that, once more.
    """
    begun = 0
    for _ in range(PROOFS):
        pairs, tried = _pairs(who)
        begun += tried
        promised = {"promised": f"{PROMISED_DB:g} dB"}
        stand = who.step(12, promised, stand="pass|fail|open")
        if stand != "open":
            break
    return Proof(pairs=tuple(pairs), begun=begun, stand=stand)


def _pairs(who: Technician) -> tuple[list[Pair], int]:
    """Make two whole pairs on one roll, mounted before; return them, and how many were begun."""
    told = "async () => (await (await fetch('/data/line')).json()).line.proof"
    times = who.page.evaluate(told)
    pair_s = times["off_s"] + times["on_s"] + ROLL_S
    made: list[Pair] = []
    fresh_roll(who)
    begun = 0
    while len(made) < PAIRS and begun < MOST_PAIRS:
        begun += 1
        if who.line.seconds_left() < (PAIRS - len(made)) * pair_s + ENDS_S:
            made = []
            fresh_roll(who)
        pair = _pair(who, times["off_s"], times["on_s"])
        made += [pair] if pair is not None else []
    return made, begun


def fresh_roll(who: Technician) -> None:
    """Mount a full roll while the correction is on: the off that comes next has no splice."""
    who.line.tell("roll")
    who.page.wait_for_timeout(1e3 * ROLL_S)
    if who.state() != "ACTIVE":
        activated(who)
    who.page.wait_for_timeout(1e3 * ON_FIRST_S)


def _pair(who: Technician, off_s: float, on_s: float) -> Pair | None:
    """Make an off and an on; None where something took the correction back meanwhile."""
    who.page.keyboard.press("F9")
    who.page.wait_for_selector("html[data-state='BYPASS']")
    off_from_s = who.line.status().time_s + 1.0
    who.page.wait_for_timeout(1e3 * off_s + 2e3)
    off_to_s = who.line.status().time_s
    activated(who)
    on_from_s = who.line.status().time_s + on_s - off_s  # the settling
    for _ in range(math.ceil((1e3 * on_s + 4e3) / LOOK_MS)):
        who.page.wait_for_timeout(LOOK_MS)
        if who.state() != "ACTIVE":
            return None
    return Pair(off=(off_from_s, off_to_s), on=(on_from_s, who.line.status().time_s))


def signed(who: Technician, stands: Mapping[int, str]) -> list[int]:
    """Sign what can be signed of a short card, have it verified; return what was signed."""
    can_be = [number for number in SIGNED if stands[number] in ("pass", "fail")]
    for number in can_be:
        who.sign(number, WHY)
    who.page.click("#verify")
    who.page.wait_for_function(
        "() => document.getElementById('job-last').textContent.includes('whole')"
    )
    return can_be
