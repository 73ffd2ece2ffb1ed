"""What the commissioner says, in the reader's language."""

from __future__ import annotations

from dataclasses import replace

from aff_hmi.commission.choices import called, with_buttons
from aff_hmi.commission.sentences import parts, sentence
from aff_hmi.commission.shown import (
    JobInShort,
    ShownDriveRow,
    ShownJob,
    ShownLast,
    ShownLine,
    ShownQuestion,
    ShownState,
    ShownStep,
    SiteInShort,
)
from aff_hmi.commission.typed_words import wanted
from aff_hmi.words import N_, Say, figures_in
from aff_runtime.app.card.standing import Stand, is_finished
from aff_runtime.app.commission.link.answers import State
from aff_runtime.app.commission.link.messages import WORDS, Refusal, Why
from aff_runtime.app.commission.views.of_line import (
    CardView,
    DriveRow,
    JobView,
    LastJob,
    LineView,
    NoService,
    QuestionView,
    SaidLine,
    ServiceView,
    StepView,
)

STANDS = {
    "not measured": ("—", N_("not measured")),
    "open": ("…", N_("open")),
    "again": ("↻", N_("again")),
    "fail": ("✗", N_("fail")),
    "pass": ("✓", N_("pass")),
    "not applicable": ("n/a", N_("not applicable")),
}
JOBS = {
    "begin": N_("begin the card"),
    "step": N_("measure a step"),
    "sign": N_("sign a step"),
    "verify": N_("verify the card"),
    "try": N_("try what is proposed"),
    "keep": N_("keep what is tried"),
    "undo": N_("take back what is tried"),
    "words": N_("find the PLC's words"),
    "lacks": N_("see what the windows lack"),
    "refine": N_("refine"),
    "try_refined": N_("try what refine proposes"),
    "add_runs": N_("read new runs"),
    "exchange": N_("note an exchange"),
    "try_settings": N_("try other settings"),
    "save_settings": N_("save other settings"),
    "go_back": N_("go back to a version"),
}
# what a probe identifies of a drive: its words, its unit
DRIVE_NUMBERS = {
    "speed_gain_rad_s": (N_("speed gain"), "rad/s"),
    "integral_time_s": (N_("integral time"), "s"),
    "inertia_kg_m2": (N_("inertia with the web"), "kg m²"),
    "friction_N_m_s": (N_("friction"), "N m s"),
    "delay_s": (N_("delay to the drive"), "s"),
    "stiffness_N_m": (N_("stiffness of the web"), "N/m"),
}


def refusal_in(refusal: Refusal, say: Say) -> str:
    """Return why something was not done."""
    why = Why(refusal.why) if refusal.why in tuple(Why) else Why.SILENT
    if why is Why.REFUSED:
        return sentence(refusal.name, say)
    is_job = why is Why.RUNNING
    called = say(JOBS[refusal.name.split(" ", maxsplit=1)[0]]) if is_job else refusal.name
    return say(WORDS[why]).replace("{name}", called)


def card_in(card: CardView, say: Say) -> CardView:
    """Return a card whose steps are told in the reader's language.

    A step's figures, remarks and signatures stay as they are on the card: that is what was signed.
    """
    return replace(
        card,
        steps=tuple(_step(one, say) for one in card.steps),
        remarks=tuple(sentence(text, say) for text in card.remarks),
        undone=tuple(
            _undone(one, say)
            for one in card.steps
            if not is_finished(one.stand, is_signed=one.signed is not None)
        ),
    )


def _undone(one: StepView, say: Say) -> str:
    """Return what is left to do of a step, as ``app.card.page.unfinished`` says it in English.

    It is put together again and not found by a pattern: titles have commas and colons in them.
    """
    _, word = STANDS[one.stand]
    stand = say(word)
    if one.stand in (Stand.PASS, Stand.NOT_APPLICABLE):
        stand = say(N_("{stand}, not signed")).replace("{stand}", stand)
    why = [*one.why]
    if one.stand == Stand.OPEN and one.entry is not None:
        why += one.entry.waits_for
    said = say(N_("step {number}, {title}: {stand}")).replace("{number}", str(one.number))
    said = said.replace("{title}", say(one.title)).replace("{stand}", stand)
    reasons = "; ".join(figures_in(sentence(text, say), say) for text in why)
    return f"{said} ({reasons})" if why else said


def _step(one: StepView, say: Say) -> ShownStep:
    mark, word = STANDS[one.stand]
    return ShownStep(
        number=one.number,
        title=say(one.title),
        measured=say(one.measured),
        limit=say(one.limit),
        seconds=one.seconds,
        stand=one.stand,
        why=tuple(sentence(text, say) for text in one.why),
        typed_names=one.typed_names,
        earlier=one.earlier,
        can_sign=one.can_sign,
        entry=one.entry,
        signed=one.signed,
        mark=mark,
        stand_word=say(word),
        typed_labels=tuple(wanted(one.number, name, say) for name in one.typed_names),
    )


def line_in(line: LineView, say: Say) -> LineView:
    """Return what is known of a line in the reader's language."""
    return replace(
        line,
        orders=tuple(sentence(text, say) for text in line.orders),
        limits=tuple(sentence(text, say) for text in line.limits),
        drives=tuple(sentence(text, say) for text in line.drives),
        responses=tuple(
            replace(
                one,
                drive=tuple(_drive_row(row, say) for row in one.drive),
                no_drive=sentence(one.no_drive, say),
            )
            for one in line.responses
        ),
    )


def _drive_row(row: DriveRow, say: Say) -> ShownDriveRow:
    words, unit = DRIVE_NUMBERS[row.name]
    return ShownDriveRow(
        name=say(words),
        value=row.value,
        low=row.low,
        high=row.high,
        is_sure=row.is_sure,
        unit=unit,
    )


def state_in(state: State, say: Say, *, sees_all: bool, is_open: bool) -> ShownState:
    """Return how the commissioner stands, for one reader.

    Parameters
    ----------
    sees_all : whether he may commission; others see no answers and no site file.
    is_open : whether his session does.
    """
    return ShownState(
        protocol=state.protocol,
        by=state.by,
        site=state.site if sees_all else SiteInShort(there=state.site.there),
        service=_service(state.service, say),
        card=state.card,
        job=_job(state.job, say, sees_all=sees_all) if state.job is not None else None,
        last=_last(state.last, say, sees_all=sees_all) if state.last is not None else None,
        long=_job(state.long, say, sees_all=sees_all) if state.long is not None else None,
        long_last=_last(state.long_last, say, sees_all=sees_all)
        if state.long_last is not None
        else None,
        is_open=is_open,
        may=sees_all,
        left_s=_left_s(state.service),
    )


def _service(service: NoService | ServiceView, say: Say) -> NoService | ServiceView:
    if not service.answers:
        return replace(service, trouble=sentence(service.trouble, say))
    return replace(
        service, probed=parts(service.probed, say), trying=sentence(service.trying, say)
    )


def _left_s(service: NoService | ServiceView) -> int | None:
    """Return the seconds of a try that are left; None while none are counted."""
    if not service.answers or service.trying_left_s < 0.0:
        return None
    return round(service.trying_left_s)


def _job(job: JobView, say: Say, *, sees_all: bool) -> ShownJob | JobInShort:
    name = say(JOBS[job.do])
    if not sees_all:
        return JobInShort(do=job.do, name=name, seconds=job.seconds)
    return ShownJob(
        do=job.do,
        step=job.step,
        said=tuple(_line(one, say) for one in job.said),
        ask=_question(job.ask, say) if job.ask is not None else None,
        name=name,
        seconds=job.seconds,
    )


def _line(one: SaidLine, say: Say) -> ShownLine:
    said = sentence(one.text, say)
    return ShownLine(kind=one.kind, text=said, lang="en" if said == one.text else "")


def _question(asked: QuestionView, say: Say) -> ShownQuestion:
    return ShownQuestion(
        number=asked.number,
        name=asked.name,
        text=with_buttons(sentence(asked.text, say), asked.choices, say),
        default=asked.default,
        choices=tuple((value, called(value, say)) for value in asked.choices),
        rows=tuple((value, sentence(text, say)) for value, text in asked.rows),
    )


def _last(last: LastJob, say: Say, *, sees_all: bool) -> ShownLast:
    text = sentence(last.text, say) if sees_all else ""
    return ShownLast(do=last.do, step=last.step, ok=last.ok, text=text, name=say(JOBS[last.do]))
