"""What to do on the machine to tell two effects apart that a record cannot."""

from __future__ import annotations

from collections.abc import Sequence

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.effect_at import EffectAt


def experiment(one: EffectAt, other: EffectAt) -> str:
    """Return the experiment that tells two effects apart, as a sentence.

    The first that fits: two effects locked to the order of different rollers; what an effect's
    own ``experiment`` gives; two on one roller; a record under other conditions.
    """
    a, b = BY_NAME[one.effect], BY_NAME[other.effect]
    elsewhere = one.location != other.location
    locked = a.order_locked and b.order_locked
    if elsewhere and locked and not (a.sensor_only or b.sensor_only):
        return (
            f"lift the web off, turn {one.location} alone half a turn by hand and record again: "
            "the line's phase moves only if that roller causes it"
        )
    own = _of_the_effects(one, other)
    if own:
        return own
    if locked and not elsewhere:
        return (
            f"turn {one.location} by hand under a dial gauge: run-out shows an eccentric or "
            "uneven roller, none an unbalance"
        )
    return (
        "record again at another speed, another tension and another roll radius, and give "
        "both records to refine together"
    )


def _of_the_effects(one: EffectAt, other: EffectAt) -> str:
    """Return what either effect gives against the other, a sensor's fault first; may be empty."""
    pairs = sorted(
        ((one, other), (other, one)), key=lambda p: not BY_NAME[p[0].effect].sensor_only
    )
    for mine, theirs in pairs:
        given_by = BY_NAME[mine.effect].experiment
        text = given_by(mine.location, BY_NAME[theirs.effect], theirs.location) if given_by else ""
        if text:
            return text
    return ""


def experiments(claimed: EffectAt, rivals: Sequence[EffectAt]) -> list[str]:
    """Return the experiments that tell ``claimed`` from its rivals, each once."""
    return list(dict.fromkeys(experiment(claimed, other) for other in rivals))
