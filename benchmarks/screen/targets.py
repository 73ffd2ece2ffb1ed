"""Whether a target was met: a miss is printed as one."""

from __future__ import annotations

from collections.abc import Iterable

from benchmarks.runtime.facts import FactRow, Section

MET, MISSED, TOO_SHORT = "met", "MISSED", "too short to judge"


def target(words: str, *bounds: tuple[float, float], is_judged: bool = True) -> str:
    """Return a target with whether it was met.

    Parameters
    ----------
    words : the target itself. ``bounds`` : what was found, and the most that it may be; what is
        not known (NaN) is a miss. ``is_judged`` : whether it was looked at for long enough for
        all of it to be met; what is missed already is missed.
    """
    is_met = all(found <= most for found, most in bounds)
    return f"target {words}: {(MET if is_judged else TOO_SHORT) if is_met else MISSED}"


def of_targets(sections: Iterable[Section]) -> Section:
    """Return how many targets were met, and which were not."""
    rows = [row for section in sections for row in section.rows]
    met, missed, short = (
        [row for row in rows if row.remark.partition(";")[0].endswith(f": {word}")]
        for word in (MET, MISSED, TOO_SHORT)
    )
    unknown = [row for row in rows if row.value == "not measured"]
    found = [
        FactRow(name="met", value=str(len(met))),
        FactRow(name="missed", value=str(len(missed))),
    ]
    for kind, those in (("missed", missed), (TOO_SHORT, short), ("not measured", unknown)):
        found += [FactRow(name=f"{kind}: {r.name}", value=r.value, remark=r.remark) for r in those]
    return Section(title="Targets", note="", rows=tuple(found))
