"""What the proposed block does at the plant, in virtual time: drawn cases that were refined.

python -m tests.sim_plant.refine.kept_blocks [--cases N ...] [--out DIR] [--docs]

Takes what ``run_cases`` has left in DIR: the case's files and the verdict from the service's own
records. The block of that verdict goes into the site file as ``refine --site`` puts it there.
Plant, PLC and runtime run twice: with the site file as it was, and with the block. Compared is
order 1 of the hidden idler in the plant's true tension, which no reading of the service is; and on
the second run, of two speeds and a step of tension, the error of the model as declared and as
amended, over the noise.

A case that has no verdict yet is left out; what was made is kept in DIR. Two minutes of one core a
case; ends with 1 where a target is missed.
"""

import argparse
import json
import shutil
import sys
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from sim_plant.base.order_tracking import order_amplitudes, reduction_dB
from sim_plant.demo.loop.drawn import IDLER, angle_of
from sim_plant.demo.loop.proof import MOST_OF_FLOOR, TARGET_DB, model_errors
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.report.aff_block import aff_blocks
from sim_plant.refine.report.site_edit import FILE, SiteFile, proposed
from sim_plant.refine.report.verdict import Verdict
from tests.doubles.recorded_run import Files, RecordedRun
from tests.sim_plant.refine.run_cases import (
    FAST_M_S,
    RAMP_S,
    SLOW_M_S,
    STEP_N,
    Case,
    files_in,
    folder_of,
)

LEARNS_S, WINDOW_S, SLOW_S, STEP_S = 40.0, 16.0, 14.0, 8.0
PAGE = Path("docs/results/kept-blocks.md")
JUDGED = "unwind_tension_N"
"""The tension in which the error of the model is told: the one that the block is to quieten."""


@dataclass(frozen=True)
class Kept:
    """What came of one case.

    Attributes
    ----------
    before_N, after_N : order 1 of the hidden idler in the true tension of the unwind.
    declared, amended : error of the model on the run with the block, over the noise.
    """

    case: Case
    answer: str
    before_N: float
    after_N: float
    declared: float
    amended: float

    @property
    def reduction_dB(self):
        """Return by how much less there is of it."""
        return reduction_dB(self.before_N, self.after_N)

    @property
    def holds(self):
        """Return whether both targets are met."""
        return self.reduction_dB >= TARGET_DB and self.amended <= MOST_OF_FLOOR


def ripple_N(files, site, runs, roller, *, later):
    """Return order 1 of a roller at the plant, and the run; ``later``: other speeds follow."""
    made = Files(line=files.plant, site=site, plc_map=files.plc)
    run = RecordedRun(made, runs, line_speed_m_s=FAST_M_S)
    seen = []
    names = ("true_unwind_tension_N", f"true_{angle_of(roller)}", "true_unwind_angle_rad")
    run.bench.plant.observers.append(lambda plant: seen.append([plant.measured[n] for n in names]))
    run.bench.run(0.5)
    run.bench.arm(LEARNS_S)
    seen.clear()
    run.bench.run(WINDOW_S)
    tension, angle, unwind = np.array(seen).T
    if later:
        run.set_speed(SLOW_M_S, RAMP_S)
        run.bench.run(SLOW_S)
        run.bench.plant.set_reference("tension_ref_N", STEP_N)
        run.bench.run(STEP_S)
    size = abs(order_amplitudes(tension, angle, (1,), {"unwind": unwind})[0])
    return float(size), run.end()


def kept(case, out):
    """Return what the block of a case does; None where there is no verdict, or no block."""
    made = folder_of(case, out, "with-block") / "kept.json"
    if made.exists():
        return Kept(case=case, **json.loads(made.read_text(encoding="utf-8")))
    one = _kept(case, out)
    if one is not None:
        numbers = {f.name: getattr(one, f.name) for f in fields(one) if f.name != "case"}
        made.write_text(json.dumps(numbers) + "\n", encoding="utf-8")
    return one


def _kept(case, out):
    told = folder_of(case, out, "service-further")
    if not (told / "verdict.json").exists():
        return None
    verdict = Verdict.from_json((told / "verdict.json").read_text(encoding="utf-8"))
    files = files_in(folder_of(case, out, "service-records"))
    here = folder_of(case, out, "with-block")
    shutil.rmtree(here, ignore_errors=True)
    here.mkdir(parents=True)
    line = load_declaration(files.line)
    proposal = proposed(SiteFile.read(files.site), aff_blocks(verdict.effects), line)
    if not proposal.adds:
        return None
    (here / FILE).write_text(proposal.text, encoding="utf-8")
    (_, roller), _ = list(case.hidden.items())[-1]
    before_N, _ = ripple_N(files, files.site, here / "runs-before", roller, later=False)
    after_N, run = ripple_N(files, here / FILE, here / "runs-after", roller, later=True)
    error = model_errors((files.line, told / "line_amended.yaml"), f"{run}@{LEARNS_S:g}..")[JUDGED]
    return Kept(
        case=case,
        answer=verdict.answer,
        before_N=before_N,
        after_N=after_N,
        declared=error.declared / error.floor,
        amended=error.amended / error.floor,
    )


HEAD = (
    *("seed", "the plant has", "verdict", "1x at the plant, N: before, with the block"),
    *("reduction", "model error over noise: declared, amended", "holds"),
)


def row(one):
    """Return one line of the table."""
    (effect, at), numbers = list(one.case.hidden.items())[-1]
    size = f"{1e3 * numbers['eccentricity_m']:.4f} mm" if effect == IDLER else ""
    cells = (
        *(f"{one.case.seed}", f"{effect} at {at} {size}".strip(), one.answer),
        *(f"{one.before_N:.3f}, {one.after_N:.4f}", f"{one.reduction_dB:.1f} dB"),
        *(f"{one.declared:.2f}, {one.amended:.2f}", "yes" if one.holds else "no"),
    )
    return f"| {' | '.join(cells)} |"


TEXT = f"""# What the proposed block does at the plant

Repeat: `make refine-runs`, then `python -m tests.sim_plant.refine.kept_blocks --docs`.

The drawn cases of [refine-runs](refine-runs.md), with the block that refine proposes from the
service's own records. Plant, PLC and runtime in virtual time at 5 ms, AFF on the unwind all along,
{LEARNS_S:.0f} s to learn, {WINDOW_S:.0f} s judged: order 1 of the hidden idler in the plant's true
tension. Asked: {TARGET_DB:g} dB less, and an error of the amended model of at most
{MOST_OF_FLOOR:.2f} of the noise on the run with the block, which was not there when it was fitted.
The responses are those of the line's equations, as a probe without error would find them; over a
wire in real time, with a probe: [demo-loop](demo-loop.md).

{{table}}
{{held}} of {{count}} hold both targets.
"""


def main():
    """Print the table; 1 where a target is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, nargs="+", default=list(range(1, 11)))
    parser.add_argument("--out", type=Path, default=Path("out/refine-runs"))
    parser.add_argument("--docs", action="store_true", help=f"write {PAGE}")
    given = parser.parse_args()
    found = []
    for seed in given.cases:
        one = kept(Case(IDLER, seed), given.out)
        if one is None:
            print(f"seed {seed}: no verdict with a block yet", flush=True)
            continue
        found.append(one)
        print(row(one), flush=True)
    table = "\n".join([f"| {' | '.join(HEAD)} |", "|---" * len(HEAD) + "|", *map(row, found), ""])
    held = sum(one.holds for one in found)
    if given.docs:
        PAGE.write_text(TEXT.format(table=table, held=held, count=len(found)), encoding="utf-8")
    return 0 if found and held == len(found) else 1


if __name__ == "__main__":
    sys.exit(main())
