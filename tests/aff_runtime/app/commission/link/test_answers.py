"""Every answer comes back as it was said, or is refused."""

import json

import pytest

from aff_runtime.app.commission.link.answers import (
    AnswerError,
    CardShown,
    DifferenceShown,
    Done,
    Good,
    LineShown,
    MaintenanceShown,
    Opened,
    Printed,
    RefinedShown,
    RefiningShown,
    SettingsShown,
    State,
    TextShown,
    VersionShown,
    decode,
    encode,
)
from aff_runtime.app.commission.link.messages import Refusal
from aff_runtime.app.commission.settings.site_lines import Clash
from aff_runtime.app.commission.views import of_line as views
from aff_runtime.app.commission.views import of_settings, of_weeks
from aff_runtime.app.commission.views.of_refining import (
    AskedOf,
    LackingView,
    ProposalView,
    RefinedRow,
    RefinedView,
    RefiningView,
    RunRow,
)
from aff_runtime.app.link.settings_answer import Version
from aff_runtime.base import refinement
from tests.each_case import each_case

SEGMENT = views.SegmentView(name="0.csv", size=7, sha256="0" * 64)
ENTRY = views.EntryView(
    number=2,
    utc="u",
    sha256="1" * 64,
    by="root; carl",
    release="1",
    reason="",
    figures=(views.FigureView(name="a", value="1 N", span="", limit="", good=None),),
    waits_for=("b",),
    proposals=(),
    remarks=("\u00e9",),
    typed=("reaction = ramp",),
    windows=(views.WindowView(folder="runs/1", from_s=0.5, to_s=20.0, segments=(SEGMENT,)),),
)
STEP = views.StepView(
    number=4,
    title="Trips",
    measured="m",
    limit="l",
    seconds=0.0,
    stand="pass",
    why=(),
    typed_names=("reaction",),
    earlier=1,
    can_sign=False,
    entry=ENTRY,
    signed=views.SignatureView(
        name="carl", reason="seen", by="root", utc="u", number=3, sha256="2" * 64
    ),
)
CARD = views.CardView(
    line="Euclid",
    first="1" * 64,
    newest="3" * 64,
    entries=3,
    utc="u",
    remarks=(),
    undone=("step 0",),
    steps=(STEP,),
    proof=views.ProofTimes(off_s=25.13, on_s=43.2),
)
RESPONSE = views.ResponseView(
    actuator="unwind",
    unit="N/(m/s)",
    measured_at="",
    speed_m_s=1.0,
    radius_m=None,
    delay_s=0.04,
    points=(views.PointView(1.0, 40.0, -57.3, 2.0, 0.99),),
    drive=(views.DriveRow(name="delay_s", value=0.04, low=0.03, high=0.05, is_sure=True),),
)
PROBE = views.ProbeRow(
    actuator="unwind",
    amplitude=0.008,
    limit=0.05,
    unit="m/s",
    signal="t_N",
    signal_unit="N",
    ripple=None,
)
LINE = views.LineView(
    errors=(),
    warnings=("w",),
    drives=(),
    probe=views.ProbeView(duration_s=25.0, rows=(PROBE,)),
    responses=(RESPONSE,),
)
QUESTION = views.QuestionView(
    number=1, name="host", text="Address", default=None, choices=("no",), rows=(("w2", "word 2"),)
)
SAID = views.SaidLine(kind="complain", text="no")
SERVICE = views.ServiceView(
    state="READY",
    heard=True,
    blocked="",
    probing=False,
    probed="",
    trying="",
    trying_left_s=-1,
    tried="",
    differs=("x",),
    learned=(),
)
STATE = State(
    by="carl",
    site=views.SiteView(path="/s.yaml", there=True, sha256=""),
    service=SERVICE,
    card=True,
    job=views.JobView(do="words", step=-1, said=(SAID,), ask=QUESTION),
    last=views.LastJob(do="begin", step=-1, ok=True, text="begun"),
)
OF_RUNS = AskedOf(windows=("a@0..60",), holdout=("b",), without=(), by="carl", utc="u")
SUMMARY = refinement.Summary(
    kind="set",
    headline="Traced: R6.",
    sure="s",
    gain="g",
    next_step="n",
    effects=(
        refinement.EffectSaid(
            place="eccentric roller at R6",
            text="t",
            numbers=(
                refinement.NumberSaid(name="size", value="0.25", unit="mm", low="0.2", high="0.3"),
            ),
            can_cancel=True,
            to_do="true it",
            others=("R7",),
            experiments=("turn R6",),
        ),
    ),
    unknown=(),
    errors=(refinement.ErrorSaid(channel="t_N", unit="N", before=2.0, after=0.5, floor=0.5),),
    limits=("one speed only",),
    judged_on="b",
    held_out=True,
    site_said=("r6 added",),
)
ROW = RefinedRow(number=3, asked=OF_RUNS, kind="set", text="Traced: R6.")
LACKS = refinement.RecordLacks(
    name="a",
    is_held=False,
    speed_m_s=(0.9, 1.2),
    tension_N=(89.0, 89.0),
    lacks=("l",),
    said=("s",),
)
REFINING = RefiningView(
    missing=("m",),
    folder="/runs",
    line="/l.yaml",
    command="sim-plant refine",
    runs=(RunRow(name="a", line="Euclid", start_utc="u", from_s=0.0, to_s=None),),
    lacking=LackingView(
        asked=OF_RUNS, found=refinement.Lacking(records=(LACKS,), together=("t",))
    ),
    refined=(ROW,),
)
PROPOSAL = ProposalView(
    sha256="0" * 64, changes=("c",), remarks=(), lines=("+ - roll: r6",), against=""
)
REFINED = RefinedView(row=ROW, summary=SUMMARY, proposal=PROPOSAL, command="sim-plant refine")
WORST = of_weeks.WorstRow(order=1, size=120.0, error=3.0, unit="um")
MAINTENANCE = of_weeks.MaintenanceView(
    store="/watch",
    line="Euclid",
    without_a_line=("r7: no line",),
    lives=(
        of_weeks.LifeRow(
            roll="r6",
            number=2,
            since_s=1.0,
            until_s=None,
            why="bearing",
            web_km=36.0,
            running_h=10.0,
            turns=None,
        ),
    ),
    trends=(
        of_weeks.TrendRow(
            roll="r6",
            order=1,
            signal="t_N",
            quantity="stroke",
            unit="um",
            life=2,
            count=1,
            left_out=0,
            speed_m_s=1.0,
            now=47.0,
            limit=60.0,
            stands_out=True,
            per_1000_km=of_weeks.SlopeRow(value=7.0, low=6.0, high=8.0),
            line=of_weeks.FitRow(from_size=40.0, to_size=47.0),
            reached=of_weeks.ReachedRow(at_s=9.0, early_s=8.0, late_s=None),
            jump_s=None,
            readings=(of_weeks.Reading(at_s=1.0, size=40.0, error=0.5),),
        ),
    ),
    rankings=(
        of_weeks.RankingRow(
            roll="unwind",
            by="shape",
            rolls=(
                of_weeks.WoundRow(
                    roll_id=41,
                    first_s=1.0,
                    last_s=2.0,
                    hours=3,
                    shape=WORST,
                    stroke=None,
                    ripple=None,
                    left=None,
                ),
            ),
        ),
    ),
    suppliers=(
        of_weeks.SupplierRankingRow(
            roll="unwind",
            by="shape",
            unit="um",
            orders=(1, 2, 3),
            suppliers=(
                of_weeks.SupplierRow(
                    number=7,
                    rolls=1,
                    medians=(of_weeks.MedianRow(order=1, size=120.0, low=None, high=None),),
                    worst_roll=41,
                    worst=WORST,
                ),
            ),
            unknown=0,
        ),
    ),
)
ROW = Version(number=3, when="u", who="w", verb="kept", why="a", sha256="2" * 64, run="r")
ONE = of_settings.SettingView(
    path="a.b[0]",
    name="b",
    kind="number",
    unit="s",
    allowed="1 to 2 s",
    choices=(),
    default="none",
    shown="1 s",
    written="1",
    live=True,
    can_edit=True,
    help="h",
)
SAID_OF = of_settings.SaidOfSetting(path="a.b[0]", text="t")
SETTINGS = of_settings.SettingsView(
    site="/site.yaml",
    sha256="3" * 64,
    running="",
    against="no service answers",
    said=(SAID_OF,),
    sections=(of_settings.SettingsSection(path="a", roll="r", settings=(ONE,)),),
    versions=(ROW,),
)
DIFFERENCE = of_settings.DifferenceView(
    sha256="4" * 64,
    changes=("a: 1 s -> 2 s (applies at once)",),
    said=(),
    refused=False,
    waits=True,
    lines=("@@", "-a", "+b"),
)
EDITED = of_settings.TextView(
    base="3" * 64,
    file="a: 1\n",
    text="a: 2\n",
    said=(of_settings.SaidOfSetting(path="", text="t", line=3, column=4),),
    sections=SETTINGS.sections,
    clashes=(Clash(line=1, theirs=("a: 3",)),),
)
VERSION = of_settings.VersionView(
    version=ROW, lines=("+b",), back=DIFFERENCE, running="1" * 64, against=""
)
ANSWERS = [
    ("state", STATE),
    ("refining", RefiningShown(refining=REFINING)),
    ("refined", RefinedShown(refined=REFINED)),
    ("refined_page", Printed(html="<!doctype html>")),
    ("maintenance", MaintenanceShown(maintenance=MAINTENANCE)),
    ("settings", SettingsShown(settings=SETTINGS)),
    ("settings_diff", DifferenceShown(difference=DIFFERENCE)),
    ("settings_text", TextShown(edited=EDITED)),
    ("settings_version", VersionShown(version=VERSION)),
    ("card", CardShown(card=CARD)),
    ("line", LineShown(line=LINE)),
    ("page", Printed(html="<!doctype html>")),
    ("open", Opened(key="k" * 43)),
    ("begin", Done(text="a card is begun, 0123")),
    ("close", Done()),
    ("state", Refusal(why="refused", name="\u00fc")),
    ("step", Refusal(why="a word of another release", name="")),
]


@each_case(("do", "answer"), ANSWERS)
def test_an_answer_comes_back_as_it_was_said(do, answer):
    assert decode(do, encode(answer)) == answer


def test_every_kind_of_answer_is_tried_here():
    assert {type(answer) for _, answer in ANSWERS} == {*Good.__args__, Refusal}


def test_a_refusal_is_told_from_what_is_done_by_one_word():
    assert json.loads(encode(Refusal(why="busy", name="carl"))) == {
        "ok": False,
        "why": "busy",
        "name": "carl",
    }
    assert json.loads(encode(Done())) == {"ok": True}


SPOILT = encode(CardShown(card=CARD)).replace(b'"entries": 3', b'"entries": "many"')


@each_case(
    "line",
    [
        b"",
        b"{",
        b"[]",
        b"null",
        b"\xff",
        b"[" * 100_000,
        b'{"ok": true}',
        b'{"ok": false}',
        SPOILT,
    ],
)
def test_what_is_no_card_is_no_answer_to_a_look_at_it(line):
    with pytest.raises(AnswerError):
        decode("card", line)


def test_what_another_release_says_besides_is_left_out():
    said = json.loads(encode(STATE)) | {"weather": "fine"}
    assert decode("state", json.dumps(said).encode()) == STATE
