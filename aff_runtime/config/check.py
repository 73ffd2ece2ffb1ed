"""What a site file says and implies, found without any I/O but reading it (``check``)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from aff_runtime.base.counted_noun import counted
from aff_runtime.config.facts import Facts, facts_of
from aff_runtime.config.findings import Finding, SiteFileError, dotted, in_file_order
from aff_runtime.config.identified_drive import with_identified
from aff_runtime.config.learned_responses import LearnedResponses, learned_responses
from aff_runtime.config.loader import Reading, read_site
from aff_runtime.config.models import Site
from aff_runtime.config.site_paths import STATE_DIRECTORY
from aff_runtime.config.wire_table import budget_lines


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """What is wrong, what deserves a look, what follows; site and facts only without errors.

    ``bus`` : what one cycle costs on the wire, as lines; ``drives`` : whose numbers are in use.
    ``refused`` : what else the service does not start with, a sentence each.
    """

    file: str
    errors: tuple[Finding, ...]
    warnings: tuple[Finding, ...] = ()
    site: Site | None = None
    facts: Facts | None = None
    bus: tuple[str, ...] = ()
    drives: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Return whether the file may be used."""
        return not self.errors and not self.refused

    @property
    def exit_code(self) -> int:
        """Return 0 when the file may be used, else 2."""
        return 0 if self.ok else SiteFileError.exit_code

    def lines(self, *, brief: bool = False) -> list[str]:
        """Return the report as text, one line each: what follows, the findings, the result.

        ``brief`` : findings and result only.
        """
        lines = [] if brief or self.facts is None else [*_fact_lines(self.facts, self.bus)]
        if lines:
            lines += [*(f"drive  {text}" for text in self.drives), ""]
        lines += [f"warning  {finding}" for finding in self.warnings]
        lines += [f"error    {finding}" for finding in (*self.errors, *self.refused)]
        lines.append(f"{self.file}: {self._result()}")
        return lines

    def _result(self) -> str:
        warnings = counted(len(self.warnings), "warning")
        if self.ok:
            return f"ok, {warnings}"
        errors = counted(len(self.errors) + len(self.refused), "error")
        return f"refused, {errors}, {warnings}; the service does not start with this file"


def check_site(
    path: Path | str, speeds_m_s: Sequence[float] = (), state: Path = STATE_DIRECTORY
) -> Report:
    """Check a site file; never raises for what the file says.

    Parameters
    ----------
    path : the site file. The response files that it names are read too.
    speeds_m_s : line speeds at which frequencies are shown, above 0; none: the highest speed.
    state : folder beside the site file's own that what it names may lie in.

    Raises
    ------
    ValueError : a speed is not a finite number above 0.
    """
    if any(not math.isfinite(speed) or speed <= 0 for speed in speeds_m_s):
        raise ValueError("speeds must be finite and above 0 m/s")
    try:
        reading = read_site(path, state)
    except SiteFileError as error:
        return Report(file=str(path), errors=error.findings)
    folder = Path(path).absolute().parent
    learned = learned_responses(reading, folder)
    warnings = in_file_order((*reading.warnings, *learned.outdated, *_closed(learned, path)))
    if learned.errors:
        return Report(file=str(path), errors=in_file_order(learned.errors), warnings=warnings)
    return Report(
        file=str(path),
        errors=(),
        warnings=warnings,
        site=reading.site,
        facts=facts_of(reading.site, tuple(speeds_m_s)),
        bus=tuple(budget_lines(reading.site, folder)),
        drives=tuple(_drives(reading, learned)),
    )


def _closed(learned: LearnedResponses, path: Path | str) -> Iterator[Finding]:
    """Yield a warning per response that only another user may read, such as the service's."""
    how = f"sudo -u aff-runtime aff-runtime check {Path(path).absolute()}"
    for one in learned.closed.values():
        text = f"{one.text}: what it says is not checked; the service's user has to read it: {how}"
        yield replace(one, text=text)


def _drives(reading: Reading, learned: LearnedResponses) -> Iterator[str]:
    """Yield whose numbers each drive has; of a response that is closed to us it is not known."""
    for drive in with_identified(reading.site, learned.measured)[1]:
        is_known = (
            drive.actuator not in learned.closed
            or reading.site.actuators[drive.actuator].uses_shape
        )
        yield str(drive) if is_known else f"{drive.actuator}: not known, its response is not read"


def _fact_lines(facts: Facts, bus: tuple[str, ...]) -> Iterator[str]:
    yield (
        f"revision {facts.site_hash[:12]}; PLC word 0x{facts.site_hash[-4:]} until a response or "
        "a shape is learned, and on CAN from the start, as `status` says"
    )
    if facts.rows:
        for title, (first, words) in (("read", facts.read_block), ("write", facts.write_block)):
            yield f"{title:5} block: wire {first}..{first + words - 1}, {words} words"
        yield f"words per tick: {facts.words_per_tick}"
    yield from bus
    for row in facts.rows:
        yield f"wire {row.address:5} {row.type}  {dotted(row.path)}"
    yield from (str(order) for order in facts.orders)
    yield from (str(shape) for shape in facts.shapes)
    yield from (str(limit) for limit in facts.limits)
    yield from (f"meeting on {name}: {meeting}" for name, meeting in facts.meetings)
    yield from (f"default  {line}" for line in facts.defaults)
