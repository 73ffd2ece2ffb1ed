"""The law of the whole site: angles of all rolls, one law per actuator."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import ActuatorStep, Permission, Snapshot
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import Inputs, LawBuilder, LawSetup
from aff_runtime.core.laws.catalogue import LAWS
from aff_runtime.core.monitor import SLOWEST_RAD_S
from aff_runtime.core.order_status import OrderStatus, order_statuses
from aff_runtime.core.params import ActuatorParams, SiteParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.response import Response
from aff_runtime.core.shape.law import ShapeLaw


class RollPhases:
    """Angles of every roll of a site; a new roll id restarts those of rolls that it exchanges.

    ``spliced`` : every roll that a splice exchanges (``resets_on_splice``).
    """

    def __init__(self, site: SiteParams) -> None:
        """Resolve channel names; ConfigError names a roll whose channel does not exist."""
        index = {name: i for i, name in enumerate(site.channels)}
        try:
            self.by_name = {roll.name: RollPhase(roll, index) for roll in site.rolls}
        except KeyError as error:
            raise ConfigError(f"a roll reads channel {error}, which the gateway lacks") from error
        self.spliced = tuple(roll.name for roll in site.rolls if roll.resets_on_splice)
        self.roll_id: int | None = None

    def step(self, snapshot: Snapshot, dt_s: float) -> bool:
        """Advance all angles; True when a new roll was put in."""
        new_roll = False
        if snapshot.fresh:
            new_roll = self.roll_id is not None and snapshot.roll_id != self.roll_id
            self.roll_id = snapshot.roll_id
        if new_roll:
            for name in self.spliced:
                self.by_name[name].restart()
        for phase in self.by_name.values():
            phase.step(snapshot.values, dt_s, snapshot.fresh)
        return new_roll


class Controller:
    """Implements ``base.ports.Law`` for every actuator of the site file, in its order."""

    def __init__(
        self,
        site: SiteParams,
        responses: Mapping[str, Response],
        loops: Mapping[str, LoopModel] | None = None,
        laws: Mapping[str, LawBuilder] = LAWS,
    ) -> None:
        """Build all laws; ``responses`` by actuator, a missing one adapts nothing.

        ``loops`` are impulse responses of the same loops where they are known already: to find
        them takes some tenths of a second, which a running control cycle does not have.

        Raises
        ------
        ConfigError
            When an actuator names a channel or a roll that does not exist.
        """
        self._site = site
        self.responses = dict(responses)
        self._phases = RollPhases(site)
        index = {name: i for i, name in enumerate(site.channels)}
        for actuator in site.actuators:
            _check(actuator, index, self._phases.by_name)
        self._laws = [
            laws[a.law](
                LawSetup(
                    params=a,
                    phases=self._phases.by_name,
                    response=responses.get(a.name),
                    loop=(loops or {}).get(a.name),
                    cycle_s=site.cycle_s,
                )
            )
            for a in site.actuators
        ]
        self._signals = [index[a.signal] for a in site.actuators]
        self._references = [index[a.reference] if a.reference else -1 for a in site.actuators]
        self._line_speed = index.get(site.line_speed or "", -1)
        self._inputs = Inputs()
        self._names = self._columns()

    def step(
        self, snapshot: Snapshot, dt_s: float, permission: Permission
    ) -> tuple[ActuatorStep, ...]:
        """Advance by ``dt_s`` and return one step per actuator; see ``base.ports.Law``."""
        if self._phases.step(snapshot, dt_s):
            self.forget_rolls(self._phases.spliced)
        lost = [name for name, phase in self._phases.by_name.items() if phase.origin_lost]
        if lost:
            self.forget_rolls(lost)
        values = snapshot.values
        inputs = self._inputs
        inputs.dt_s = dt_s
        inputs.fresh = snapshot.fresh
        inputs.adapt = permission.adapt
        inputs.line_speed_m_s = values[self._line_speed] if self._line_speed >= 0 else math.nan
        steps: list[ActuatorStep] = []
        for i, law in enumerate(self._laws):
            reference = self._references[i]
            inputs.signal = values[self._signals[i]]
            inputs.reference = values[reference] if reference >= 0 else math.nan
            inputs.limit_ratio = permission.limit_ratio[i]
            inputs.applied_ratio = permission.applied_ratio[i]
            if permission.headroom:
                inputs.limit, inputs.slew_limit = permission.headroom[i]
            steps.append(law.step(inputs))
        return tuple(steps)

    def arming_objections(self) -> Mapping[str, tuple[str, ...]]:
        """Return, per actuator, why it may not arm at the present speed and radius."""
        named = zip(self._site.actuators, self._laws, strict=True)
        return {a.name: (*law.objections(), *self._of_rolls(a)) for a, law in named}

    def _of_rolls(self, actuator: ActuatorParams) -> list[str]:
        """Return what stands against the encoders of an actuator's rolls."""
        rolls = dict.fromkeys(block.roll for block in actuator.blocks)
        return [text for roll in rolls if (text := self._phases.by_name[roll].objection())]

    def roll_notes(self) -> tuple[str, ...]:
        """Return what is said of radii that are not taken, and of counts that start over early."""
        rolls = self._phases.by_name.values()
        notes = (note for roll in rolls for note in (roll.radius_note(), roll.wraps.note()))
        return tuple(note for note in notes if note)

    def ripple(self) -> tuple[tuple[float, float], ...]:
        """Return ripple before and now per actuator, in its signal's unit; NaN when unknown."""
        return tuple(law.ripple() for law in self._laws)

    def forget(self, actuator: int) -> None:
        """Drop what one actuator's law has learned, and its ripple before and now."""
        for roll in self._phases.by_name:
            self._laws[actuator].reset_roll(roll)

    def forget_rolls(self, rolls: Collection[str]) -> None:
        """Drop what every law has learned of some rolls: they were exchanged."""
        for law in self._laws:
            for roll in rolls:
                law.reset_roll(roll)

    def learned_rolls(self) -> frozenset[str]:
        """Return the rolls of which some law has learned something."""
        return frozenset(
            roll for law in self._laws for (roll, _), weight in law.weights().items() if weight
        )

    @property
    def line_speed_m_s(self) -> float:
        """Line speed of the last step, m/s; NaN when unknown."""
        return self._inputs.line_speed_m_s

    @property
    def slowest_omega_rad_s(self) -> float:
        """Speed of the slowest roll that turns, rad/s; 0 when none does."""
        turning = [abs(phase.omega_rad_s) for phase in self._phases.by_name.values()]
        return min((omega for omega in turning if omega > SLOWEST_RAD_S), default=0.0)

    @property
    def site(self) -> SiteParams:
        """The settings that this controller was built from."""
        return self._site

    @property
    def phases(self) -> RollPhases:
        """The rolls' angles and the present roll id."""
        return self._phases

    def shape_laws(self) -> Mapping[str, ShapeLaw]:
        """Return the shape laws by actuator; an actuator with another law is left out."""
        named = zip(self._site.actuators, self._laws, strict=True)
        return {a.name: law for a, law in named if isinstance(law, ShapeLaw)}

    def adopt(self, old: Controller) -> None:
        """Go on where another controller stands: angles and weights (bumpless retuning)."""
        for name, phase in old._phases.by_name.items():
            if name in self._phases.by_name:
                self._phases.by_name[name].follow(phase)
        self._phases.roll_id = old._phases.roll_id
        before = {a.name: law for a, law in zip(old._site.actuators, old._laws, strict=True)}
        for actuator, law in zip(self._site.actuators, self._laws, strict=True):
            if actuator.name in before:
                law.adopt(before[actuator.name])

    def telemetry(self) -> tuple[float, ...]:
        """Return angle, speed, source and quality per roll, then every law's numbers."""
        row: list[float] = []
        for phase in self._phases.by_name.values():
            row += (
                math.remainder(phase.theta_rad, math.tau),
                phase.omega_rad_s,
                float(phase.source),
                float(phase.quality),
            )
        for law in self._laws:
            row += law.telemetry()
        return tuple(row)

    def order_statuses(self) -> tuple[OrderStatus, ...]:
        """Return every order of every actuator as its law sees it now."""
        return order_statuses(dict(zip(self._names, self.telemetry(), strict=True)))

    def telemetry_names(self) -> tuple[str, ...]:
        """Return the columns of ``telemetry``, the same for the controller's life."""
        return self._names

    def _columns(self) -> tuple[str, ...]:
        columns = ("theta_rad", "omega_rad_s", "source", "quality")
        names = [f"{roll}.{column}" for roll in self._phases.by_name for column in columns]
        for actuator, law in zip(self._site.actuators, self._laws, strict=True):
            names += [f"{actuator.name}.{name}" for name in law.telemetry_names()]
        return tuple(names)


def _check(
    actuator: ActuatorParams, index: Mapping[str, int], rolls: Mapping[str, RollPhase]
) -> None:
    """Raise ConfigError when a channel or a roll that an actuator names does not exist."""
    for channel in (actuator.signal, actuator.reference):
        if channel is not None and channel not in index:
            raise ConfigError(f"actuator {actuator.name} reads {channel}, which the gateway lacks")
    for block in actuator.blocks:
        if block.roll not in rolls:
            raise ConfigError(f"actuator {actuator.name} names roll {block.roll}, not declared")
    drive = actuator.drive
    if drive is not None and drive.roll not in {block.roll for block in actuator.blocks}:
        raise ConfigError(f"actuator {actuator.name}: its drive turns {drive.roll}, no block does")
