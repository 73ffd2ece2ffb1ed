"""One plant commissioned at its screen, from the begin to a row."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from aff_runtime.app.card.verify import verify
from aff_runtime.base.clock import MonotonicClock, wall_time_iso
from aff_runtime.base.errors import AffError, PlantError
from aff_runtime.config.loader import load_site
from benchmarks.screen.pages import PATIENCE_MS, browser
from benchmarks.setup_console.at_the_machine import StuckError
from benchmarks.setup_console.words import wrong_words
from benchmarks.wizard.answers import Answers
from benchmarks.wizard.fresh_line import FreshLine
from benchmarks.wizard.judging import card_says, judged
from benchmarks.wizard.playing import (
    Proof,
    activated,
    measured,
    probed,
    proven,
    ready_to_probe,
    rest_measured,
    signed,
    words_found,
)
from benchmarks.wizard.technician import Technician
from sim_plant.line.record_file import read_columns

PlayedPlant = dict[str, Any]
Say = Callable[[str], None]
KEYS = ("plant", "measured", "stage")
"""What every row has; ``stage`` is the last one that came to its end."""
NOTHING_ASKED: PlayedPlant = {
    "questions": 0,
    "typed": [],
    "by_enter": [],
    "by_moving": [],
    "by_manual": [],
    "wrong_words": None,
}
VIEW = {"width": 1280, "height": 800}
PATIENCE_OF_TWO = 2.0 * PATIENCE_MS


def played(name: str, out: Path, say: Say, to: str = "card") -> PlayedPlant:
    """Play one plant; return its row, with ``failed`` where it did not come to its end.

    Parameters
    ----------
    out : folder for what it leaves: the card, its PDF, pictures, logs.
    to : stage to end with: ``site``, ``active`` or ``card``.
    """
    row: PlayedPlant = {
        "plant": name,
        "measured": wall_time_iso(),
        "stage": "",
        "load": os.getloadavg(),
    }
    row |= NOTHING_ASKED
    proof: Proof | None = None
    try:
        line = FreshLine(out / "line", name)
    except PlantError as error:
        return row | {"failed": _first_line(error)}
    machine = line.answers()
    try:
        with _at_its_screen(line) as who:
            try:
                proof = _stages(who, machine, row, out, say, to)
            except Exception:
                with contextlib.suppress(Exception):
                    who.page.screenshot(path=str(out / "failed.png"), full_page=True)
                raise
    except Exception as error:
        row["failed"] = _first_line(error)
    finally:
        line.close()
    row |= _asked(machine, line)
    if proof is not None and proof.pairs:
        row["ripple"] = _ripple(line, proof)
    return row


@contextlib.contextmanager
def _at_its_screen(line: FreshLine) -> Iterator[Technician]:
    with browser() as chromium:
        context = chromium.new_context(viewport=VIEW)
        context.set_default_timeout(PATIENCE_OF_TWO)
        page = context.new_page()
        page.goto(f"{line.url}login?lang=en")
        yield Technician(page, line)
        context.close()


def _stages(
    who: Technician, machine: Answers, row: PlayedPlant, out: Path, say: Say, to: str
) -> Proof | None:
    """Play stage after stage; what is known of each is in the row at once."""
    clock = MonotonicClock()
    began_ns = clock.now_ns()

    def done(stage: str) -> None:
        minutes = (clock.now_ns() - began_ns) / 60e9
        row["stage"], row[f"{stage}_min"] = stage, minutes
        who.page.screenshot(path=str(out / f"{stage}.png"), full_page=True)
        say(f"  {stage}: {minutes:.1f} min")

    words_found(who, machine)
    done("site")
    if to == "site":
        return None
    ready_to_probe(who)
    row["probes"] = probed(who)
    activated(who)
    done("active")
    if to == "active":
        return None
    stands = measured(who)
    proof = proven(who)
    row["pairs_begun"] = proof.begun
    stands |= {12: proof.stand, **rest_measured(who)}
    row["stands"] = {str(number): stands[number] for number in sorted(stands)}
    row["signed"] = signed(who, stands)
    done("card")
    pdf = out / "card.pdf"
    who.page.pdf(path=str(pdf))
    row["pdf_bytes"] = pdf.stat().st_size
    result = verify(who.line.folder / "card", records=True)
    row["wrong_in_card"], row["entries"] = list(result.wrong), result.entries
    return proof


def _asked(machine: Answers, line: FreshLine) -> PlayedPlant:
    """Return what setup asked, how it was answered, and whether it found the PLC's words."""
    words = line.words
    wrong: list[str] | None = None
    if words is not None and line.site.exists():
        wrong = wrong_words(load_site(line.site), words)
    return {
        "questions": machine.questions,
        "typed": machine.typed,
        "by_enter": machine.by_enter,
        "by_moving": machine.by_moving,
        "by_manual": machine.by_manual,
        "wrong_words": wrong,
    }


def _ripple(line: FreshLine, proof: Proof) -> PlayedPlant:
    """Return by tension the ripple off and on at the plant, beside what the card says."""
    try:
        site = load_site(line.site)
        said = card_says(line.folder / "card")
        found = judged(read_columns(line.folder / "plant.csv.gz"), proof.pairs, site)
    except (AffError, OSError, ValueError, KeyError) as error:
        return {"failed": _first_line(error)}
    return {signal: {**one, "card_dB": said.get(signal)} for signal, one in found.items()}


def _first_line(error: Exception) -> str:
    if isinstance(error, StuckError):
        return f"the same question again and again: {error}"
    return (str(error).strip() or type(error).__name__).splitlines()[0]
