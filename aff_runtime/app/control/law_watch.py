"""Reports of the law to guard and operator: objections, rising ripple, held or resting blocks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import tau

from aff_runtime.app.report.block_status import RESTS
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State
from aff_runtime.config.models import Site
from aff_runtime.core.controller import Controller
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.order_status import OrderStatus
from aff_runtime.core.ripple_watch import RippleWatch
from aff_runtime.loop.ports import Advice

STEADY_ASKS = 10  # looks that must agree before a block counts as held, or as free again
EVENT_OF = {
    OrderState.CLAMPED: BY_NAME["BLOCK_CLAMPED"],
    OrderState.HELD_PHASE: BY_NAME["PHASE_UNSURE"],
}
RESTS_IN = "shape"  # the law whose orders rest when they do harm
REPORTED = {*EVENT_OF, OrderState.RISING}


class LawWatch:
    """Asked every few ticks; a few microseconds per block, and silent until something changes.

    Parameters
    ----------
    event : keeps an event code in the record.
    say : passes a sentence to the supervisor's log.
    """

    def __init__(self, event: Callable[[int], None], say: Callable[[str], None]) -> None:
        self._event = event
        self._say = say
        self._watches: dict[str, RippleWatch] = {}
        self._unbelieved: set[str] = set()
        self._held = HeldBlocks()
        self._tick = 0
        self._origin_losses: dict[str, int] = {}

    @property
    def unbelieved(self) -> frozenset[str]:
        """Actuators that made ripple rise and whose weights are about to be dropped."""
        return frozenset(self._unbelieved)

    def advise(self, law: LawSlot, site: Site, *, state: State, quiet: bool, tick: int) -> Advice:
        """Return the law side's advice to the guard.

        Parameters
        ----------
        state : of the guard. ``quiet`` : every output is closed and zero.
        tick : number of the present tick.
        """
        elapsed_s, self._tick = (tick - self._tick) * site.cycle_s, tick
        if law.probe is not None:
            self._watches.clear()
            self._held = HeldBlocks()
            return Advice()
        controller = law.controller
        is_open = state is State.ACTIVE
        self._note_origins(controller)
        self._note_blocks(controller, is_open)
        rose = self._watch_ripple(controller, site, is_open, elapsed_s)
        self._forget_unbelieved(controller, site, quiet)
        return Advice(
            objections=tuple(
                f"{actuator}: {text}"
                for actuator, texts in controller.arming_objections().items()
                for text in texts
            ),
            ripple_rose=rose,
        )

    def _watch_ripple(
        self, controller: Controller, site: Site, is_open: bool, elapsed_s: float
    ) -> bool:
        speed_m_s = controller.line_speed_m_s
        turns = elapsed_s * controller.slowest_omega_rad_s / tau
        rose = False
        for name, ripple in zip(site.actuators, controller.ripple(), strict=False):
            watch = self._watches.setdefault(name, RippleWatch())
            if not watch.step(ripple, is_open=is_open, speed_m_s=speed_m_s, turns=turns):
                continue
            rose = True
            if name not in self._unbelieved:
                self._unbelieved.add(name)
                signal = site.actuators[name].error.signal
                self._say(f"RIPPLE_ROSE {name}: {_rise(signal, watch.reference, ripple[1])}")
        return rose

    def _forget_unbelieved(self, controller: Controller, site: Site, quiet: bool) -> None:
        """Drop what made ripple rise, once nothing of it goes out any more."""
        if not quiet:
            return
        for name in self._unbelieved:
            if name in site.actuators:
                controller.forget(list(site.actuators).index(name))
        self._unbelieved.clear()

    def _note_origins(self, controller: Controller) -> None:
        """Say whose angle came back after a gap without its former origin."""
        for roll, phase in controller.phases.by_name.items():
            before = self._origin_losses.get(roll, phase.origin_losses)
            self._origin_losses[roll] = phase.origin_losses
            if phase.origin_losses > before:
                self._say(
                    f"{roll}: its angle was lost for a while and has another origin now; "
                    "what was learned on it is forgotten"
                )

    def _note_blocks(self, controller: Controller, is_open: bool) -> None:
        for order, state in self._held.step(controller.order_statuses(), is_open=is_open):
            block = f"{order.actuator}.{order.name}"
            if state is OrderState.RISING:
                if order.law == RESTS_IN:
                    self._say(f"{block} {RESTS}")
                continue
            event = EVENT_OF[state]
            self._event(event.code)
            self._say(f"{event.name} {block}: {event.text}; {event.action}")


def _rise(signal: str, expected: float, now: float) -> str:
    """Return what rose; both are ripple in the signal's unit."""
    unit = unit_of_channel(signal) or ""
    return f"{signal} {expected:.3g} {unit} expected without correction, {now:.3g} {unit} now"


class HeldBlocks:
    """Finds the moment in which a block becomes held or resting, once per lasting change."""

    def __init__(self) -> None:
        self._count: dict[tuple[str, str], int] = {}
        self._reported: dict[tuple[str, str], OrderState | None] = {}

    def step(
        self, orders: Sequence[OrderStatus], *, is_open: bool = True
    ) -> list[tuple[OrderStatus, OrderState]]:
        """Return the blocks newly held or resting, with their state; none unless ``is_open``."""
        news: list[tuple[OrderStatus, OrderState]] = []
        for order in orders:
            block = (order.actuator, order.name)
            reported = self._reported.get(block)
            held = order.state if is_open and order.state in REPORTED else None
            count = self._count.get(block, 0) + 1 if held is not reported else 0
            if count >= STEADY_ASKS:
                count = 0
                self._reported[block] = held
                if held is not None:
                    news.append((order, held))
            self._count[block] = count
        return news
