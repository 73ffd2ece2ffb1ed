"""The script: record what is wrong, trace it, try and keep the block, record again."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import PlantError
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import RunWindow
from sim_plant.base.arrays import Array
from sim_plant.base.order_tracking import order_amplitudes
from sim_plant.demo.loop.correcting import Decision, correct
from sim_plant.demo.loop.drawn import Files, Hidden, angle_of, drawn, write_files
from sim_plant.demo.loop.judging import BlockOrder, Judgement, judged, new_orders
from sim_plant.demo.loop.recorder_kill import Loss, kill_recorder, loss_of
from sim_plant.demo.processes import (
    PLANT,
    Bench,
    Child,
    plant_status,
    runtime_command,
    runtime_status,
)
from sim_plant.demo.runtime_status import RuntimeStatus
from sim_plant.demo.session import (
    Progress,
    await_state,
    fresh_folder,
    pause,
    plant_command,
    plant_time,
    probe,
    service_command,
)
from sim_plant.line.record_file import read_columns
from sim_plant.servers.answers import PlantStatus
from sim_plant.servers.control_client import ask

FAST_M_S, SLOW_M_S = 0.85, 0.62
TENSION_N, STEP_N = 88.9644, 95.0
RAMP_S, RAMP_STEP_S = 3.0, 0.1
ALONE_S, LEARN_S, SLOW_S, STEP_S = 8.0, 22.0, 18.0, 12.0
WINDOW_S = 16.0
THINNEST_M, THIN_M = 0.125, 0.135
"""A roll is changed at the one radius; at the other before a window: no splice may be in it."""
SPLICE_S = 3.0
"""After the exchange: the splice has passed, and what it took back has armed itself."""
FIRST_S = 3.0
"""Of a run, left out of its window: what was adopted comes in."""
LOOK_S = 1.0
"""From one look at the PLC to the next; where it takes nothing, a command asks the service."""
ARM_ATTEMPTS, ARM_PATIENCE_S = 4, 8.0
NO_REPLY = "did not reply in time"
"""What the service says of a control process that the machine holds up."""
STRETCHES = 3
"""How often a stretch is recorded at most: one without a hole is what can be judged."""
REFINE_S = 270.0
"""Longest time for the trace; it then says what it lacks: nothing is guessed."""
RESTING = ("FAULT", "BYPASS", "READY", "OFF")


@dataclass(frozen=True, slots=True, kw_only=True)
class StoryPlan:
    """What to run; ``kills_recorder`` in the middle of what the trace reads."""

    out: Path
    effect: str
    seed: int
    wire: str = "modbus"
    kills_recorder: bool = False


@dataclass(slots=True, kw_only=True)
class Story:
    """What happened; windows in plant time, s.

    Attributes
    ----------
    before, after : windows at the same speed, without and with the block.
    first_run, later_run : what the models are judged on: fitted, and recorded after all.
    diff, history : as the console said them. ``decision`` : about the block; None without one.
    loss : what the recorder's death cost; None where it was left alone.
    arms : how often the operator armed. ``pauses`` : what the machine lost.
    """

    plan: StoryPlan
    files: Files
    hidden: tuple[Hidden, ...]
    before: tuple[float, float] = (0.0, 0.0)
    after: tuple[float, float] | None = None
    first_run: str = ""
    held_run: str = ""
    later_run: str = ""
    refine_s: float = 0.0
    diff: str = ""
    history: str = ""
    decision: Decision | None = None
    loss: Loss | None = None
    arms: int = 0
    missed_ticks: int = 0
    load: list[float] = field(default_factory=list)
    record: dict[str, Array] = field(default_factory=dict)

    @property
    def kept(self) -> bool:
        """Whether the block is in the site file."""
        return self.decision is not None and self.decision.kept


def run_story(plan: StoryPlan, progress: Progress) -> Story:
    """Run the whole script; both processes are ended whatever happens."""
    folder = fresh_folder(plan.out)
    hidden = drawn(plan.effect, plan.seed)
    files = write_files(folder, hidden, plan.wire)
    story = Story(plan=plan, files=files, hidden=hidden)
    bench = Bench(folder=folder, site=files.site, plant_arguments=files.plant_arguments)
    plant = plant_command(bench, files.plant, FAST_M_S, plan.seed)
    service = [*service_command(bench), "--state-dir", str(folder)]
    progress("starting the plant (compiles its kernel the first time)")
    with Child("plant", plant, folder / "plant.log", ready="ready") as line:
        with Child("runtime", service, folder / "runtime.log") as runtime:
            _Script(bench, runtime, story, progress).run()
            runtime.stop()
        line.stop()
    names = ["time_s", "true_unwind_tension_N", "true_unwind_angle_rad", *_angles(hidden)]
    story.record = read_columns(bench.plant_record, names)
    return story


def _angles(hidden: tuple[Hidden, ...]) -> list[str]:
    """Return the plant's record of the hidden roller's angle, where it is an idler."""
    at = hidden[-1].location
    return [f"true_{angle_of(at)}"] if at.startswith("R") and at[1:].isdecimal() else []


class _Script:
    """One line's operator and engineer."""

    def __init__(self, bench: Bench, runtime: Child, story: Story, progress: Progress) -> None:
        self.bench, self.runtime, self.story = bench, runtime, story
        self._progress = progress
        self._before_run = ""
        self._kill_is_due = story.plan.kills_recorder

    def say(self, text: str) -> None:
        """Tell who is watching."""
        self._progress(text)

    def run(self) -> None:
        """Do everything in its order."""
        out = self.bench.folder
        await_state(self.bench, self.runtime, {"FAULT", "OFF", "READY"}, 60.0)
        self.say(f"PI drives alone for {ALONE_S:.0f} s, then the probe")
        pause(ALONE_S)
        probe(self.bench, self.say)
        self.arm()
        self.say("AFF on the unwind; two speeds and a step of tension are recorded")
        self.watch(LEARN_S)
        self.unbroken(self.both_speeds)
        runs = sorted((out / "runs").iterdir())
        start_s, end_s = _span_s(runs[-1])
        self.story.first_run = f"{runs[-1]}@{start_s + FIRST_S:.0f}..{end_s:.0f}"
        self.story.held_run = str(runs[0])
        if self.story.plan.kills_recorder:
            self.story.loss = loss_of(self.story.first_run)
            self.say(str(self.story.loss))
        self.back()
        self.refine()
        self.story.before, self._before_run = self.window()
        if (out / "refine/site_proposed.yaml").exists():
            self.correct(out / "refine/site_proposed.yaml")
        else:
            self.say("no block to try: the page says what to do at the machine")
        self.later()
        self.story.history = runtime_command(self.bench, "settings", "history")
        self.story.missed_ticks = runtime_status(self.bench).missed_ticks or 0

    def both_speeds(self) -> None:
        """Record the slow speed and a step of tension; kill the recorder where that is asked."""
        self.ramp(FAST_M_S, SLOW_M_S)
        self.watch(SLOW_S / 2.0)
        if self._kill_is_due:
            self._kill_is_due = False
            self.say(f"SIGKILL to recorder {kill_recorder(self.runtime.process.pid)}")
        self.watch(SLOW_S / 2.0)
        self.set("tension_ref_N", STEP_N)
        self.watch(STEP_S)

    def back(self) -> None:
        """Return to the fast speed and the tension of the start."""
        self.set("tension_ref_N", TENSION_N)
        self.ramp(SLOW_M_S, FAST_M_S)

    def unbroken(self, stretch: Callable[[], None]) -> float:
        """Record a stretch; anew where the correction went to zero in it, ``STRETCHES`` times.

        What acted from the machine's pause until it was armed again is not in the record. Returns
        how long the last one took, s.
        """
        clock = MonotonicClock()
        for left in reversed(range(STRETCHES)):
            arms, began_ns = self.story.arms, clock.now_ns()
            stretch()
            if self.story.arms == arms or not left:
                break
            self.say("the correction went to zero in this stretch: it is recorded once more")
            self.back()
        return (clock.now_ns() - began_ns) * 1e-9

    def refine(self) -> None:
        """Trace the cause from the service's own records, beside the running line."""
        out = self.bench.folder
        self.say("tracing the cause from what the service recorded, beside the running line")
        command = [
            *("nice", "-n", "10", *PLANT, "refine", str(self.story.files.line)),
            *(self.story.first_run, "--holdout", self.story.held_run, "--workers", "2"),
            *("--site", str(self.bench.site), "--out", str(out / "refine")),
        ]
        clock = MonotonicClock()
        began_ns = clock.now_ns()
        with (out / "refine.log").open("wb") as log:
            work = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
            try:
                while work.poll() is None:
                    self.watch(LOOK_S)
                    if (clock.now_ns() - began_ns) * 1e-9 > REFINE_S:
                        raise PlantError(
                            f"the trace took more than {REFINE_S:.0f} s: free the machine of "
                            f"other work and try again; {out / 'refine.log'} says how far it came"
                        )
            finally:
                if work.poll() is None:
                    work.terminate()
                    work.wait()
        self.story.refine_s = (clock.now_ns() - began_ns) * 1e-9
        text = (out / "refine.log").read_text(errors="replace")
        if work.returncode:
            raise PlantError(f"refine: {text[-1500:]}")
        self.say(text[text.rfind("\nverdict") :].strip())

    def correct(self, proposed: Path) -> None:
        """Try the block that was proposed; keep it where the service's records show a fall."""
        self.story.diff = runtime_command(self.bench, "settings", "diff", str(proposed))
        if "nothing differs" in self.story.diff:
            self.say("the site file has all that was proposed already")
            return
        self.say(f"trying:\n{self.story.diff.strip()}")
        orders = new_orders(self.bench.site, proposed)
        cause = f"traced by refine: {self.story.plan.effect}"
        self.story.decision = correct(self, self.bench.site, proposed, orders, cause)
        if self.story.decision.judgement is None:
            self.story.after = None
        self.say(f"{'kept' if self.story.kept else 'undone'}: {self.story.decision.why}")

    def settings(self, *words: str) -> str:
        """Give ``aff-runtime settings`` and return what it says."""
        return runtime_command(self.bench, "settings", *words).strip()

    def status(self) -> RuntimeStatus:
        """Return how the service stands."""
        return runtime_status(self.bench)

    def probe_again(self) -> None:
        """Take the correction back, probe with the site file in force, and arm."""
        self.say("taking the correction back; probing again with the new roll in the site file")
        runtime_command(self.bench, "bypass")
        pause(1.0)
        probe(self.bench, self.say)
        self.arm()

    def record(self) -> str:
        """Let a window pass and return it, as ``compare`` takes it."""
        self.story.after, window = self.window()
        return window

    def judge(self, window: str, orders: tuple[BlockOrder, ...]) -> Judgement:
        """Compare a window with the one before the block."""
        return judged(self._before_run, window, orders, self.bench.folder / "compare")

    def later(self) -> None:
        """Record again at both speeds, with what is kept, for the models to be judged on."""
        self.say("a later run: both speeds again")
        before = sorted((self.bench.folder / "runs").iterdir())[-1]
        runtime_command(self.bench, "bypass")
        pause(1.0)
        self.arm()
        long_s = self.unbroken(self.slower_and_tighter)
        start_s, end_s = _span_s(before)
        self.story.later_run = f"{before}@{max(start_s, end_s - long_s):.0f}..{end_s:.0f}"

    def slower_and_tighter(self) -> None:
        """Record some seconds at the fast speed, a ramp, the slow speed and a step of tension."""
        self.watch(6.0)
        self.ramp(FAST_M_S, SLOW_M_S)
        self.watch(14.0)
        self.set("tension_ref_N", STEP_N)
        self.watch(8.0)

    def window(self) -> tuple[tuple[float, float], str]:
        """Let a window pass; return it in plant time, and as the service's own record has it."""
        if self._changes_rolls(plant_status(self.bench), THIN_M):
            self.watch(LEARN_S)
        start = plant_time(self.bench)
        self.watch(WINDOW_S)
        end = plant_time(self.bench)
        run = sorted((self.bench.folder / "runs").iterdir())[-1]
        first_s, last_s = _span_s(run)
        return (start, end), f"{run}@{max(first_s, last_s - WINDOW_S):.2f}..{last_s:.2f}"

    def arm(self) -> None:
        """Arm as an operator does; once more where the machine paused right then."""
        for attempt in range(1, ARM_ATTEMPTS + 1):
            try:
                runtime_command(self.bench, "arm")
                self.story.arms += 1
                await_state(self.bench, self.runtime, {"ACTIVE"}, ARM_PATIENCE_S)
            except PlantError as error:
                paused = NO_REPLY in str(error) or runtime_status(self.bench).state == "FAULT"
                if attempt == ARM_ATTEMPTS or not paused:
                    raise
            else:
                return

    def watch(self, seconds: float) -> None:
        """Let time pass; arm again where the machine's pauses took the correction back.

        A trace that takes long outlasts a roll: then it is changed at speed, as a turret does.
        """
        clock = MonotonicClock()
        end_ns = clock.now_ns() + int(seconds * 1e9)
        while clock.now_ns() < end_ns:
            pause(min(LOOK_S, max(0.0, (end_ns - clock.now_ns()) * 1e-9)))
            self.story.load.append(os.getloadavg()[0])
            seen = plant_status(self.bench)
            self._changes_rolls(seen, THINNEST_M)
            if seen.counts_now:
                continue
            status = runtime_status(self.bench)
            if status.state in RESTING:
                self.say(f"the correction went to zero ({status.alarm}); arming again")
                self.arm()

    def _changes_rolls(self, seen: PlantStatus, below_m: float) -> bool:
        """Put full rolls on where the unwind's is smaller than ``below_m``; return whether."""
        radius_m = seen.measured.get("unwind_radius_m")
        if radius_m is None or radius_m >= below_m:
            return False
        self.say(f"the roll is down to {1e3 * radius_m:.0f} mm: another one is spliced on")
        change_s = ask(self.bench.plant_socket, "roll")["change_s"]
        while plant_time(self.bench) < change_s + SPLICE_S:
            pause(0.5)
        return True

    def ramp(self, start_m_s: float, end_m_s: float) -> None:
        """Change the line speed evenly."""
        steps = round(RAMP_S / RAMP_STEP_S)
        for k in range(steps):
            at = start_m_s + (end_m_s - start_m_s) * (k + 1) / steps
            self.set("line_speed_ref_m_s", at)
            pause(RAMP_STEP_S)

    def set(self, name: str, value: float) -> None:
        """Set a reference of the plant."""
        ask(self.bench.plant_socket, f"set {name} {value:.5f}")


def _span_s(run: Path) -> tuple[float, float]:
    """Return when a run that is still recorded begins and ends, by the clock of its rows.

    That clock begins with the control process, not with the folder.
    """
    times = read_table(RunWindow(folder=run), keep=lambda _name: False).columns["time_s"]
    return float(times[0]), float(times[-1])


def first_order(record: dict[str, Array], span: tuple[float, float], channel: str) -> float:
    """Return the amplitude of order 1 of a roller in the unwind's true tension, N."""
    keep = (record["time_s"] >= span[0]) & (record["time_s"] < span[1])
    part = {name: values[keep] for name, values in record.items()}
    others = {"unwind": part["true_unwind_angle_rad"]}
    tension, angle = part["true_unwind_tension_N"], part[channel]
    return float(abs(order_amplitudes(tension, angle, (1,), others)[0]))
