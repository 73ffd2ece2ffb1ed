"""A card as plain values, for a screen to show: the words of its page, none of its marks."""

from __future__ import annotations

import math
from collections.abc import Sequence

from aff_runtime.app.card.entries import Measured
from aff_runtime.app.card.evidence import CheckedSite, Evidence
from aff_runtime.app.card.figures import Figure
from aff_runtime.app.card.page import span_text, undone, value_text
from aff_runtime.app.card.standing import SIGNABLE, Card, StepStanding
from aff_runtime.app.card.steps import Step
from aff_runtime.app.card.typed_values import TypedValues
from aff_runtime.app.commission.messages import Told
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.config.models import Site

TURNS, SETTLES, MEMORIES = 20.0, 3.0, 2.0


def card_view(
    card: Card, checked: CheckedSite | None, answer: StatusAnswer | None, remarks: Sequence[str]
) -> Told:
    """Return everything that a page shows of a card.

    Parameters
    ----------
    checked : the site as it lies there now; None where it is not good.
    answer : of the running service, None where none answers.
    remarks : what is to be said of the comparison with what holds now.
    """
    return {
        "line": card.begun.line,
        "newest": card.newest,
        "entries": card.entries,
        "utc": card.utc,
        "remarks": list(remarks),
        "undone": list(undone(card)),
        "steps": [_step(one, checked) for one in card.steps],
        "proof": proof_times(checked.site, answer) if checked is not None and answer else None,
    }


def proof_times(site: Site, answer: StatusAnswer) -> dict[str, float] | None:
    """Return how long each part of the proof takes at this speed, s; None while it stands.

    ``off_s`` : twenty turns of the largest roll. ``on_s`` : the same, after it has settled.
    """
    speed = abs(answer.live.tick.number(site.line.speed)) if answer.live is not None else 0.0
    radius_m = max(roll.largest_radius_m for roll in site.rolls.values())
    if not speed > 0.0:
        return None
    turn_s = math.tau * radius_m / speed
    settles = [0.0]
    for one in site.actuators.values():
        if one.uses_shape:
            settles.append(MEMORIES * one.memory_turns * turn_s)
        else:
            settles += [SETTLES * block.settle_s for block in one.blocks]
    return {"off_s": TURNS * turn_s, "on_s": TURNS * turn_s + max(settles)}


def _step(one: StepStanding, checked: CheckedSite | None) -> Told:
    step, said, entry = one.step, one.measured, one.last
    view: Told = {
        "number": step.number,
        "title": step.title,
        "measured": step.measured,
        "limit": step.limit,
        "seconds": step.seconds,
        "stand": str(one.stand),
        "why": list(one.why),
        "typed_names": _typed_names(step, checked),
        "earlier": one.earlier,
        "can_sign": one.stand in SIGNABLE and one.signed is None,
        "entry": None,
        "signed": None,
    }
    if said is None or entry is None:
        return view
    view["entry"] = {
        "number": entry.number,
        "utc": entry.utc,
        "sha256": entry.sha256,
        "by": said.by,
        "release": said.release,
        "reason": said.reason,
        "figures": [_figure(figure) for figure in said.finding.figures],
        "missing": list(said.finding.waits_for),
        "proposals": list(said.finding.proposals),
        "remarks": list(said.finding.remarks),
        "typed": [f"{typed.name} = {typed.text}" for typed in said.typed],
        "windows": _windows(said),
    }
    if one.signed is not None and one.signature is not None:
        view["signed"] = {
            "name": one.signed.name,
            "reason": one.signed.reason,
            "by": one.signed.by,
            "utc": one.signature.utc,
            "number": one.signature.number,
            "sha256": one.signature.sha256,
        }
    return view


def _figure(figure: Figure) -> Told:
    return {
        "name": figure.name,
        "value": value_text(figure),
        "span": span_text(figure),
        "limit": figure.limit,
        "good": figure.good,
    }


def _windows(said: Measured) -> list[Told]:
    return [
        {
            "folder": one.folder,
            "from_s": one.from_s,
            "to_s": one.to_s,
            "segments": [
                {"name": s.name, "size": s.size, "sha256": s.sha256} for s in one.segments
            ],
        }
        for one in said.windows
    ]


def _typed_names(step: Step, checked: CheckedSite | None) -> list[str]:
    if checked is None:
        return []
    return list(step.typed(Evidence(checked=checked, typed=TypedValues(()))))
