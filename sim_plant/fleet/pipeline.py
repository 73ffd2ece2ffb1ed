"""The night's work: every look refined once, one table, one page."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import PlantError
from aff_runtime.base.files import replace_text
from sim_plant.base.worker_pool import LostJobError
from sim_plant.fleet.cluster import Cluster
from sim_plant.fleet.findings import Finding, findings_of, with_trends, write_parquet
from sim_plant.fleet.looks import Look, looks_in
from sim_plant.fleet.page import write_page
from sim_plant.fleet.refine_look import LookResult, Order, refine_look

LIMIT_S = 3600.0
"""For one look: it takes one to six minutes of a core."""
TABLE, PAGE = "fleet.parquet", "fleet.html"


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetPlan:
    """Where lines and records are, where the table goes, who works; ``most`` looks at once."""

    lines: Path
    runs: Path
    out: Path
    workers: int = 2
    scheduler: str = ""
    limit_s: float = LIMIT_S
    most: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetOutcome:
    """The table, and what came of this time.

    Attributes
    ----------
    findings : rows of the table, of every look that has a result.
    lost : looks that lost every process that was given them.
    refined, waiting : looks refined this time, and looks that wait for the next.
    wall_s, each_s : from the first look given out to the last result; the mean of one look.
    """

    findings: Sequence[Finding]
    lost: Sequence[str]
    refined: int
    waiting: int
    wall_s: float
    each_s: float


def refine_fleet(plan: FleetPlan, say: Callable[[str], None]) -> FleetOutcome:
    """Refine what has no row yet, then write table and page into the plan's folder.

    Rows are written whole, one per look, as they come: what was stopped goes on from there. What
    failed is done again after all that is new: a disk may have been full.

    Raises
    ------
    PlantError
        When the folders hold no fleet or the output cannot be written.
    ClusterError
        When the cluster cannot be used.
    """
    looks = looks_in(plan.lines, plan.runs)
    out = plan.out.absolute()
    try:
        (out / "rows").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PlantError(f"--out {plan.out}: cannot be written ({error})") from error
    keys = {look: look.key for look in looks}
    kept = {look: kept_result(row_file(out, key), say) for look, key in keys.items()}
    results: dict[Look, LookResult] = {look: row for look, row in kept.items() if row is not None}
    fresh = [look for look in looks if look not in results]
    failed = [look for look, row in results.items() if row.verdict is None]
    orders = [Order(look=look, out=out / "reports" / keys[look]) for look in (*fresh, *failed)]
    todo = orders[: plan.most]
    later = f", {len(orders) - len(todo)} wait" if len(orders) > len(todo) else ""
    later += f"; {len(failed)} failed before" if failed else ""
    say(
        f"{len(looks)} looks at {len({look.line for look in looks})} lines, "
        f"{len(todo)} to refine{later}"
    )
    lost, times_s, clock = [], [], MonotonicClock()
    begun_ns = ended_ns = clock.now_ns()
    for order, result in _refined(plan, todo, say):
        if isinstance(result, LostJobError):
            lost.append(str(result))
            say(str(result))
            continue
        replace_text(row_file(out, keys[order.look]), result.to_json())
        results[order.look] = result
        times_s.append(result.time_s)
        ended_ns = clock.now_ns()
        say(f"{order}: {result.answer}, {result.time_s:.0f} s")
    done = [results[look] for look in looks if look in results]
    findings = with_trends([f for result in done for f in findings_of(result)])
    write_parquet(findings, out / TABLE)
    places = {look: f"reports/{keys[look]}/report.html" for look in looks if look in results}
    reports = {look.line: place for look, place in places.items() if (out / place).is_file()}
    write_page(findings, [result.answer for result in done], reports, out / PAGE)
    return FleetOutcome(
        findings=findings,
        lost=lost,
        refined=len(times_s),
        waiting=len(orders) - len(todo),
        wall_s=(ended_ns - begun_ns) * 1e-9,
        each_s=sum(times_s) / max(1, len(times_s)),
    )


def row_file(out: Path, key: str) -> Path:
    """Return where the row of a look lies."""
    return out / "rows" / f"{key}.json"


def kept_result(path: Path, say: Callable[[str], None]) -> LookResult | None:
    """Return what a kept row says; None where there is none, or no whole one: that is said."""
    try:
        return LookResult.from_json(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError, PlantError) as error:
        say(f"{path}: {error}; it counts as not done")
        return None


def _refined(
    plan: FleetPlan, todo: Sequence[Order], say: Callable[[str], None]
) -> Iterator[tuple[Order, LookResult | LostJobError]]:
    """Yield (order, result or what was lost) as they come."""
    if not todo:
        return
    with Cluster(
        refine_look, plan.workers, scheduler=plan.scheduler, limit_s=plan.limit_s, tell=say
    ) as cluster:
        for at, result in cluster.run(todo):
            yield todo[at], result
