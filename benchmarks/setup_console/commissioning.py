"""The service on a site file that setup wrote: probe, arm, and every step of the card.

What only hands can do at a real line (hanging a weight) is left out with its reason; every other
step is done at the simulated one, at the terminal, and measured as a technician would.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import asdict
from pathlib import Path

from aff_runtime.base.clock import wall_time_iso
from benchmarks.setup_console.running import Note, PlayError, Running

SHORT = (0, 2, 3, 4, 8, 10, 12)
WHY = "played at the simulated line"
LIMITS = {"unwind": 0.15, "swrap_follower": 0.05}
SPEEDS_M_S = (1.016, 0.85, 1.2)
SIGN = -1.0
"""A faster unwind or follower lets more web into the zone behind it: tension falls."""
BROWSERS = ("chromium", "chromium-browser")
ROLL_S, SETTLE_S, FULL_M, READ_S = 6.0, 40.0, 0.2032, 5.0


class Commissioning(Running):
    """One card, in the folder of the service's runs."""

    @property
    def _card(self) -> Path:
        return self.folder / "card"

    def card(self, *, whole: bool, first: int = 0) -> bool:
        """Play the card; return whether it holds and each step that was measured is signed.

        Parameters
        ----------
        first : step to begin with; above 0 the card that is there goes on.
        """
        for left in ("run",) if first else ("run", "runs", "state", "card"):
            shutil.rmtree(self.folder / left, ignore_errors=True)
        self.runtime_dir.mkdir(mode=0o700)
        began_s = self.now_s() - self._before(first)
        try:
            self.start()
            if not first:
                self.aff("new", "card", "new", str(self.site), str(self._card), *self.state())
            signed = []
            for step in range(first, 13) if whole else SHORT:
                getattr(self, f"_step_{step}")()
                signed.append(self._sign(step))
            is_signed = all(signed)
            self._page()
        except PlayError as error:
            self.say(f"not good: {error}")
            is_signed = False
        finally:
            self.stop()
        took_s = round(self.now_s() - began_s)
        notes = [asdict(one) for one in self.notes]
        kept = {"measured": wall_time_iso(), "seconds": took_s, "notes": notes}
        (self.folder / "card.json").write_text(json.dumps(kept, indent=1), encoding="utf-8")
        self.say(f"the card took {took_s} s")
        return is_signed

    def _before(self, first: int) -> float:
        """Take over the notes of a card that goes on; return how long it took until then, s."""
        kept = self.folder / "card.json"
        if not first or not kept.exists():
            return 0.0
        before = json.loads(kept.read_text(encoding="utf-8"))
        self.notes += [Note(**one) for one in before["notes"]]
        return float(before["seconds"])

    # --- steps ----------------------------------------------------------------------------------

    def _step_0(self) -> None:
        self.wait(62.0)
        self._measure(0)

    def _step_1(self) -> None:
        self._leave_out(1, "simulated line: no weight can be hung on a load cell")

    def _step_2(self) -> None:
        self.wait(8.0)
        now_s, run = self.recorded_until()
        measured = self.status_of_plant().measured
        shown = {
            "unwind_tension_N": f"{measured['tension_ref_N']:.1f} N",
            "pullroll_tension_N": f"{self.mean('pullroll_tension_N'):.1f} N",
            "line_speed_m_s": f"{self.mean('line_speed_m_s'):.4f} m/s",
            "unwind_radius_m": f"{self.shown('unwind_radius_m'):.4f} m",  # it shrinks: read last
        }
        self.wait(1.0)
        typed = [f"{name}={text}" for name, text in shown.items()]
        # a busy machine starts a command in a quarter of a minute: the window is that of the look
        self._measure(2, *typed, run=f"{run}@{max(0.0, now_s - READ_S):.2f}..{now_s + READ_S:.2f}")

    def _step_3(self) -> None:
        typed = [f"{name}={limit} m/s" for name, limit in LIMITS.items()]
        found = self._measure(3, *typed)
        warnings = sum(line.startswith("remark    warning") for line in found)
        if warnings:
            self._measure(3, *typed, f"warnings_understood={warnings}")

    def _step_4(self) -> None:
        self._measure(4, "reaction=ramp", "time=180 ms")

    def _step_5(self) -> None:
        self.into_shadow()
        self.wait(20.0)
        self.tell("fault", "mute:2")
        self.wait(10.0)
        self._measure(5, "base_reference=190 ms")

    def _step_6(self) -> None:
        self.tell("roll")
        self.wait(ROLL_S)
        self.into_shadow()
        self.wait(606.0)
        self._measure(6)
        self.aff("shadow off", "shadow", "off", *self.where())

    def _step_7(self) -> None:
        for speed_m_s in SPEEDS_M_S:
            for _ in range(2):
                self.tell("roll")  # the same radius for both, and none that ends
                self.wait(ROLL_S)
                self.tell("set", "line_speed_ref_m_s", f"{speed_m_s}")
                self.wait(ROLL_S)
                self.probe()
                self._measure(7, *(f"sign_{name}={SIGN:g}" for name in LIMITS))
        self.tell("set", "line_speed_ref_m_s", f"{SPEEDS_M_S[0]}")
        self.wait(5.0)

    def _step_8(self) -> None:
        if not any(one.step == "probe" for one in self.notes):
            self.tell("roll")  # a thin one shrinks too much while it is probed
            self.wait(ROLL_S)
            self.probe()
        self.tell("roll")
        self.wait(ROLL_S + 25.0)
        self.arm()
        self.wait(45.0)
        self._measure(8)

    def _step_9(self) -> None:
        self.arm()
        self._measure(9, "actuator=unwind")

    def _step_10(self) -> None:
        self.arm()
        self.wait(10.0)
        self._measure(10)

    def _step_11(self) -> None:
        trips = {
            "web_break": ("fault", "permissive=WEB_INTACT:1"),
            "splice": ("fault", "splice"),
            "stop": ("fault", "permissive=LINE_RUN:2"),
            "cable": ("fault", "refuse:2"),
            "plc_stop": ("fault", "freeze:2"),
        }
        self.tell("roll")
        self.wait(ROLL_S)
        for trip, words in trips.items():
            self.arm()
            self.wait(8.0)
            self.tell(*words)
            self.wait(12.0)
            self._measure(11, f"trip={trip}")
        self.arm()
        self.wait(8.0)
        self.aff("bypass", "bypass", *self.where())
        self.wait(8.0)
        self._measure(11, "trip=bypass")
        for trip in ("restart", "kill"):
            self.arm()
            self.wait(4.0)
            self.end(kill=trip == "kill")
            self.start()
            self.wait(6.0)
            self._measure(11, f"trip={trip}", "time=180 ms")

    def _step_12(self) -> None:
        turns_s = 20.0 * 6.2832 * FULL_M / SPEEDS_M_S[0] + 4.0
        self.tell("roll")
        self.wait(ROLL_S)
        for _ in range(2):
            self.aff("bypass", "bypass", *self.where())
            self.wait(turns_s)
            self.arm()
            self.wait(SETTLE_S + turns_s)
        self._measure(12, "promised=3 dB", f"settle={SETTLE_S:g} s")

    # --- signing and printing -------------------------------------------------------------------

    def _sign(self, step: int) -> bool:
        """Sign a step at once: what it rests on may change with the next; return whether it is."""
        words = ("card", "sign", str(step), "--as", "Ada Miller", "--reason", WHY)
        code, _ = self.aff(f"sign {step}", *words, *self._of_card(), ok=(0, 2, 4))
        return code == 0

    def _page(self) -> None:
        """Verify the card with its records, and print it."""
        self.aff("show", "card", "show", *self._of_card())
        self.aff("verify", "card", "verify", str(self._card), "--records")
        self.aff("page", "card", "page", *self._of_card())
        browser = next(filter(None, map(shutil.which, BROWSERS)), None)
        if browser is None:
            self.say("no Chromium: card.html is not printed")
            return
        page, out = self._card / "card.html", self.folder / "card.pdf"
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"]
        options += [f"--user-data-dir={self.folder / 'browser'}", f"--print-to-pdf={out}"]
        subprocess.run([browser, *options, page.as_uri()], capture_output=True, check=True)
        shutil.rmtree(self.folder / "browser", ignore_errors=True)
        self.say(f"printed {out}, {out.stat().st_size} bytes")

    def _measure(self, step: int, *typed: str, run: str = "") -> list[str]:
        words = [word for one in typed for word in ("--typed", one)]
        words += ["--run", run] if run else []
        found = ("card", "step", str(step), *words, *self._of_card())
        _, lines = self.aff(f"step {step}", *found, ok=(0, 5))
        return lines

    def _leave_out(self, step: int, why: str) -> None:
        words = ("card", "step", str(step), "--not-applicable", why)
        self.aff(f"step {step}", *words, *self._of_card())

    def _of_card(self) -> tuple[str, ...]:
        return ("--card", str(self._card), *self.where(), *self.state())
