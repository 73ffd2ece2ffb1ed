"""A card for a screen to show: the sentences and numbers of its printed page, without HTML."""

from __future__ import annotations

from collections.abc import Sequence

from aff_runtime.app.card.entries import CardEntry, Measured
from aff_runtime.app.card.evidence import CheckedSite, Evidence
from aff_runtime.app.card.figures import Figure
from aff_runtime.app.card.measure import proof
from aff_runtime.app.card.page import interval_text, signed_reason, unfinished, value_text
from aff_runtime.app.card.standing import SIGNABLE, Card, StepStanding
from aff_runtime.app.card.steps import Step
from aff_runtime.app.card.typed_values import TypedValues
from aff_runtime.app.commission.views.of_line import (
    CardView,
    EntryView,
    FigureView,
    ProofTimes,
    SegmentView,
    SignatureView,
    StepView,
    WindowView,
)
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.config.models import Site


def card_view(
    card: Card, checked: CheckedSite | None, answer: StatusAnswer | None, remarks: Sequence[str]
) -> CardView:
    """Return everything that a page shows of a card.

    Parameters
    ----------
    checked : the site file as it is now; None where the check refuses it.
    answer : of the running service, None where none answers.
    remarks : what is to be said of the comparison with what holds now.
    """
    return CardView(
        line=card.begun.line,
        first=card.first,
        newest=card.newest,
        entries=card.entry_count,
        utc=card.utc,
        remarks=tuple(remarks),
        undone=tuple(unfinished(card)),
        steps=tuple(_step(one, checked) for one in card.steps),
        proof=proof_times(checked.site, answer) if checked is not None and answer else None,
    )


def proof_times(site: Site, answer: StatusAnswer) -> ProofTimes | None:
    """Return how long each part of the proof takes at this speed; None while the line stands."""
    speed = abs(answer.live.tick.number(site.line.speed)) if answer.live is not None else 0.0
    if not speed > proof.SLOWEST_M_S or not proof.corrected(site):
        return None
    off_s = proof.part_s(site, speed)
    return ProofTimes(off_s=off_s, on_s=off_s + proof.settling_s(site, speed))


def _step(one: StepStanding, checked: CheckedSite | None) -> StepView:
    step, measurement, entry = one.step, one.measured, one.last
    return StepView(
        number=step.number,
        title=step.title,
        measured=step.measured,
        limit=step.limit,
        seconds=step.seconds,
        stand=str(one.stand),
        why=one.why,
        typed_names=_typed_names(step, checked),
        earlier=one.earlier,
        can_sign=one.stand in SIGNABLE and one.signed is None,
        entry=_entry(entry, measurement)
        if entry is not None and measurement is not None
        else None,
        signed=_signature(one),
    )


def _entry(entry: CardEntry, measurement: Measured) -> EntryView:
    return EntryView(
        number=entry.number,
        utc=entry.utc,
        sha256=entry.sha256,
        by=measurement.by,
        release=measurement.release,
        reason=measurement.reason,
        figures=tuple(_figure(figure) for figure in measurement.result.figures),
        waits_for=measurement.result.waits_for,
        proposals=measurement.result.proposals,
        remarks=measurement.result.remarks,
        typed=tuple(f"{typed.name} = {typed.text}" for typed in measurement.typed),
        windows=_windows(measurement),
    )


def _signature(one: StepStanding) -> SignatureView | None:
    if one.signed is None or one.signature_entry is None:
        return None
    return SignatureView(
        name=one.signed.name,
        reason=signed_reason(one.signed),
        by=one.signed.by,
        utc=one.signature_entry.utc,
        number=one.signature_entry.number,
        sha256=one.signature_entry.sha256,
    )


def _figure(figure: Figure) -> FigureView:
    return FigureView(
        name=figure.name,
        value=value_text(figure),
        span=interval_text(figure),
        limit=figure.limit,
        good=figure.good,
    )


def _windows(measurement: Measured) -> tuple[WindowView, ...]:
    return tuple(
        WindowView(
            folder=one.folder,
            from_s=one.from_s,
            to_s=one.to_s,
            segments=tuple(
                SegmentView(name=s.name, size=s.size, sha256=s.sha256) for s in one.segments
            ),
        )
        for one in measurement.windows
    )


def _typed_names(step: Step, checked: CheckedSite | None) -> tuple[str, ...]:
    if checked is None:
        return ()
    return tuple(step.typed(Evidence(checked=checked, typed=TypedValues(()))))
