"""Six weeks of runs of the simulated line, and what watch says of them against what the plant had.

python -m tests.aff_runtime.app.report.watching.weeks [--docs] [--out DIR]

Every day plant, PLC and runtime run in virtual time, AFF on with a block for idler R6, and the
recorder's own folder is written: 23 s after R6 was learned and a few rows from the end of ten
hours, as the bound on the disk leaves it. R6's eccentricity grows with the web that ran, differs
from day to day, and is another one from the day of the exchange on. Every evening the store takes
the run. Runs are kept in DIR: a command that was stopped goes on. Ten seconds of one core a day.
"""

import argparse
import math
import shutil
import sys
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

from aff_runtime.app.report.watching.findings import findings
from aff_runtime.app.report.watching.run_hours import run_hours
from aff_runtime.app.report.watching.sentences import notes
from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.trend import slope
from tests.doubles.recorded_run import RecordedRun, files

COMMAND = "python -m tests.aff_runtime.app.report.watching.weeks --docs"
PAGE = Path("docs/results/watch-weeks.md")
BEGAN = datetime(2026, 1, 5, 6, tzinfo=UTC)
DAYS, EXCHANGED = 42, 28
DAY_S, OFF_S, LEARNS_S, ON_S = 36_000.0, 1.0, 14.0, 23.0
KM_A_DAY = 1e-3 * DAY_S
"""At 1 m/s."""
FIRST_M, NEXT_M, GROWS_M_KM, SCATTER_M = 1e-4, 6e-5, 16e-9, 1e-6
"""Eccentricity of the one idler and the next, its growth, and how days differ (sd)."""
LIMIT_SHARE = 1.35
"""The limit that is asked about: so many times the first evening's stroke."""
REDRAWN = 2000
SEED, OTHER_SEEDS = 1, (2, 3, 4, 5)
"""Of the one draw of all days; of further draws of the new roller's."""


@dataclass(frozen=True)
class Evening:
    """What was said on the evening of a day."""

    day: int
    found: list
    said: list


def eccentricities_m(seed=SEED):
    """Return what the plant has, day by day; the mean of a day, and that with its scatter."""
    off = SCATTER_M * np.random.default_rng(seed).standard_normal(DAYS)
    days = np.arange(DAYS)
    since = np.where(days < EXCHANGED, days, days - EXCHANGED)
    mean = np.where(days < EXCHANGED, FIRST_M, NEXT_M) + GROWS_M_KM * KM_A_DAY * since
    return mean, mean + off


def angle_rad(day, seed=SEED):
    """Return where the eccentricity stands when a day begins: anywhere."""
    return float(np.random.default_rng([seed, day]).uniform(0.0, math.tau))


def write_day(folder, day, size_m, seed=SEED):
    """Write the run of a day; what is there is not made again."""
    runs, shape = (
        folder / f"day-{day:02d}",
        {"eccentricity_m": float(size_m), "angle_rad": angle_rad(day, seed)},
    )
    done = sorted(runs.glob("*/summary.json"))
    if done:
        return done[0].parent
    shutil.rmtree(runs, ignore_errors=True)
    runs.mkdir(parents=True)
    effect = {"effect": "eccentric_roller", "location": "R6", "parameters": shape}
    begun = (BEGAN + timedelta(days=day)).isoformat()
    run = RecordedRun(
        files(runs, [effect]),
        runs,
        law_too=True,
        segment_s=60.0,
        start_utc=begun,
        seed=100 * seed + day,
    )
    run.recording = False
    run.bench.run(OFF_S)
    run.bench.arm(LEARNS_S)
    run.recording = True
    run.bench.run(ON_S)
    run.goes_on_until(DAY_S)
    return run.end()


def stroke_of(found):
    """Return the finding about R6's stroke."""
    return next(
        f for f in found if (f.readings.roll, f.readings.quantity.name) == ("r6", "stroke_m")
    )


def evenings(folder):
    """Return the store, and every evening."""
    store, found, limit = Store(), [], {}
    for day, size_m in enumerate(eccentricities_m()[1]):
        store.add(run_hours(write_day(folder, day, size_m)))
        now = findings(store, limit)
        if not limit:
            limit = {("r6", "m"): LIMIT_SHARE * float(stroke_of(now).readings.size[0])}
            now = findings(store, limit)
        found.append(Evening(day, now, list(notes(now))))
        print(
            f"day {day}: R6 {1e6 * size_m:.1f} um; {'; '.join(found[-1].said) or '-'}", flush=True
        )
    return store, found, limit


def other_draws(folder):
    """Return the finding of the new roller's days in each further draw of days and noise."""
    found = []
    for seed in OTHER_SEEDS:
        store, had_m = Store(), eccentricities_m(seed)[1]
        for day in range(EXCHANGED, DAYS):
            store.add(run_hours(write_day(folder / f"seed-{seed}", day, had_m[day], seed)))
        found.append(stroke_of(findings(store, {})))
    return found


@dataclass(frozen=True)
class Redrawn:
    """What trends through days say that are drawn again from how far all days were off.

    ``correlation`` of neighbours and ``sd_m`` of what readings were off; ``spread`` of the slopes,
    their standard deviation; ``half`` of the intervals, in the middle; ``holds`` : share of them;
    ``as_far`` : share of slopes that are as far off as the one asked about.
    """

    correlation: float
    sd_m: float
    spread: float
    half: float
    holds: float
    as_far: float


def redrawn(off_m, error_m, gain, far):
    """Return what ``REDRAWN`` draws of the new roller's days say.

    ``off_m``, ``error_m`` : per draw of days what its readings were off, and their own errors; a
    day that is drawn has a scatter of its own too. ``far`` : how far off a slope is asked about.
    """
    rng = np.random.default_rng(0)
    every, errors = np.concatenate(off_m), np.concatenate(error_m)
    place = KM_A_DAY * np.arange(DAYS - EXCHANGED)
    lines = []
    for _ in range(REDRAWN):
        days = rng.integers(every.size, size=place.size)
        own = gain * SCATTER_M * rng.standard_normal(place.size)
        lines.append(slope(place, 1e-4 + every[days] + own, errors[days]))
    value = np.array([line.value for line in lines])
    pairs = np.concatenate([np.stack([one[:-1], one[1:]]) for one in off_m], axis=1)
    return Redrawn(
        correlation=float(np.sum(pairs[0] * pairs[1]) / np.sum(every**2)),
        sd_m=float(np.std(every)),
        spread=float(np.std(value)),
        half=float(np.median([0.5 * (line.high - line.low) for line in lines])),
        holds=float(np.mean([line.low <= 0.0 <= line.high for line in lines])),
        as_far=float(np.mean(np.abs(value) >= abs(far))),
    )


def expected_day(scatter_m):
    """Return the first day on which 4 sigma of a slope through the days are below the growth.

    ``scatter_m``: of the days, as an eccentricity.
    """
    for count in range(8, DAYS):
        days = np.arange(count)
        error = scatter_m / math.sqrt(float(np.sum((days - days.mean()) ** 2)))
        sigma = 4.0 + (4.0**3 + 4.0) / (4.0 * (count - 2))  # Student's, first order
        if sigma * error < GROWS_M_KM * KM_A_DAY:
            return count - 1
    return DAYS


def report(folder):
    """Return the page, and whether everything held."""
    store, all_, limit = evenings(folder)
    mean_m, had_m = eccentricities_m()
    last = stroke_of(all_[EXCHANGED - 1].found)
    ratio = last.readings.size / had_m[:EXCHANGED]
    gain, spread = float(np.mean(ratio)), float(np.std(ratio, ddof=1) / np.mean(ratio))
    scatter_m = math.hypot(SCATTER_M, spread * float(np.mean(had_m[:EXCHANGED])))
    by_4_sigma, line = expected_day(scatter_m), last.per_km
    own = GROWS_M_KM * gain  # what the plant's growth is as a stroke
    told = next((e.day for e in all_ if any("r6 1x stroke grows" in s for s in e.said)), None)
    asked = next((e.day for e in all_ if any("jumped" in s for s in e.said)), None)
    true_weeks = (limit["r6", "m"] / gain - mean_m[EXCHANGED - 1]) / (GROWS_M_KM * KM_A_DAY) / 7.0
    weeks = last.weeks or (math.nan,) * 3
    others = sorted({s for e in all_ for s in e.said if not s.startswith("r6 ")})
    store.exchange("r6", BEGAN.replace(hour=0) + timedelta(days=EXCHANGED), "worn")
    new_found = stroke_of(findings(store, limit))
    new = new_found.per_km
    others_found = other_draws(folder)
    others_new = [one.per_km for one in others_found]
    seen = [(last, had_m[:EXCHANGED]), (new_found, had_m[EXCHANGED:])]
    seen += [
        (one, eccentricities_m(seed)[1][EXCHANGED:])
        for one, seed in zip(others_found, OTHER_SEEDS, strict=True)
    ]
    again = redrawn(
        [one.readings.size - gain * had for one, had in seen],
        [one.readings.error for one, _ in seen],
        gain,
        new.value - own,
    )
    um = 1e9  # m a km as um per 1000 km
    rows = [
        (
            f"growth on the evening of day {EXCHANGED - 1}, stroke in um per 1000 km",
            f"{um * own:.2f}; of the days as drawn {um * gain * _drawn(had_m[:EXCHANGED]):.2f}",
            _interval(um, line),
            line.low <= own <= line.high,
        ),
        (
            "first evening that tells it",
            f"day {by_4_sigma} by 4 sigma of {1e6 * scatter_m:.1f} um a day",
            f"day {told}",
            told is not None and abs(told - by_4_sigma) <= 6,
        ),
        (
            f"weeks from there to {1e6 * limit['r6', 'm']:.0f} um of stroke",
            f"{true_weeks:.1f}",
            f"{weeks[0]:.1f} ({weeks[1]:.1f} to {weeks[2]:.1f})",
            weeks[1] <= true_weeks <= weeks[2],
        ),
        (
            "exchange asked about",
            f"on day {EXCHANGED}",
            f"on the evening of day {asked}",
            asked is not None and 0 <= asked - EXCHANGED <= 5,
        ),
        (
            f"growth of the new one after {DAYS - EXCHANGED} days, um per 1000 km",
            f"{um * own:.2f}; of the days as drawn {um * gain * _drawn(had_m[EXCHANGED:]):.2f}",
            _interval(um, new),
            new.low <= own <= new.high,
        ),
        (
            f"the same in {len(others_new)} further draws of days and noise",
            f"{um * own:.2f} in each",
            "; ".join(_interval(um, line) for line in others_new)
            + f"; mean of all {len(others_new) + 1} "
            + f"{um * float(np.mean([line.value for line in (new, *others_new)])):.2f}",
            all(line.low <= own <= line.high for line in others_new),
        ),
        (
            f"of {REDRAWN} trends through {DAYS - EXCHANGED} days drawn from all of them",
            "95 % of the intervals are to hold it",
            f"{100 * again.holds:.1f} % hold it",
            0.94 <= again.holds <= 0.99,
        ),
        ("notes about other rollers, response or drive", "0", f"{len(others)}", not others),
    ]
    table = "\n".join(f"| {a} | {b} | {c} | {'yes' if ok else 'no'} |" for a, b, c, ok in rows)
    sentence = {
        "told": next((s for e in all_ if e.day == told for s in e.said if "grows" in s), "-"),
        "before": next((s for s in all_[EXCHANGED - 1].said if "grows" in s), "-"),
        "asked": next((s for e in all_ if e.day == asked for s in e.said if "jumped" in s), "-"),
    }
    text = HEAD.format(
        command=COMMAND,
        gain=gain,
        spread=100 * spread,
        table=table,
        days=sum(had.size for _, had in seen),
        off=1e6 * again.sd_m,
        own=1e6 * float(np.mean(np.concatenate([one.readings.error for one, _ in seen]))),
        correlation=again.correlation,
        sigma=um * again.spread,
        half=um * again.half,
        far=um * abs(new.value - own),
        sigmas=abs(new.value - own) / again.spread,
        as_far=100 * again.as_far,
        **sentence,
    )
    text += "".join(f"- {one}\n" for one in others)
    return text, all(ok for *_, ok in rows)


def _drawn(had_m):
    """Return the slope of what the plant had with its scatter, day by day, m per km."""
    return float(np.polyfit(KM_A_DAY * np.arange(had_m.size), had_m, 1)[0])


def _interval(um, line):
    return f"{um * line.value:.2f} ({um * line.low:.2f} to {um * line.high:.2f})"


HEAD = f"""# Six weeks of runs, and what `watch` says of them

Repeat: `{{command}}`.
Plant, PLC and runtime in virtual time, a run folder a day for {DAYS} days, AFF on all along with a
block for idler R6. The plant's R6 begins at {1e6 * FIRST_M:.0f} um off centre and grows by
{1e9 * GROWS_M_KM:.0f} um per 1000 km of web ({KM_A_DAY:.0f} km a day); from day to day it differs
by {1e6 * SCATTER_M:.0f} um (sd), in an angle of its own; on day {EXCHANGED} another of
{1e6 * NEXT_M:.0f} um is put in. The service knows none of this. Its readings are strokes,
{{gain:.2f}} times the eccentricity at this speed; the readings of {EXCHANGED} days keep to that
within {{spread:.1f}} % (1 sigma), which is what noise makes of one stretch of {ON_S:.0f} s (a line
that runs all day has one of 60 s and more an hour). What the plant had is shown times that. Days
count from 0. An interval is one of 95 %: of twenty that are right, one does not hold. Fourteen
readings tell a growth to some 10 um per 1000 km (1 sigma): 1 um of the days and what noise makes
of a stretch, over 470 km.

Why an interval may not hold: over all {{days}} days a reading is off by {{off:.1f}} um (1 sigma),
by its own error it is by {{own:.1f}}. Neighbours have a correlation of {{correlation:.2f}}: no
drift is to be allowed for. Fourteen such days, with the 1 um of the days, tell a growth to
{{sigma:.1f}} um per 1000 km (1 sigma); half an interval is {{half:.0f}} as a rule. The new
roller's first draw is off by {{far:.0f}}, {{sigmas:.1f}} sigma, as {{as_far:.1f}} % of draws are.
What the record lacks is readings: more days, or longer stretches.

The growth was chosen so that four weeks tell it. At half of it (8 um per 1000 km, limit at 1.15
times the first stroke, one noise for all days) no trend stood on day 27, and the first note said
44.6 (30.5 to 58.6) um per 1000 km where the plant had 22.7.

| what | the plant | `watch` | holds |
|---|---|---|---|
{{table}}

What it said on the first evening, on the last before the exchange, and after it:

```text
{{told}}
{{before}}
{{asked}}
```

How often growth is told where there is none: `python -m benchmarks.watch`
([watching over weeks](../technician/watch.md)).
"""


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/watch-weeks"))
    parser.add_argument("--make", type=int, nargs=2, metavar="DAY", help="only write these days")
    parser.add_argument("--docs", action="store_true", help=f"write {PAGE}")
    given = parser.parse_args()
    for wanted in range(*(given.make or (0, 0))):
        write_day(given.out, wanted, eccentricities_m()[1][wanted])
    if given.make:
        sys.exit(0)
    page, held = report(given.out)
    print(page)
    if given.docs:
        PAGE.write_text(page, encoding="utf-8")
    sys.exit(0 if held else 1)
