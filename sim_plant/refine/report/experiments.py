"""What to do on the machine to tell two effects apart that a record cannot."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType

from sim_plant.base.effects import Value
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.along_web import listed, sorted_along

NONE_FITTED: Mapping[str, Value] = MappingProxyType({})


def experiment(
    one: EffectAt,
    other: EffectAt,
    values: Mapping[str, Value] = NONE_FITTED,
    angles: Collection[str] = (),
    places: Sequence[str] = (),
    along: Sequence[str] = (),
) -> str:
    """Return the experiment that tells two effects apart, as a sentence.

    The first that fits: two effects locked to the order of different rollers, at standstill before
    a record; what an effect's own ``experiment`` gives; two on one roller; a record under other
    conditions.

    Parameters
    ----------
    values : the numbers of ``one`` as fitted; none: no size is told.
    angles : bodies whose angle is recorded. Without it a body's turn by hand leaves no trace: its
        phase is found anew in every record.
    places : where the same effect may be, both among them; empty: at those two.
    along : the line's bodies in the order of its web.
    """
    a, b = BY_NAME[one.effect], BY_NAME[other.effect]
    elsewhere = one.location != other.location
    both = sorted_along(places or (one.location, other.location), along)
    locked = a.order_locked and b.order_locked and not (a.sensor_only or b.sensor_only)
    if elsewhere and locked:
        at_rest = _by_gauge(one, other, values, listed(both, along))
        at_rest = at_rest or _of_the_effects(one, other, listed(both, along))
        said = [text for text in (at_rest, _half_a_turn(one.location, angles)) if text]
        if said:
            return "; then ".join(said)
    own = _of_the_effects(one, other, listed(both, along))
    if own:
        return own
    if a.order_locked and b.order_locked and not elsewhere:
        return (
            f"turn {one.location} by hand under a dial gauge: run-out shows an eccentric or "
            "uneven roller, none an unbalance"
        )
    return (
        "record again at another speed, another tension and another roll radius, and give "
        "both records to refine together"
    )


def _by_gauge(one: EffectAt, other: EffectAt, values: Mapping[str, Value], places: str) -> str:
    """Return what a dial gauge tells at standstill; empty where it reads nothing of either."""
    known = BY_NAME[one.effect]
    if known.run_out is None:
        if BY_NAME[other.effect].run_out is None:
            return ""
        at, cause = other.location, "if it is the cause"
        return f"take the web off and turn {at} by hand under a dial gauge: it runs out {cause}"
    in_mm = 1e3 * known.run_out({**known.parameters, **values}) if values else 0.0
    size = f", {in_mm:.3g} mm in total" if in_mm else ""
    if one.effect == other.effect:
        every, which = places, "the eccentric one runs out"
    else:
        every, which = one.location, "if it is the cause it runs out"
    return (
        f"take the web off and turn {every} by hand under a dial gauge: {which} by twice the "
        f"eccentricity{size}"
    )


def _half_a_turn(roller: str, angles: Collection[str]) -> str:
    if roller not in angles:
        return ""
    return (
        f"lift the web off, turn {roller} alone half a turn by hand and record again: "
        "the line's phase moves only if that roller causes it"
    )


def _of_the_effects(one: EffectAt, other: EffectAt, places: str) -> str:
    """Return what either effect gives against the other, a sensor's fault first; may be empty.

    ``places``: all at which it may be, where it is the same effect.
    """
    among = BY_NAME[one.effect].among
    if one.effect == other.effect and one.location != other.location and among is not None:
        return among(places)
    pairs = sorted(
        ((one, other), (other, one)), key=lambda p: not BY_NAME[p[0].effect].sensor_only
    )
    for mine, theirs in pairs:
        given_by = BY_NAME[mine.effect].experiment
        text = given_by(mine.location, BY_NAME[theirs.effect], theirs.location) if given_by else ""
        if text:
            return text
    return ""


def experiments(
    claimed: EffectAt,
    rivals: Sequence[EffectAt],
    values: Mapping[str, Value] = NONE_FITTED,
    angles: Collection[str] = (),
    along: Sequence[str] = (),
) -> list[str]:
    """Return the experiments that tell ``claimed`` from its rivals, each once; see `experiment`.

    One gauge, or one look, goes round all places of the same effect, ``along`` the web.
    """
    alike = [r.location for r in rivals if r.effect == claimed.effect]
    places = list(dict.fromkeys([claimed.location, *alike]))
    said = [
        experiment(claimed, other, values, angles, places if len(places) > 1 else (), along)
        for other in rivals
    ]
    return list(dict.fromkeys(said))
