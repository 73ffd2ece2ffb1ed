"""``python -m benchmarks.wizard``: the screen's wizard played on six unusual plants.

Goes on where it was stopped: a plant with a whole row in ``--out`` is not played again, one that
did not come to its end is. Some 15 min a plant on a quiet machine with two cores.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path

from aff_runtime.base.files import replace_text
from benchmarks.rows import read_row, write_row
from benchmarks.screen.pages import reason_not
from benchmarks.wizard.page import page
from benchmarks.wizard.row import KEYS, PlayedPlant, played
from sim_plant.cli.output import say
from sim_plant.demo.processes import end_as_by_hand
from sim_plant.demo.unusual_plants import PLANTS

ROOT, DOCS = Path(__file__).parents[2], "docs/results/wizard.md"
SIX = (
    "low words first",
    "pounds and feet",
    "status bits of its own",
    "no encoder",
    "heartbeat of 10 ms",
    "CAN by DBC",
)
STAGES = ("site", "active", "card")
ALL = "all"


def folder_of(out: Path, name: str) -> Path:
    """Return the folder of a plant."""
    return out / name.replace(",", "").replace(" ", "-")


def kept(out: Path, name: str) -> PlayedPlant | None:
    """Return the row of a plant; None without one."""
    return read_row(folder_of(out, name) / "row.json", KEYS)


def is_whole(row: PlayedPlant | None, to: str) -> bool:
    """Return whether a plant need not be played again to come to a stage."""
    return row is not None and "failed" not in row and f"{to}_min" in row


def main(arguments: list[str]) -> int:
    """Play what is missing, then write the page; 1 where a plant did not come to its end."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.wizard", description=__doc__)
    parser.add_argument(
        "--plant",
        action="append",
        choices=(*PLANTS, ALL),
        help=f"may be repeated ({', '.join(SIX)})",
    )
    parser.add_argument("--to", choices=STAGES, default="card", help="stage to end with (card)")
    parser.add_argument("--again", action="store_true", help="play what has a whole row, too")
    parser.add_argument("--report-only", action="store_true", help="the page of what lies there")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "wizard")
    parser.add_argument("--docs", action="store_true", help=f"write {DOCS}")
    given = parser.parse_args(arguments)
    asked = given.plant or SIX
    names = list(PLANTS) if ALL in asked else asked
    out = given.out.absolute()
    if not given.report_only:
        if reason_not():
            sys.exit(reason_not())
        end_as_by_hand()
        for name in names:
            if given.again or not is_whole(kept(out, name), given.to):
                _play(name, folder_of(out, name), given.to)
    rows = [row for name in PLANTS if (row := kept(out, name)) is not None]
    target = ROOT / DOCS if given.docs else out / "wizard.md"
    target.parent.mkdir(parents=True, exist_ok=True)
    replace_text(target, page(rows))
    say(f"page: {target}")
    return 0 if all(is_whole(kept(out, name), given.to) for name in names) else 1


def _play(name: str, folder: Path, to: str) -> None:
    """Play one plant, its row last of all."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    say(f"{name}:")
    row = played(name, folder, say, to)
    write_row(folder / "row.json", row)
    say(f"  {row.get('failed', 'good')}")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
