"""What the reader of a verdict may do now, in the order in which it is to be done."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from sim_plant.refine.report.facts import NOTHING_KNOWN, RefineFacts
from sim_plant.refine.report.partly import incomplete, is_incomplete
from sim_plant.refine.report.verdict import Ambiguity, EffectFinding, UnknownFinding, Verdict
from sim_plant.refine.report.wording import claim_words, remedy

ANOTHER_SPEED = (
    "Record at another speed and fit both records: what repeats in time keeps its frequency "
    "there, what turns its length of web or its order."
)
PERIODIC = ("time", "travel", "angle")
NO_BLOCK: Mapping[str, str] = MappingProxyType({})
ALL_WITHIN: Mapping[str, float] = MappingProxyType({})


def next_step(
    verdict: Verdict,
    by: Mapping[str, str] = NO_BLOCK,
    above: Mapping[str, float] = ALL_WITHIN,
    facts: RefineFacts = NOTHING_KNOWN,
    untold: Sequence[str] = (),
) -> str:
    """Return what the reader may do now: measure, mend, and cancel until that is done.

    Parameters
    ----------
    by : rolls of the AFF block to paste, and whose actuator each belongs to; empty: no block.
    above : channels that hold more than noise as amended, and how much of their noise floor.
    facts : of line and records.
    untold : what these records cannot tell, as sentences.
    """
    open_ = {a.place for a in verdict.ambiguous}
    said = [
        *_of_effects([e for e in verdict.effects if e.place not in open_], by, facts),
        *_of_unknown(verdict.unknown, facts),
        *_of_sets(verdict.ambiguous, by, facts),
    ]
    if said:
        return " ".join([*said, *_not_explained({} if verdict.unknown else above, facts)])
    if above:
        return (
            f"Do not take the declaration for right: {', '.join(above)} above noise on the record "
            "judged. Fit that record and judge on the other."
        )
    if untold:
        return (
            "Nothing to do: the declaration stands, except for what these records cannot tell: "
            f"{'; '.join(untold)}."
        )
    return "Nothing to do: the declaration stands."


def _of_effects(
    effects: Sequence[EffectFinding], by: Mapping[str, str], facts: RefineFacts
) -> list[str]:
    """Return what to do at the machine, and the block that cancels until it is done."""
    ripples = [e for e in effects if e.cancel and e.place.location in by]
    others = [e for e in effects if e not in ripples]
    said = []
    if ripples:
        places = dict.fromkeys(e.place.location for e in ripples)
        where = " and ".join(dict.fromkeys(by[place] for place in places))
        paste = "paste the AFF block below into the site file, at the actuator of"
        if facts.is_proposed:
            paste = "try site_proposed.yaml with `aff-runtime settings try`: it has the block of"
            where = " and ".join(places)
        said += [
            f"First at the machine: {_remedies(ripples)}.",
            f"Until that is done, {paste} {where}.",
            "The ripple of a cancelled roller comes back when the service is off.",
        ]
    if others:
        which = "Also at the machine" if ripples else "At the machine"
        said.append(f"{which}: {_remedies(others)}.")
        if not any(e.cancel for e in others):
            said.append("This is no ripple to cancel.")
    return said


def _of_sets(
    ambiguous: Sequence[Ambiguity], by: Mapping[str, str], facts: RefineFacts
) -> list[str]:
    """Return what tells apart what these records do not, and that nothing is changed before."""
    said = []
    for one in ambiguous:
        where = claim_words(one.place, one.alternatives, facts.along, told=False)
        what = "; then ".join(one.experiments) or "record again at another speed and tension"
        said.append(f"For {where}: change nothing before this test: {what}.")
        if one.place.location in by:
            said.append(f"Nor paste the AFF block of {one.place.location} before it.")
    return said


def _remedies(effects: Sequence[EffectFinding]) -> str:
    return "; ".join(dict.fromkeys(map(remedy, effects)))


def _of_unknown(unknown: Sequence[UnknownFinding], facts: RefineFacts) -> list[str]:
    """Return where to look for what no effect explains: in a log first where it has a moment."""
    if not unknown:
        return []
    turning = [
        u for u in unknown if u.unknown_class == "angle" and "roll" in u.coordinate and not u.also
    ]
    if turning:
        named = " and then on ".join(dict.fromkeys(str(u.coordinate["roll"]) for u in turning))
        gauge = (
            f"Put a dial gauge on {named} and turn it once by hand: what the gauge shows is the "
            "cause."
        )
        return [gauge, *_of_unknown([u for u in unknown if u not in turning], facts)]
    cells = [str(u.coordinate["channel"]) for u in unknown if "gap_N" in u.coordinate]
    if cells:
        return [
            f"At standstill hang weights on the measuring roller of {cells[0]} one by one and "
            "take them off again: a reading that comes back otherwise sticks."
        ]
    if any("period_s" in u.coordinate and not u.also for u in unknown):
        return [
            "Look for what a clock starts or stops at that period: a task of the PLC, a message "
            "on the bus, a valve, a fan; the amended line does not contain it."
        ]
    if unknown[0].unknown_class in PERIODIC:
        one_speed = [ANOTHER_SPEED] if any(u.also for u in unknown) else []
        return [
            *one_speed,
            "Look for what turns or swings at that coordinate; the amended line does not "
            "contain it.",
        ]
    moments = list(dict.fromkeys(u.begins for u in unknown if u.begins is not None))
    said = [
        f"Look in the log of {m.record} at {m.time_s:.2f} s: what was done on the line then."
        for m in moments
    ]
    look = [f"What is left is largest in {facts.loudest}: look there."] if facts.loudest else []
    return [*said, *look] or ["Record again, longer, and at other speeds and tensions."]


def _not_explained(above: Mapping[str, float], facts: RefineFacts) -> list[str]:
    """Return what the amended line leaves, as a sentence, or nothing."""
    loud = [f"{name} {100.0 * (ratio - 1.0):.0f} % above noise" for name, ratio in above.items()]
    many = is_incomplete(facts)
    far = [] if many else [f"{r.name} {r.shift} (tolerance {r.tolerance})" for r in facts.far]
    said = "; ".join(part for part in (", ".join(loud), ", ".join(far)) if part)
    rest = [f"Not explained: {said}{': check these' * bool(far)}."] if said else []
    if many:
        rest.append(
            f"{incomplete(facts)}: the explanation is incomplete; do not correct them, record "
            "again."
        )
    return rest
