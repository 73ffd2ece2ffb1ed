"""Step 12: off, on, off, on over the running web: by how much each order is smaller."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Figure, StepResult, at_most
from aff_runtime.app.card.measure.phases import last_two, offs_and_ons, phases
from aff_runtime.app.report.comparison.comparing import Comparison, OrderRow, compare
from aff_runtime.app.report.comparison.turns import NOT_TOLD, Change, Estimate
from aff_runtime.app.report.comparison.window import Window
from aff_runtime.base.errors import RefusedError
from aff_runtime.config.models import Actuator, Block, Site

AT_LEAST = " (at least: in the noise when on)"
AT_MOST = " (at most: in the noise when off)"
TYPED = ("promised", "settle")
DEFAULT_PROMISE_dB = 0.0  # where none is typed
TURNS, BROKEN_TURNS = 20, 2
"""Turns of the slowest corrected roll that each off and on needs: whole ones, and what may be
broken at its two ends."""
NOTHING_PROVEN = (
    "nothing is proven: no corrected order stands out of the noise in both pairs; make each off, "
    f"and each on behind its settling, {TURNS + BROKEN_TURNS} turns of the largest roll long"
)
PARTS = ("first off", "first on", "second off", "second on")
SPEED_PERCENT, SLOWEST_M_S = 2.0, 1e-3
"""How far the line speeds of the four parts may be apart; what a mean speed counts as at least."""
SETTLES, MEMORIES = 3.0, 2.0
"""An on is left alone for so many settle times of a block, or memories of a shape law."""
RISE_SHARE = 0.02
"""Of all corrected orders together when off: by less no order of them counts as risen. Of many
orders some seem to rise by chance, and by so little none is seen in the tension."""
DOES_NOT_RISE = f"does not rise by {100.0 * RISE_SHARE:.0f} % of all"
Key = tuple[str, str, int]
"""Signal, roll, order."""
_DB = 20.0 / math.log(10.0)  # dB of a natural logarithm


def measure(evidence: Evidence) -> StepResult:
    """Return the reduction of every order that is corrected, and of all together."""
    window = evidence.window
    settle_s = evidence.typed.number("settle", "s")
    if not math.isfinite(settle_s):
        settle_s = settling_s(evidence.site, mean_speed_m_s(window))
    promised = evidence.typed.number("promised", "dB")
    made = offs_and_ons(phases(window), settle_s)
    if len(made) < 2:
        return StepResult(
            figures=(),
            missing=(
                "off, on, off, on is not in the window, each long enough "
                f"(on: {settle_s:.0f} s to settle, and {TURNS + BROKEN_TURNS} turns)",
            ),
        )
    wanted = corrected(evidence.site)
    newest_first = (compare(off.of(window), on.of(window)) for off, on in reversed(made))
    pairs, cut = last_two(newest_first, lambda pair: _is_whole(pair, wanted))
    overall = list(_overall(pairs, wanted, promised))
    turns = list(_turns(pairs, wanted))
    conditions = _conditions(pairs, window.table.events)
    short = [one for one in turns if not one.good]
    return StepResult(
        figures=(*overall, *turns, *conditions, *_orders(pairs, wanted)),
        missing=(
            *(() if any(one.good is not None for one in overall) else (NOTHING_PROVEN,)),
            *(_hidden(one) for one in overall if one.is_missing),
            *map(_too_short, short),
        ),
        remarks=(*_remarks(pairs), *map(_left_out, cut)),
    )


def settling_s(site: Site, speed_m_s: float) -> float:
    """Return how long an on is left alone before it counts, s.

    Three settle times of the slowest block; of a shape law twice its memory, at the largest
    radius of its rolls.
    """
    times_s = []
    for actuator in site.actuators.values():
        if actuator.uses_shape:
            radius_m = max(site.rolls[block.roll].largest_radius_m for block in enabled(actuator))
            turn_s = math.tau * radius_m / speed_m_s
            times_s.append(MEMORIES * actuator.memory_turns * turn_s)
        else:
            times_s.extend(SETTLES * block.settle_s for block in enabled(actuator))
    return max(times_s, default=0.0)


def part_s(site: Site, speed_m_s: float) -> float:
    """Return how long an off lasts, and an on behind its settling, s: enough of whole turns."""
    radius_m = max(site.rolls[roll].largest_radius_m for _, roll, _ in corrected(site))
    return (TURNS + BROKEN_TURNS) * math.tau * radius_m / speed_m_s


def mean_speed_m_s(window: Window) -> float:
    """Return the mean line speed of a window, never 0.

    Raises
    ------
    RefusedError
        It is not recorded.
    """
    speed = window.speed
    if speed is None:
        raise RefusedError(f"{window.table.window}: no reading of the line speed in it")
    return max(abs(float(np.nanmean(speed))), SLOWEST_M_S)


def _left_out(cut: Comparison) -> str:
    off, on = (f"{one.name}, {one.seconds:.0f} s" for one in cut.windows)
    return f"left out, fewer than {TURNS} whole turns in one of them: off {off}, on {on}"


def reduction(changes: Sequence[Change]) -> Change:
    """Return two changes as one reduction, dB, positive where ripple fell.

    Its sign is turned: a change of ``at_most`` a value is a reduction of ``at_least`` it. The
    interval is that of the mean, and never narrower than half of what the two differ by. An order
    that is in the noise when off, and rose out of it every time, is a reduction of ``at_most``.
    """
    bounds = {change.bound for change in changes}
    if bounds == {"at_least"} and all(change.low_dB > 0.0 for change in changes):
        most = max(-change.value_dB for change in changes)
        low = max(-change.low_dB for change in changes)
        return Change(value_dB=most, low_dB=NAN, high_dB=low, bound="at_most")
    values = [-change.value_dB for change in changes if math.isfinite(change.value_dB)]
    if bounds & {*NOT_TOLD, "at_least"} or not values:
        return Change(value_dB=NAN, low_dB=NAN, high_dB=NAN, bound="none")
    if bounds != {""}:
        surely = [-change.high_dB for change in changes]  # the lower end, of a bound itself
        return Change(value_dB=min(surely), low_dB=NAN, high_dB=NAN, bound="at_least")
    halves = [0.5 * (change.high_dB - change.low_dB) for change in changes]
    mean = sum(values) / len(values)
    half = max(math.hypot(*halves) / len(values), 0.5 * (max(values) - min(values)))
    return Change(value_dB=mean, low_dB=mean - half, high_dB=mean + half, bound="")


def corrected(site: Site) -> frozenset[Key]:
    """Return signal, roll and order of everything that a block corrects."""
    return frozenset(
        (actuator.error.signal, block.roll, order)
        for actuator in site.actuators.values()
        for block in enabled(actuator)
        for order in block.orders
    )


def enabled(actuator: Actuator) -> tuple[Block, ...]:
    """Return the blocks that the law has: one that is switched off corrects nothing."""
    return tuple(block for block in actuator.blocks if block.enabled)


def by_key(comparison: Comparison, wanted: frozenset[Key]) -> Mapping[Key, OrderRow]:
    """Return the rows of what is corrected."""
    rows = {(row.signal, row.roll, row.order): row for row in comparison.rows}
    return {key: row for key, row in rows.items() if key in wanted}


def _orders(pairs: Sequence[Comparison], wanted: frozenset[Key]) -> Iterator[Figure]:
    first, second = both = [by_key(pair, wanted) for pair in pairs]
    shares = [rise_shares(rows) for rows in both]
    for key in first:
        if key in second:
            rise_share = sum(of_pair[key] for of_pair in shares) / len(shares)
            yield reduction_figure(key, [first[key].change, second[key].change], rise_share)


def rise_shares(rows: Mapping[Key, OrderRow]) -> dict[Key, float]:
    """Return by how much each order rose, over its signal's orders together when off."""
    together = {
        signal: root_sum([row.before for key, row in rows.items() if key[0] == signal], 0.0)[0]
        for signal in {key[0] for key in rows}
    }
    return {
        key: (row.after.amplitude - row.before.amplitude) / together[key[0]]
        if together[key[0]]
        else math.inf
        for key, row in rows.items()
    }


def reduction_figure(key: Key, changes: Sequence[Change], rise_share: float) -> Figure:
    """Return the reduction of one order; NaN, and not needed, for one that is in the noise.

    An order that surely rose fails if ``rise_share`` of :func:`rise_shares` is above
    ``RISE_SHARE``.
    """
    signal, roll, order = key
    change = reduction(changes)
    noise = change.bound == "none"
    bound = {"at_least": AT_LEAST, "at_most": AT_MOST}.get(change.bound, "")
    return Figure(
        name=f"{signal}, {roll} {order}x: reduction{bound}",
        value=change.value_dB,
        unit="dB",
        low=change.low_dB,
        high=change.high_dB,
        limit="in the noise, off or both" if noise else DOES_NOT_RISE,
        good=None if noise else not (change.high_dB < 0.0 and rise_share > RISE_SHARE),
        needed=not noise,
    )


def surely_fell(figure: Figure) -> bool:
    """Whether a figure of :func:`reduction_figure` says that its order fell, not only may have."""
    if figure.name.endswith(AT_LEAST):
        return figure.value > 0.0
    return figure.low > 0.0


def _overall(
    pairs: Sequence[Comparison], wanted: frozenset[Key], promised: float
) -> Iterator[Figure]:
    """Yield per signal the reduction of all corrected orders that stand out at all."""
    bound = promised if math.isfinite(promised) else DEFAULT_PROMISE_dB
    both = [by_key(pair, wanted) for pair in pairs]
    for signal in dict.fromkeys(key[0] for key in both[0]):
        rows = [
            [
                row
                for key, row in one.items()
                if key[0] == signal and row.change.bound not in NOT_TOLD
            ]
            for one in both
        ]
        if not all(rows):
            continue
        change = reduction([_together(one) for one in rows])
        at_least = AT_LEAST if change.bound else ""
        yield Figure(
            name=f"{signal}: all corrected orders together, reduction{at_least}",
            value=change.value_dB,
            unit="dB",
            low=change.low_dB,
            high=change.high_dB,
            limit=f"above {bound:g} dB" + (" (promised)" if math.isfinite(promised) else ""),
            good=_is_kept(change, rows, bound),
            needed=math.isfinite(promised),
        )


def _is_kept(change: Change, pairs: Sequence[Sequence[OrderRow]], bound_dB: float) -> bool | None:
    """Whether a reduction is what was promised; None where the noise hides whether it is."""
    if change.value_dB >= bound_dB:
        return True
    if not change.bound:
        return False
    return None if max(map(_best_dB, pairs)) >= bound_dB else False


def _best_dB(rows: Sequence[OrderRow]) -> float:
    """Return what orders together fell by at best: what the noise hides when on is nothing."""
    off, off_half = root_sum([row.before for row in rows], 1.0)
    on, on_half = root_sum([row.after for row in rows], 0.0)
    return _DB * math.log((off + off_half) / (on - on_half)) if on > on_half else math.inf


def _hidden(figure: Figure) -> str:
    shown = f"{figure.value:.1f} dB" if math.isfinite(figure.value) else "not known"
    return (
        f"{figure.name}: {shown}, {figure.limit}; the noise hides whether it is "
        "more: make each off, and each on, longer"
    )


def _together(rows: Sequence[OrderRow]) -> Change:
    """Return the change of orders together; a bound where one of them is in the noise when on."""
    off, off_half = root_sum([row.before for row in rows], 0.0)
    on, on_half = root_sum([row.after for row in rows], 1.0)
    if off <= 0.0 or on <= 0.0:
        return Change(value_dB=NAN, low_dB=NAN, high_dB=NAN, bound="none")
    if any(not row.after.stands_out for row in rows):
        if not off > off_half:
            return Change(value_dB=NAN, low_dB=NAN, high_dB=NAN, bound="unknown")
        most = _DB * math.log((on + on_half) / (off - off_half))
        return Change(value_dB=most, low_dB=NAN, high_dB=most, bound="at_most")
    value = _DB * math.log(on / off)
    half = _DB * math.hypot(off_half / off, on_half / on)
    return Change(value_dB=value, low_dB=value - half, high_dB=value + half, bound="")


def root_sum(ends: Sequence[Estimate], noise: float) -> tuple[float, float]:
    """Return the root of the sum of squares of amplitudes, and half its interval.

    What is in the noise counts as ``noise`` times the most that it may be: nothing when off, all
    when on, so that the reduction is never better than is known.
    """
    sizes = [end.amplitude if end.stands_out else noise * end.most for end in ends]
    halves = [0.5 * (end.high - end.low) if end.stands_out else 0.0 for end in ends]
    total = math.sqrt(sum(size**2 for size in sizes))
    spread = math.sqrt(sum((s * h) ** 2 for s, h in zip(sizes, halves, strict=True)))
    return total, spread / total if total else 0.0


def _turns(pairs: Sequence[Comparison], wanted: frozenset[Key]) -> Iterator[Figure]:
    """Yield for each of the four parts the fewest whole turns that an estimate rests on."""
    fewest = [one for pair in pairs for one in _fewest_turns(pair, wanted)]
    for part, (turns, roll) in zip(PARTS, fewest, strict=True):
        yield Figure(
            name=f"{part}: whole turns{f' of {roll}' if roll else ''}",
            value=float(turns),
            limit=f"at least {TURNS}",
            good=None if _is_short((turns, roll)) else True,
        )


def _fewest_turns(pair: Comparison, wanted: frozenset[Key]) -> Iterator[tuple[int, str]]:
    """Yield of an off and its on the fewest whole turns of a corrected roll, and which it is."""
    rows = by_key(pair, wanted).values()
    yield min(((row.before.turns, row.roll) for row in rows), default=(0, ""))
    yield min(((row.after.turns, row.roll) for row in rows), default=(0, ""))


def _is_whole(pair: Comparison, wanted: frozenset[Key]) -> bool:
    """Whether an off and its on have their turns; how far the ripple fell is not asked."""
    return not any(map(_is_short, _fewest_turns(pair, wanted)))


def _is_short(turns: tuple[int, str]) -> bool:
    return turns[0] < TURNS


def _too_short(turns: Figure) -> str:
    return f"{turns.name}: {turns.value:.0f}, {TURNS} are needed; make it longer, or type settle"


def _conditions(
    pairs: Sequence[Comparison], events: Sequence[Mapping[str, str]]
) -> Iterator[Figure]:
    """Yield what would spoil the proof: another speed, other settings, a ripple that rose."""
    speeds = [facts.speed_m_s[0] for pair in pairs for facts in pair.windows]
    apart = 100.0 * (max(speeds) - min(speeds)) / max(1e-12, *map(abs, speeds))
    yield Figure(
        name="line speed: largest difference of the four",
        value=apart,
        unit="%",
        limit=f"at most {SPEED_PERCENT:g} %",
        good=at_most(apart, SPEED_PERCENT),
    )
    rose = sum(row.get("name") == "RIPPLE_ROSE" for row in events)
    others = sum(len(pair.differences) for pair in pairs)
    for name, count in (("RIPPLE_ROSE", rose), ("differences of settings", others)):
        yield Figure(name=f"{name} in it", value=float(count), limit="0", good=count == 0)


def _remarks(pairs: Sequence[Comparison]) -> Iterator[str]:
    for which, pair in zip(("first", "second"), pairs, strict=True):
        for window in pair.windows:
            yield (
                f"{which} pair: {window.name}, {window.seconds:.0f} s at "
                f"{window.speed_m_s[0]:.4g} m/s"
            )
        yield from (f"{which} pair: {label}" for label in pair.labels)
