"""One probe inside the control process, and its fit in a child of it."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Mapping, Sequence

from aff_runtime.app.link import replies
from aff_runtime.app.link.messages import Probed
from aff_runtime.app.link.packets import Link
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.wiring.site_to_law import probe_params
from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import AffError
from aff_runtime.base.signals import State
from aff_runtime.config.models import Site
from aff_runtime.config.probe_bound import TIMES_LOUDER
from aff_runtime.core.params import SiteParams
from aff_runtime.core.probe.probe import Probe, ProbeResult, Stage
from aff_runtime.core.response import Provenance, Response

START_PATIENCE_S = 10.0
TOO_LONG = "the result is too long for the link; probe fewer actuators"


class ProbeRun:
    """From the operator's command to the fit.

    Parameters
    ----------
    params : the settings of the law that runs.
    former : the responses in force. ``louder`` : send twice what was sent for them, if it may be.

    Raises
    ------
    RefusedError
        When the named actuators cannot be probed together.
    """

    def __init__(
        self,
        site: Site,
        actuators: Sequence[str],
        *,
        params: SiteParams,
        was_armed: bool,
        config_hash: str,
        version: str,
        former: Mapping[str, Response] | None = None,
        louder: bool = False,
    ) -> None:
        settings = probe_params(site, actuators, louder_than=_louder(former, actuators, louder))
        self._site = site
        self._config_hash = config_hash
        self._version = version
        self._settings = settings
        self.probe = Probe(params, settings, former)
        self.was_armed = was_armed
        self.duration_s = self.probe.expected_s + START_PATIENCE_S
        self._first_tick: int | None = None
        self._failure = ""

    def watch_tick(self, state: State, tick: int) -> bool:
        """Take one tick; return whether the probe is done, aborted, or not getting under way."""
        if self._first_tick is None:
            self._first_tick = tick
        if self.probe.stage in (Stage.DONE, Stage.ABORTED):
            return True
        waited_s = (tick - self._first_tick) * self._site.cycle_s
        at_rest = state in (State.FAULT, State.BYPASS, State.OFF)
        if waited_s > 1.0 and at_rest:
            self._failure = f"not in operation (state {state.name})"
        elif waited_s > self.duration_s:
            self._failure = f"did not end in {self.duration_s:.0f} s (state {state.name})"
        return bool(self._failure)

    def failure(self, state: State, blocked: str) -> str:
        """Return why there is nothing to fit, empty when there is something.

        Parameters
        ----------
        blocked : what stands in the way of an output now, empty for nothing.
        """
        if self.probe.stage is Stage.DONE:
            return ""
        reason = self.probe.reason or self._failure or "aborted"
        if self.probe.stage is Stage.LISTENING and self.probe.waiting:
            reason = f"{reason}; {self.probe.waiting}"
        return f"{reason}; {state.name}: {blocked}" if blocked else reason

    def fit_in_child(self, link: Link, tick: TickRow) -> None:
        """Fit in a forked child: least squares would hold up ten ticks here.

        The child gets ordinary priority (reset on fork), sends the result over the link and ends.
        It keeps nothing else open: what it held would outlive the tick, a connection that shall be
        reset, the lock of a serial line, the ring's by which readers see this process alive.

        Parameters
        ----------
        link : to the supervisor.
        tick : newest row, for the provenance.
        """
        signal.signal(signal.SIGCHLD, signal.SIG_IGN)
        try:
            child = os.fork()
        except OSError as error:
            link.send(Probed(error=f"the fit cannot start: {error.strerror}"))
            return
        if child == 0:
            self._fit_and_exit(link, tick)

    def _fit_and_exit(self, link: Link, tick: TickRow) -> None:
        """Send the result and leave without running anybody's clean-up."""
        try:
            _close_all_but(link.fileno())
            with contextlib.suppress(OSError):
                os.sched_setaffinity(0, range(os.cpu_count() or 1))
            if not link.send(Probed(results=self.results(tick))):
                link.send(
                    Probed(error="the result is too long for the link; probe fewer actuators")
                )
        except AffError as error:
            link.send(Probed(error=str(error)))
        except Exception as error:
            link.send(Probed(error=f"the fit failed ({error!r}); probe again"))
        finally:
            os._exit(0)

    def results(self, tick: TickRow) -> tuple[replies.ProbeResult, ...]:
        """Return one row per actuator, with the response file's text."""
        about = {
            name: Provenance(
                actuator=name,
                signal=self._site.actuators[name].error.signal,
                measured_at=wall_time_iso(),
                config_hash=self._config_hash,
                version=self._version,
                line_speed_m_s=tick.number(self._site.line.speed),
                radius_m=self._radius_m(name, tick),
                cycle_s=self._site.cycle_s,
            )
            for name in self._settings.actuators
        }
        return tuple(_told(result) for result in self.probe.result(about))

    def _radius_m(self, actuator: str, tick: TickRow) -> float:
        """Return the present radius of the first roll that the actuator works on."""
        roll = self._site.rolls[self._site.actuators[actuator].blocks[0].roll]
        if roll.radius_m is not None:
            return roll.radius_m
        return tick.number(roll.radius)


def _close_all_but(kept: int) -> None:
    """Close every descriptor but standard input and output and ``kept``."""
    os.closerange(3, kept)
    os.closerange(kept + 1, os.sysconf("SC_OPEN_MAX"))


def _louder(former: Mapping[str, Response] | None, names: Sequence[str], louder: bool) -> float:
    """Return the amplitude that a louder probe is to reach; 0 where none was sent before."""
    sent = [former[name].provenance.amplitude for name in names if former and name in former]
    return TIMES_LOUDER * max((one for one in sent if one > 0.0), default=0.0) if louder else 0.0


def _told(result: ProbeResult) -> replies.ProbeResult:
    """Return a result as it goes to the supervisor."""
    return replies.ProbeResult(
        actuator=result.actuator,
        sign=result.sign,
        remarks=tuple(result.remarks),
        delay_s=result.response.delay_s,
        text=result.response.to_json(),
    )
