"""One row of a table: one law on one case, against PI alone and against a perfect roll."""

from __future__ import annotations

import functools
import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from aff_runtime.core.shape.law import ShapeLaw
from aff_runtime.core.shape.profile import ShapeProfile
from benchmarks.control import cases, film, scores
from benchmarks.control.laws import OWN, follower_law, oracle, rival, shape_law
from benchmarks.control.lockstep import LawBuilder, Recording, run

BenchRow = dict[str, Any]
Array = npt.NDArray[np.float64]
SAVED = f"{OWN}, saved profile"
ORACLE = "best fixed weights"
NO_SWRAP = f"{OWN}, no S-wrap"
PERFECT = "perfect roll"
BOTH = "follower and unwind"


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """What to run for one row."""

    section: str
    case: cases.Case
    law: str
    seed: int
    end_in: float = 2.5


def do(job: Job) -> BenchRow:
    """Run a row."""
    started = time.process_time()
    judged = {
        "constant": _constant,
        "mismatch": _constant,
        "ramp": _ramp,
        "roll": _roll,
        "follower": _follower,
        "transient": _transient,
        "film": _film,
    }[job.section](job)
    row: BenchRow = {
        "section": job.section,
        "case": job.case.name,
        "law": job.law,
        "seed": job.seed,
    }
    for key, value in judged.items():
        row[key] = [float(x) for x in value] if isinstance(value, np.ndarray) else value
    row["cpu_s"] = time.process_time() - started
    return row


def _profile(job: Job) -> Array:
    case = job.case
    if job.section == "film":
        return film.profile(case)
    if job.section == "ramp":
        return cases.ramp_profile()
    if job.section == "roll":
        count = math.ceil(cases.roll_duration_s(case, job.end_in) / case.cycle_s)
        return np.full(count, case.speed_m_s)
    if job.section == "follower":
        return np.full(round(70.0 / case.cycle_s), case.speed_m_s)
    found = case.profile()
    if case.note and case.cycle_s * found.size < 60.0:
        found = np.full(round(60.0 / case.cycle_s), case.speed_m_s)
    return found


def _run(job: Job, laws: dict[str, LawBuilder], profile: Array, **more: Any) -> Recording:
    case = job.case
    given = {"seed": job.seed, "on_s": cases.ON_S, **more}
    return run(case.line(), laws, profile, cycle_s=case.cycle_s, hidden=case.hidden, **given)


@functools.lru_cache(maxsize=2)
def _plain(section: str, case: cases.Case, seed: int, end_in: float) -> Recording:
    """Return the same row with the tension PI alone."""
    job = Job(section=section, case=case, law="", seed=seed, end_in=end_in)
    return _run(job, {}, _profile(job))


def _without(job: Job) -> Recording:
    return _plain(job.section, job.case, job.seed, job.end_in)


def _with(job: Job, profile: Array) -> Recording:
    """Return the record under the job's law; a perfect roll is a line without any fault."""
    case = job.case
    if job.law == PERFECT:
        round_line = replace(case, shape=None, lead_m=0.0, follower_m=0.0)
        return _run(replace(job, case=round_line), {}, profile)
    if job.law == OWN and job.section == "constant":
        return _learning(job, profile, job.seed)
    if job.law == SAVED:
        builder = shape_law(case.material, case.cycle_s, profile=_learned(job, profile, job.seed))
    elif job.law == ORACLE:
        builder = oracle(case.material, case.cycle_s, _learned(job, profile, None))
    elif job.law == NO_SWRAP:
        builder = shape_law(case.material, case.cycle_s, swrap=False)
    else:
        builder = rival(job.law, case.material, case.cycle_s)
    return _run(job, {"unwind": builder}, profile)


_LEARNED: dict[tuple[cases.Case, int | None], ShapeProfile] = {}


def _learning(job: Job, profile: Array, seed: int | None) -> Recording:
    """Run the law over a constant-speed case and keep what it knows at the end."""

    def keep(k: int, laws: Any) -> None:
        if k == profile.size - 1 and isinstance(laws["unwind"], ShapeLaw):
            _LEARNED[job.case, seed] = laws["unwind"].profile()

    for other in [key for key in _LEARNED if key[0] != job.case]:
        del _LEARNED[other]
    builder = shape_law(job.case.material, job.case.cycle_s)
    return _run(job, {"unwind": builder}, profile, seed=seed, watch=keep)


def _learned(job: Job, profile: Array, seed: int | None) -> ShapeProfile:
    """Return what the law knows at the end of the row; without noise when ``seed`` is None."""
    if (job.case, seed) not in _LEARNED:
        _learning(job, profile, seed)
    return _LEARNED[job.case, seed]


def _constant(job: Job) -> dict[str, Any]:
    profile = _profile(job)
    record, plain = _with(job, profile), _without(job)
    v = scores.score_constant(record, plain, cases.ON_S)
    return {
        "late_dB": v.late_dB,
        "middle_dB": v.middle_dB,
        "reference_dB": v.reference_dB,
        "settle_turns": v.settle_20_turns,
        "first_turns": v.first_20_turns,
        "turn_s": job.case.turn_s,
        "ripple": v.ripple_ratio,
        "peak": v.peak_ratio,
        "largest_m_s": float(np.abs(record.correction_m_s).max()),
    }


def _ramp(job: Job) -> dict[str, Any]:
    record, plain = _with(job, _profile(job)), _without(job)
    first, second = (scores.score_moving(record, plain, a, b, 2) for a, b in cases.RAMPS_S)
    return {
        "first_dB": first.mean_dB,
        "second_dB": second.mean_dB,
        "first_ripple": first.ripple_ratio,
        "second_ripple": second.ripple_ratio,
    }


def _roll(job: Job) -> dict[str, Any]:
    profile = _profile(job)
    record, plain = _with(job, profile), _without(job)
    end_s = profile.size * job.case.cycle_s
    v = scores.score_moving(record, plain, 30.0, end_s - 1.0, 10)
    starts_s = np.arange(0.0, end_s - 5.0, 5.0)
    parts = [scores.between(record, t, t + 5.0) for t in starts_s]
    trace = [scores.rms(record.tension_N[p]) / scores.rms(plain.tension_N[p]) for p in parts]
    radius_m = np.interp(starts_s + 2.5, record.time_s, record.radius_m)
    return {
        "mean_dB": v.mean_dB,
        "worst_dB": v.worst_dB,
        "ripple": v.ripple_ratio,
        "worst_5s": v.worst_5s,
        "worse_share": v.worse_share,
        "trace": np.array(trace),
        "radius_in": radius_m / 0.0254,
        "largest_m_s": float(np.abs(record.correction_m_s).max()),
    }


def _follower(job: Job) -> dict[str, Any]:
    material = job.case.material
    velocity = "velocity" in job.law
    follower = {
        "swrap_follower speed" if velocity else "swrap_follower": follower_law(
            material, velocity=velocity
        )
    }
    both = {"unwind": shape_law(material)} if "and unwind" in job.law else {}
    record, plain = _run(job, {**follower, **both}, _profile(job)), _without(job)
    part = scores.between(plain, 45.0, 70.0)

    def first(r: Recording) -> Array:
        seen = r.pullroll_N[part]
        found = scores.order_amplitudes(seen, r.follower_rad[part], r.unwind_rad[part], 0.005)
        return found[:1]

    def ratio(name: str) -> float:
        return scores.rms(getattr(record, name)[part]) / scores.rms(getattr(plain, name)[part])

    return {
        "pullroll_1x_dB": float(scores.ratio_dB(first(plain), first(record))[0]),
        "pullroll": ratio("pullroll_N"),
        "unwind": ratio("tension_N"),
        "follower_speed": ratio("follower_m_s"),
    }


def _film(job: Job) -> dict[str, Any]:
    return film.judge(job.case, _with(job, _profile(job)), _without(job))


def _transient(job: Job) -> dict[str, Any]:
    """Stop and start, emergency stop, splice: ripple before, during, and how fast it is back."""
    plan = cases.transient(job.case)
    plain = _run(job, {}, plan.speed_m_s, roll_id=plan.roll_id, enabled=plan.enabled)
    builder = rival(job.law, job.case.material, job.case.cycle_s)
    record = _run(
        job, {"unwind": builder}, plan.speed_m_s, roll_id=plan.roll_id, enabled=plan.enabled
    )
    return scores.score_transient(record, plain, plan.event_s, plan.back_s)
