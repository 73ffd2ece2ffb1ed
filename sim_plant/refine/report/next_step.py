"""What the reader of a verdict may do now, in the order in which it is to be done."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType

from sim_plant.refine.report.verdict import EffectFinding, UnknownFinding, Verdict
from sim_plant.refine.report.wording import remedy

AGAIN = "record again with more speeds and a tension step, and more channels"
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
    outside: Collection[str] = (),
    untold: Sequence[str] = (),
) -> str:
    """Return what the reader may do now: measure, mend, and cancel until that is done.

    Parameters
    ----------
    by : rolls of the AFF block to paste, and whose actuator each belongs to; empty: no block.
    above : channels that hold more than noise as amended, and how much of their noise floor.
    outside : declared numbers that were estimated beyond their tolerance.
    untold : what these records cannot tell, as sentences.
    """
    if verdict.ambiguous:
        said = ["First do what tells the candidates apart, before anything is changed."]
    else:
        said = [*_of_effects(verdict.effects, by), *_of_unknown(verdict.unknown)]
    if said:
        return " ".join([*said, *_not_explained({} if verdict.unknown else above, outside)])
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


def _of_effects(effects: Sequence[EffectFinding], by: Mapping[str, str]) -> list[str]:
    """Return what to do at the machine, and the block that cancels until it is done."""
    ripples = [e for e in effects if e.cancel and e.place.location in by]
    others = [e for e in effects if e not in ripples]
    said = []
    if ripples:
        where = " and ".join(dict.fromkeys(by[e.place.location] for e in ripples))
        said += [
            f"First at the machine: {_remedies(ripples)}.",
            "Until that is done, paste the AFF block below into the site file, at the actuator of "
            f"{where}.",
            "The ripple of a cancelled roller comes back when the service is off.",
        ]
    if others:
        which = "Beside it, no ripple to cancel" if ripples else "This is no ripple to cancel"
        said.append(f"{which}: {_remedies(others)}.")
    return said


def _remedies(effects: Sequence[EffectFinding]) -> str:
    return "; ".join(dict.fromkeys(map(remedy, effects)))


def _of_unknown(unknown: Sequence[UnknownFinding]) -> list[str]:
    """Return where to look for what no effect explains: in a log first where it has a moment."""
    if not unknown:
        return []
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
    more = f"If nothing was, {AGAIN}." if said else f"{AGAIN[:1].upper()}{AGAIN[1:]}."
    return [*said, more]


def _not_explained(above: Mapping[str, float], outside: Collection[str]) -> list[str]:
    """Return what the amended line leaves, as a sentence, or nothing."""
    loud = [f"{name} {100.0 * (ratio - 1.0):.0f} % above noise" for name, ratio in above.items()]
    far = f"{' and '.join(outside)} outside {'its' if len(outside) == 1 else 'their'} tolerance"
    said = "; ".join(part for part in (", ".join(loud), far if outside else "") if part)
    return [f"Not explained: {said}: check these."] if said else []
