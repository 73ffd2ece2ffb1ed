"""How the service stands: what ``status`` answers, and what a door tells beside the ring."""

from __future__ import annotations

import math
from dataclasses import replace

from aff_runtime.app.door.messages import Facts
from aff_runtime.app.report.command_counts import CommandTally
from aff_runtime.app.report.line_facts import line_facts
from aff_runtime.app.report.probe_facts import probes_of
from aff_runtime.app.report.status import live_status
from aff_runtime.app.report.status_answer import NOT_SAID, SILENT, StatusAnswer
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.hand.desk import HandDesk
from aff_runtime.app.supervisor.meeting_forecast import MeetingForecast
from aff_runtime.app.supervisor.probe_desk import ProbeDesk
from aff_runtime.app.supervisor.processes import FRESH_S, Processes
from aff_runtime.app.supervisor.response_ledger import learned_sentences
from aff_runtime.app.supervisor.settings.desk import SettingsDesk
from aff_runtime.base.signals import State


class Standing:
    """Gathers what the parts of the service say of themselves.

    Parameters
    ----------
    hand : None where none is open; ``hand_is_wanted`` : whether the command line asks for one.
    """

    def __init__(
        self,
        processes: Processes,
        edits: EditSession,
        settings: SettingsDesk,
        probes: ProbeDesk,
        forecast: MeetingForecast,
        counts: CommandTally,
        hand: HandDesk | None,
        *,
        hand_is_wanted: bool,
    ) -> None:
        self._processes, self._edits, self._settings = processes, edits, settings
        self._probes, self._forecast, self._counts = probes, forecast, counts
        self._hand, self._hand_is_wanted = hand, hand_is_wanted

    def status(self) -> StatusAnswer:
        """Return the answer to a status request."""
        processes, parameters = self._processes, self._processes.parameters
        standing = self._standing()
        state, live, latest = standing.state, None, processes.latest()
        age_s = math.nan
        if processes.ring is not None and latest is not None:
            guard_state, live = live_status(latest, parameters.permissives, parameters.site)
            age_s = processes.age_s(latest)
            is_fresh = age_s < FRESH_S
            state = guard_state.name if is_fresh else SILENT
            live = replace(
                live,
                comm=live.comm if is_fresh else SILENT,
                wire=processes.troubles,
                blocked_by=processes.blocked,
                also_blocking=processes.also_blocking,
                meta=processes.ring.header.meta,
            )
        said_s = round(age_s, 3) if math.isfinite(age_s) else NOT_SAID
        return replace(standing, state=state, live=live, tick_age_s=said_s)

    def facts(self) -> Facts:
        """Return what who looks on cannot see in the ring."""
        processes = self._processes
        return Facts(
            status=self._standing(),
            blocked=processes.blocked,
            also_blocking=processes.also_blocking,
            wire=processes.troubles,
        )

    def _standing(self) -> StatusAnswer:
        """Return how the service stands, without what the newest tick says."""
        processes, parameters = self._processes, self._processes.parameters
        return StatusAnswer(
            line=parameters.site.line.name,
            state="STARTING" if processes.control is not None else State.FAULT.name,
            config_hash=parameters.config_hash,
            site_hash=parameters.site_hash,
            learned=tuple(learned_sentences(parameters, processes.probed)),
            config_differs=tuple(self._edits.differs),
            control_pid=processes.control.pid if processes.control is not None else 0,
            probing=self._probes.is_under_way,
            probed=self._probes.said,
            trying=self._settings.trying,
            trying_left_s=self._settings.trying_left_s,
            tried=self._settings.tried,
            recorder=processes.recorder_report(),
            control_restarts=processes.restarts,
            audit_records=self._hand.audit_records if self._hand is not None else NOT_SAID,
            audit_ok=self._audit_ok(),
            commands=self._counts.rows(),
            operators=tuple(processes.operators),
            probes=tuple(probes_of(parameters.responses)),
            shapes=tuple(processes.shapes.sentences),
            meeting_sentences=tuple(self._forecast.sentences()),
            meetings=self._forecast.meetings(),
            facts=line_facts(parameters.site, parameters.permissives),
        )

    def _audit_ok(self) -> int:
        if not self._hand_is_wanted:
            return NOT_SAID
        return int(self._hand is not None and self._hand.is_kept)
