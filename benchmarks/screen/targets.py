"""Whether a target was met: a miss is printed as one."""

from __future__ import annotations

from collections.abc import Iterable

from benchmarks.runtime.facts import Row, Section

MET, MISSED = "met", "MISSED"


def target(words: str, *bounds: tuple[float, float]) -> str:
    """Return a target with whether it was met.

    Parameters
    ----------
    words : the target itself. ``bounds`` : what was found, and the most that it may be; what is
        not known (NaN) is a miss.
    """
    is_met = all(found <= most for found, most in bounds)
    return f"target {words}: {MET if is_met else MISSED}"


def of_targets(sections: Iterable[Section]) -> Section:
    """Return how many targets were met, and which were not."""
    rows = [row for section in sections for row in section.rows]
    missed = [row for row in rows if row.remark.partition(";")[0].endswith(MISSED)]
    unknown = [row for row in rows if row.value == "not measured"]
    met = sum(row.remark.partition(";")[0].endswith(f": {MET}") for row in rows)
    found = [Row(name="met", value=str(met)), Row(name="missed", value=str(len(missed)))]
    for kind, those in (("missed", missed), ("not measured", unknown)):
        found += [Row(name=f"{kind}: {r.name}", value=r.value, remark=r.remark) for r in those]
    return Section(title="Targets", note="", rows=tuple(found))
