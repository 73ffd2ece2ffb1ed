"""How far neighbouring idlers of one zone are apart in a record, by the channels that are in it.

python -m tests.sim_plant.refine.apart [--seed N]

The line of ``run_cases`` is simulated with the drawn eccentricity at each of its places, twice a
quarter turn apart, without noise; what differs from the sound line is the effect
alone. What a neighbour of any size and angle leaves of it, over the noise of each channel, is the
log-likelihood by which the true place is ahead of that neighbour where all else is known: the most
that any search can have. One minute of one core.
"""

import argparse
import itertools
import math
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from sim_plant.demo.loop.drawn import IDLER, drawn, write_files
from sim_plant.line.declared.declaration import LoadCell
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from tests.sim_plant.refine.run_cases import FAST_M_S, RAMP_S, SLOW_M_S, STEP_N

SERVICE = ("unwind_tension_N", "pullroll_tension_N", "line_speed_m_s", "swrap_follower_speed_m_s")
FURTHER = ("r3_tension_N", "rewind_tension_N", "unwind_speed_rad_s", "rewind_speed_rad_s")


def references(line):
    """Return speed and tension references of the record that is fitted, (n,) each."""
    step_s = line.sample_time_s
    time_s = np.arange(round((22.5 + RAMP_S + 30.0) / step_s)) * step_s
    speed = np.interp(time_s, [0.0, 22.5, 22.5 + RAMP_S], [FAST_M_S, FAST_M_S, SLOW_M_S])
    return speed, np.where(time_s < 43.5, line.operating_point.tension_N, STEP_N)


def simulated(line, effects):
    """Return the channels of the line with these effects."""
    speed, tension = references(line)
    run = make_line(
        line.model_copy(update={"effects": tuple(effects), "sensors": _without_noise(line)}),
        seed=1,
        speed_m_s=float(speed[0]),
        tension_N=float(tension[0]),
    )
    run.settle()
    return run.simulate(speed, tension)


def _without_noise(line):
    """Return the sensors of a line without noise and as good as without rounding."""
    exact = {"noise_sd_N": 0.0, "lsb_N": 1e-9, "noise_sd_rad_s": 0.0, "lsb_rad_s": 1e-9}
    return tuple(
        s.model_copy(update={k: v for k, v in exact.items() if hasattr(s, k)})
        for s in line.sensors
    )


def noise_of(sensor):
    """Return the standard deviation of one reading, rounding included."""
    if isinstance(sensor, LoadCell):
        return math.hypot(sensor.noise_sd_N, sensor.lsb_N / math.sqrt(12.0))
    scale = sensor.scale_radius_m or 1.0
    return scale * math.hypot(sensor.noise_sd_rad_s, sensor.lsb_rad_s / math.sqrt(12.0))


def ahead(true, other, noise, channels):
    """Return the log-likelihood by which ``true`` (cos) is ahead of ``other`` (cos, sin)."""
    wanted = np.concatenate([true[c] / noise[c] for c in channels])
    basis = np.column_stack(
        [np.concatenate([part[c] / noise[c] for c in channels]) for part in other]
    )
    left = wanted - basis @ np.linalg.lstsq(basis, wanted, rcond=None)[0]
    return 0.5 * float(left @ left)


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=2)
    given = parser.parse_args()
    with TemporaryDirectory() as folder:
        hidden = drawn(IDLER, given.seed)
        files = write_files(Path(folder), hidden)
        plant = load_declaration(files.plant)
    roll = [e for e in plant.effects if e.location == "unwind"]
    idler = next(e for e in plant.effects if e.location != "unwind")
    sensors = {s.channel: s for s in plant.sensors if s.channel in (*SERVICE, *FURTHER)}
    noise = {name: noise_of(sensor) for name, sensor in sensors.items()}
    base = simulated(plant, roll)
    places = {}
    for at in ("R1", "R2", "R3", "R4", "R5"):
        parts = []
        for angle in (0.0, 0.5 * math.pi):
            shape = {**idler.parameters, "angle_rad": angle}
            run = simulated(
                plant, [*roll, idler.model_copy(update={"location": at, "parameters": shape})]
            )
            parts.append({c: np.asarray(run[c]) - np.asarray(base[c]) for c in noise})
        places[at] = parts
    sets = {"the service's four": SERVICE}
    sets |= {f"and {name}": (*SERVICE, name) for name in FURTHER}
    sets["all of these"] = (*SERVICE, *FURTHER)
    names = list(places)
    pairs = list(itertools.pairwise(names))
    print(f"| channels | {' | '.join(f'{a} ahead of {b}' for a, b in pairs)} |")
    print("|---" * (len(pairs) + 1) + "|")
    for said, channels in sets.items():
        cells = [f"{ahead(places[a][0], places[b], noise, channels):.1f}" for a, b in pairs]
        print(f"| {said} | {' | '.join(cells)} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
