"""The place in the cycle where a law works: the site's controller, or a probe before it."""

from __future__ import annotations

from math import nan

from aff_runtime.base.probe_columns import PROGRESS, STAGE
from aff_runtime.base.signals import ActuatorStep, Permission, Snapshot
from aff_runtime.core.controller import Controller
from aff_runtime.core.probe.probe import Probe

BRIDGED_S = 0.1
"""A probe goes on through gaps of its permission that are no longer."""
PROBE_COLUMNS = (STAGE, PROGRESS)


class LawSlot:
    """Steps a controller, and a probe in its place while there is one.

    Columns of telemetry change with the orders, the cycle's do not; so the cycle learns of no
    columns, and its ``loop.ports.OutsidePort`` asks for ``law_telemetry`` instead.

    Parameters
    ----------
    controller : the law of the site file.
    adopt_from : the law before it; its weights and angles are taken over in the first step.
    probe : measures the response; the controller follows the angles meanwhile and adapts nothing.

    Attributes
    ----------
    is_stepping : the cycle has stepped it, so what is recorded from now on are its columns.
    """

    __slots__ = (
        "_adopt_from",
        "_was_permitted",
        "_withheld_s",
        "controller",
        "is_stepping",
        "probe",
    )

    def __init__(
        self,
        controller: Controller,
        *,
        adopt_from: Controller | None = None,
        probe: Probe | None = None,
    ) -> None:
        self.controller = controller
        self.probe = probe
        self.is_stepping = False
        self._adopt_from = adopt_from
        self._withheld_s = 0.0
        self._was_permitted = False

    def step(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        """Advance by ``dt_s``; see ``base.ports.Law``."""
        self.is_stepping = True
        if self._adopt_from is not None:
            self.controller.adopt(self._adopt_from)
            self._adopt_from = None
        if self.probe is None:
            return self.controller.step(snapshot, dt_s, permission)
        not_adapting = Permission(
            adapt=False, applied_ratio=permission.applied_ratio, limit_ratio=permission.limit_ratio
        )
        self.controller.step(snapshot, dt_s, not_adapting)
        return self.probe.step(snapshot, dt_s, self._bridged(permission, dt_s))

    def _bridged(self, permission: Permission, dt_s: float) -> Permission:
        """Return ``permission`` without its short gaps: one late reply is no end of a probe.

        The guard still decides what goes out, and a sample without a reading is not fitted.
        """
        self._withheld_s = 0.0 if permission.adapt else self._withheld_s + dt_s
        self._was_permitted = permission.adapt or self._was_permitted
        if permission.adapt or not self._was_permitted or self._withheld_s > BRIDGED_S:
            return permission
        return Permission(
            adapt=True, applied_ratio=permission.applied_ratio, limit_ratio=permission.limit_ratio
        )

    def law_telemetry(self) -> tuple[float, ...]:
        """Return the controller's numbers, and stage and progress of a probe (NaN without one)."""
        probe = (nan, nan) if self.probe is None else self.probe.telemetry()
        return (*self.controller.telemetry(), *probe)

    def law_telemetry_names(self) -> tuple[str, ...]:
        """Return their column names."""
        return (*self.controller.telemetry_names(), *PROBE_COLUMNS)

    def telemetry(self) -> tuple[float, ...]:
        """Return nothing: the cycle's columns are fixed, a law's are not."""
        return ()

    def telemetry_names(self) -> tuple[str, ...]:
        """Return nothing."""
        return ()
