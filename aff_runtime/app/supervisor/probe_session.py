"""The supervisor's side of a probe: keep the responses, hand them on, tell the operator."""

from __future__ import annotations

from collections.abc import Callable

from aff_runtime.app.link.answers import Done, KeptResponse, ProbeDone
from aff_runtime.app.link.messages import Probed
from aff_runtime.app.link.replies import ProbeResult
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.files import replace_text
from aff_runtime.base.runs.responses import with_units


class ProbeSession:
    """From the request to the answer.

    Parameters
    ----------
    processes : for the record's file names and notes.
    edits : looks at the files again, which hands the new responses to the running law.
    tell : called once with what came of it.
    """

    def __init__(
        self, processes: Processes, edits: EditSession, tell: Callable[[Done | ProbeDone], None]
    ) -> None:
        self._processes = processes
        self._edits = edits
        self._tell = tell
        self._answer: Done | ProbeDone | None = None

    @property
    def is_finished(self) -> bool:
        """Whether it is known what came of the probe."""
        return self._answer is not None

    def finish(self, probed: Probed) -> None:
        """Write what was measured, or note why there is nothing."""
        error = probed.error
        written: list[KeptResponse] = []
        if not error:
            try:
                written = [self._keep(result) for result in probed.results]
            except OSError as failure:
                error = f"{failure.filename}: {failure.strerror}; the response is not kept"
        if error:
            self._processes.note("PROBE", error)
            code = RefusedError.exit_code
            self._answer = Done(ok=False, message=error, exit_code=code)
            return
        self._edits.look_again()
        self._answer = ProbeDone(results=tuple(written))

    def has_answered(self) -> bool:
        """Answer the caller once the running law has the new responses; True when done."""
        if self._answer is None or (self._answer.ok and self._edits.is_busy):
            return False
        self._tell(self._answer)
        return True

    def close(self, reason: str) -> None:
        """Answer now: with what is known, else with the reason why nothing will be."""
        if self._answer is None:
            self.finish(Probed(error=reason))
        if self._answer is not None:
            self._tell(self._answer)

    def _keep(self, result: ProbeResult) -> KeptResponse:
        """Replace one response file, whole or not at all; return the result with its path.

        The record gets it first: it was measured, whether the file can be written or not.
        """
        unit = self._processes.parameters.site.actuators[result.actuator].response_unit
        self._processes.keep_response(result.actuator, with_units(result.text, unit))
        path = self._processes.parameters.response_files[result.actuator]
        text = result.text + "\n"
        self._processes.probed.add(path, text)
        replace_text(path, text)
        self._processes.note("PROBE", f"{result.actuator}: {path}")
        return KeptResponse(result=result, file=path)
