"""`aff-runtime setup` at a terminal, played by somebody who knows the plant's displays alone.

``python -m benchmarks.setup_console --out out/setup`` starts the simulated line, answers every
question at a pseudo-terminal with what a display shows at that moment, and leaves
``out/setup/site.yaml``. ``make demo SITE=out/setup/site.yaml`` runs with it.
"""

from __future__ import annotations

import argparse
import os
import pty
import re
import select
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from aff_runtime.base.clock import MonotonicClock
from sim_plant.demo.processes import PLANT, RUNTIME, Child
from sim_plant.demo.wires import free_port
from sim_plant.servers.control_client import ask

ROOT = Path(__file__).parents[1]
LBF_N, IN_M, FPM_M_S = 4.4482216152605, 0.0254, 0.00508
PATIENCE_S = 90.0
Measured = Mapping[str, float]
Answer = str | Callable[[Measured], str]


def of(channel: str, unit: float, text: str) -> Callable[[Measured], str]:
    """Return what a display shows of a channel; format ``text``."""
    return lambda measured: text.format(measured[channel] / unit)


ANSWERS: tuple[tuple[str, Answer], ...] = (
    ("Address of the PLC", "127.0.0.1"),
    ("Name of the line", "Euclid"),
    ("Name of a second driven roller", "swrap_follower"),
    ("Channel of the web tension behind", "pullroll_tension_N"),
    ("as web tension behind the unwind", of("tension_ref_N", LBF_N, "{:.1f} lbf")),
    ("as set point of that tension", of("tension_ref_N", LBF_N, "{:.2f} lbf")),
    ("as line speed", of("line_speed_ref_m_s", FPM_M_S, "{:.1f} FPM")),
    ("as radius of the unwind", of("unwind_radius_m", IN_M, "{:.2f} in")),
    ("as speed of swrap_follower", of("line_speed_ref_m_s", FPM_M_S, "{:.1f} FPM")),
    ("as web tension behind swrap_follower", of("pullroll_tension_N", LBF_N, "{:.1f} lbf")),
    ("Highest speed", "300 FPM"),
    ("Highest web tension", "400 N"),
    ("Radius of the empty core", "4 in"),
    ("Radius of the full roll", "12 in"),
    ("Largest correction that the PLC allows at the unwind", "0.15"),
    ("Radius of swrap_follower", "0.15367"),
    ("Largest correction that the PLC allows at swrap_follower", "0.04"),
    ("Amplitude of the probe", "0.02"),
    ("Law: blocks", "shape"),
    ("Word with the status bits", "1"),
    ("Word that counts splices", "8"),
    ("copy of our heartbeat", "15"),
    ("correction of unwind that the PLC", "16"),
    ("correction of swrap_follower that the PLC", "17"),
    ("Speed loop", "15"),
    ("Damping", "1.1"),
    ("Inertia", "0.25"),
    ("Density", "395"),
    ("Width", "6 in"),
    ("Outer radius of the core", "1.75 in"),
)
LINE_SPEED_WORD = "w5"  # two words show the same speed; the PLC's manual tells


class Technician:
    """Reads the terminal and the displays, types the answers.

    Parameters
    ----------
    socket : the plant's control socket. ``port`` : of its Modbus server.
    """

    def __init__(self, socket: Path, port: int) -> None:
        self._socket = socket
        self._port = port
        self._asked_for = ""
        self.questions = 0

    def answer(self, question: str) -> str:
        """Return what to type; empty takes the default."""
        self.questions += 1
        if question.startswith("Port"):
            return str(self._port)
        if "Which one?" in question and self._asked_for == "as line speed":
            return LINE_SPEED_WORD
        if question.startswith("Which one?"):
            return "1"
        for fragment, said in ANSWERS:
            if fragment in question:
                self._asked_for = fragment
                return said if isinstance(said, str) else said(self.measured())
        return ""

    def measured(self) -> Measured:
        """Return what the plant's displays show."""
        status: dict[str, Any] = ask(self._socket, "status")
        shown: Measured = status["measured"]
        return shown


def play(command: list[str], technician: Technician) -> tuple[int, str]:
    """Run a command at a pseudo-terminal; return its exit code and everything it showed."""
    ours, theirs = pty.openpty()
    child = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, close_fds=True)
    os.close(theirs)
    shown, asked = "", 0
    while True:
        ready, _, _ = select.select([ours], [], [], PATIENCE_S)
        try:
            fresh = os.read(ours, 65536).decode(errors="replace") if ready else ""
        except OSError:
            fresh = ""
        if not fresh:
            break
        shown += fresh.replace("\r", "")
        last = shown[asked:].rpartition("\n")[2]
        if re.fullmatch(r".+: ", last):
            os.write(ours, f"{technician.answer(last)}\n".encode())
            asked = len(shown)
    os.close(ours)
    return child.wait(), shown


def main() -> int:
    """Play it once."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/setup"))
    parser.add_argument("--line", type=Path, default=ROOT / "config/lines/euclid_ripple.yaml")
    parser.add_argument("--speed-m-s", type=float, default=1.016)
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    for name in ("site.yaml", "site.setup.json"):
        (out / name).unlink(missing_ok=True)
    port, socket, clock = free_port(), out / "plant.sock", MonotonicClock()
    plant = [
        *PLANT,
        "serve",
        str(options.line),
        "--modbus",
        f"127.0.0.1:{port}",
        "--control",
        str(socket),
        "--speed-m-s",
        f"{options.speed_m_s:g}",
    ]
    with Child("plant", plant, out / "plant.log", ready="ready") as running:
        begin_ns = clock.now_ns()
        technician = Technician(socket, port)
        code, shown = play([*RUNTIME, "setup", str(out / "site.yaml")], technician)
        took_s = (clock.now_ns() - begin_ns) * 1e-9
        counts = ask(socket, "status")["counts"]
        running.stop()
    (out / "console.txt").write_text(shown, encoding="utf-8")
    written = counts["writes"] + counts["foreign_writes"]
    sys.stdout.write(
        f"exit {code}, {technician.questions} questions, {took_s:.0f} s, {counts['reads']} reads, "
        f"{written} writes; {out / 'site.yaml'}\n"
    )
    return code


if __name__ == "__main__":
    sys.exit(main())
