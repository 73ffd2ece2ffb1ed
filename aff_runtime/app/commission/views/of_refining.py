"""What a screen is shown of refining, as frozen records.

Their names and order are those of the JSON that passes through ``commission.sock``.
"""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.base.refinement import Lacking, Summary


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRow:
    """A recorded run.

    Attributes
    ----------
    name : of its folder. ``line`` : name of the line. ``start_utc`` : when it began.
    from_s, to_s : its first row, and about its last one; None where it holds none.
    """

    name: str
    line: str
    start_utc: str
    from_s: float | None
    to_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class AskedOf:
    """What a refinement, or a look at what records lack, was asked for.

    Attributes
    ----------
    windows, holdout : parts of runs to fit and to judge on. ``without`` : effects left out.
    by : account. ``utc`` : when.
    """

    windows: tuple[str, ...]
    holdout: tuple[str, ...]
    without: tuple[str, ...]
    by: str
    utc: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LackingView:
    """What the records lack that were asked for last."""

    asked: AskedOf
    found: Lacking


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinedRow:
    """One refinement in short.

    Attributes
    ----------
    kind : of its verdict, empty without one. ``text`` : its headline, or why it has none.
    """

    number: int
    asked: AskedOf
    kind: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RefiningView:
    """Everything that the page needs before somebody chooses.

    Attributes
    ----------
    missing : what stands against refining on this machine, a sentence each.
    folder : of the runs. ``line`` : line file. ``command`` : how it is done on another machine.
    """

    missing: tuple[str, ...]
    folder: str
    line: str
    command: str
    runs: tuple[RunRow, ...]
    lacking: LackingView | None
    refined: tuple[RefinedRow, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ProposalView:
    """What a refinement would change of the site file.

    Attributes
    ----------
    sha256 : of the proposed text, which a try names.
    changes : by setting, with units, as the service has them. ``remarks`` : of its check.
    lines : of the text, with a sign before each. ``against`` : why it cannot be tried, or empty.
    """

    sha256: str
    changes: tuple[str, ...]
    remarks: tuple[str, ...]
    lines: tuple[str, ...]
    against: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinedView:
    """One refinement.

    Attributes
    ----------
    summary : None where it came to no end. ``proposal`` : None where nothing can be cancelled.
    """

    row: RefinedRow
    summary: Summary | None
    proposal: ProposalView | None
    command: str
