"""Learned responses as files, and the service around an edit of its site file."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace

import pytest

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.check.validate import check_result
from aff_runtime.app.link.messages import Message, Parameters
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.supervisor import edit_session
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.response_ledger import ResponseLedger, learned_sentences
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from tests.doubles.virtual_clock import VirtualClock

ROOT = Path(__file__).parents[2]
SITE = ROOT / "config" / "euclid_blocks.yaml"
SIGNALS = {"unwind": "unwind_tension_N", "swrap_follower": "pullroll_tension_N"}
GAIN = 2000.0
REVISION_WORD = 7  # of the write block


def response(actuator: str, turned_rad: float = 0.0) -> str:
    """A good measurement, its phases turned: by 180 degrees it drives ripple up."""
    points = [
        ResponsePoint(
            frequency_Hz=f,
            gain=GAIN,
            phase_rad=math.pi - math.tau * f * 0.030 + turned_rad,
            relative_error=0.01,
            coherence=1.0,
        )
        for f in (0.3, 0.6, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0)
    ]
    about = Provenance(actuator=actuator, signal=SIGNALS[actuator])
    return Response(points=points, delay_s=0.030, provenance=about).to_json() + "\n"


def checked(site: Path) -> ParameterRecord:
    return check_result(site).checked()


def site_in(folder: Path) -> Path:
    """Write the site file into a folder, beside one for what is learned; return its path."""
    path = folder / "site.yaml"
    path.write_text(SITE.read_text())
    (folder / "learned").mkdir()
    return path


def learned(site: Path, actuator: str = "unwind") -> Path:
    return site.parent / "learned" / f"euclid_{actuator}.json"


class House:
    """The service around an edit: live or not, and what reaches the control process."""

    def __init__(self, site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.live = True
        self.said: list[tuple[str, str]] = []
        self.sent: list[Message] = []
        self.parameters = checked(site)
        self.probed = ResponseLedger(str)
        self.control = SimpleNamespace(link=SimpleNamespace(send=self._send))
        self._pending = Pending(VirtualClock())
        monkeypatch.setattr(edit_session, "Validation", CheckInProcess)
        self.edits = EditSession(
            self, self._pending, site, CheckResult(parameters=self.parameters, findings=())
        )

    def note(self, name: str, text: str) -> None:
        self.said.append((name, text))

    def is_live(self) -> bool:
        return self.live

    def revised(self, parameters: ParameterRecord) -> ParameterRecord:
        return parameters.with_shapes({})

    def note_applied(self) -> None:
        self.note("CONFIG_APPLIED", "; ".join(learned_sentences(self.parameters, self.probed)))

    def _send(self, message: Message) -> bool:
        self.sent.append(message)
        return True

    def look(self) -> None:
        """See the file, as after a change that has settled; the control process agrees."""
        self.edits.look_again()
        self.step()

    def step(self) -> None:
        self.edits.step()
        for message in self.sent:
            if isinstance(message, Parameters):
                self._pending.resolve(Reply(id=message.id, ok=True))

    @property
    def running(self) -> str:
        return str(self.parameters.learned.get("unwind", {}).get("response", "none"))


class CheckInProcess:
    """The check of a file, in this process."""

    def __init__(self, site: Path, *_: object, **__: object) -> None:
        self._site = site

    def result(self, **_: object) -> CheckResult:
        return check_result(self._site)

    def abandon(self) -> None:
        pass
