"""`aff-runtime setup` at a terminal, played by somebody who knows displays and manual alone.

``python -m benchmarks.setup_console --out out/setup`` starts the simulated line, answers every
question at a pseudo-terminal with what a display shows at that moment, and leaves
``out/setup/shipped/site.yaml``. ``--plant "low words first"`` takes another one, ``--plant all``
each of them, ``--plant none --docs`` writes the page of what lies there. With ``--card`` the
service runs on the site file: probe, arm, and the card, measured, signed, verified and printed.
``make demo SITE=...`` runs with the site file too.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.files import replace_text
from aff_runtime.config.loader import load_site
from aff_runtime.config.models.gateway import ModbusTcp
from benchmarks.setup_console.at_the_machine import StuckError
from benchmarks.setup_console.commissioning import Commissioning
from benchmarks.setup_console.page import page
from benchmarks.setup_console.plants import PLANTS
from benchmarks.setup_console.technician import Technician
from benchmarks.setup_console.terminal import play
from benchmarks.setup_console.words import wrong_words
from sim_plant.demo.processes import PLANT, RUNTIME, Child
from sim_plant.demo.unusual_plants import UnusualPlant
from sim_plant.demo.wires import free_port
from sim_plant.servers.map_file import load_plc_map

SPEED_M_S = 1.016
ROOT, DOCS = Path(__file__).parents[2], "docs/results/setup-console.md"


def say(text: str) -> None:
    """Print a line at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def commissioned(name: str, plant: UnusualPlant, out: Path, steps: str, first: int) -> bool:
    """Play one plant; return whether all of it came out.

    Parameters
    ----------
    steps : of the card: "" for none, "short" or "whole".
    first : step with which the card that is there goes on, without setup; 0: from the beginning.
    """
    out.mkdir(parents=True, exist_ok=True)
    site = out / "site.yaml"
    if not first:
        for left in (site, out / "site.setup.json"):
            left.unlink(missing_ok=True)
    plc, socket = plant.plc_map(out), out / "plant.sock"
    port = _port_of(site) if first else free_port()
    words = load_plc_map(plc)
    command = [*PLANT, "serve", str(plant.line_file(out)), "--plc", str(plc)]
    command += ["--modbus", f"127.0.0.1:{port}", "--control", str(socket)]
    command += ["--speed-m-s", f"{SPEED_M_S:g}", *([] if plant.fc23 else ["--no-fc23"])]
    clock = MonotonicClock()
    with Child("plant", command, out / "plant.log", ready="ready") as running:
        if first:
            going_on = Commissioning(out, site, socket, say)
            return going_on.card(whole=steps == "whole", first=first)
        manual = {item.name: item.address for item in words.channels}
        who = Technician(socket, port, manual, plant.answers)
        begin_ns = clock.now_ns()
        try:
            code, shown = play([*RUNTIME, "setup", str(site)], who.answer)
        except StuckError as error:
            say(f"{name}: stuck at {error}")
            return False
        took_s = (clock.now_ns() - begin_ns) * 1e-9
        (out / "console.txt").write_text(shown, encoding="utf-8")
        counts = who.status().counts
        wrong = wrong_words(load_site(site), words) if site.exists() else ["no site file"]
        row = {
            "plant": name,
            "exit": code,
            "questions": who.questions,
            "seconds": round(took_s),
            "writes": counts.writes + counts.foreign_writes,
            "wrong": wrong,
            "by_enter": who.by_enter,
            "by_moving": who.by_moving,
            "by_manual": who.by_manual,
        }
        (out / "setup.json").write_text(json.dumps(row, indent=1), encoding="utf-8")
        say(json.dumps(row))
        is_good = code == 0 and not wrong and not row["writes"]
        if is_good and steps:
            is_good = Commissioning(out, site, socket, say).card(whole=steps == "whole")
        running.stop()
    return is_good


def _port_of(site: Path) -> int:
    section = load_site(site).gateway.modbus
    assert isinstance(section, ModbusTcp)
    return section.port


def main() -> int:
    """Play the plants; 1 where one does not come out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/setup"))
    parser.add_argument("--plant", choices=(*PLANTS, "all", "none"), default="shipped")
    parser.add_argument("--card", choices=("short", "whole"), default="")
    parser.add_argument(
        "--from-step", type=int, default=0, metavar="N", help="a whole card goes on there"
    )
    parser.add_argument("--docs", action="store_true", help=f"write {DOCS}")
    options = parser.parse_args()
    names = {"all": list(PLANTS), "none": []}.get(options.plant, [options.plant])
    results = {}
    for name in names:
        folder = options.out.resolve() / name.replace(" ", "-")
        played = PLANTS[name]
        results[name] = commissioned(name, played, folder, options.card, options.from_step)
    for name, is_good in results.items():
        say(f"{name}: {'good' if is_good else 'NOT GOOD'}")
    if options.docs:
        replace_text(ROOT / DOCS, page(options.out.resolve(), list(PLANTS)))
        say(f"wrote {DOCS}")
    return 0 if all(results.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
