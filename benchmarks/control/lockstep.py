"""A law and a line in lockstep: no sockets, one sample of transport, the guard's limits."""

from __future__ import annotations

import copy
import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.core.controller import RollPhases
from aff_runtime.core.law import ActuatorLaw, Inputs
from aff_runtime.core.params import RollParams, SiteParams
from aff_runtime.core.phase import RollPhase
from benchmarks.control.lines import SPIKE_READINGS, Hidden, with_hidden
from sim_plant.line.arrays.build import cell_sensors
from sim_plant.line.declared.declaration import Declaration, Roller
from sim_plant.line.equations.kernel import log_frame, run_frames, step_frame
from sim_plant.line.equations.log_layout import LogLayout
from sim_plant.line.open import make_line
from sim_plant.line.running.simulation import LineSimulation

Array = npt.NDArray[np.float64]
CHANNELS = (
    "unwind_tension_N",
    "tension_ref_N",
    "line_speed_m_s",
    "unwind_radius_m",
    "pullroll_tension_N",
    "unwind_angle_rad",
    "swrap_follower_angle_rad",
    "swrap_follower_speed_m_s",
)
COUNT_RAD = math.tau / 4096
FASTEST_RAD_S = 400.0
SIGNAL_OF = {"unwind": 0, "swrap_follower": 4, "swrap_follower speed": 7}
SOFT_START_S = 0.3
LIMIT_M_S = 0.3
WORD_SPAN_N = 400.0
CHUNK = 4096
KEPT_LINES = 4
NEW_ROLL_RAD = 1.9  # by how much a new roll's shape lies at another angle of the encoder
LawBuilder = Callable[[Mapping[str, RollPhase], float], ActuatorLaw]


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """What a run leaves: one entry per control sample.

    ``tension_N`` and ``pullroll_N`` are the true means of the two spans at the cells, without
    filter and noise; ``correction_m_s`` is (actuators, samples), as applied.
    """

    time_s: Array
    tension_N: Array
    pullroll_N: Array
    follower_m_s: Array
    unwind_rad: Array
    follower_rad: Array
    radius_m: Array
    speed_m_s: Array
    correction_m_s: Array


class _Actuator:
    """A law, its way to the line, and the guard's envelope and limit around it."""

    def __init__(self, wanted: str, law: ActuatorLaw, delay: int) -> None:
        self.law = law
        self.signal = SIGNAL_OF[wanted]
        self.pipe = deque([0.0] * delay)
        self.inputs = Inputs(limit_ratio=1.0, applied_ratio=0.0)
        self.level = 0.0

    def step(self, values: Sequence[float], dt_s: float, enabled: bool) -> float:
        """Return the correction that acts during the coming sample."""
        given = self.inputs
        given.signal = values[self.signal]
        given.reference = values[1] if self.signal == 0 else math.nan
        given.line_speed_m_s = values[2]
        given.dt_s = dt_s
        given.limit = LIMIT_M_S
        given.fresh = True
        given.adapt = enabled
        wish = self.law.step(given)
        room = dt_s / SOFT_START_S
        self.level = min(1.0, self.level + room) if enabled else max(0.0, self.level - room)
        scale = min(1.0, LIMIT_M_S / wish.peak_bound) if wish.peak_bound > 0.0 else 1.0
        given.limit_ratio = scale
        given.applied_ratio = scale * self.level
        self.pipe.append(wish.value * given.applied_ratio)
        return self.pipe.popleft()


def rolls_of(declaration: Declaration) -> tuple[RollParams, ...]:
    """Return what the law knows of the angles of the unwind and of the S-wrap follower."""
    return (
        RollParams(
            name="unwind",
            angle="unwind_angle_rad",
            line_speed="line_speed_m_s",
            radius="unwind_radius_m",
            radius_min_m=0.04,
            radius_max_m=0.45,
            resets_on_splice=True,
            max_omega_rad_s=FASTEST_RAD_S,
        ),
        RollParams(
            name="swrap_follower",
            angle="swrap_follower_angle_rad",
            line_speed="line_speed_m_s",
            radius_m=_follower(declaration).radius_m,
            max_omega_rad_s=FASTEST_RAD_S,
        ),
    )


def _follower(declaration: Declaration) -> Roller:
    return declaration.rollers[declaration.body("swrap_follower")]


def run(
    declaration: Declaration,
    laws: Mapping[str, LawBuilder],
    speed_m_s: Array,
    *,
    seed: int | None,
    on_s: float,
    cycle_s: float = 0.005,
    hidden: Hidden | None = None,
    watch: Callable[[int, Mapping[str, ActuatorLaw]], None] | None = None,
    roll_id: npt.NDArray[np.int64] | None = None,
    enabled: npt.NDArray[np.bool_] | None = None,
) -> Recording:
    """Run the line over a speed profile (m/s per sample), the laws enabled from ``on_s``.

    Laws are named by the driven roller they correct (``SIGNAL_OF`` says what they read). The
    value of tick k acts from tick k + 1 on (one sample of transport), plus what ``hidden`` adds.
    """
    secret = hidden or Hidden()
    line = settled_line(with_hidden(declaration, secret), cycle_s, float(speed_m_s[0]))
    if not laws:
        return _alone(line, speed_m_s, seed, cycle_s, secret)
    rolls = rolls_of(declaration)
    site = SiteParams(cycle_s=cycle_s, channels=CHANNELS, rolls=rolls, actuators=())
    phases = RollPhases(site)
    delay = 1 + round(secret.delay_s / cycle_s)
    actuators = {
        name: _Actuator(name, build(phases.by_name, cycle_s), delay)
        for name, build in laws.items()
    }
    drives = {name: line.drive_index(name.split()[0]) for name in laws}
    count = speed_m_s.size
    cells, d = line.arrays.cells.size, line.arrays.drives.size
    log = np.zeros((count, line.log.width))
    corrections = np.zeros((max(1, len(laws)), count))
    columns = LineColumns(line.declaration, line.log, secret)
    state, arrays, lay, work = line.state, line.arrays, line.layout, line.work
    aff = np.zeros(d)
    rng = np.random.default_rng(seed)
    arrays.timing["noisy"] = 0 if seed is None else 1
    width = cells + d * (1 + line.timing.ticks_per_frame)
    theta0 = line.angles().copy()
    tension_ref = np.full(arrays.loops.size, declaration.operating_point.tension_N)
    noise = rng.standard_normal((0, width))
    row = log[0]
    log_frame(arrays, lay, state, work, row)
    for k in range(count):
        values = columns.values(row, theta0, float(tension_ref[0]), k)
        if roll_id is not None and roll_id[k] > 1:
            values = (*values[:5], values[5] + NEW_ROLL_RAD * (int(roll_id[k]) - 1), *values[6:])
        on = k * cycle_s >= on_s if enabled is None else bool(enabled[k])
        snapshot = Snapshot(
            tick=k,
            t_ns=0,
            outcome=Outcome.OK,
            fresh=True,
            age_s=0.0,
            plc_heartbeat=k,
            status=255,
            roll_id=1 if roll_id is None else int(roll_id[k]),
            values=values,
        )
        if phases.step(snapshot, cycle_s):
            for actuator in actuators.values():
                for roll in phases.spliced:
                    actuator.law.reset_roll(roll)
        for i, (name, actuator) in enumerate(actuators.items()):
            aff[drives[name]] = corrections[i, k] = actuator.step(values, cycle_s, on)
        if watch is not None:
            watch(k, {name: a.law for name, a in actuators.items()})
        if k + 1 == count:
            break
        if k % CHUNK == 0:
            noise = (
                rng.standard_normal((CHUNK, width))
                if seed is not None
                else np.zeros((CHUNK, width))
            )
        row = log[k + 1]
        step_frame(
            arrays,
            lay,
            state,
            work,
            speed_m_s[k],
            speed_m_s[k + 1],
            tension_ref,
            aff,
            noise[k % CHUNK],
            row,
        )
    return columns.record(log, theta0, corrections, speed_m_s, cycle_s)


_SETTLED: dict[tuple[str, float, float], LineSimulation] = {}


def settled_line(declaration: Declaration, cycle_s: float, speed_m_s: float) -> LineSimulation:
    """Return a line at rest in its operating point; the laws of a row start from copies of it."""
    key = (declaration.model_dump_json(), cycle_s, speed_m_s)
    if key not in _SETTLED:
        if len(_SETTLED) >= KEPT_LINES:
            del _SETTLED[next(iter(_SETTLED))]
        line = make_line(declaration, seed=None, sample_time_s=cycle_s, speed_m_s=speed_m_s)
        line.settle()
        _SETTLED[key] = line
    return copy.deepcopy(_SETTLED[key])


def _alone(
    line: LineSimulation, speed_m_s: Array, seed: int | None, cycle_s: float, hidden: Hidden
) -> Recording:
    """Run the line without any law: the same frames in compiled chunks."""
    state, arrays, lay, work = line.state, line.arrays, line.layout, line.work
    cells, d, count = arrays.cells.size, arrays.drives.size, speed_m_s.size
    log = np.zeros((count, line.log.width))
    rng = np.random.default_rng(seed)
    arrays.timing["noisy"] = 0 if seed is None else 1
    width = cells + d * (1 + line.timing.ticks_per_frame)
    theta0 = line.angles().copy()
    log_frame(arrays, lay, state, work, log[0])
    tension_N = line.declaration.operating_point.tension_N
    for first in range(0, count - 1, CHUNK):
        frames = min(CHUNK, count - 1 - first)
        noise = rng.standard_normal((CHUNK, width)) if seed is not None else np.zeros((1, width))
        ends = np.lib.stride_tricks.sliding_window_view(speed_m_s[first : first + frames + 1], 2)
        run_frames(
            arrays,
            lay,
            state,
            work,
            np.ascontiguousarray(ends),
            np.full((frames, arrays.loops.size), tension_N),
            np.zeros((frames, d)),
            noise,
            log[first + 1 : first + 1 + frames],
        )
    columns = LineColumns(line.declaration, line.log, hidden)
    return columns.record(log, theta0, np.zeros((1, count)), speed_m_s, cycle_s)


class LineColumns:
    """Where a log row keeps what the gateway and the judge read."""

    def __init__(self, declaration: Declaration, log: LogLayout, hidden: Hidden) -> None:
        names = [r.name for r in declaration.rollers]
        channels = [s.channel for s in cell_sensors(declaration)]
        driven = [d.roller for d in declaration.control.drives]
        self.log = log
        self.tension = channels.index("unwind_tension_N")
        self.pullroll = channels.index("pullroll_tension_N")
        self.lead, self.follower = driven.index("swrap_lead"), driven.index("swrap_follower")
        self.follower_body = names.index("swrap_follower")
        self.swrap_m = _follower(declaration).radius_m
        self.hidden = hidden

    def values(
        self, row: Array, theta0: Array, tension_ref_N: float, reading: int = 0
    ) -> tuple[float, ...]:
        """Return the gateway's channels of one row, at the resolution of its words."""
        at, f = self.log, self.follower_body
        a, speed = at.theta_rad, at.measured_rad_s
        tension = float(row[at.measured_N + self.tension])
        if (reading + 1) % SPIKE_READINGS == 0:
            tension += self.hidden.spike_N
        if self.hidden.word_bits is not None:
            lsb = WORD_SPAN_N / 2**self.hidden.word_bits
            tension = lsb * math.floor(tension / lsb + 0.5)
        unwind = COUNT_RAD * math.floor((float(row[a]) - theta0[0]) / COUNT_RAD + 0.5)
        follower = COUNT_RAD * math.floor((float(row[a + f]) - theta0[f]) / COUNT_RAD + 0.5)
        radius = float(row[at.radius_m]) * self.hidden.radius_tag_ratio
        return (
            tension,
            tension_ref_N,
            float(row[speed + self.lead]) * self.swrap_m,
            2e-5 * math.floor(radius / 2e-5 + 0.5),
            float(row[at.measured_N + self.pullroll]),
            unwind,
            follower,
            float(row[speed + self.follower]) * self.swrap_m,
        )

    def record(
        self, log: Array, theta0: Array, corrections: Array, speed_m_s: Array, cycle_s: float
    ) -> Recording:
        """Return the run's true signals."""
        at, f = self.log, self.follower_body
        a = at.theta_rad
        return Recording(
            time_s=np.asarray(np.arange(len(log)) * cycle_s, dtype=np.float64),
            tension_N=log[:, at.mean_N + self.tension].copy(),
            pullroll_N=log[:, at.mean_N + self.pullroll].copy(),
            follower_m_s=log[:, at.true_rad_s + self.follower] * self.swrap_m,
            unwind_rad=log[:, a] - theta0[0],
            follower_rad=log[:, a + f] - theta0[f],
            radius_m=log[:, at.radius_m].copy(),
            speed_m_s=speed_m_s,
            correction_m_s=corrections,
        )
