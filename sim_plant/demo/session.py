"""The script of the demo: start both, watch PI alone, probe, arm, run, stop."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.demo.pace import Pace, pace_of
from sim_plant.demo.processes import (
    COMMAND_S,
    PLANT,
    RUNTIME,
    Bench,
    Child,
    plant_status,
    runtime_command,
    runtime_status,
)
from sim_plant.demo.wires import wire_up
from sim_plant.line.record_file import read_columns

Progress = Callable[[str], None]
ATTEMPTS = 3
SETTLED_S = 6.0  # a pause this long before a window still shows in it
PROBE_S = 200.0  # the command itself gives up 150 s after its excitation: a fit takes its time
ARM_AGAIN = "arm again"  # said by an `arm` against which nothing stands any more
OF_A_PAUSE = ("PLC_STALE", "OVERRUN")  # alarms that a busy machine raises


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoPlan:
    """What to run and for how long, s."""

    line: Path
    site: Path
    out: Path
    line_speed_m_s: float
    wire: str = "modbus"
    seed: int = 7
    before_s: float = 16.0
    learn_s: float = 60.0
    after_s: float = 20.0
    relearn_s: float = 30.0
    limit_m_s: float | None = None  # of the unwind's correction; None: the site file's own


@dataclass(frozen=True, slots=True, kw_only=True)
class Session:
    """What came out of it."""

    plan: DemoPlan
    record: dict[str, Array]  # the plant's own record, true values included
    before_s: tuple[float, float]
    after_s: tuple[float, float]
    armed_at_s: float
    run_folder: Path
    probe_text: str
    exit_codes: dict[str, int]


def prepare(plan: DemoPlan) -> Bench:
    """Make a fresh output folder and a copy of the site file with a wire of our own.

    Raises
    ------
    PlantError
        The folder holds something else than an earlier demo.
    """
    folder = fresh_folder(plan.out)
    wired = wire_up(plan.wire, plan.site, folder, plan.limit_m_s)
    return Bench(folder=folder, site=wired.site, plant_arguments=wired.plant_arguments)


def fresh_folder(out: Path) -> Path:
    """Make the output folder anew and return it, whole.

    Raises
    ------
    PlantError
        The folder holds something else than an earlier demo.
    """
    folder = out.resolve()
    if folder.exists():
        is_ours = any((folder / log).exists() for log in ("plant.log", "runtime.log"))
        if any(folder.iterdir()) and not is_ours:
            raise PlantError(f"--out {out}: holds other files; name a folder of its own")
        shutil.rmtree(folder)
    (folder / "run").mkdir(parents=True, mode=0o700)
    return folder


def plant_command(bench: Bench, line: Path, line_speed_m_s: float, seed: int) -> list[str]:
    """Return the command that starts the plant of a line file."""
    return [
        *PLANT,
        "serve",
        str(line),
        *bench.plant_arguments,
        "--speed-m-s",
        f"{line_speed_m_s:.6f}",
        "--seed",
        str(seed),
        "--record",
        str(bench.plant_record),
        "--control",
        str(bench.plant_socket),
    ]


def service_command(bench: Bench) -> list[str]:
    """Return the command that starts the service."""
    return [
        *RUNTIME,
        "run",
        str(bench.site),
        "--runtime-dir",
        str(bench.runtime_dir),
        "--record-dir",
        str(bench.folder / "runs"),
    ]


def run_session(plan: DemoPlan, progress: Progress) -> Session:
    """Run the whole script; both processes are ended whatever happens."""
    bench = prepare(plan)
    progress("starting the plant (compiles its kernel the first time)")
    codes: dict[str, int] = {}
    command = plant_command(bench, plan.line, plan.line_speed_m_s, plan.seed)
    with Child("plant", command, bench.folder / "plant.log", ready="ready") as plant:
        with Child("runtime", service_command(bench), bench.folder / "runtime.log") as service:
            try:
                times, probe_text = _script(plan, bench, service, progress)
            finally:
                codes["runtime"] = service.stop()
        codes["plant"] = plant.stop()
    folders = sorted((bench.folder / "runs").glob("*/run.yaml"))
    return Session(
        plan=plan,
        record=read_columns(bench.plant_record),
        before_s=(times[0], times[1]),
        after_s=(times[3], times[4]),
        armed_at_s=times[2],
        run_folder=folders[-1].parent,
        probe_text=probe_text,
        exit_codes=codes,
    )


def _script(
    plan: DemoPlan, bench: Bench, service: Child, progress: Progress
) -> tuple[tuple[float, ...], str]:
    """Return plant times (before start, before end, armed, after start, after end) and probe."""
    await_state(bench, service, {"FAULT", "OFF", "READY"}, 30.0)
    progress(f"PI drives alone for {plan.before_s:.0f} s")
    start = plant_time(bench)
    _watch(bench, plan.before_s, progress)
    before_end = plant_time(bench)
    progress("probing the response of both actuators (a small excitation, line running)")
    probe_text = probe(bench, progress)
    armed, after_start, after_end = _correct(plan, bench, service, progress)
    progress("fading out and stopping")
    runtime_command(bench, "bypass")
    pause(0.5)
    return (start, before_end, armed, after_start, after_end), probe_text


def probe(bench: Bench, progress: Progress) -> str:
    """Return what the probe printed, begun again where the machine paused in it."""
    words = ("probe", str(bench.site))
    return _tried(bench, progress, words, OF_A_PAUSE, then="; probing again", patience_s=PROBE_S)


def arm(bench: Bench, progress: Progress) -> None:
    """Arm, again where what stood against it in that moment is over, as after a pause."""
    _tried(bench, progress, ("arm",), (ARM_AGAIN,))


def _tried(
    bench: Bench,
    progress: Progress,
    words: Sequence[str],
    passing: Sequence[str],
    *,
    then: str = "",
    patience_s: float = COMMAND_S,
) -> str:
    """Return what a command printed, given again where what it was refused for passes by itself.

    ``passing`` : of what such a refusal says one. ``then`` is told behind it.
    """
    attempt = 1
    while True:
        try:
            return runtime_command(bench, *words, patience_s=patience_s)
        except PlantError as error:
            if attempt == ATTEMPTS or not any(said in str(error) for said in passing):
                raise
            progress(f"{error}{then}")
        attempt += 1
        pause(1.0)


def _correct(
    plan: DemoPlan, bench: Bench, service: Child, progress: Progress
) -> tuple[float, float, float]:
    """Arm, learn and measure; return plant times (armed, after start, after end).

    A machine that is too busy lets the PLC's data go stale, the runtime fades to zero and waits
    for an operator. The demo is that operator: it says so, arms again and measures anew. A window
    in which the machine paused is measured again as well, but once only: the roll gets smaller
    and its order 1 nears the S-wrap's. The last window counts whatever happened in it.
    """
    arm(bench, progress)
    armed = plant_time(bench)
    learn_s, has_paused = plan.learn_s, False
    for attempt in range(ATTEMPTS):
        await_state(bench, service, {"ACTIVE"}, 10.0)
        progress(f"armed; learning for {learn_s:.0f} s")
        _watch(bench, learn_s - SETTLED_S, progress)
        pace = _pace(bench)
        _watch(bench, SETTLED_S, progress)
        after_start = plant_time(bench)
        progress(f"measuring for {plan.after_s:.0f} s")
        _watch(bench, plan.after_s, progress)
        after_end = plant_time(bench)
        status = runtime_status(bench)
        lost = _pace(bench).lost_since(pace)
        is_active = status.state == "ACTIVE"
        if attempt == ATTEMPTS - 1 or (is_active and (has_paused or not lost)):
            break
        if is_active:
            progress(f"the machine paused ({lost}); measuring again")
            learn_s, has_paused = 2.0 * SETTLED_S, True
            continue
        learn_s = plan.relearn_s
        progress(f"the runtime went to zero ({status.alarm}); arming again as an operator")
        arm(bench, progress)
    if status.giving_way:
        orders = ", ".join(status.giving_way)
        progress(f"a limit takes part of {orders}; LIMIT=0.3 (--limit-m-s) gives more room")
    return armed, after_start, after_end


def _pace(bench: Bench) -> Pace:
    return pace_of(runtime_status(bench), plant_status(bench))


def pause(seconds: float) -> None:
    """Wait on the monotonic clock."""
    clock = MonotonicClock()
    clock.sleep_until_ns(clock.now_ns() + int(seconds * 1e9))


def plant_time(bench: Bench) -> float:
    """Return the plant's own time, s."""
    return plant_status(bench).time_s


def await_state(bench: Bench, service: Child, states: set[str], patience_s: float) -> None:
    """Wait until the guard is in one of ``states``.

    Raises
    ------
    PlantError
        When it is not in time, or the service ends.
    """
    clock = MonotonicClock()
    end = clock.now_ns() + int(patience_s * 1e9)
    last = "no answer"
    while clock.now_ns() < end:
        if service.process.poll() is not None:
            raise PlantError(f"the runtime ended: {service.tail()}")
        try:
            status = runtime_status(bench)
            last = f"{status.state} ({status.blocked_by})"
            if status.state in states:
                return
        except PlantError as error:
            last = str(error)
        pause(0.3)
    raise PlantError(f"the runtime did not reach {sorted(states)}: {last}\n{service.tail()}")


def _watch(bench: Bench, seconds: float, progress: Progress) -> None:
    """Wait and show the true tension ripple every two seconds, from the plant itself."""
    clock = MonotonicClock()
    end = clock.now_ns() + int(seconds * 1e9)
    recent: list[tuple[float | None, float | None]] = []
    shown = clock.now_ns()
    while clock.now_ns() < end:
        pause(0.05)
        true = plant_status(bench).true_tension_N
        recent.append((true["true_unwind_tension_N"], true["true_pullroll_tension_N"]))
        if clock.now_ns() - shown > 2_000_000_000:
            shown = clock.now_ns()
            ripple = np.std(np.array(recent[-80:], dtype=np.float64), axis=0)
            left = (end - clock.now_ns()) * 1e-9
            progress(
                f"  unwind ripple {ripple[0]:6.3f} N rms   pull-roll ripple {ripple[1]:6.3f} N rms"
                f"   {left:4.0f} s left"
            )
