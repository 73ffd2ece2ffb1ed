"""The service on a site file that setup wrote: probe, arm, and every step of the card.

What only hands can do at a real line (hanging a weight) is left out with its reason; every other
step is done at the simulated one, at the terminal, and measured as a technician would.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.clock import MonotonicClock
from sim_plant.demo.processes import RUNTIME, Child
from sim_plant.demo.session import pause
from sim_plant.servers.answers import PlantStatus
from sim_plant.servers.control_client import ask

PATIENCE_S = 700.0
TRIES = 3
SHORT = (0, 2, 3, 4, 8, 10, 12)
WHY = "played at the simulated line"
LIMITS = {"unwind": 0.15, "swrap_follower": 0.05}
SPEEDS_M_S = (1.016, 0.85, 1.2)
SIGN = -1.0
"""A faster unwind or follower lets more web into the zone behind it: tension falls."""
BROWSERS = ("chromium", "chromium-browser")
ROLL_S, SETTLE_S, FULL_M = 6.0, 40.0, 0.2032


class PlayError(Exception):
    """A command did not do what it should."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """What one step took, and how it ended."""

    step: str
    seconds: float
    exit: int
    said: tuple[str, ...]


class Commissioning:
    """One service, one plant, one card.

    Parameters
    ----------
    folder : for runs, state, card. ``plant`` : its control socket.
    """

    def __init__(self, folder: Path, site: Path, plant: Path, say: Callable[[str], None]) -> None:
        self._folder, self._site, self._plant, self._say = folder, site, plant, say
        self._runtime_dir, self._card = folder / "run", folder / "card"
        self._service: Child | None = None
        self._clock = MonotonicClock()
        self.notes: list[Note] = []

    def card(self, *, whole: bool, first: int = 0) -> bool:
        """Play the card; return whether it holds and each step that was measured is signed.

        Parameters
        ----------
        first : step to begin with; above 0 the card that is there goes on.
        """
        for left in ("run",) if first else ("run", "runs", "state", "card"):
            shutil.rmtree(self._folder / left, ignore_errors=True)
        self._runtime_dir.mkdir(mode=0o700)
        began_s = self._now_s() - self._before(first)
        try:
            self._start()
            if not first:
                self._aff("new", "card", "new", str(self._site), str(self._card), *self._state())
            signed = []
            for step in range(first, 13) if whole else SHORT:
                getattr(self, f"_step_{step}")()
                signed.append(self._sign(step))
            is_signed = all(signed)
            self._page()
        except PlayError as error:
            self._say(f"not good: {error}")
            is_signed = False
        finally:
            self._stop()
        took_s = round(self._now_s() - began_s)
        kept = {"seconds": took_s, "notes": [asdict(one) for one in self.notes]}
        (self._folder / "card.json").write_text(json.dumps(kept, indent=1), encoding="utf-8")
        self._say(f"the card took {took_s} s")
        return is_signed

    def _before(self, first: int) -> float:
        """Take over the notes of a card that goes on; return how long it took until then, s."""
        kept = self._folder / "card.json"
        if not first or not kept.exists():
            return 0.0
        before = json.loads(kept.read_text(encoding="utf-8"))
        self.notes += [Note(**one) for one in before["notes"]]
        return float(before["seconds"])

    # --- steps ----------------------------------------------------------------------------------

    def _step_0(self) -> None:
        self._wait(62.0)
        self._measure(0)

    def _step_1(self) -> None:
        self._leave_out(1, "simulated line: no weight can be hung on a load cell")

    def _step_2(self) -> None:
        self._wait(10.0)
        measured = self._status_of_plant().measured
        shown = {
            "unwind_tension_N": f"{measured['tension_ref_N']:.1f} N",
            "pullroll_tension_N": f"{self._mean('pullroll_tension_N'):.1f} N",
            "line_speed_m_s": f"{self._mean('line_speed_m_s'):.4f} m/s",
            "unwind_radius_m": f"{self._mean('unwind_radius_m'):.4f} m",
        }
        self._measure(2, *(f"{name}={text}" for name, text in shown.items()))

    def _step_3(self) -> None:
        typed = [f"{name}={limit} m/s" for name, limit in LIMITS.items()]
        found = self._measure(3, *typed)
        warnings = sum(line.startswith("remark    warning") for line in found)
        if warnings:
            self._measure(3, *typed, f"warnings_understood={warnings}")

    def _step_4(self) -> None:
        self._measure(4, "reaction=ramp", "time=180 ms")

    def _step_5(self) -> None:
        self._into_shadow()
        self._wait(20.0)
        self._tell("fault", "mute:2")
        self._wait(10.0)
        self._measure(5, "base_reference=190 ms")

    def _step_6(self) -> None:
        self._tell("roll")
        self._wait(ROLL_S)
        self._into_shadow()
        self._wait(606.0)
        self._measure(6)
        self._aff("shadow off", "shadow", "off", *self._where())

    def _step_7(self) -> None:
        for speed_m_s in SPEEDS_M_S:
            for _ in range(2):
                self._tell("roll")  # the same radius for both, and none that ends
                self._wait(ROLL_S)
                self._tell("set", "line_speed_ref_m_s", f"{speed_m_s}")
                self._wait(ROLL_S)
                self._probe()
                self._measure(7, *(f"sign_{name}={SIGN:g}" for name in LIMITS))
        self._tell("set", "line_speed_ref_m_s", f"{SPEEDS_M_S[0]}")
        self._wait(5.0)

    def _step_8(self) -> None:
        if not any(one.step == "probe" for one in self.notes):
            self._probe()
        self._tell("roll")
        self._wait(ROLL_S + 25.0)
        self._arm()
        self._wait(45.0)
        self._measure(8)

    def _step_9(self) -> None:
        self._arm()
        self._measure(9, "actuator=unwind")

    def _step_10(self) -> None:
        self._arm()
        self._wait(10.0)
        self._measure(10)

    def _step_11(self) -> None:
        trips = {
            "web_break": ("fault", "permissive=WEB_INTACT:1"),
            "splice": ("fault", "splice"),
            "stop": ("fault", "permissive=LINE_RUN:2"),
            "cable": ("fault", "refuse:2"),
            "plc_stop": ("fault", "freeze:2"),
        }
        self._tell("roll")
        self._wait(ROLL_S)
        for trip, words in trips.items():
            self._arm()
            self._wait(8.0)
            self._tell(*words)
            self._wait(12.0)
            self._measure(11, f"trip={trip}")
        self._arm()
        self._wait(8.0)
        self._aff("bypass", "bypass", *self._where())
        self._wait(8.0)
        self._measure(11, "trip=bypass")
        for trip in ("restart", "kill"):
            self._arm()
            self._wait(4.0)
            self._end(kill=trip == "kill")
            self._start()
            self._wait(6.0)
            self._measure(11, f"trip={trip}", "time=180 ms")

    def _step_12(self) -> None:
        turns_s = 20.0 * 6.2832 * FULL_M / SPEEDS_M_S[0] + 4.0
        self._tell("roll")
        self._wait(ROLL_S)
        for _ in range(2):
            self._aff("bypass", "bypass", *self._where())
            self._wait(turns_s)
            self._arm()
            self._wait(SETTLE_S + turns_s)
        self._measure(12, "promised=3 dB", f"settle={SETTLE_S:g} s")

    # --- signing and printing -------------------------------------------------------------------

    def _sign(self, step: int) -> bool:
        """Sign a step at once: what it rests on may change with the next; return whether it is."""
        words = ("card", "sign", str(step), "--as", "Ada Miller", "--reason", WHY)
        code, _ = self._aff(f"sign {step}", *words, *self._of_card(), ok=(0, 2, 4))
        return code == 0

    def _page(self) -> None:
        """Verify the card with its records, and print it."""
        self._aff("show", "card", "show", *self._of_card())
        self._aff("verify", "card", "verify", str(self._card), "--records")
        self._aff("page", "card", "page", *self._of_card())
        browser = next(filter(None, map(shutil.which, BROWSERS)), None)
        if browser is None:
            self._say("no Chromium: card.html is not printed")
            return
        page, out = self._card / "card.html", self._folder / "card.pdf"
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"]
        options += [f"--user-data-dir={self._folder / 'browser'}", f"--print-to-pdf={out}"]
        subprocess.run([browser, *options, page.as_uri()], capture_output=True, check=True)
        shutil.rmtree(self._folder / "browser", ignore_errors=True)
        self._say(f"printed {out}, {out.stat().st_size} bytes")

    # --- the service ----------------------------------------------------------------------------

    def _start(self) -> None:
        command = [*RUNTIME, "run", str(self._site), *self._where(), *self._state()]
        command += ["--record-dir", str(self._folder / "runs")]
        self._service = Child("runtime", command, self._folder / "runtime.log")
        for _ in range(100):
            self._wait(0.5)
            if self._state_now() in ("FAULT", "OFF", "READY", "BYPASS"):
                return
        raise PlayError(f"the service does not start: {self._service.tail()}")

    def _end(self, *, kill: bool) -> None:
        assert self._service is not None
        if kill:
            self._service.process.kill()
        self._service.stop()
        self._service = None

    def _stop(self) -> None:
        if self._service is not None:
            self._end(kill=False)

    def _probe(self) -> None:
        for _ in range(TRIES):
            code, _ = self._aff("probe", "probe", str(self._site), *self._where(), ok=(0, 4, 5))
            if code == 0:
                return
        raise PlayError("the probe does not end well")

    def _arm(self) -> None:
        """Arm until it is on: a machine that others use may trip it."""
        for _ in range(3 * TRIES):
            if self._state_now() == "ACTIVE":
                return
            self._aff("arm", "arm", *self._where(), ok=(0, 4, 5))
            self._wait(3.0)
        raise PlayError("it cannot be armed")

    def _into_shadow(self) -> None:
        for _ in range(TRIES):
            if self._state_now() == "SHADOW":
                return
            self._aff("shadow", "shadow", "on", *self._where(), ok=(0, 4, 5))
            self._wait(1.0)
        raise PlayError("it does not go into shadow")

    def _state_now(self) -> str:
        done = self._run("status", "--json", *self._where())
        try:
            return str(json.loads(done.stdout)["state"])
        except (ValueError, KeyError):
            return ""

    # --- commands -------------------------------------------------------------------------------

    def _measure(self, step: int, *typed: str) -> list[str]:
        words = [word for one in typed for word in ("--typed", one)]
        found = ("card", "step", str(step), *words, *self._of_card())
        _, lines = self._aff(f"step {step}", *found, ok=(0, 5))
        return lines

    def _leave_out(self, step: int, why: str) -> None:
        words = ("card", "step", str(step), "--not-applicable", why)
        self._aff(f"step {step}", *words, *self._of_card())

    def _aff(self, step: str, *words: str, ok: Sequence[int] = (0,)) -> tuple[int, list[str]]:
        """Run a command, note it; return its exit code and its lines."""
        began_s = self._now_s()
        done = self._run(*words)
        lines = (done.stdout + done.stderr).splitlines()
        seconds = round(self._now_s() - began_s, 1)
        self.notes.append(
            Note(step=step, seconds=seconds, exit=done.returncode, said=tuple(lines))
        )
        self._say(f"  {step}: exit {done.returncode}, {seconds} s; {lines[-1] if lines else ''}")
        if done.returncode not in ok:
            raise PlayError(f"aff-runtime {' '.join(words)}: exit {done.returncode}: {lines}")
        return done.returncode, lines

    def _run(self, *words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [*RUNTIME, *words], capture_output=True, text=True, timeout=PATIENCE_S, check=False
        )

    def _where(self) -> tuple[str, ...]:
        return ("--runtime-dir", str(self._runtime_dir))

    def _state(self) -> tuple[str, ...]:
        return ("--state-dir", str(self._folder / "state"))

    def _of_card(self) -> tuple[str, ...]:
        return ("--card", str(self._card), *self._where(), *self._state())

    # --- the plant ------------------------------------------------------------------------------

    def _tell(self, *words: str) -> dict[str, Any]:
        answer: dict[str, Any] = ask(self._plant, " ".join(words))
        if "error" in answer:
            raise PlayError(f"sim-plant tell {' '.join(words)}: {answer['error']}")
        return answer

    def _status_of_plant(self) -> PlantStatus:
        return PlantStatus.from_json(self._tell("status"))

    def _mean(self, channel: str) -> float:
        values = []
        for _ in range(20):
            values.append(self._status_of_plant().measured[channel] or 0.0)
            self._wait(0.1)
        return sum(values) / len(values)

    def _now_s(self) -> float:
        return self._clock.now_ns() * 1e-9

    @staticmethod
    def _wait(seconds: float) -> None:
        pause(seconds)
