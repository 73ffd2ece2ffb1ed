"""The settings' desk with the real edit session in virtual time; a double takes the settings."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from aff_runtime.app.check import validate
from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.hand.may import Circumstances
from aff_runtime.app.link.answers import Answer, refusal
from aff_runtime.app.link.messages import Parameters
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.link.runtime_directory import RuntimePaths
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.app.link.settings_request import settings_request
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.settings.desk import SettingsDesk
from aff_runtime.base.errors import AffError
from aff_runtime.base.signals import State, StateBits
from tests.doubles.virtual_clock import VirtualClock
from tests.parameter_records import CONFIG

TICK_S = 0.005
ROUND_S = 0.1
COLUMNS = ("time_s", "unwind_tension_N", "tension_ref_N", "pullroll_tension_N")
WHO = "uid 1000 (tech1 via root), pid 4711"


class AtOnce:
    """A check that has ended when it is asked."""

    def __init__(self, site: Path, state: Path, text: str | None = None) -> None:
        self._given = (site, state, None if text is None else text.encode())

    def result(self) -> CheckResult:
        return validate.check_result(*self._given)

    def abandon(self) -> None:
        pass


class Control:
    """Takes parameters as the control process does; ``deaf`` answers nothing, ``no`` refuses."""

    def __init__(self, pending: Pending) -> None:
        self.pending = pending
        self.link = self
        self.deaf, self.no = False, ""
        self.taken: list[ParameterRecord] = []

    def send(self, message: object) -> bool:
        if isinstance(message, Parameters) and not self.deaf:
            if not self.no:
                self.taken.append(message.record)
            self.pending.resolve(Reply(id=message.id, ok=not self.no, message=self.no))
        return True


class Signals:
    """A ring's signals: a sine of ``amplitude_N`` on both tensions."""

    def __init__(self, clock: VirtualClock) -> None:
        self._clock = clock
        self._next_s = 0.0
        self.amplitude_N = 1.0

    def read_new(self) -> list[tuple[float, ...]]:
        rows = []
        while self._next_s <= self._clock.now_ns() * 1e-9:
            ripple = self.amplitude_N * math.sin(math.tau * 1.1 * self._next_s)
            rows.append((self._next_s, 89.0 + ripple, 89.0, 94.0 + 0.1 * ripple))
            self._next_s += TICK_S
        return rows


class Ring:
    """The ring as the desk reads it."""

    columns = COLUMNS

    def __init__(self, clock: VirtualClock) -> None:
        self.signals = Signals(clock)


class Running:
    """What the desk knows of the children."""

    def __init__(self, parameters: ParameterRecord, clock: VirtualClock, pending: Pending) -> None:
        self.parameters = parameters
        self.control: Control | None = Control(pending)
        self.ring = Ring(clock)
        self.probed = None
        self.live = True
        self.notes: list[str] = []
        self.starts: list[str] = []

    def is_live(self) -> bool:
        return self.live

    def revised(self, parameters: ParameterRecord) -> ParameterRecord:
        return parameters

    def note_applied(self) -> None:
        self.note("CONFIG_APPLIED", self.parameters.site_hash)

    def recorder_report(self) -> None:
        return None

    def note(self, name: str, text: str) -> None:
        self.notes.append(f"{name}: {text}")

    def stop(self) -> None:
        pass

    def start(self) -> None:
        self.starts.append(self.parameters.site_text)


class Question:
    """One request of somebody, and what was answered."""

    who = WHO

    def __init__(self, **keys: Any) -> None:
        self.request = self
        self.settings = settings_request(keys)
        self.said: Answer | None = None

    def answer(self, answer: Answer) -> None:
        assert self.said is None
        self.said = answer

    def refuse(self, error: AffError) -> None:
        self.answer(refusal(error))

    @property
    def text(self) -> str:
        """The text that was handed out."""
        return SettingsAnswer.from_json(self.json).text

    @property
    def json(self) -> dict[str, Any]:
        assert self.said is not None
        return self.said.to_json()


class Rig:
    """A site file, what runs of it, and the desk."""

    def __init__(self, folder: Path) -> None:
        self.site = folder / "site.yaml"
        self.former = (CONFIG / "euclid_blocks.yaml").read_text()
        self.site.write_text(self.former)
        self.clock = VirtualClock(1)
        found = validate.check_result(self.site)
        self.pending = Pending(self.clock)
        self.running = Running(found.checked(), self.clock, self.pending)
        state = folder / "state"
        state.mkdir()
        options = RunOptions(
            site=self.site,
            paths=RuntimePaths(directory=folder, socket=folder / "s"),
            state_directory=state,
        )
        self.edits = EditSession(self.running, self.pending, self.site, found, state)  # type: ignore[arg-type]
        self.now = Circumstances(state=State.ACTIVE)
        self.desk = SettingsDesk(
            self.running,  # type: ignore[arg-type]
            self.edits,
            options,
            self.clock,
            lambda: self.now,
        )

    def other(self, before: str = "settle_s: 6,", after: str = "settle_s: 12,") -> str:
        """Return the former text with one value changed."""
        assert before in self.former
        return self.former.replace(before, after, 1)

    def ask(self, **keys: Any) -> Question:
        """Ask as the request desk does."""
        question = Question(**keys)
        try:
            self.desk.do(question)  # type: ignore[arg-type]
        except AffError as error:
            question.refuse(error)
        return question

    def run(self, seconds: float) -> None:
        """Let the supervisor look after everything."""
        for _ in range(round(seconds / ROUND_S)):
            self.clock.advance_ns(round(ROUND_S * 1e9))
            self.pending.expire()
            bits = StateBits.ARMED | StateBits.ACTIVE if self.running.live else StateBits(0)
            self.desk.step(TickRow({"state_bits": float(int(bits))}))
            self.edits.step()

    def begin(self, text: str = "", seconds: float = 60.0) -> Question:
        """Try a text and let it be taken."""
        said = self.ask(act="try", text=text or self.other(), seconds=seconds, why="hunting at 1x")
        self.run(0.3)
        return said

    @property
    def runs_the_former(self) -> bool:
        """Whether the former settings run, by the last word to the control process."""
        assert self.running.control is not None
        last = self.running.control.taken[-1:]
        return self.running.parameters.site_text == self.former and all(
            parameters.site == self.running.parameters.site for parameters in last
        )

    @property
    def rows(self) -> list[tuple[str, str]]:
        """The history: verb and reason."""
        return [(v["verb"], v["why"]) for v in self.ask(act="history").json["versions"]]
