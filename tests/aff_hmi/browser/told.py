"""In place of a commissioner: what a screen is told of refining and of a line over weeks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from aff_hmi.commission.link import Commission
from aff_runtime.app.commission.link.answers import (
    Answer,
    Done,
    MaintenanceShown,
    Opened,
    RefinedShown,
    RefiningShown,
    State,
)
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.records.maintenance_jobs import maintenance_view
from aff_runtime.app.commission.views import of_line as views
from aff_runtime.app.commission.views.of_refining import (
    AskedOf,
    LackingView,
    ProposalView,
    RefinedRow,
    RefinedView,
    RefiningView,
    RunRow,
)
from aff_runtime.base.refinement import (
    EffectSaid,
    ErrorSaid,
    Lacking,
    NumberSaid,
    RecordLacks,
    Summary,
)
from tests.aff_runtime.app.report.watching.made_store import BEGAN, DAY, made_store

RUNS = ("20260105T060000Z_Euclid", "20260106T060000Z_Euclid", "20260107T060000Z_Euclid")
ASKED = AskedOf(
    windows=(f"{RUNS[0]}@2:00..12:00",),
    holdout=(RUNS[1],),
    without=(),
    by="carl",
    utc="2026-01-08T07:00:00.000+00:00",
)
NO_REFERENCE = (
    "no speed reference: the measured speed stands in, some 100 ppm off; at which of several like "
    "idlers of a zone an effect sits is not told, nor what only the drives' common speed shows"
)
LACKING = Lacking(
    records=(
        RecordLacks(
            name=ASKED.windows[0],
            is_held=False,
            length_s=600.0,
            speed_m_s=(0.9, 1.2),
            tension_N=(88.9, 95.0),
            radius_m=0.203,
            lacks=(
                NO_REFERENCE,
                "not recorded: r3_tension_N; where an effect sits rests on fewer channels",
            ),
            said=("AFF on 300 s, off 300 s", "taken is 0.0..600.0 s of the run"),
        ),
        RecordLacks(
            name=RUNS[1],
            is_held=True,
            refused=f"/runs/{RUNS[1]}: no 20 s of the running line without a break",
        ),
    ),
    together=("more than one held-out record: the errors are those of a",),
)
EFFECT = EffectSaid(
    place="eccentric roller at R6",
    text="a roller turns off its axis",
    numbers=(
        NumberSaid(name="eccentricity", value="0.2512", unit="mm", low="0.2487", high="0.2537"),
        NumberSaid(name="angle", value="57.3", unit="deg", low="56.1", high="58.5"),
    ),
    can_cancel=True,
    to_do="true the journals of R6, or exchange it",
    others=(),
    experiments=(),
)
SUMMARY = Summary(
    kind="traced",
    headline="Traced: eccentric roller at R6, eccentricity 0.2512 mm (95 %: 0.2487 to 0.2537).",
    sure="eccentric roller at R6 scores 981535, no other explains the record as well.",
    gain="On the held-out record the error in unwind_tension_N is 1.91 N rms as declared, "
    "0.251 N rms as amended; noise alone leaves 0.25 N.",
    next_step="Paste the AFF block below into the site file.",
    effects=(EFFECT,),
    unknown=(),
    errors=(
        ErrorSaid(channel="unwind_tension_N", unit="N", before=1.91, after=0.251, floor=0.25),
        ErrorSaid(channel="pullroll_tension_N", unit="N", before=0.61, after=0.31, floor=0.25),
    ),
    limits=(f"{RUNS[0]}: {NO_REFERENCE}",),
    judged_on=RUNS[1],
    held_out=True,
    site_said=("actuators.unwind.blocks: r6 added, and rolls.r6 with a radius of 38.1 mm",),
)
ROWS = (
    RefinedRow(number=8, asked=ASKED, kind="traced", text=SUMMARY.headline),
    RefinedRow(
        number=7, asked=ASKED, kind="event", text="Unknown: an event at 212.40 s in R3 to R7."
    ),
    RefinedRow(number=6, asked=ASKED, kind="set", text="Traced: <b>eccentric</b> roller at R6."),
    RefinedRow(number=5, asked=ASKED, kind="nothing", text="Nothing found."),
    RefinedRow(number=4, asked=ASKED, kind="", text="it took longer than 4 h"),
)
PROPOSAL = ProposalView(
    sha256="3f" * 32,
    changes=("actuators.unwind.blocks.1.orders: (absent) -> 1 (applies at once)",),
    remarks=(),
    lines=("@@ -40,3 +40,5 @@", "       settle_s: 6", "+      - roll: r6", "+        orders: [1]"),
    against="",
)
REFINING = RefiningView(
    missing=(),
    folder="/var/lib/aff-runtime/runs",
    line="/var/lib/aff-runtime/site/line.yaml",
    command="sim-plant refine line.yaml runs/RUN_DIR@FROM..TO --holdout runs/RUN_DIR --out DIR",
    runs=tuple(
        RunRow(
            name=name,
            line="Euclid",
            start_utc="2026-01-05T06:00:00.000+00:00",
            from_s=0.0,
            to_s=3540.0,
        )
        for name in RUNS
    ),
    lacking=LackingView(asked=ASKED, found=LACKING),
    refined=ROWS,
)
TRIED = "3f" * 32
SERVICE = views.ServiceView(
    state="READY",
    heard=True,
    blocked="",
    probing=False,
    probed="measured",
    trying="",
    trying_left_s=-1,
    tried="",
    differs=(),
    learned=(),
)


def running(*lines: str) -> views.JobView:
    """Return a refinement that has said this."""
    said = tuple(views.SaidLine(kind="say", text=line) for line in lines)
    return views.JobView(do="refine", step=-1, said=said, ask=None, seconds=754.0)


class Told(Commission):
    """Answers at once; what was asked is kept.

    Attributes
    ----------
    is_there : whether a commissioner answers. ``long``, ``job`` : what runs, for hours or not.
    refining, refined : what is shown of them. ``last`` : what ended last.
    """

    def __init__(self) -> None:
        super().__init__(Path("/nowhere"))
        self.said: list[Request] = []
        self.is_there = True
        self.by = ""
        self.trying = ""
        self.long: views.JobView | None = None
        self.job: views.JobView | None = None
        self.last: views.LastJob | None = None
        self.refining = REFINING
        self.refined = RefinedView(
            row=ROWS[0], summary=SUMMARY, proposal=PROPOSAL, command="sim-plant refine"
        )
        store = made_store(40)
        store.exchange("r6", (BEGAN + 5 * DAY).astype(object), "serial 4711, bearing")
        self.maintenance = maintenance_view(Path("/var/lib/aff-runtime/watch"), store)

    async def _ask(self, asked: Request) -> Answer:
        if not self.is_there:
            return Refusal(why=Why.SILENT)
        if asked.do not in ("state", "refining", "refined", "maintenance"):
            self.said.append(asked)
        if asked.do == "open":
            self.by = asked.account
            return Opened(key="k" * 43)
        answers: dict[str, Answer] = {
            "state": self._state(),
            "refining": RefiningShown(refining=self.refining),
            "refined": RefinedShown(refined=self.refined),
            "maintenance": MaintenanceShown(maintenance=self.maintenance),
        }
        return answers.get(asked.do, Done())

    def _state(self) -> State:
        return State(
            by=self.by,
            site=views.SiteView(path="/site.yaml", there=True, sha256="0" * 64),
            service=replace(
                SERVICE,
                trying=self.trying,
                trying_left_s=87.0 if self.trying else -1,
                tried=TRIED if self.trying else "",
            ),
            card=False,
            job=self.job,
            last=None,
            long=self.long,
            long_last=self.last,
        )
