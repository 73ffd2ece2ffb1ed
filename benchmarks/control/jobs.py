"""One row of a table: run PI alone and every law on one case, return plain numbers."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from aff_runtime.core.shape_law import ShapeLaw
from aff_runtime.core.shape_profile import ShapeProfile
from benchmarks.control import cases, judge
from benchmarks.control.laws import follower_law, oracle, rival, shape_law
from benchmarks.control.lockstep import Record, run
from benchmarks.control.nominal_loop import nominal_loop

Row = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """What to run for one row."""

    section: str
    case: cases.Case
    laws: tuple[str, ...]
    seed: int
    extras: bool = False
    end_in: float = 2.5


def do(job: Job) -> list[Row]:
    """Return one row per law."""
    return {
        "constant": _constant,
        "mismatch": _constant,
        "ramp": _ramp,
        "roll": _roll,
        "follower": _follower,
    }[job.section](job)


def _row(job: Job, law: str, **numbers: Any) -> Row:
    found: Row = {"section": job.section, "case": job.case.name, "law": law, "seed": job.seed}
    for key, value in numbers.items():
        found[key] = [float(x) for x in value] if isinstance(value, np.ndarray) else value
    return found


def _go(job: Job, builder: Any, profile: Any, seed: int | None = -1, **more: Any) -> Record:
    laws = {} if builder is None else {"unwind": builder}
    case = job.case
    return run(
        case.line(), laws, profile, seed=job.seed if seed == -1 else seed, on_s=cases.ON_S,
        cycle_s=case.cycle_s, hidden=case.hidden, **more,
    )  # fmt: skip


def _constant(job: Job) -> list[Row]:
    case = job.case
    nominal_loop(case.material, cycle_s=case.cycle_s)
    profile = case.profile()
    if case.note and case.cycle_s * profile.size < 60.0:
        profile = np.full(round(60.0 / case.cycle_s), case.speed_m_s)
    plain = _go(job, None, profile)
    rows = []
    learned: list[ShapeProfile] = []

    def keep(k: int, laws: Any) -> None:
        if k == profile.size - 1 and isinstance(laws["unwind"], ShapeLaw):
            learned.append(laws["unwind"].profile())

    builders = {law: rival(law, case.material, case.cycle_s) for law in job.laws}
    for law, builder in builders.items():
        watch = keep if law == "shape-KF" else None
        rows.append(_verdict(job, law, _go(job, builder, profile, watch=watch), plain))
    if job.extras and learned:
        warm = shape_law(case.material, case.cycle_s, profile=learned[0])
        rows.append(_verdict(job, "shape-KF, saved profile", _go(job, warm, profile), plain))
        learned.clear()
        quiet = shape_law(case.material, case.cycle_s)
        _go(job, quiet, profile, seed=None, watch=keep)
        best = oracle(case.material, case.cycle_s, learned[0])
        rows.append(_verdict(job, "oracle", _go(job, best, profile), plain))
    return rows


def _verdict(job: Job, law: str, record: Record, plain: Record) -> Row:
    v = judge.judge_constant(record, plain, cases.ON_S)
    return _row(
        job, law, late_dB=v.late_dB, middle_dB=v.middle_dB, reference_dB=v.reference_dB,
        settle_turns=v.settle_20_turns, ripple=v.ripple_ratio, peak=v.peak_ratio,
        largest_m_s=float(np.abs(record.correction_m_s).max()),
    )  # fmt: skip


def _ramp(job: Job) -> list[Row]:
    profile = cases.ramp_profile()
    case = job.case
    plain = _go(job, None, profile)
    perfect = replace(case, shape=None, lead_m=0.0, follower_m=0.0)
    rows = []
    records = {"perfect roll": _go(replace(job, case=perfect), None, profile)}
    for law in job.laws:
        records[law] = _go(job, rival(law, case.material), profile)
    for law, record in records.items():
        first, second = (judge.judge_moving(record, plain, a, b, 2) for a, b in cases.RAMPS_S)
        rows.append(
            _row(
                job, law, first_dB=first.mean_dB, second_dB=second.mean_dB,
                first_ripple=first.ripple_ratio, second_ripple=second.ripple_ratio,
            )
        )  # fmt: skip
    return rows


def _roll(job: Job) -> list[Row]:
    case = job.case
    end_s = cases.roll_duration_s(case, job.end_in)
    profile = np.full(math.ceil(end_s / case.cycle_s), case.speed_m_s)
    plain = _go(job, None, profile)
    rows = []
    builders = {law: rival(law, case.material) for law in job.laws}
    if job.extras:
        builders["shape-KF, no S-wrap"] = shape_law(case.material, swrap=False)
    for law, builder in builders.items():
        record = _go(job, builder, profile)
        v = judge.judge_moving(record, plain, 30.0, end_s - 1.0, 10)
        trace = [
            judge.rms(record.tension_N[part]) / judge.rms(plain.tension_N[part])
            for part in (
                judge.between(record, t, t + 5.0) for t in np.arange(0.0, end_s - 5.0, 5.0)
            )
        ]
        rows.append(
            _row(
                job, law, mean_dB=v.mean_dB, worst_dB=v.worst_dB, ripple=v.ripple_ratio,
                worst_5s=v.worst_5s, worse_share=v.worse_share, trace=np.array(trace),
                radius_in=np.interp(
                    np.arange(0.0, end_s - 5.0, 5.0) + 2.5, record.time_s, record.radius_m
                ) / 0.0254,
            )
        )  # fmt: skip
    return rows


def _follower(job: Job) -> list[Row]:
    case = job.case
    profile = np.full(round(70.0 / case.cycle_s), case.speed_m_s)
    plain = _go(job, None, profile)
    unwind = shape_law(case.material)
    choices: dict[str, Any] = {
        "follower, tension": {"swrap_follower": follower_law(case.material)},
        "follower and unwind": {
            "swrap_follower": follower_law(case.material), "unwind": unwind,
        },
        "follower, velocity": {
            "swrap_follower speed": follower_law(case.material, velocity=True)
        },
        "velocity and unwind": {
            "swrap_follower speed": follower_law(case.material, velocity=True), "unwind": unwind,
        },
    }  # fmt: skip
    part = judge.between(plain, 45.0, 70.0)
    rows = []
    for name, laws in choices.items():
        record = run(
            case.line(), laws, profile, seed=job.seed, on_s=cases.ON_S, hidden=case.hidden
        )
        rows.append(_row(job, name, **_zones(record, plain, part)))
    return rows


def _zones(record: Record, plain: Record, part: slice) -> dict[str, float]:
    def first(r: Record, signal: Any) -> float:
        return float(
            judge.order_amplitudes(signal[part], r.follower_rad[part], r.unwind_rad[part], 0.005)[
                0
            ]
        )

    return {
        "pullroll_1x_dB": float(
            judge.ratio_dB(
                np.array(first(plain, plain.pullroll_N)),
                np.array(first(record, record.pullroll_N)),
            )
        ),
        "pullroll": judge.rms(record.pullroll_N[part]) / judge.rms(plain.pullroll_N[part]),
        "unwind": judge.rms(record.tension_N[part]) / judge.rms(plain.tension_N[part]),
        "follower_speed": judge.rms(record.follower_m_s[part])
        / judge.rms(plain.follower_m_s[part]),
    }


def timing(orders: int = 16, ticks: int = 3000) -> Row:
    """Return p50 and p99 of one tick of the shape law, us, paced by nothing but itself."""
    from benchmarks.control.timing import tick_times_us

    times = tick_times_us(orders, ticks)
    return {
        "section": "timing", "case": f"{orders} orders and S-wrap 1x", "law": "shape-KF",
        "p50_us": float(np.percentile(times, 50)), "p99_us": float(np.percentile(times, 99)),
        "at": time.strftime("%Y-%m-%d"),
    }  # fmt: skip
