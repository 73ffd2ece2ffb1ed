"""What the commissioner says, in the reader's language."""

from __future__ import annotations

from aff_hmi.commission.sentences import sentence
from aff_hmi.words import N_, Say
from aff_runtime.app.commission.messages import WORDS, Told, Why

STANDS = {
    "not done": ("—", N_("not done")),
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
}


def refusal_in(told: Told, say: Say) -> str:
    """Return why something was not done."""
    why = Why(told["why"]) if told.get("why") in tuple(Why) else Why.SILENT
    name = str(told.get("name", ""))
    if why is Why.REFUSED:
        return sentence(name, say)
    called = say(JOBS[name.split(" ", maxsplit=1)[0]]) if why is Why.RUNNING else name
    return say(WORDS[why]).replace("{name}", called)


def card_in(card: Told, say: Say) -> Told:
    """Return a card whose steps are told in the reader's language.

    Figures, remarks and signatures stay as they are on the card: that is what was signed.
    """
    return card | {"steps": [_step(one, say) for one in card["steps"]]}


def _step(one: Told, say: Say) -> Told:
    mark, word = STANDS[one["stand"]]
    said = {key: say(one[key]) for key in ("title", "measured", "limit")}
    return one | said | {"mark": mark, "stand_word": say(word)}


# what a probe finds of a drive: its words, its unit
FOUND = {
    "speed_gain_rad_s": (N_("speed gain"), "rad/s"),
    "integral_time_s": (N_("integral time"), "s"),
    "inertia_kg_m2": (N_("inertia with the web"), "kg m²"),
    "friction_N_m_s": (N_("friction"), "N m s"),
    "delay_s": (N_("delay to the drive"), "s"),
    "stiffness_N_m": (N_("stiffness of the web"), "N/m"),
}


def line_in(line: Told, say: Say) -> Told:
    """Return what is known of a line in the reader's language."""
    responses = []
    for one in line["responses"]:
        drive = [
            row | {"name": say(FOUND[row["name"]][0]), "unit": FOUND[row["name"]][1]}
            for row in one["drive"]
        ]
        responses.append(one | {"drive": drive})
    return line | {"responses": responses}


def state_in(told: Told, say: Say, *, sees_all: bool) -> Told:
    """Return how the commissioner stands, for one reader.

    Parameters
    ----------
    sees_all : whether he may commission; others see no answers and no site file.
    """
    job, last = told["job"], told["last"]
    shown = dict(told)
    if job is not None:
        shown["job"] = _job(job, say) if sees_all else {"do": job["do"], "said": [], "ask": None}
        shown["job"]["name"] = say(JOBS[job["do"]])
    if last is not None:
        text = sentence(last["text"], say) if sees_all else ""
        shown["last"] = last | {"name": say(JOBS[last["do"]]), "text": text}
    if not sees_all:
        shown["site"] = {"there": told["site"]["there"]}
    return shown


def _job(job: Told, say: Say) -> Told:
    said = [one | {"text": sentence(one["text"], say)} for one in job["said"]]
    asked = job["ask"]
    if asked is not None:
        rows = [[value, sentence(text, say)] for value, text in asked["rows"]]
        choices = [[value, say(CHOICES.get(value, value))] for value in asked["choices"]]
        asked = asked | {"text": sentence(asked["text"], say), "rows": rows, "choices": choices}
    return job | {"said": said, "ask": asked}


CHOICES = {
    "yes": N_("yes"),
    "no": N_("no"),
    "none": N_("none"),
    "skip": N_("skip"),
    "again": N_("another moment"),
    "find": N_("find"),
}
