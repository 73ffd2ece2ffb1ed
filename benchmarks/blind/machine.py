"""From a declaration to one true machine, its start, and its record."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.blind.plant import Array, Now, Plant, places, radius_now, span
from benchmarks.blind.run import ROW_S, TICKS, Memory, run

TOLERANCE = {
    "EA": 0.02,
    "eta": 0.2,
    "density": 0.01,
    "thickness": 0.005,
    "wound_in": 0.01,
    "idlers": 0.02,
    "friction": 0.05,
    "inertia": 0.01,
    "roll": 2e-4,
    "radius": 5e-5,
    "draw": 1e-5,
    "gain": 0.001,
    "zero_N": 0.1,
    "corner": 0.03,
    "loop": 0.005,
    "drive": 0.005,
}
"""Two standard deviations of what is declared, as shares; where a unit stands, in it."""
SETTLE_ROWS = 3000
RING_TICKS = 512


class Scatter:
    """Draws numbers about those declared; ``size`` 0 gives these."""

    def __init__(self, rng: np.random.Generator, size: float = 1.0) -> None:
        self._rng, self._size = rng, size

    def off(self, kind: str) -> float:
        """Return a normal draw of half the tolerance, no further than the tolerance."""
        drawn = float(np.clip(self._rng.normal(0.0, 0.5), -1.0, 1.0))
        return self._size * TOLERANCE[kind] * drawn

    def near(self, value: float, kind: str) -> float:
        """Return ``value`` times 1 and a draw."""
        return value * (1.0 + self.off(kind))


def machine(line: Mapping[str, Any], s: Scatter) -> Plant:
    """Return the machine that a declaration tells of, without effects."""
    rollers, web, control = line["rollers"], line["web"], line["control"]
    names = [r["name"] for r in rollers]
    n, last = len(rollers), len(rollers) - 1
    kinds = {"roll": "roll", "driven": "radius", "idler": ""}
    radius = np.array([_near(s, r["radius_m"], kinds[r["kind"]]) for r in rollers])
    thickness = s.near(web["thickness_m"], "thickness")
    growth = np.zeros(n)
    growth[0], growth[last] = -thickness / (2.0 * math.pi), thickness / (2.0 * math.pi)
    idlers = 1.0 + s.off("idlers")
    modulus = s.near(web["EA_N"], "EA")
    cells = [row for row in line["sensors"] if "low_pass_Hz" in row]
    loops = {row["acts_on"]: at for at, row in enumerate(control["tension_pi"])}
    drives = control["drives"]
    driven = np.array([names.index(row["roller"]) for row in drives])
    density = s.near(web["density_kg_m3"], "density")
    strain = s.near(web["wound_in_tension_N"], "wound_in") / modulus
    corner = 1.0 + s.off("corner")  # of one make
    d, c = len(drives), len(cells)
    core = line["initial_radii_m"]["core"]
    return Plant(
        x=np.array([r["center_x_m"] for r in rollers]),
        y=np.array([r["center_y_m"] for r in rollers]),
        sense=np.array([1.0 if r["rotation"] == "ccw" else -1.0 for r in rollers]),
        radius=radius,
        growth=growth,
        inertia=np.array(
            [
                r["inertia_kg_m2"] * idlers
                if r["kind"] == "idler"
                else s.near(r["inertia_kg_m2"], "inertia")
                for r in rollers
            ]
        ),
        drag=np.array([s.near(r["friction_constant_N_m"], "friction") for r in rollers]),
        viscous=np.array([r["friction_viscous_N_m_s"] for r in rollers]),
        off=np.zeros(n),
        off_angle=np.zeros(n),
        heavy=np.zeros(n),
        heavy_angle=np.zeros(n),
        shape=np.zeros((3, 2)),
        slip=np.zeros(n),
        slip_above=np.zeros(n),
        web=np.array(
            [
                modulus,
                s.near(web["kelvin_voigt_eta_s"], "eta"),
                strain,
                density * web["width_m"],
                core,
                0.0,
                1.0,
            ]
        ),
        drive_body=driven,
        drive_inertia=np.array([rollers[k]["inertia_kg_m2"] for k in driven]),
        drive_gain=np.array([s.near(row["K_ref_rad_s"], "drive") for row in drives]),
        drive_zeta=np.array([s.near(row["zeta"], "drive") for row in drives]),
        drive_draw=np.array(
            [
                control["pull_roll_draw"] + s.off("draw")
                if "draw" in row["speed_reference"]
                else 0
                for row in drives
            ]
        ),
        drive_loop=np.array([loops.get(row["roller"], -1) for row in drives]),
        drive_ratio=np.array([rollers[k]["radius_m"] for k in driven]) / radius[driven],
        drive_delay=np.zeros(d, dtype=np.int64),
        drive_slew=np.zeros(d),
        drive_ramp=np.zeros(d),
        ripple=np.zeros((d, 3)),
        shaft=np.zeros((d, 4)),
        cell_body=np.array([names.index(row["roller"]) for row in cells]),
        cell_Hz=np.array([row["low_pass_Hz"] * corner for row in cells]),
        cell_gain=np.array([s.near(1.0, "gain") for _ in cells]),
        cell_zero=np.array([s.off("zero_N") for _ in cells]),
        cell_ring_Hz=np.zeros(c),
        cell_ring_damping=np.zeros(c),
        hum=np.zeros((c, 3)),
        loop_cell=np.array(
            [[row["roller"] for row in cells].index(t["load_cell"]) for t in control["tension_pi"]]
        ),
        loop_gain=np.array([s.near(t["gain_m_s_per_N"], "loop") for t in control["tension_pi"]]),
        loop_corner=np.array([s.near(t["corner_rad_s"], "loop") for t in control["tension_pi"]]),
        loop_sign=np.array(
            [-1.0 if t["acts_on"] == names[0] else 1.0 for t in control["tension_pi"]]
        ),
        axle=np.zeros(7),
        seam=np.array([-1.0, 0.0, 0.0]),
        change=np.zeros((0, 6)),
        play_N=np.zeros(1),
        freeze=np.zeros(2),
        pulse=np.zeros(n),
        shake=np.array([-9.0, 0.0, 0.0, 1.0]),
    )


def _near(s: Scatter, value: float, kind: str) -> float:
    return s.near(value, kind) if kind else value


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Told:
    """References: line speed m/s (rows + 1,), linear between rows, and tension N (rows,)."""

    speed_m_s: Array
    tension_N: Array


def start(p: Plant, line: Mapping[str, Any], speed: float, tension: float, angles: Array) -> Any:
    """Return scratch, state and memory near rest at this speed and tension."""
    n, c, d = p.x.size, p.cell_body.size, p.drive_body.size
    w = places(n, c, d)
    y = np.zeros(w.size)
    y[:n] = angles
    y[w.omega : w.omega + n] = speed / p.radius
    now = Now(
        drag=np.zeros(n),
        warm=np.zeros(n - 1),
        torque=np.zeros(d),
        phi=np.radians([row["direction_deg"] for row in line["spans"]]),
        fixed=np.zeros((n - 1, 8)),
        moves=np.ones(n - 1, dtype=np.int64),
        lifts=np.zeros(n),
        pull=np.full(n - 1, tension),
        zero=np.array([angles[0], angles[-1]]),
        slopes=np.zeros((4, w.size)),
        trial=np.zeros(w.size),
    )
    free = (p.off != 0.0) | (p.growth != 0.0)
    for i in range(n - 1):
        span(p, now, y, i, w)
        now.moves[i] = int(free[i] or free[i + 1])
    pulls = resting_pulls(p, speed, tension)
    strain = pulls / p.web[0]
    y[w.natural : w.natural + n - 1] = now.fixed[:, 0] / (1.0 + strain)
    y[w.crept : w.crept + n - 1] = strain * y[w.natural : w.natural + n - 1]
    y[w.cell : w.cell + c] = tension
    y[w.mount : w.mount + 2 * c : 2] = tension
    y[w.passed] = -1e9
    load = (p.drag + p.viscous * speed / p.radius) - p.radius * np.diff(
        pulls, prepend=0.0, append=0.0
    )
    if p.axle[0] != 0.0:
        y[w.axle] = pulls[0] / (p.axle[0] * (2.0 * math.pi * p.axle[1]) ** 2)
        y[w.natural] -= y[w.axle] / (1.0 + strain[0])
    memory = Memory(
        integral=np.zeros(d),
        reference=np.full(d, speed),
        ramped=np.zeros(d),
        past=np.zeros((d, RING_TICKS)),
        error=np.zeros(p.loop_cell.size),
        correction=np.zeros(p.loop_cell.size),
        words=np.full(c, tension),
        stuck=np.full(c, tension),
    )
    for at, k in enumerate(p.drive_body):
        inertia = p.drive_inertia[at]
        if p.growth[k] != 0.0:
            inertia += 0.5 * math.pi * p.web[3] * (radius_now(p, now, y, k) ** 4 - p.web[4] ** 4)
        gain = p.drive_gain[at]
        memory.integral[at] = load[k] / (inertia * gain**2 / (4.0 * p.drive_zeta[at] ** 2))
        y[w.motor + at] = speed / p.radius[k]
        if p.shaft[at, 1] != 0.0:
            y[w.twist + at] = load[k] / p.shaft[at, 1]
            y[w.twist + at] += math.copysign(0.5 * p.shaft[at, 3], load[k])
    return now, y, memory


def resting_pulls(p: Plant, speed: float, tension: float) -> Array:
    """Return about the tensions at rest: drag of idlers adds up, the loops' cells hold theirs.

    Between S-wrap and pull roll as much unstretched web passes at either end: (1 + e) / v is the
    same. What a start is off there takes half a minute to pass.
    """
    rise = (p.drag + p.viscous * speed / p.radius) / p.radius
    rise[p.drive_body] = 0.0
    total = np.cumsum(rise)[:-1]
    given = speed * (1.0 + p.drive_draw) / p.drive_ratio
    given *= 1.0 - p.slip[p.drive_body] * np.maximum(0.0, given - p.slip_above[p.drive_body])
    lead, follower, pull_roll = (int(k) for k in p.drive_body[1:4])
    pull = np.empty(total.size)
    for zone, cell in zip((slice(lead), slice(pull_roll, None)), p.loop_cell, strict=True):
        k = p.cell_body[cell]
        held = (tension - p.cell_zero[cell]) / p.cell_gain[cell]
        pull[zone] = held + total[zone] - total[k] + 0.5 * rise[k]
    before = 1.0 + pull[lead - 1] / p.web[0]
    pull[lead] = p.web[0] * (before * given[2] / given[1] - 1.0)
    end = p.web[0] * (before * given[3] / given[1] - 1.0)
    pull[follower:pull_roll] = end + total[follower:pull_roll] - total[pull_roll - 1]
    return pull


def simulate(
    p: Plant,
    line: Mapping[str, Any],
    told: Told,
    angles: Array,
    seed: int = 0,
    *,
    noise: bool = True,
    settle: int = SETTLE_ROWS,
) -> dict[str, Array]:
    """Return the channels of one record; without noise all words are exact."""
    rows = told.tension_N.size
    c, d, n = p.cell_body.size, p.drive_body.size, p.x.size
    rng = np.random.default_rng(seed)
    cells = [row for row in line["sensors"] if "low_pass_Hz" in row]
    speeds = [row for row in line["sensors"] if "noise_sd_rad_s" in row]
    size = 1.0 if noise else 0.0
    cell_noise = size * cells[0]["noise_sd_N"] * rng.standard_normal((rows + settle, c))
    sd = size * speeds[0]["noise_sd_rad_s"]
    speed_noise = sd * rng.standard_normal((rows, d))
    loop_noise = sd * rng.standard_normal(((rows + settle) * TICKS, d))
    steps = size * np.array([cells[0]["lsb_N"], speeds[0]["lsb_rad_s"]])
    now, y, memory = start(p, line, told.speed_m_s[0], told.tension_N[0], angles)
    out = np.empty((rows, c + d + n + 1))
    run(
        p,
        now,
        y,
        memory,
        told.speed_m_s,
        told.tension_N,
        settle,
        cell_noise,
        speed_noise,
        loop_noise,
        steps,
        out,
    )
    names = [r["name"] for r in line["rollers"]]
    driven = [names[k] for k in p.drive_body]
    found: dict[str, Array] = {"time_s": np.arange(rows, dtype=np.float64) * ROW_S}
    for row in line["sensors"]:
        name, roller = row["channel"], row["roller"]
        if "low_pass_Hz" in row:
            found[name] = out[:, [r["roller"] for r in cells].index(roller)]
        elif "noise_sd_rad_s" in row:
            found[name] = out[:, c + driven.index(roller)] * row.get("scale_radius_m", 1.0)
        elif "lsb_rad" in row:
            angle = out[:, c + d + names.index(roller)]
            found[name] = _words(angle - angle[0], size * row["lsb_rad"])
        else:
            found[name] = _words(out[:, -1], size * row["lsb_m"])
    found["tension_ref_N"] = told.tension_N
    found["line_speed_ref_m_s"] = told.speed_m_s[:-1]
    found["aff_correction_m_s"] = np.zeros(rows)
    found["start_rad"] = out[0, c + d : c + d + n].copy()
    return found


def _words(values: Array, step: float) -> Array:
    return values if step == 0.0 else step * np.floor(values / step + 0.5)
