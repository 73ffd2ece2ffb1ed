"""What a step may look at, gathered by who runs it; a step asks nobody itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from aff_runtime.app.card.figures import Sample
from aff_runtime.app.card.typed_values import TypedValues
from aff_runtime.app.report.block_status import BlockStatus
from aff_runtime.app.report.comparison.window import Window
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.machine import Machine
from aff_runtime.config.facts import LimitFact
from aff_runtime.config.models import Site
from aff_runtime.core.response import Response
from aff_runtime.telemetry.header import Right


class Need(StrEnum):
    """What has to be gathered for a step."""

    RECORD = "a window of a record"
    SERVICE = "the running service"


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedSite:
    """What the check says: the site, its warnings, its limits in counts."""

    site: Site
    warnings: tuple[str, ...] = ()
    limits: tuple[LimitFact, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Try:
    """A setting that the service has tried for a while.

    Attributes
    ----------
    factor : by which `settle_s` or `memory_turns` of the site file was multiplied; 1 is the
        present setting. ``measured`` : a window of the record shows it.
    ended : why it ended before it was measured; empty where it was.
    worse : it ended because ripple rose: that is a result, and not a try that was cut off.
    """

    actuator: str
    factor: float
    measured: bool
    ended: str = ""
    worse: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """Everything that one measurement rests on.

    Attributes
    ----------
    windows : of records; empty for a step that looks at none.
    rights, machine : real-time rights of the control process; processors and kernel of
        this computer, where the service that answered runs on it.
    state, blocks : of the running service: its state, every order of every law.
    responses : the measured response by actuator. ``probed_here`` : actuators
        of whose response the service says that its own probe wrote it.
    tries : settings that were tried; of each that was measured a window, in the same order.
    former : samples of earlier measurements of the step, as far as they still count.
    """

    checked: CheckedSite
    typed: TypedValues
    windows: tuple[Window, ...] = ()
    rights: tuple[Right, ...] = ()
    machine: Machine | None = None
    state: str = ""
    blocks: tuple[BlockStatus, ...] = ()
    responses: Mapping[str, Response] = field(default_factory=dict)
    probed_here: frozenset[str] = frozenset()
    tries: tuple[Try, ...] = ()
    former: tuple[Sample, ...] = ()

    @property
    def site(self) -> Site:
        """The site."""
        return self.checked.site

    @property
    def window(self) -> Window:
        """The window that a step of one window looks at.

        Raises
        ------
        RefusedError
            There is none.
        """
        if not self.windows:
            raise RefusedError(
                "no record: name a window of one (on the console: --run RUN_DIR@FROM..TO)"
            )
        return self.windows[-1]
