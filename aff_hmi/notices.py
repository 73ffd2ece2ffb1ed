"""What asks for a person: alarms of the service, and what this screen finds itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from aff_hmi.watch import Seen
from aff_hmi.words import N_, Say
from aff_runtime.app.report.alarm_table import PRIORITIES, Priority
from aff_runtime.app.report.block_status import SHAPE, SHAPE_WHY, WHY, WORDS
from aff_runtime.base.events import BY_CODE
from aff_runtime.base.printable import printable
from aff_runtime.core.order_status import OrderStatus

FACTS_OLD_S = 2.0
MOST = 8
FEW = 3
RANK = {Priority.HIGH: 1, Priority.MEDIUM: 2, Priority.LOW: 3}


@dataclass(frozen=True, slots=True, kw_only=True)
class Notice:
    """One line of the list; ``rank`` 1 is the most urgent. Words are translated."""

    rank: int
    name: str
    text: str
    to_do: str


def notices_of(seen: Seen, state: str, say: Say) -> tuple[Notice, ...]:
    """Return what stands now, the most urgent first, ``MOST`` at most."""
    found = [*_alarm(seen, say), *_service(seen, say), *_resting(seen, state, say)]
    found.sort(key=lambda notice: notice.rank)
    return tuple(found[:MOST])


def _alarm(seen: Seen, say: Say) -> Iterator[Notice]:
    if seen.row is None or not seen.writer_lives:
        return
    event = BY_CODE.get(seen.row.alarm)
    if event is not None and event.name in PRIORITIES:
        yield Notice(
            rank=RANK[PRIORITIES[event.name]],
            name=event.name,
            text=say(event.text),
            to_do=say(event.action),
        )


def _service(seen: Seen, say: Say) -> Iterator[Notice]:
    """Yield what the facts say against the service, and their silence."""
    facts = seen.facts
    if facts is None:
        return
    medium, low = RANK[Priority.MEDIUM], RANK[Priority.LOW]
    if seen.facts_age_s is not None and seen.facts_age_s > FACTS_OLD_S:
        text = say(N_("the supervisor has not spoken for {seconds} s; what it last said is shown"))
        yield Notice(
            rank=medium,
            name="SUPERVISOR",
            text=text.format(seconds=round(seen.facts_age_s)),
            to_do=say(N_("see its log; restart the service when it does not come back")),
        )
    for text in facts.wire[:2]:
        to_do = say(N_("check cable, switch and PLC"))
        yield Notice(rank=low, name="WIRE", text=printable(text, 200), to_do=to_do)
    for text in facts.status.config_differs[:1]:
        if seen.row is None or seen.row.alarm != 10:  # the alarm of that name says it too
            to_do = say(N_("correct the site file"))
            yield Notice(rank=low, name="CONFIG_DIFFERS", text=printable(text, 200), to_do=to_do)
    recorder = facts.status.recorder
    to_do = say(N_("look at the disk of the gateway"))
    if recorder is not None and recorder.folder and not recorder.alive:
        yield Notice(rank=low, name="RECORDER", text=say(N_("nothing is recorded")), to_do=to_do)
    elif recorder is not None and recorder.lost:
        text = say(N_("{rows} rows of the record are lost")).format(rows=recorder.lost)
        yield Notice(rank=low, name="RECORDER", text=text, to_do=to_do)


def _resting(seen: Seen, state: str, say: Say) -> Iterator[Notice]:
    """Yield which orders rest and why, those of one reason together."""
    if seen.row is None or state != "ACTIVE" or is_probing(seen):
        return
    by_reason: dict[tuple[str, str], list[str]] = {}
    for order in seen.row.orders():
        if why := _why(order):
            by_reason.setdefault((order.actuator, why), []).append(order.name)
    for (actuator, why), names in by_reason.items():
        yield Notice(
            rank=RANK[Priority.LOW],
            name=printable(f"{actuator}: {_few(names)}", 80),
            text=say(why),
            to_do=say(N_("see tuning, or ask the technician")),
        )


def is_probing(seen: Seen) -> bool:
    """Return whether a response is being measured: what goes out then is no correction."""
    return seen.facts is not None and seen.facts.status.probing


def _few(names: list[str]) -> str:
    more = len(names) - FEW
    return ", ".join(names[:FEW]) + (f" +{more}" if more > 0 else "")


def _why(order: OrderStatus) -> str:
    if order.state is None or order.state not in WORDS:
        return ""
    return (SHAPE_WHY if order.law == SHAPE else {}).get(order.state, WHY.get(order.state, ""))
