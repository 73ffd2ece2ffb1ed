"""Drawn cases from the service's own records and from clean ones of the same line, as tables.

python -m tests.sim_plant.refine.run_cases [--cases N] [--pairs further ...] [--out DIR] [--docs]

Every case is a seed of ``make demo-loop``: a roll that is not round, and one effect at a drawn
place. The service's records are of plant, PLC and runtime in virtual time: AFF on in the one that
is fitted, off in the one held out. A clean record is the plant's own under the same references,
without service and wire. What is compared, in the order that tells most first:

further : the service's records with all that the demo's site file maps, two load cells and three
    speeds for the record alone among it; clean records with all channels that the line declares.
shipped : the same records of the service without these; the same clean ones.
alike_channels : the service's records without these; clean ones with the same channels and the
    rewind's tension, without which the line's loop there has no cell.

Ends with 1 where fewer than nine in ten verdicts of ``further`` are alike, or an error held out is
above 1.10 of the floor. Some four minutes of one core a verdict. Verdicts are kept in DIR, one
folder a case: what is there is not made again, what was stopped is begun anew.
"""

import argparse
import shutil
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from aff_runtime.config.loader import load_site
from sim_plant.cli.main import main as sim_plant
from sim_plant.demo.loop.drawn import IDLER, drawn, write_files
from sim_plant.demo.loop.drawn import Files as Loop
from sim_plant.demo.loop.further_words import REFERENCE, WORDS
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.report.verdict import Verdict
from tests import quick_yaml
from tests.doubles.recorded_run import Files, RecordedRun

FAST_M_S, SLOW_M_S, STEP_N = 0.85, 0.62, 95.0
RAMP_S, OFF_S = 3.0, 35.0
ALIKE_SHARE = 0.9
MOST_OF_FLOOR = 1.10
FURTHER = frozenset(WORDS) - {REFERENCE}
"""Channels that the demo's site file maps for the record alone."""
JUDGED = "unwind_tension_N"
PAGE = Path("docs/results/refine-runs.md")


@dataclass(frozen=True)
class Case:
    """One drawn case."""

    effect: str
    seed: int

    @property
    def hidden(self):
        """What the plant has, place by place."""
        return {(h.effect, h.location): h.parameters for h in drawn(self.effect, self.seed)}


def service_records(files, folder):
    """Return the run to fit (AFF on) and the one held out (off)."""
    made = Files(line=files.plant, site=files.site, plc_map=files.plc)
    on = RecordedRun(made, folder / "on", line_speed_m_s=FAST_M_S)
    on.bench.run(0.5)
    on.bench.arm(22.0)
    on.set_speed(SLOW_M_S, RAMP_S)
    on.bench.run(18.0)
    on.bench.plant.set_reference("tension_ref_N", STEP_N)
    on.bench.run(12.0)
    off = RecordedRun(made, folder / "off", line_speed_m_s=FAST_M_S)
    off.bench.run(OFF_S)
    return on.end(), off.end()


def clean_records(files, folder, seed):
    """Return the same two records from the plant alone; channels are those of ``files.line``."""
    plant, owner = load_declaration(files.plant), load_declaration(files.line)
    channels = [sensor.channel for sensor in owner.sensors]
    step_s, (start_N, end_N) = plant.sample_time_s, (plant.operating_point.tension_N, STEP_N)
    time_s = np.arange(round((22.5 + RAMP_S + 30.0) / step_s)) * step_s
    speed = np.interp(time_s, [0.0, 22.5, 22.5 + RAMP_S], [FAST_M_S, FAST_M_S, SLOW_M_S])
    tension = np.where(time_s < 43.5, start_N, end_N)
    rest = np.ones(round(OFF_S / step_s))
    plans = {"a": (speed, tension), "b": (FAST_M_S * rest, start_N * rest)}
    return [
        _clean(plant, channels, references, folder / f"clean_{name}.csv", 2 * seed + k)
        for k, (name, references) in enumerate(plans.items())
    ]


def _clean(plant, channels, references, path, seed):
    speed, tension = references
    line = make_line(plant, seed=seed, speed_m_s=float(speed[0]), tension_N=float(tension[0]))
    line.settle()
    out = line.simulate(speed, tension)
    time_s = np.arange(speed.size) * line.sample_time_s
    columns = {"time_s": time_s, "line_speed_ref_m_s": speed, "tension_ref_N": tension}
    columns |= {name: out[name] for name in channels}
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, "%.9g", ",", header=",".join(columns), comments="")
    return path


@dataclass(frozen=True)
class Source:
    """Where a verdict comes from.

    Attributes
    ----------
    service : records of the service; else clean ones.
    shipped_only : without the channels for the record alone; of clean records: with those of
        the shipped site file and no other.
    """

    service: bool
    shipped_only: bool


SOURCES = {
    "service-further": Source(service=True, shipped_only=False),
    "service-shipped": Source(service=True, shipped_only=True),
    "clean": Source(service=False, shipped_only=False),
    "clean-shipped": Source(service=False, shipped_only=True),
}
PAIRS = {
    "further": ("service-further", "clean"),
    "shipped": ("service-shipped", "clean"),
    "alike_channels": ("service-shipped", "clean-shipped"),
}
TITLES = {
    "further": "All that the PLC shows is recorded",
    "shipped": "The shipped site file's channels alone",
    "alike_channels": "The shipped site file's channels alone, in the clean records too",
}


def folder_of(case, out, name):
    """Return where a verdict is kept."""
    return out / f"{case.effect}-{case.seed}" / name


def verdict(case, out, name):
    """Return what refine says of one of ``SOURCES``; made where it is not there."""
    said = folder_of(case, out, name) / "verdict.json"
    if not said.exists():
        files, fit, held = records(case, out, name)
        arguments = [str(files.line), str(fit), "--holdout", str(held), "--workers", "1"]
        assert sim_plant(["refine", *arguments, "--out", str(said.parent)]) == 0
    return Verdict.from_json(said.read_text(encoding="utf-8"))


def records(case, out, name):
    """Return the files of a source, the record to fit and the one held out."""
    source = SOURCES[name]
    made = folder_of(case, out, "service-records" if source.service else f"{name}-records")
    done = made / "records.txt"
    if source.service and done.exists():
        files = files_in(made)
        fit, held = map(Path, done.read_text(encoding="utf-8").splitlines())
    else:
        shutil.rmtree(made, ignore_errors=True)
        made.mkdir(parents=True)
        files = write_files(made, drawn(case.effect, case.seed))
    if source.shipped_only:
        line = with_channels(files, made / "line-shipped.yaml", service=source.service)
        files = replace(files, line=line)
    if not source.service:
        return (files, *clean_records(files, made, case.seed))
    if not done.exists():
        fit, held = service_records(files, made)
        done.write_text(f"{fit}\n{held}\n", encoding="utf-8")
    return files, fit, held


def files_in(folder):
    """Return the files that ``write_files`` has written into a folder."""
    names = {"line": "line.yaml", "plant": "plant.yaml", "site": "euclid.yaml", "plc": "plc.yaml"}
    return Loop(**{k: folder / name for k, name in names.items()}, plant_arguments=())


def with_channels(files, path, *, service):
    """Write the owner's line for records with the shipped site file's channels; return its path.

    A tension loop needs its cell: for a run of the service that keeps its place under a name that
    no run has; a clean record has to have every channel, and gets the rewind's cell as well.
    """
    mapped = set(load_site(files.site).gateway.read.channels) - FURTHER
    line = quick_yaml.safe_load(files.line.read_text(encoding="utf-8"))
    looped = {loop["load_cell"] for loop in line["control"]["tension_pi"]}
    kept = []
    for sensor in line["sensors"]:
        if sensor["channel"] in mapped:
            kept.append(sensor)
        elif sensor["roller"] in looped:
            unshown = {"channel": f"unshown_{sensor['channel']}"} if service else {}
            kept.append(sensor | unshown)
    path.write_text(
        quick_yaml.safe_dump(line | {"sensors": kept}, sort_keys=False), encoding="utf-8"
    )
    return path


def alike(one, other):
    """Return whether two verdicts say the same: answer, effects, places, kinds of unknown."""
    return _told(one) == _told(other)


def _told(verdict):
    effects = frozenset(str(e.place) for e in verdict.effects)
    return verdict.answer, effects, frozenset(u.unknown_class for u in verdict.unknown)


def size_error(case, verdict):
    """Return the error of the drawn effect's size, relative; None where it is not named."""
    (place, given), numbers = list(case.hidden.items())[-1], {}
    for e in verdict.effects:
        if (e.place.effect, e.place.location) == place:
            numbers = e.parameters
    sizes = [n for n in given if n in numbers and not n.endswith("_rad")]
    return float(numbers[sizes[0]]) / float(given[sizes[0]]) - 1.0 if sizes else None


def of_floor(verdict):
    """Return the error held out over what noise alone leaves, in the tension that is corrected."""
    tension = verdict.residual_rms[JUDGED]
    return tension.after / tension.noise_floor


def row(case, service, clean):
    """Return one line of the table."""
    cells = [f"{case.seed}", "; ".join(f"{name} at {at}" for name, at in case.hidden)]
    for verdict in (service, clean):
        error = size_error(case, verdict)
        cells += [_said(verdict), "-" if error is None else f"{100 * error:+.1f} %"]
    cells += [f"{of_floor(service):.2f}", "yes" if alike(service, clean) else "no"]
    return f"| {' | '.join(cells)} |"


def _said(verdict):
    told = ", ".join(str(e.place) for e in verdict.effects) or "-"
    told += "".join(f"; unknown: {u.unknown_class}" for u in verdict.unknown)
    for a in verdict.ambiguous:
        told += f"; or {', '.join(str(place) for place in a.alternatives)}"
    return f"{verdict.answer}: {told}"


HEAD = (
    *("seed", "the plant has", "from the service's records", "size", "from clean ones", "size"),
    *("error held out over floor", "alike"),
)


@dataclass(frozen=True)
class Table:
    """The table, and what was counted in it.

    Attributes
    ----------
    alike : verdicts of service and clean records.
    within : errors held out that are at most ``MOST_OF_FLOOR`` of the floor.
    """

    text: str
    cases: int
    alike: int
    within: int

    @property
    def summary(self):
        """Return the counts as a sentence."""
        return (
            f"{self.alike} of {self.cases} verdicts alike (nine in ten asked); error held out at "
            f"most {MOST_OF_FLOOR:.2f} of the floor in {self.within} of {self.cases}."
        )

    @property
    def holds(self):
        """Return whether the targets were met."""
        return self.alike >= ALIKE_SHARE * self.cases and self.within == self.cases


def table(cases, out, pair="further", *, only_made=False):
    """Return the table of cases; ``only_made``: of those that have been refined already."""
    rows = [f"| {' | '.join(HEAD)} |", "|---" * len(HEAD) + "|"]
    count = same = within = 0
    for case in cases:
        places = [folder_of(case, out, name) / "verdict.json" for name in PAIRS[pair]]
        if only_made and not all(place.exists() for place in places):
            continue
        service, clean = (verdict(case, out, name) for name in PAIRS[pair])
        rows.append(row(case, service, clean))
        count, same = count + 1, same + alike(service, clean)
        within += of_floor(service) <= MOST_OF_FLOOR
    return Table("\n".join(rows) + "\n", count, same, within)


def page(found):
    """Return the page of results; ``found`` : tables by pair."""
    parts = [f"## {TITLES[p]}\n\n{one.text}\n{one.summary}\n" for p, one in found.items()]
    return TEXT.format(tables="\n".join(parts))


TEXT = """# Verdicts from the service's records and from clean ones

Repeat: `make refine-runs`; a verdict is some four minutes of one core, a stopped run goes on. Each
case is a seed of `make demo-loop`. The service's records are of plant, PLC and runtime in virtual
time, AFF on in the one that is fitted and off in the one held out; clean records are the plant's
own, with every channel that the line file declares where nothing else is said. Two verdicts are
alike when answer, effects and places are the same.

{tables}
How far neighbouring idlers are apart in such a record, by channel:
`python -m tests.sim_plant.refine.apart`.
"""


def main():
    """Refine the cases that are missing, print the tables; 1 where a target is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--effect", default=IDLER)
    parser.add_argument("--pairs", nargs="+", choices=PAIRS, default=["further", "shipped"])
    parser.add_argument("--out", type=Path, default=Path("out/refine-runs"))
    parser.add_argument("--docs", action="store_true", help=f"write {PAGE}")
    parser.add_argument(
        "--only-made", action="store_true", help="tables of what is refined already"
    )
    given = parser.parse_args()
    cases = [Case(given.effect, seed) for seed in range(1, given.cases + 1)]
    found = {}
    for pair in given.pairs:
        found[pair] = one = table(cases, given.out, pair, only_made=given.only_made)
        print(f"{TITLES[pair]}\n\n{one.text}\n{one.summary}\n", flush=True)
    if given.docs:
        PAGE.write_text(page(found), encoding="utf-8")
    return 0 if found[given.pairs[0]].holds else 1


if __name__ == "__main__":
    sys.exit(main())
