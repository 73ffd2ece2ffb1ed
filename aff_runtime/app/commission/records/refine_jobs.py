"""Refining for a screen: what records lack, the work, its verdict, a try of what it proposes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from aff_runtime.app.commission.link.answers import (
    Answer,
    Done,
    Printed,
    RefinedShown,
    RefiningShown,
)
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.link.talk import Talk
from aff_runtime.app.commission.paths import Paths, status_of
from aff_runtime.app.commission.records import refine_program as program
from aff_runtime.app.commission.records.refine_shelf import (
    FAILED,
    LOG,
    OUT,
    PAGE_FILE,
    PROPOSED,
    SITE_AT_BEGIN,
    Shelf,
    summary_in,
    text_in,
)
from aff_runtime.app.commission.records.run_list import paths_of, runs_folder, runs_in, windows_in
from aff_runtime.app.commission.settings.form import lines_between
from aff_runtime.app.commission.settings.jobs import ask_settings, by_screen, try_text
from aff_runtime.app.commission.views.of_refining import (
    AskedOf,
    ProposalView,
    RefinedView,
    RefiningView,
)
from aff_runtime.base.clock import wall_time_iso
from aff_runtime.base.errors import AffError, RefusedError
from aff_runtime.base.files import replace_text
from aff_runtime.base.signals import State
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.plain_file import read_plain
from aff_runtime.config.yaml_marks import MAX_BYTES

FEWEST_BESIDE_CONTROL = 4
"""With fewer processors no refinement begins while a correction goes out."""
NO_LINE = (
    "no line file: start the commissioner with --line LINE.yaml, a copy of "
    "config/lines/euclid.yaml with your rollers, web and sensors"
)
NO_PROGRAM = (
    "sim-plant is not installed whole beside this commissioner: on a gateway install.sh --plant "
    "brings it, or give the command below on another machine that has line file, site file and "
    "runs"
)
A_WINDOW = "RUN_DIR@FROM..TO"
"""Stands in a command where the reader puts a part of a run."""
NO_VERDICT = "it has come to no verdict"
NOTHING_SEEN = "the look at these windows has ended without a finding"
OTHER_SITE = (
    "the site file is another one since this refinement began: refine again, so that nothing of "
    "it is lost"
)


def refining(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return what can be chosen, what was, and what stands against refining here."""
    shelf = Shelf(where.site, where.state)
    missing, folder = list(_missing(where)), ""
    try:
        folder = str(runs_folder(where))
    except AffError as error:
        missing.append(str(error))
    runs = runs_in(Path(folder)) if folder else ()
    if folder and not runs:
        missing.append(f"{folder}: holds no run with rows yet")
    return RefiningShown(
        refining=RefiningView(
            missing=tuple(missing),
            folder=folder,
            line=str(where.line or ""),
            command=_command_line(where, folder, (A_WINDOW,), (A_WINDOW,), ()),
            runs=runs,
            lacking=shelf.lacking(),
            refined=tuple(shelf.rows()),
        )
    )


def lacks(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Look what the named parts of runs lack, before any work on them."""
    said, windows, holdout = _named(where, asked)
    _refuse_missing(where)
    folder = Shelf(where.site, where.state).look(said)
    arguments = _command(where, windows, holdout, said.without, folder / OUT)
    why = program.run([*arguments, "--lacking"], folder / LOG, talk.say)
    found = Shelf(where.site, where.state).lacking()
    if found is None:
        raise RefusedError(why or NOTHING_SEEN)
    if not found.found.can_begin:
        return Done(text="looked at; not every window can be used")
    return Done(text="looked at; every window can be used")


def refine(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Refine with the named parts of runs."""
    said, windows, holdout = _named(where, asked)
    _refuse_missing(where)
    _refuse_while_out(where)
    shelf = Shelf(where.site, where.state)
    folder = shelf.begin(said, _text(where.site))
    arguments = _command(where, windows, holdout, said.without, folder / OUT)
    talk.say(program.command_line(arguments))
    why = program.run(arguments, folder / LOG, talk.say)
    found = summary_in(folder)
    if why or found is None:
        replace_text(folder / FAILED, why or NO_VERDICT)
        raise RefusedError(why or NO_VERDICT)
    return Done(text=f"refinement {int(folder.name)}: {found.headline}")


def refined(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return one refinement, and what it would change."""
    shelf = Shelf(where.site, where.state)
    try:
        row, folder = shelf.row(asked.number), shelf.of(asked.number)
    except (OSError, ValueError):
        raise RefusedError(f"refinement {asked.number} cannot be read") from None
    site = _text(where.site)
    text = text_in(folder / OUT, PROPOSED)
    return RefinedShown(
        refined=RefinedView(
            row=row,
            summary=summary_in(folder),
            proposal=_proposal(where, site, text, text_in(folder, SITE_AT_BEGIN))
            if text
            else None,
            command=_command_line(
                where,
                str(where.runs or "RUNS"),
                row.asked.windows,
                row.asked.holdout,
                row.asked.without,
            ),
        )
    )


def page(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Return refine's own page of a refinement."""
    html = text_in(Shelf(where.site, where.state).of(asked.number) / OUT, PAGE_FILE)
    if not html:
        raise RefusedError(f"refinement {asked.number} has no page")
    return Printed(html=html)


def try_refined(where: Paths, asked: Request, talk: Talk) -> Answer:
    """Have the service run what a refinement proposes for a while; it takes it back by itself."""
    folder = Shelf(where.site, where.state).of(asked.number)
    text = text_in(folder / OUT, PROPOSED)
    if not text or text_digest(text) != asked.measured:
        return Refusal(why=Why.CHANGED)  # it is another text than the person has seen
    if _text(where.site) != text_in(folder, SITE_AT_BEGIN):
        raise RefusedError(OTHER_SITE)
    why = by_screen(asked, of=f"refinement {asked.number}")
    return try_text(where, asked, talk, text, why)


# --- what it needs ------------------------------------------------------------------------------


def _missing(where: Paths) -> Sequence[str]:
    said = []
    if where.line is None:
        said.append(NO_LINE)
    elif not where.line.is_file():
        said.append(f"{where.line}: the line file is not there; copy yours there")
    if not where.site.is_file():
        said.append(f"{where.site}: no site file is there")
    if program.program() is None:
        said.append(NO_PROGRAM)
    return said


def _refuse_missing(where: Paths) -> None:
    if missing := _missing(where):
        raise RefusedError(missing[0])


def _refuse_while_out(where: Paths) -> None:
    """Refuse hours of work beside a correction where the machine has no processor to spare."""
    count = os.cpu_count() or 1
    status = status_of(where.socket) if count < FEWEST_BESIDE_CONTROL else None
    if status is not None and status.state in (State.ARMED.name, State.ACTIVE.name):
        raise RefusedError(
            f"a correction goes out and this machine has {count} processors: bypass first, or "
            "give the command on another machine"
        )


def _named(where: Paths, asked: Request) -> tuple[AskedOf, tuple[str, ...], tuple[str, ...]]:
    """Return what was asked for, and the paths of its windows.

    Raises
    ------
    RefusedError
        A window names no run, none is to be fitted, or an effect's name is none.
    """
    windows, holdout = windows_in(asked.windows), windows_in(asked.holdout)
    without = tuple(asked.without.replace(",", " ").split())
    if not windows:
        raise RefusedError("choose at least one window to fit")
    if not all(name.isidentifier() for name in without):
        raise RefusedError("effects are left out by their names, such as roll_bounce")
    folder = runs_folder(where)
    said = AskedOf(
        windows=windows, holdout=holdout, without=without, by=asked.account, utc=wall_time_iso()
    )
    return said, paths_of(windows, folder), paths_of(holdout, folder)


def _text(site: Path) -> str:
    try:
        return read_plain(site, MAX_BYTES).decode("utf-8")
    except (OSError, ValueError):
        return ""


def _command(
    where: Paths,
    windows: Sequence[str],
    holdout: Sequence[str],
    without: Sequence[str],
    out: str | Path,
) -> tuple[str, ...]:
    """Return the arguments of ``sim-plant`` for the line and the site of this commissioner."""
    line, site = os.fspath(where.line or "LINE.yaml"), os.fspath(where.site)
    return program.command_of(line, windows, holdout, without, site=site, out=os.fspath(out))


def _command_line(
    where: Paths,
    folder: str,
    windows: Sequence[str],
    holdout: Sequence[str],
    without: Sequence[str],
) -> str:
    """Return the command that does the same elsewhere, with the paths of this machine."""

    def path(one: str) -> str:
        return one if one == A_WINDOW else f"{folder}/{one}"

    fitted, held = [path(one) for one in windows], [path(one) for one in holdout]
    return program.command_line(_command(where, fitted, held, without, "DIR"))


# --- what it proposes ---------------------------------------------------------------------------


def _proposal(where: Paths, site: str, text: str, base: str) -> ProposalView:
    changes: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    against = ""
    if site == text:
        against = "the site file says so already"
    elif site != base:
        against = OTHER_SITE
    else:
        try:
            answer = ask_settings(where, act="diff", text=text)
            changes, remarks = answer.changes, answer.remarks
        except AffError as error:
            against = str(error)
    return ProposalView(
        sha256=text_digest(text),
        changes=changes,
        remarks=remarks,
        lines=lines_between(site, text),
        against=against,
    )
