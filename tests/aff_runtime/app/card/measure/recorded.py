"""Records and evidence that are made up column by column, so that every figure has a formula."""

from dataclasses import replace

import numpy as np

from aff_runtime.app.card.evidence import CheckedSite, Evidence
from aff_runtime.app.card.typed_values import TypedValues, typed
from aff_runtime.app.report.comparison.window import load_window, window_of
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.signals import State
from aff_runtime.config.facts import facts_of
from aff_runtime.config.loader import load_site
from aff_runtime.loop.record import record_columns
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
from tests.aff_runtime.app.fake_plc import READY_STATUS
from tests.aff_runtime.telemetry.heads import head_of
from tests.parameter_records import CONFIG

SITE_FILE = CONFIG / "euclid_blocks.yaml"
SITE = load_site(SITE_FILE)
CHANNELS = tuple(SITE.gateway.read.channels)
OUTPUTS = tuple(f"{name}_m_s" for name in SITE.actuators)
CYCLE_S = 0.005
RADIUS_M, FOLLOWER_M, SPEED_M_S = 0.2, 0.15367, 1.0
SMALL_M = 0.15
"""Radius of a roll that turns more than twenty times in 20 s."""


def steady(seconds):
    """Return the columns of a line that runs, without noise or ripple, in shadow."""
    count = round(seconds / CYCLE_S)
    time_s = np.arange(count) * CYCLE_S
    found = {name: np.zeros(count) for name in record_columns(CHANNELS, OUTPUTS, ())}
    found |= {
        "time_s": time_s,
        "tick": np.arange(count, dtype=float),
        "state": np.full(count, float(State.SHADOW)),
        "fresh": np.ones(count),
        "periods_count": np.ones(count),
        "plc_heartbeat": np.arange(count) % 65536.0,
        "roll_id": np.full(count, 4.0),
        "wake_us": np.full(count, 50.0),
        "unwind_tension_N": np.full(count, 88.0),
        "tension_ref_N": np.full(count, 88.0),
        "pullroll_tension_N": np.full(count, 60.0),
        "line_speed_m_s": np.full(count, SPEED_M_S),
        "unwind_radius_m": np.full(count, RADIUS_M),
        "swrap_follower_speed_m_s": np.full(count, SPEED_M_S),
        "unwind_angle_rad": SPEED_M_S / RADIUS_M * time_s,
        "swrap_follower_angle_rad": SPEED_M_S / FOLLOWER_M * time_s,
    }
    return found


LOOKED_AT = 1000
"""Rows that are written at a time; the recorder takes some 50, and flushes after each."""
RIPPLE_N, LEFT_N, SETTLE_S, NOISE_N = 1.9, 0.15, 4.0, 0.25


def switched(seconds, arms, off_N=RIPPLE_N, left_N=LEFT_N):
    """Return the columns of a follower off centre, and its true part.

    The correction is on within the spans ``arms``; from the begin of one on the follower's first
    order goes from ``off_N`` to ``left_N``. The true part is time, tension of the pull roll
    without noise, and the follower's angle (rows, 3).
    """
    found = steady(seconds)
    time_s, angle = found["time_s"], found["swrap_follower_angle_rad"]
    size_N, on = np.full(time_s.size, off_N), np.zeros(time_s.size, dtype=bool)
    for from_s, to_s in arms:
        inside = (time_s >= from_s) & (time_s < to_s)
        falls = np.exp(-(time_s[inside] - from_s) / SETTLE_S)
        size_N[inside], on = left_N + (off_N - left_N) * falls, on | inside
    true_N = 60.0 + size_N * np.cos(angle + 0.3)
    rng = np.random.default_rng(2)
    radius_m = SMALL_M - 1e-5 * time_s
    found |= {
        "status": np.full(time_s.size, float(READY_STATUS)),
        "state": np.where(on, float(State.ACTIVE), float(State.READY)),
        "correction_swrap_follower_m_s": np.where(on, 0.0015 * np.cos(angle), 0.0),
        "pullroll_tension_N": true_N + NOISE_N * rng.standard_normal(time_s.size),
        "unwind_tension_N": 88.96 + NOISE_N * rng.standard_normal(time_s.size),
        "unwind_radius_m": radius_m,
        "unwind_angle_rad": np.cumsum(SPEED_M_S / radius_m) * CYCLE_S,
    }
    return found, np.column_stack([time_s, true_N, angle])


def recorded(folder, columns, events=(), rights=(), site_text=None, segment_s=20.0):
    """Write a run folder with these columns and (time_s, name) events; return its path."""
    text = SITE_FILE.read_text() if site_text is None else site_text
    made = RunFolder(
        folder,
        replace(head_of(RunMeta(rights=tuple(rights))), columns=tuple(columns)),
        RunContext(name="Euclid", site_text=text, segment_s=segment_s),
    )
    rows = np.column_stack(list(columns.values())).tolist()
    for first in range(0, len(rows), LOOKED_AT):
        made.add(rows[first : first + LOOKED_AT])
    made.finish(ring_overruns=0)
    with (made.path / "events.csv").open("a") as file:
        file.writelines(f"{time_s},,,{name},,\n" for time_s, name in events)
    return made.path


def window(path, from_s=0.0, to_s=float("inf")):
    """Return a window of a run."""
    return load_window(RunWindow(folder=path, from_s=from_s, to_s=to_s))


def in_memory(folder, columns, events=(), site_text=None):
    """Return a window of these columns; of a long one the folder holds the first second alone."""
    second = {name: values[: round(1.0 / CYCLE_S)] for name, values in columns.items()}
    path = recorded(folder, second, events, site_text=site_text)
    return window_of(replace(read_table(RunWindow(folder=path)), columns=columns))


def evidence(*windows, given=(), site=SITE, warnings=(), **more):
    """Return what a step looks at; ``given`` as on the command line."""
    return Evidence(
        checked=CheckedSite(site=site, warnings=tuple(warnings), limits=facts_of(site).limits),
        typed=TypedValues(typed(text) for text in given),
        windows=windows,
        **more,
    )


def figure(finding, part):
    """Return the one figure whose name holds ``part``."""
    (found,) = [one for one in finding.figures if part in one.name]
    return found
