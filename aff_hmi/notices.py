"""What asks for a person: alarms of the service, and what this screen finds itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from urllib.parse import quote

from aff_hmi.condition import LASTS_S, RANK, ROLLS, TIMING, Condition
from aff_hmi.upkeep import upkeep
from aff_hmi.watch import Observed
from aff_hmi.wire_sentences import told
from aff_hmi.words import N_, Say, figures_in
from aff_runtime.app.report.alarm_table import PRIORITIES, Priority
from aff_runtime.app.report.block_status import SHAPE, SHAPE_WHY, WHY, WORDS
from aff_runtime.base.events import BY_CODE
from aff_runtime.base.printable import printable
from aff_runtime.core.order_status import OrderStatus
from aff_runtime.core.phase import Source
from aff_runtime.telemetry.recorder_messages import RecorderReport

FACTS_OLD_S = 2.0
MOST = 8
FEW = 3
ENCODER_S = 5.0  # a glitch is over sooner


@dataclass(frozen=True, slots=True, kw_only=True)
class Notice:
    """One line of the list; ``rank`` 1 is the most urgent. Words are translated."""

    rank: int
    name: str
    text: str
    to_do: str


def notices_of(
    seen: Observed, state: str, say: Say, standing: Mapping[str, str] | None = None
) -> tuple[Notice, ...]:
    """Return what stands now, the most urgent first, ``MOST`` at most.

    Parameters
    ----------
    standing : names of the alarms that stand by their keys, of who has waited for their delays;
        None where nobody has: then what is there at this moment stands.
    """
    there = [
        one
        for one in conditions_of(seen, state)
        if standing is None or not one.delay_s or one.key in standing
    ]
    return tuple(
        Notice(
            rank=one.rank,
            name=one.name if standing is None else standing.get(one.key, one.name),
            text=filled(one.text, one.values, say),
            to_do=say(one.to_do),
        )
        for one in there[:MOST]
    )


def conditions_of(seen: Observed, state: str) -> tuple[Condition, ...]:
    """Return what stands now, the most urgent first."""
    conditions = [
        *_alarm(seen),
        *_service(seen),
        *upkeep(seen),
        *_encoders(seen),
        *_resting(seen, state),
    ]
    return tuple(sorted(conditions, key=lambda one: one.rank))


def filled(text: str, values: Mapping[str, str], say: Say) -> str:
    """Return a text in the reader's language, with its values; empty stays empty."""
    found = say(text) if text else ""
    for name, value in values.items():
        found = found.replace(f"{{{name}}}", figures_in(value, say))
    return found


def _alarm(seen: Observed) -> Iterator[Condition]:
    if seen.row is None or not seen.writer_lives:
        return
    event = BY_CODE.get(seen.row.alarm_code)
    if event is not None and event.name in PRIORITIES:
        yield Condition(
            key=event.name,
            rank=RANK[PRIORITIES[event.name]],
            name=_with_signal(event.name, seen),
            text=event.text,
            to_do=event.action,
            code=event.code,
        )


def _with_signal(name: str, seen: Observed) -> str:
    """Return the name of an alarm with the signal that the guard names, while it does."""
    blocked = seen.facts.blocked if seen.facts is not None else ""
    return printable(blocked, 80) if blocked.startswith(f"{name} (") else name


def _encoders(seen: Observed) -> Iterator[Condition]:
    """Yield which rolls have an encoder that is not believed: another source drifts."""
    if seen.row is None or not seen.writer_lives or seen.site is None:
        return
    for roll in seen.site.rolls:
        source = seen.row.roll(roll.name).source
        if roll.angle_channel and source in (Source.ROLL_SPEED, Source.LINE_SPEED):
            yield Condition(
                key=f"ENCODER {roll.name}",
                rank=RANK[Priority.MEDIUM],
                name=printable(f"ENCODER ({roll.angle_channel})", 80),
                text=N_(
                    "the angle reading stands still or cannot be believed; the angle is counted "
                    "from the speed, which drifts against the roll"
                ),
                to_do=N_("check the encoder, its coupling and its word in the PLC"),
                delay_s=ENCODER_S,
                page=ROLLS,
            )


def _service(seen: Observed) -> Iterator[Condition]:
    """Yield what the facts say against the service, and their silence."""
    facts = seen.facts
    if facts is None:
        return
    medium, low = RANK[Priority.MEDIUM], RANK[Priority.LOW]
    if seen.facts_age_s is not None and seen.facts_age_s > FACTS_OLD_S:
        yield Condition(
            key="SUPERVISOR",
            rank=medium,
            name="SUPERVISOR",
            text=N_("the supervisor has not spoken for {seconds} s; what it last said is shown"),
            values={"seconds": str(round(seen.facts_age_s))},
            to_do=N_("see its log; restart the service when it does not come back"),
            page=TIMING,
        )
    for number, trouble in enumerate(facts.wire[:2]):
        said = told(trouble)
        of_roll = said.trouble.is_of_a_roll
        yield Condition(
            key=f"{said.name} {said.values['roll']}" if of_roll else f"WIRE {number}",
            rank=low,
            name=said.name,
            text=said.trouble.text,
            values=said.values,
            to_do=said.trouble.to_do,
            page=ROLLS if of_roll else TIMING,
        )
    for text in facts.status.config_differs[:1]:
        if seen.row is None or seen.row.alarm_code != 10:  # the alarm of that name says it too
            yield Condition(
                key="CONFIG_DIFFERS",
                rank=low,
                name="CONFIG_DIFFERS",
                text="{text}",
                values={"text": printable(text, 200)},
                to_do=N_("correct the site file"),
                delay_s=LASTS_S,
            )
    yield from _recorder(facts.status.recorder)


def _recorder(recorder: RecorderReport | None) -> Iterator[Condition]:
    text, values = "", {}
    if recorder is not None and recorder.folder and not recorder.alive:
        text = N_("nothing is recorded")
    elif recorder is not None and recorder.lost:
        text, values = N_("{rows} rows of the record are lost"), {"rows": str(recorder.lost)}
    if text:
        yield Condition(
            key="RECORDER",
            rank=RANK[Priority.LOW],
            name="RECORDER",
            text=text,
            values=values,
            to_do=N_("look at the disk of the gateway"),
            page=TIMING,
        )


def _resting(seen: Observed, state: str) -> Iterator[Condition]:
    """Yield which orders rest and why, those of one reason together."""
    if seen.row is None or state != "ACTIVE" or is_probing(seen):
        return
    by_reason: dict[tuple[str, str], list[OrderStatus]] = {}
    for order in seen.row.orders():
        if why := why_it_rests(order):
            by_reason.setdefault((order.actuator, why), []).append(order)
    for (actuator, why), orders in by_reason.items():
        yield Condition(
            key=f"{actuator}: {why}",
            rank=RANK[Priority.LOW],
            name=printable(f"{actuator}: {_few([one.name for one in orders])}", 80),
            text=why,
            to_do=N_("see tuning, or ask the technician"),
            delay_s=LASTS_S,
            page=_place_of(orders),
        )


def place_key(actuator: str, roll: str) -> str:
    """Return what a roll that an actuator follows is called on its page."""
    return f"{actuator} {roll}"


def _place_of(orders: list[OrderStatus]) -> str:
    """Return the place of the first roll among orders; an imbalance has none of its own."""
    first = next((one for one in orders if not one.is_imbalance), None)
    return ROLLS if first is None else _place_on_page(place_key(first.actuator, first.roll))


@lru_cache(maxsize=64)
def _place_on_page(key: str) -> str:
    return f"{ROLLS}#{quote(key)}"


def is_probing(seen: Observed) -> bool:
    """Return whether a response is being measured: what goes out then is no correction."""
    return seen.facts is not None and seen.facts.status.probing


def _few(names: list[str]) -> str:
    more = len(names) - FEW
    return ", ".join(names[:FEW]) + (f" +{more}" if more > 0 else "")


def why_it_rests(order: OrderStatus) -> str:
    """Return why nothing of an order goes out, or less; empty when it works."""
    if order.state is None or order.state not in WORDS:
        return ""
    return (SHAPE_WHY if order.law == SHAPE else {}).get(order.state, WHY.get(order.state, ""))
