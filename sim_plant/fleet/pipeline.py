"""The night's work: every look refined once, one table, one page."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import PlantError
from sim_plant.base.worker_pool import LostJobError
from sim_plant.fleet.cluster import Cluster
from sim_plant.fleet.findings import Finding, findings_of, with_trends, write_parquet
from sim_plant.fleet.looks import Fleet, fleet_in
from sim_plant.fleet.page import write_page
from sim_plant.fleet.refine_look import LookResult, Order, refine_look
from sim_plant.fleet.rows import KeptLook, keep, of_the_table, rows_in, told

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
    out = plan.out.absolute()  # as the others: workers have working folders of their own
    rows = rows_in(out, say)
    fleet = fleet_in(plan.lines.absolute(), plan.runs.absolute(), told(rows.values()))
    try:
        (out / "rows").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PlantError(f"--out {plan.out}: cannot be written ({error})") from error
    looks, marks = fleet.looks, {look: look.mark() for look in fleet.looks}
    keys = {look: mark.key for look, mark in marks.items()}
    for look, key in keys.items():
        if key in rows and not rows[key].result.fitted:
            rows[key] = keep(out, marks[look], look, rows[key].result)
    fresh = [look for look in looks if keys[look] not in rows]
    failed = [k for k in looks if keys[k] in rows and rows[keys[k]].result.verdict is None]
    orders = [Order(look=look, out=out / "reports" / keys[look]) for look in (*fresh, *failed)]
    todo = orders[: plan.most]
    _say_what_there_is(fleet, len(todo), len(orders), len(failed), say)
    lost, times_s, clock = [], [], MonotonicClock()
    begun_ns = ended_ns = clock.now_ns()
    for order, result in _refined(plan, todo, say):
        if isinstance(result, LostJobError):
            lost.append(str(result))
            say(str(result))
            continue
        rows[keys[order.look]] = keep(out, marks[order.look], order.look, result)
        times_s.append(result.time_s)
        ended_ns = clock.now_ns()
        say(f"{order}: {result.answer}, {result.time_s:.0f} s")
    findings = _written(out, fleet, of_the_table(fleet, keys, rows))
    return FleetOutcome(
        findings=findings,
        lost=lost,
        refined=len(times_s),
        waiting=len(orders) - len(todo),
        wall_s=(ended_ns - begun_ns) * 1e-9,
        each_s=sum(times_s) / max(1, len(times_s)),
    )


def _say_what_there_is(
    fleet: Fleet, todo: int, orders: int, failed: int, say: Callable[[str], None]
) -> None:
    looks = fleet.looks
    later = f", {orders - todo} wait" if orders > todo else ""
    later += f"; {failed} failed before" if failed else ""
    lines = len({look.line for look in looks})
    say(f"{len(looks)} looks at {lines} lines, {todo} to refine{later}")
    if not looks:
        say("no line has two records yet: the table has what was told before")
    for shut in fleet.closed:
        say(f"{shut.line}: {shut.error}")


def _written(out: Path, fleet: Fleet, rows: Sequence[KeptLook]) -> list[Finding]:
    """Write table and page; return what stands there."""
    findings = with_trends([f for row in rows for f in findings_of(row.result)])
    findings += [
        Finding(line=shut.line, recorded=shut.recorded, verdict="failed", to_do=shut.error)
        for shut in fleet.closed
    ]
    write_parquet(findings, out / TABLE)
    places = {row.result.line: f"reports/{row.key}/report.html" for row in rows}
    answers = [*(row.result.answer for row in rows), *("failed" for _ in fleet.closed)]
    reports = {line: place for line, place in places.items() if (out / place).is_file()}
    write_page(findings, answers, reports, out / PAGE)
    return findings


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
