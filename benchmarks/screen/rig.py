"""A simulated line with service and screen on loopback, and a reader of its ticks."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np

from aff_runtime.app.door.client import DoorClient
from aff_runtime.app.door.messages import DoorMessage, RingPassed
from aff_runtime.app.hand.accounts import Account, secret_of, write_accounts
from aff_runtime.app.hand.may import Role
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError, PlantError, WireError
from aff_runtime.base.events import BY_CODE
from aff_runtime.base.python_child import module_command
from aff_runtime.base.signals import State
from aff_runtime.telemetry.ring import RingReader
from benchmarks.screen.clients import beside_control
from benchmarks.screen.ticks import Block, as_words
from sim_plant.demo.processes import SCREEN, Child, runtime_command
from sim_plant.demo.session import (
    DemoPlan,
    await_state,
    plant_command,
    prepare,
    probe,
    service_command,
)
from sim_plant.demo.wires import free_port
from sim_plant.servers.control_client import ask

ROOT = Path(__file__).resolve().parents[2]
ACCOUNT, PASSWORD = "anna", "tension, 90 N"
LOOK_S = 0.25
SETTLE_S = 3.0
SMALL_M, SPLICE_S = 0.14, 2.0
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")
TICKS_PER_S = os.sysconf("SC_CLK_TCK")
CLOCK = MonotonicClock()


def pause(seconds: float) -> None:
    """Wait in real time."""
    CLOCK.sleep_until_ns(CLOCK.now_ns() + int(seconds * 1e9))


def used(pid: int) -> tuple[float, float]:
    """Return processor time, s, and resident memory, MB, of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S, pages * PAGE_BYTES * 1e-6


def goes_first(pid: int) -> bool:
    """Have a process go before all others of its processor, as a PLC does; False: not allowed."""
    try:
        for task in Path(f"/proc/{pid}/task").iterdir():
            os.sched_setscheduler(int(task.name), os.SCHED_RR, os.sched_param(1))
    except PermissionError:
        return False
    return True


class Ring:
    """Ticks and events as they come, through the service's door as any visitor gets them."""

    def __init__(self, door: Path) -> None:
        self._path = door
        self._door = DoorClient(door)
        self._ring: RingReader | None = None
        self._missed = -1.0

    def poll(self) -> RingReader:
        """Follow the door to the ring of now; come in anew where a long pause had us sent away."""
        while True:
            while (message := self._message()) is not None:
                if isinstance(message, RingPassed):
                    self._let_go()
                    self._ring = RingReader(message.descriptor)
                    self._ring.signals.read_new()
                    self._ring.events.read_new()
            if self._ring is not None:
                return self._ring
            pause(0.02)

    def _message(self) -> DoorMessage | None:
        try:
            return self._door.receive()
        except WireError:
            self._door.close()
            self._door = DoorClient(self._path)
            return None

    def ticks(self) -> tuple[list[float], int, Counter[str]]:
        """Return when new ticks ended, us after they were due; how many are missing.

        Of the idle ones, too, how many there were by state and alarm.
        """
        ring = self.poll()
        records = ring.signals.read_new()
        names = ("wake_us", "tick_us", "missed_count", "state", "alarm")
        at = {name: ring.columns.index(name) for name in names}
        missed = 0
        if records:
            newest = records[-1][at["missed_count"]]
            missed = int(newest - self._missed) if 0.0 <= self._missed <= newest else 0
            self._missed = newest
        states = [(int(row[at["state"]]), int(row[at["alarm"]])) for row in records]
        idle = Counter(_named(*one) for one in states if one[0] != State.ACTIVE)
        return [row[at["wake_us"]] + row[at["tick_us"]] for row in records], missed, idle

    def rights(self) -> str:
        """Return which real-time rights the control process was refused."""
        refused = [one.text for one in self.poll().header.meta.rights if not one.granted]
        return "; ".join(refused) or "all granted"

    def event_ns(self, code: int, patience_s: float = 2.0) -> int | None:
        """Return when the next event of a code took place; None for not in time."""
        ring = self.poll()
        end_ns = CLOCK.now_ns() + int(patience_s * 1e9)
        while CLOCK.now_ns() < end_ns:
            for _, t_ns, found, _ in ring.events.read_new():
                if int(found) == code:
                    return int(t_ns)
            pause(0.005)
        return None

    def close(self) -> None:
        """Leave."""
        self._door.close()
        self._let_go()

    def _let_go(self) -> None:
        if self._ring is not None:
            self._ring.close()
        self._ring = None


def _named(state: int, alarm: int) -> str:
    """Return a state with the alarm that stands."""
    by = BY_CODE[alarm].name if alarm in BY_CODE else str(alarm)
    return f"{State(state).name} by {by}" if alarm else State(state).name


class Rig:
    """Plant and service; a screen when one is asked for.

    Attributes
    ----------
    plant, service : their processes. ``ring`` : what the service does.
    plc_goes_first : whether the plant, whose PLC would be a machine of its own, waits for no
        screen and no browser on the processor that they share here.
    """

    def __init__(self, out: Path, stack: ExitStack) -> None:
        beside_control()
        plan = DemoPlan(
            line=ROOT / "config/lines/euclid_ripple.yaml",
            site=ROOT / "config/euclid.yaml",
            out=out,
            line_speed_m_s=1.016,
        )
        self.bench = prepare(plan)
        folder = self.bench.folder
        (folder / "state").mkdir()
        command = plant_command(self.bench, plan.line, plan.line_speed_m_s, plan.seed)
        self.plant = stack.enter_context(Child("plant", command, folder / "plant.log", "ready"))
        self.plc_goes_first = goes_first(self.plant.process.pid)
        command = service_command(self.bench)
        command += ["--hand", "operate", "--state-dir", str(folder / "state")]
        self.service = stack.enter_context(Child("runtime", command, folder / "runtime.log"))
        await_state(self.bench, self.service, {"FAULT", "OFF", "READY"}, 120.0)
        secret = secret_of(PASSWORD)
        write_accounts(
            folder / "accounts", [Account(name=ACCOUNT, role=Role.OPERATE, secret=secret)]
        )
        self.ring = Ring(self.bench.runtime_dir / "door.sock")
        stack.callback(self.ring.close)
        self._has_response = False

    def arm(self, *, is_at_work: bool = False) -> bool:
        """Have the line armed, its response measured first; False where it cannot be.

        Parameters
        ----------
        is_at_work : wait until the correction goes out.
        """
        wanted = {"ACTIVE"} if is_at_work else {"ARMED", "ACTIVE"}
        try:
            self._change_roll()
            if not self._has_response:
                probe(self.bench, print)
                self._has_response = True
            if runtime_state(self) not in wanted:
                runtime_command(self.bench, "arm")
                await_state(self.bench, self.service, wanted, 10.0)
        except (AffError, subprocess.TimeoutExpired) as error:
            print(error)
            return False
        return True

    def _change_roll(self) -> None:
        """Put in a new roll before the one at work is at its core: that is eight minutes."""
        signals = json.loads(runtime_command(self.bench, "status", "--json"))["signals"]
        if (signals.get("unwind_radius_m") or 1.0) > SMALL_M:
            return
        ask(self.bench.plant_socket, "roll")
        pause(SPLICE_S + SETTLE_S)

    @property
    def control_pid(self) -> int:
        """Process that controls."""
        return int(json.loads(runtime_command(self.bench, "status", "--json"))["control_pid"])

    @contextlib.contextmanager
    def screen(self) -> Iterator[tuple[Child, str]]:
        """Run a screen; its process and its address."""
        run = self.bench.runtime_dir
        command = [
            *(*SCREEN, "--door", str(run / "door.sock"), "--hand-socket", str(run / "hand.sock")),
            *("--accounts", str(self.bench.folder / "accounts")),
            *("--listen", f"127.0.0.1:{free_port()}"),
        ]
        with Child("screen", command, self.bench.folder / "screen.log", piped=True) as screen:
            yield screen, screen.await_line("look: ", 120.0).removeprefix("look: ")

    def block(self, seconds: float, screen: Child | None = None) -> Block:
        """Return the ticks of the next ``seconds``."""
        pids = [self.service.process.pid, *([screen.process.pid] if screen is not None else [])]
        self.ring.ticks()
        before = [used(pid)[0] for pid in pids]
        ends: list[float] = []
        missed, idle = 0, Counter[str]()
        start_ns = CLOCK.now_ns()
        while CLOCK.now_ns() < start_ns + int(seconds * 1e9):
            pause(LOOK_S)
            fresh, lost, resting = self.ring.ticks()
            ends, missed, idle = ends + fresh, missed + lost, idle + resting
        passed_s = (CLOCK.now_ns() - start_ns) * 1e-9
        is_there = screen is not None and screen.process.poll() is None
        ended = [used(pid) for pid in (pids if is_there else pids[:1])]
        cores = [(now - was) / passed_s for (now, _), was in zip(ended, before, strict=False)]
        return Block(
            end_us=np.asarray(ends),
            missed=missed,
            idle=idle.total(),
            idle_as=as_words(idle),
            supervisor_core=cores[0],
            screen_core=cores[1] if is_there else 0.0,
            screen_MB=ended[1][1] if is_there else 0.0,
        )


def runtime_state(rig: Rig) -> str:
    """Return the guard's state, as the console says it."""
    return str(json.loads(runtime_command(rig.bench, "status", "--json"))["state"])


def clients(kind: str, url: str, seconds: float) -> subprocess.Popen[str]:
    """Start ten browsers, or a flood, for a while; they print what they saw."""
    command = [*module_command("benchmarks.screen.clients"), kind, url, str(seconds)]
    tree = {**os.environ, "PYTHONPATH": str(ROOT)}  # benchmarks are not installed
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT, env=tree)


def heard(visitors: subprocess.Popen[str], block: Block, patience_s: float) -> Block:
    """Return a block with what its visitors saw.

    Raises
    ------
    PlantError
        When they say nothing in time.
    """
    try:
        told, _ = visitors.communicate(timeout=patience_s)
        seen = json.loads(told)
    except (subprocess.TimeoutExpired, ValueError) as error:
        visitors.kill()
        visitors.communicate()
        raise PlantError(f"the visitors came to nothing: {error}") from None
    if not seen["bytes"]:
        return block
    return replace(
        block,
        frames_per_s=seen["frames"] / seen["clients"] / seen["seconds"],
        frame_bytes=seen["bytes"] / seen["frames"],
    )
