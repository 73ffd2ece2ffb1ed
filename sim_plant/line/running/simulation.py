"""A running line: settle it, step it sample by sample, or run a whole record."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array, LineArrays, copy_state
from sim_plant.line.arrays.build import Timing, build_arrays, start_state, timing_of
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.equations.kernel import log_frame, measure, run_frames, step_frame
from sim_plant.line.equations.log_layout import LogLayout, log_layout
from sim_plant.line.equations.scratch import make_work
from sim_plant.line.rest.start import start_at_rest
from sim_plant.line.running.channels import (
    MeasuredColumns,
    channel_value,
    channels_of,
    column_values,
)
from sim_plant.line.running.references import References, between_rows, held, until_next_row
from sim_plant.line.running.roll_change import change_rolls


class LineSimulation:
    """A line in closed loop, deterministic under its seed.

    Implements ``sim_plant.base.ports.SteppedLine``. ``arrays`` may be changed (effects) before
    ``settle``; ``seed=None`` runs without noise and with exact sensors.
    """

    def __init__(
        self,
        declaration: Declaration,
        *,
        sample_time_s: float | None = None,
        seed: int | None = 0,
        arrays: LineArrays | None = None,
        substeps: int = 1,
        line_speed_m_s: float | None = None,
        tension_N: float | None = None,
    ) -> None:
        self.declaration = declaration
        self.timing: Timing = timing_of(declaration, sample_time_s or declaration.sample_time_s)
        self.arrays = arrays or build_arrays(declaration, self.timing, substeps)
        point = declaration.operating_point
        self._speed = point.line_speed_m_s if line_speed_m_s is None else line_speed_m_s
        start_N = point.tension_N if tension_N is None else tension_N
        self._tension = np.full(self.arrays.loops.size, start_N)
        self._aff = np.zeros(self.arrays.drives.size)
        directions = [span.direction_deg for span in declaration.spans]
        self.layout, self.state = start_state(self.arrays, directions, self._speed, start_N)
        start_at_rest(self.arrays, self.layout, self.state, self._speed, start_N)
        self.work = make_work(self.arrays, self.layout, self.state)
        self._rng = None if seed is None else np.random.default_rng(seed)
        self._row = np.zeros(self.log.width)
        self.channels = channels_of(declaration, self.layout, self.arrays)
        driven: list[int] = self.arrays.drives["body"].tolist()
        names = enumerate(r.name for r in declaration.rollers)
        self._drive_of = {name: driven.index(body) for body, name in names if body in driven}
        self._theta0 = self._start_angles()
        self._observe()

    @property
    def sample_time_s(self) -> float:
        """Control sample time, s."""
        t = self.timing
        return t.frames_per_sample * t.ticks_per_frame * t.drive_tick_s

    @property
    def log(self) -> LogLayout:
        """Where each value sits in a log row."""
        p = self.arrays
        return log_layout(p.cells.size, p.drives.size, self.layout.n, p.carriages.size)

    def noise(self, frames: int) -> Array:
        """Return the noise of so many frames, as ``run_frames`` takes it; one row: none."""
        p = self.arrays
        p.timing["noisy"] = 0 if self._rng is None else 1
        width = p.cells.size + p.drives.size * (1 + self.timing.ticks_per_frame)
        if self._rng is None:
            return np.zeros((1, width))
        return self._rng.standard_normal((frames, width))

    @property
    def lengths_m(self) -> Array:
        """Length of every span now, m (n - 1,)."""
        found: Array = self.work.contacts[:, 0]
        return found

    def angles(self) -> Array:
        """Return the angle of every body, rad, sense of transport (view of the state)."""
        lay = self.layout
        return self.state.y[lay.theta : lay.theta + lay.n]

    def _start_angles(self) -> Array:
        """Return the angles of all bodies, then of the shafts that all encoders sit on, rad."""
        lay, driven = self.layout, self.arrays.drives["body"]
        angles = self.angles()
        twist = self.state.y[lay.twist : lay.twist + driven.size]
        return np.concatenate((angles, angles[driven] + twist))

    def settle(self, duration_s: float = 40.0, *, quiet: bool = True) -> None:
        """Bring the line to its steady state at the present references, then rewind its rolls.

        Runs before any splice and any change, without noise when ``quiet``; angles, radii, time
        and counters are put back afterwards.

        Raises
        ------
        PlantError
            When the line diverges.
        """
        for given in self.settling(duration_s, quiet=quiet):
            self._run(given)

    def settling(self, duration_s: float, *, quiet: bool) -> Iterator[References]:
        """Yield the runs that ``settle`` consists of, to be made one after the other."""
        lay, start = self.layout, copy_state(self.state)
        rng = self._rng
        if quiet:
            self._rng = None
        web = self.arrays.web
        splice = web.copy()
        web["splice_EA_ratio"] = web["splice_thickness_ratio"] = 1.0
        web["splice_step_m"] = 0.0
        changes = self.arrays.changes
        from_s = changes["from_s"].copy()
        changes["from_s"] = np.inf
        frame_s = self.timing.ticks_per_frame * self.timing.drive_tick_s
        for _ in range(4):
            frames = round(duration_s / 4 / frame_s)
            yield held(self._speed, self._tension, self._aff, frames)
            y = self.state.y
            y[lay.radius : lay.radius + 2] = start.y[lay.radius : lay.radius + 2]
        y = self.state.y
        y[lay.theta : lay.theta + lay.n] = start.y[lay.theta : lay.theta + lay.n]
        y[lay.flow : lay.flow + 2] = 0.0
        self.state.time_s[0] = 0.0
        self.state.counters[0] = 0
        self._rng = rng
        web[:] = splice
        changes["from_s"] = from_s
        self.channels = channels_of(self.declaration, lay, self.arrays)
        self._observe()
        self._theta0 = self._start_angles()

    def _observe(self) -> None:
        """Measure the present state and log it as the row that the next record starts with."""
        measure(self.arrays, self.layout, self.state, self.noise(1)[0])
        p, lay = self.arrays, self.layout
        log_frame(p, lay, self.state, self.work, self._row)

    def _run(self, given: References) -> Array:
        frames = given.line_speed_m_s.shape[0]
        out = np.empty((frames, self.log.width))
        noise = self.noise(frames)
        run_frames(self.arrays, self.layout, self.state, self.work, *given, noise, out)
        if not np.isfinite(self.state.y).all():
            raise PlantError("the simulated line diverged: a state is not finite")
        return out

    def step(self, inputs: Mapping[str, float]) -> Mapping[str, float]:
        """Advance one control sample; see ``SteppedLine.step``."""
        self._accept(inputs)
        for _ in range(self.timing.frames_per_sample):
            step_frame(
                self.arrays,
                self.layout,
                self.state,
                self.work,
                self._speed,
                self._speed,
                self._tension,
                self._aff,
                self.noise(1)[0],
                self._row,
            )
        return self.readings()

    def _accept(self, inputs: Mapping[str, float]) -> None:
        for name, value in inputs.items():
            if name == "line_speed_ref_m_s":
                self._speed = value
            elif name == "tension_ref_N":
                self._tension[:] = value
            elif name.startswith("travel_") and name.endswith("_m_s"):
                self._drive_travel(name[7:-4], value)
            elif name.startswith("aff_") and name.endswith("_m_s"):
                self._aff[self.drive_index(name[4:-4])] = value
            else:
                raise PlantError(f"input {name!r} is unknown to this line")

    def _drive_travel(self, name: str, speed_m_s: float) -> None:
        if name not in self.driven_travels:
            known = list(self.driven_travels)
            raise PlantError(f"no accumulator {name!r} with a drive; this line has {known}")
        self.arrays.carriages["speed_m_s"][self.declaration.carriage(name)] = speed_m_s

    def change_rolls(self) -> None:
        """Put full rolls on at both ends while the line runs; see ``RollChanger``."""
        change_rolls(self.arrays, self.layout, self.state)

    @property
    def web_left_m(self) -> float:
        """Length of web between the unwind roll's radius and its core, m; see ``WebSupply``."""
        web, radius_m = self.arrays.web[0], float(self.state.y[self.layout.radius])
        area_m2 = math.pi * (radius_m**2 - float(web["core_radius_m"]) ** 2)
        return area_m2 / float(web["thickness_m"])

    def drive_index(self, roller: str) -> int:
        """Return the drive number of ``roller``; PlantError when it is not driven."""
        drive = self._drive_of.get(roller)
        if drive is None:
            raise PlantError(f"roller {roller!r} has no drive in this line")
        return drive

    def torque_N_m(self, roller: str) -> float:
        """Return the torque that the speed loop of a roller holds; see ``TorqueReader``."""
        return float(self.state.torque_N_m[self.drive_index(roller)])

    @property
    def driven_travels(self) -> tuple[str, ...]:
        """Names of accumulators that have a drive of their own; see ``TravelDriver``."""
        gains = self.arrays.carriages["gain_rad_s"]
        carriages = self.declaration.carriages
        return tuple(c.name for c, gain in zip(carriages, gains, strict=True) if gain > 0.0)

    def readings(self) -> dict[str, float]:
        """Return the channels of the last sample: measured, and ``true_`` twins."""
        found = {"line_speed_ref_m_s": self._speed, "tension_ref_N": float(self._tension[0])}
        row, theta0, exact = self._row.tolist(), self._theta0.tolist(), self._rng is None
        for channel in self.channels:
            measured, true = channel_value(channel, row, theta0, exact)
            found[channel.name] = measured
            found["true_" + channel.name] = true
        return found

    def simulate(
        self,
        line_speed_m_s: Array,
        tension_N: Array,
        aff_m_s: Mapping[str, Array] | None = None,
        aff_N_m: Mapping[str, Array] | None = None,
        *,
        speed_holds: bool = False,
    ) -> dict[str, Array]:
        """Run a whole record under reference columns (samples,) and return channels (samples,).

        Row k is sampled before reference row k acts, as in a record; the line speed is linear
        between rows unless ``speed_holds``, the others hold. All frames go through the same
        compiled code as ``step``.
        ``aff_m_s`` and ``aff_N_m`` are corrections by driven roller: of the velocity reference,
        and of the torque.
        """
        repeat = self.timing.frames_per_sample
        given = self.references(
            line_speed_m_s, tension_N, aff_m_s, aff_N_m, speed_holds=speed_holds
        )
        first = self._row.copy()
        log = self._run(given)
        rows = np.vstack([first[None, :], log[repeat - 1 :: repeat]])
        self._row = rows[-1].copy()
        rows = rows[:-1]
        exact = self._rng is None
        found: dict[str, Array] = {}
        for channel in self.channels:
            measured, true = column_values(channel, rows, self._theta0, exact)
            found[channel.name] = measured
            found["true_" + channel.name] = true
        at = self.log
        found["span_tension_N"] = rows[:, at.tension_N : at.travel_m]
        found["body_angle_rad"] = rows[:, at.theta_rad : at.radius_m]
        return found

    def references(
        self,
        line_speed_m_s: Array,
        tension_N: Array,
        aff_m_s: Mapping[str, Array] | None = None,
        aff_N_m: Mapping[str, Array] | None = None,
        *,
        speed_holds: bool = False,
    ) -> References:
        """Return the references of a record frame by frame; see ``simulate``.

        Raises
        ------
        PlantError
            When a corrected roller has no drive.
        """
        drives, repeat = self.arrays.drives.size, self.timing.frames_per_sample
        corrections = np.zeros((line_speed_m_s.size, 2 * drives if aff_N_m else drives))
        for shift, given in ((0, aff_m_s or {}), (drives, aff_N_m or {})):
            for roller, values in given.items():
                corrections[:, shift + self.drive_index(roller)] = values
        between = until_next_row if speed_holds else between_rows
        tension = np.repeat(tension_N[:, None], self.arrays.loops.size, axis=1)
        return References(
            between(line_speed_m_s, repeat),
            np.repeat(tension, repeat, axis=0),
            np.repeat(corrections, repeat, axis=0),
        )

    def measured(self, names: Sequence[str]) -> MeasuredColumns:
        """Return how these channels are read from a log of the columns that they need."""
        return MeasuredColumns.of(
            [channel for name in names for channel in self.channels if channel.name == name],
            self._row,
            self._theta0,
            self._rng is None,
        )
