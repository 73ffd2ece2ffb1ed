"""A guard on a test bench: good readings by default, time that moves one tick at a time."""

from __future__ import annotations

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import (
    NO_ECHO,
    ActuatorStep,
    Outcome,
    Permission,
    Snapshot,
    State,
    Status,
)
from aff_runtime.safety.guard import Guard
from aff_runtime.safety.params import (
    ActuatorLimits,
    ChannelParams,
    FreshnessParams,
    GuardParams,
    RadiusParams,
)

PERIOD_NS = 5_000_000
PERIOD_S = 0.005
FADE_S = 0.150
TENSION, SPEED, RADIUS = 0, 1, 2
ALL_WELL = (
    Status.LINE_RUN
    | Status.AFF_ENABLE_REQUEST
    | Status.WEB_INTACT
    | Status.TENSION_VALID
    | Status.ESTOP_OK
)
PARAMS = GuardParams(
    actuators=(
        ActuatorLimits(name="unwind", limit=0.05, slew_limit=2.0, soft_start_s=0.2),
        ActuatorLimits(
            name="swrap", limit=0.02, slew_limit=1.0, soft_start_s=0.2, active_above_m_s=0.5
        ),
    ),
    fade_s=FADE_S,
    freshness=FreshnessParams(hold_after_s=0.015, fault_after_s=0.080),
    channels=(
        ChannelParams(
            channel=TENSION,
            name="unwind_tension_N",
            minimum=1.0,
            maximum=400.0,
            stuck_after_s=0.5,
            event=BY_NAME["TENSION_IMPLAUSIBLE"].code,
        ),
        ChannelParams(channel=SPEED, name="line_speed_m_s", minimum=-1.0, maximum=10.0),
    ),
    radii=(RadiusParams(channel=RADIUS, name="unwind_radius_m", tolerance_m=0.005),),
    line_speed_channel=SPEED,
    splice_settle_s=0.1,
)
STEP = ActuatorStep(value=0.01, peak_bound=0.012, slew_bound=0.1)


class Bench:
    """Runs a guard tick by tick and keeps what went out last."""

    def __init__(self, params: GuardParams = PARAMS) -> None:
        self.guard = Guard(params)
        self.now_ns = 1_000_000_000
        self.tick = 0
        self.tension_N = 90.0
        self.speed_m_s = 1.0
        self.radius_m = 0.2
        self.status = int(ALL_WELL)
        self.roll_id = 1
        self.tension_moves = True
        self.heartbeat_moves = True
        self.outcome = Outcome.OK
        self.heartbeat = 0
        self.echo_age = 1
        self.applied: tuple[float, ...] = ()
        self.moved_ns = self.now_ns
        self.overrun = False
        self.supervisor_alive = True
        self.steps: tuple[ActuatorStep, ...] | None = (STEP, STEP)
        self.out: tuple[float, ...] = (0.0, 0.0)
        self.bits = 0
        self.alarm = 0
        self.permission: Permission | None = None

    @property
    def state(self) -> State:
        return self.guard.state

    def snapshot(self) -> Snapshot:
        good = self.outcome is Outcome.OK
        fresh = good and self.heartbeat_moves
        if fresh:
            self.heartbeat += 1
            self.moved_ns = self.now_ns
        wiggle_N = 0.001 * (self.tick % 2) if self.tension_moves else 0.0
        nan = float("nan")
        return Snapshot(
            tick=self.tick,
            t_ns=self.now_ns,
            outcome=self.outcome,
            fresh=fresh,
            age_s=(self.now_ns - self.moved_ns) * 1e-9,
            plc_heartbeat=self.heartbeat,
            status=self.status if good else 0,
            roll_id=self.roll_id if good else 0,
            values=(self.tension_N + wiggle_N, self.speed_m_s, self.radius_m)
            if good
            else (nan, nan, nan),
            echo_age=self.echo_age if good else NO_ECHO,
            applied=self.applied if good else (),
        )

    def run(self, ticks: int = 1) -> None:
        for _ in range(ticks):
            self.now_ns += PERIOD_NS
            self.tick += 1
            self.permission = self.guard.observe(
                self.snapshot(), self.now_ns, self.overrun, self.supervisor_alive
            )
            self.out, self.bits, self.alarm = self.guard.limit(self.steps, PERIOD_S)

    def run_s(self, seconds: float) -> None:
        self.run(round(seconds / PERIOD_S))

    def arm(self) -> None:
        self.run()
        assert self.guard.arm() == ""
        self.run()

    def active(self) -> Bench:
        """Arm and run through the soft start."""
        self.arm()
        self.run_s(0.3)
        assert self.state is State.ACTIVE
        assert self.out == (STEP.value, STEP.value)
        self.guard.drain_events()
        return self

    def clear(self, bit: Status) -> None:
        self.status &= ~bit

    def set(self, bit: Status) -> None:
        self.status |= bit

    def codes(self) -> list[str]:
        by_code = {event.code: name for name, event in BY_NAME.items()}
        return [by_code[code] for _, code in self.guard.drain_events()]
