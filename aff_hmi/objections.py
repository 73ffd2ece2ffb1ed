"""What stands against arming, in the reader's language: the sentences of law and guard.

The service says them in English with names and figures in them. A sentence that is none of these
is shown as it was said.
"""

from __future__ import annotations

import re
from functools import cache

from aff_hmi.words import N_, Say, figures_in

PROBE = N_("run the probe with the line at its speed: page Commissioning, or aff-runtime probe")
PROBE_HERE = N_("probe at this speed and radius")
SITE_FILE = N_("correct the site file")
# the sentence, and what to do about it
SENTENCES = {
    N_("no measured response; run the probe"): PROBE,
    N_("no order of {roll} has a sure response; run the probe"): PROBE,
    N_("{order}: its roll does not turn, or its angle is not known"): N_(
        "start the line; where it runs, look at the angle of that roll"
    ),
    N_("{order}: {f} Hz is outside the probed {low}..{high} Hz"): PROBE_HERE,
    N_("{order}: phase error at {f} Hz may reach {error} deg"): PROBE_HERE,
    N_("{order}: coherence {coherence} near {f} Hz is too low"): PROBE_HERE,
    N_("{order}: {f} Hz is above the {limit} Hz of the plain law at a cycle of {ms} ms"): N_(
        "shorten cycle_ms, run slower or take out that order"
    ),
    N_(
        "{order}: {f} Hz is above the {limit} Hz of the plain law, which stands in, at a cycle of "
        "{ms} ms"
    ): N_(
        "identify the drive by a probe or declare it, else shorten cycle_ms, run slower or take "
        "out that order"
    ),
    N_("{order}: {f} Hz is too fast to be learned from a reading every {ms} ms"): N_(
        "run slower, leave that order out of the site file, or take law: blocks"
    ),
    N_("{roll}: its angle is lost"): N_("look at that roll's encoder and at its speed channel"),
    N_(
        "{roll}: {angle} counts against the line's speed; turn the sign of its scale, "
        "or that of the speed"
    ): SITE_FILE,
    N_(
        "{roll}: {angle} turns {ratio} times as fast as speed over radius; mend its scale "
        "(counts per turn of the roll, gear), the radius or the channel"
    ): SITE_FILE,
}
LONGEST = 300
"""Characters of a reason that are read: the longest sentence, with names of 60 characters."""
MORE = N_("and {count} more")
PREFIXED = "{actuator}: "
"""How a sentence of the law begins: with the actuator that it is about."""
BY_GUARD = {
    N_("REMOTE=1: the PLC arms, by its reset"): N_("arm at the PLC, or turn its key to local"),
    "SHADOW=1": N_("end shadow operation: page Timing and rights, or aff-runtime shadow off"),
}


def translated(blocked: str, say: Say) -> tuple[str, str] | None:
    """Return an objection and what to do about it; None for a sentence that is not known.

    Parameters
    ----------
    blocked : one reason against arming as the service says it: a sentence of the guard as it is
        (``SHADOW=1``), one of the law behind its actuator (``unwind: ...``), or at the end of a
        long list how many more there are (``and 3 more``).
    """
    more = _pattern(MORE).fullmatch(blocked)
    if more is not None:
        return say(MORE).format(count=more["count"]), say(N_("clear those that are listed first"))
    if blocked in BY_GUARD:
        return say(blocked), say(BY_GUARD[blocked])
    for sentence, to_do in SENTENCES.items():
        # the service says some with what to do behind them: a console shows nothing else
        said = blocked.removesuffix(f"; {to_do}")
        found = _pattern(PREFIXED + sentence).fullmatch(said)
        if found is not None:
            named = found.groupdict()
            actuator = named.pop("actuator")
            told = {name: figures_in(value, say) for name, value in named.items()}
            return f"{actuator}: {say(sentence).format(**told)}", say(to_do)
    return None


@cache
def _pattern(sentence: str) -> re.Pattern[str]:
    """Return what finds a sentence with something in the place of each ``{name}``."""
    parts = re.split(r"\{(\w+)\}", sentence)
    texts = [f"(?P<{part}>.+?)" if i % 2 else re.escape(part) for i, part in enumerate(parts)]
    return re.compile("".join(texts), re.DOTALL)
