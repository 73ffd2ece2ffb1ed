"""What the cycle has been told: arm, bypass, stop, and which law to run."""

from __future__ import annotations

from collections import deque

from aff_runtime.base.ports import Law
from aff_runtime.loop.messages import Arm, Bypass, Message, Shadow, Stop, SupervisorLost, Swap
from aff_runtime.loop.ports import GuardPort, OutsidePort


class Inbox:
    """Takes the supervisor's messages between two ticks.

    Attributes
    ----------
    law : the law in force.
    config_revision : shown to the PLC.
    supervisor_alive : False once the command link is gone.
    stop_wanted : set by a message or a signal handler; ``stopping`` once the guard knows.
    """

    def __init__(
        self, *, guard: GuardPort, law: Law, outside: OutsidePort, advice_every_ticks: int
    ) -> None:
        self.law = law
        self.config_revision = 0
        self.supervisor_alive = True
        self.stop_wanted = False
        self.stopping = False
        self._guard = guard
        self._outside = outside
        self._advice_every_ticks = advice_every_ticks
        self._pending_swap: Swap | None = None
        self._waiting: deque[Message] = deque()
        self._last_blocked: tuple[str, ...] = ()

    def listen(self, tick: int) -> None:
        """Obey every message there is; ask the law's side for advice now and then."""
        if self.stop_wanted and not self.stopping:
            self._begin_stop()
        self._waiting.extend(self._outside.poll())
        while self._waiting:  # a message that fails does not take the next ones with it
            self._obey(self._waiting.popleft())
        if self._pending_swap is not None:
            self._swap_law(self._pending_swap)
        if tick % self._advice_every_ticks == 0:
            self._ask_advice()

    def _begin_stop(self) -> None:
        self.stopping = True
        if self.supervisor_alive:
            self._guard.bypass()

    def _obey(self, message: Message) -> None:
        match message:
            case Bypass():
                self._guard.bypass()
            case Stop():
                self.stop_wanted = True
            case SupervisorLost():
                self.supervisor_alive = False
                self.stop_wanted = True
            case Arm() if not self.stop_wanted:
                self._ask_advice()
                self._guard.arm()
            case Shadow(on=on) if not self.stop_wanted:
                self._guard.shadow(on)
            case Swap() if not self.stop_wanted:
                self._swap(message)

    def _swap(self, swap: Swap) -> None:
        if swap.guard_params is not None:
            self._outside.adopt(swap.guard_params)
        if swap.config_revision is not None:
            self.config_revision = swap.config_revision
        if swap.law is not None:
            self._pending_swap = swap

    def _swap_law(self, swap: Swap) -> None:
        """Change laws at once when one can take over, otherwise at the end of a fade."""
        if swap.law is None:
            return
        take_over = swap.take_over or getattr(swap.law, "take_over", None)
        if take_over is None and not self._guard.quiet:
            self._guard.fade_once()
            return
        self._pending_swap = None
        if take_over is not None:
            take_over(self.law)
        self.law = swap.law
        self._ask_advice()

    def _ask_advice(self) -> None:
        advice = self._outside.advise(self.law)
        self._guard.objections = advice.objections
        self._guard.ripple_rose = advice.ripple_rose
        blocked = self._guard.reasons()
        if blocked != self._last_blocked:
            self._last_blocked = blocked
            self._outside.blocked(blocked)
