"""The rows that are kept of looks: what was told stays, also of records that are there no more."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.errors import PlantError
from aff_runtime.base.files import replace_text
from sim_plant.fleet.looks import Fleet, Look, Mark, Told
from sim_plant.fleet.refine_look import LookResult


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptLook:
    """A look's result, the name of its file, and when that was written."""

    key: str
    result: LookResult
    written_ns: int


def row_file(out: Path, key: str) -> Path:
    """Return where the row of a look lies."""
    return out / "rows" / f"{key}.json"


def rows_in(out: Path, say: Callable[[str], None]) -> dict[str, KeptLook]:
    """Return every row that is kept, by its key."""
    found = {}
    for path in sorted((out / "rows").glob("*.json")):
        result = kept_result(path, say)
        if result is not None:
            written_ns = path.stat().st_mtime_ns
            found[path.stem] = KeptLook(key=path.stem, result=result, written_ns=written_ns)
    return found


def kept_result(path: Path, say: Callable[[str], None]) -> LookResult | None:
    """Return what a kept row says; None where there is none, or no whole one: that is said."""
    try:
        return LookResult.from_json(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError, PlantError) as error:
        say(f"{path}: {error}; it counts as not done")
        return None


def keep(out: Path, mark: Mark, look: Look, result: LookResult) -> KeptLook:
    """Write the row of a look, whole, by its mark of before the work; return it."""
    named, path = result.of(look, mark.declared), row_file(out, mark.key)
    replace_text(path, named.to_json())
    return KeptLook(key=mark.key, result=named, written_ns=path.stat().st_mtime_ns)


def told(rows: Iterable[KeptLook]) -> list[Told]:
    """Return which records were looked at together."""
    results = [row.result for row in rows if row.result.fitted]
    return [Told(r.line, r.fitted, r.held, r.verdict is None) for r in results]


def of_the_table(
    fleet: Fleet, keys: Mapping[Look, str], rows: Mapping[str, KeptLook]
) -> list[KeptLook]:
    """Return the rows of all lines that are there, by line and record.

    Of a look whose records are there it is the row of these records and this line file. Where one
    is there no more, its last row stays that has a verdict.
    """
    now = [rows[key] for key in keys.values() if key in rows]
    there = {look.pair for look in keys}
    gone: dict[tuple[str, str, str], KeptLook] = {}
    for row in sorted(rows.values(), key=lambda row: (row.written_ns, row.key)):
        found = row.result
        pair = (found.line, found.fitted, found.held)
        if found.line in fleet.lines and found.fitted and found.verdict and pair not in there:
            gone[pair] = row
    return sorted((*now, *gone.values()), key=_place)


def _place(row: KeptLook) -> tuple[str, str, str]:
    return row.result.line, row.result.fitted, row.result.held
