"""A window is of the settings that ran in it, whatever runs or lies in the file today."""

from dataclasses import replace

import pytest

from aff_runtime.app.card.entries import UNKNOWN
from aff_runtime.app.card.evidence import CheckedSite
from aff_runtime.app.card.gather import Sources, gather
from aff_runtime.app.card.run_settings import in_force
from aff_runtime.app.card.standing import changed
from aff_runtime.app.card.steps import step_of
from aff_runtime.app.card.typed_values import TypedValues, typed
from aff_runtime.app.report.status_answer import Live, StatusAnswer
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.text_digest import text_digest
from aff_runtime.config.loader import load_recorded_site
from aff_runtime.config.revision import SHORT, site_hash_of
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.telemetry.recorder_messages import RecorderReport
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE, recorded, steady, window
from tests.parameter_records import record_of

TEXT_A = SITE_FILE.read_text()
TEXT_B = TEXT_A.replace("settle_s: 6", "settle_s: 3")
EDIT_S, WINDOWS = 20.0, {"before": (2.0, 15.0), "after": (25.0, 38.0)}
STEP, LOAD = step_of(1), TypedValues(map(typed, ["load=0", "signal=unwind_tension_N"]))


def response(gain):
    """Return the text of a response file."""
    one = ResponsePoint(
        frequency_Hz=1.0, gain=gain, phase_rad=0.0, relative_error=0.1, coherence=0.9
    )
    about = Provenance(actuator="unwind", signal="unwind_tension_N")
    return Response(points=[one], delay_s=0.0, provenance=about).to_json()


THEN, TODAY = response(1.0), response(2.0)


def parameters(text):
    site = load_recorded_site(text, "site.yaml")
    record = record_of(site, site_text=text, site_hash=site_hash_of(site))
    return record.model_copy(update={"responses": {"unwind": TODAY}})


A, B = parameters(TEXT_A), parameters(TEXT_B)
assert A.site_hash != B.site_hash


def applied(time_s, record, learned="unwind: no response"):
    """Return the event that the service notes when settings have been taken."""
    text = f"{'c' * SHORT}: site {record.site_hash[:SHORT]}; {learned}"
    return f'{time_s},,,CONFIG_APPLIED,,"{text}"\n'


def run_of(folder, rows):
    """Return a run of 40 s on roll 3 that began with A, with these rows of events."""
    columns = steady(40.0)
    columns["roll_id"][:] = 3.0
    path = recorded(folder, columns, site_text=TEXT_A)
    with (path / "events.csv").open("a") as file:
        file.writelines(rows)
    return path


@pytest.fixture(scope="module")
def edited(tmp_path_factory):
    """A run in which A was exchanged for B; nobody writes to it."""
    edit = [f"{EDIT_S},,,EDIT,,settle_s\n", applied(EDIT_S + 0.1, B)]
    return run_of(tmp_path_factory.mktemp("edited"), [applied(0.0, A), *edit])


def gathered(run, span, record, *, on_service):
    """Return what step 1 looks at of a part of a run, with the service on it or without one."""
    live = Live(signals={"time_s": 40.0, "roll_id": 7.0})
    answer = StatusAnswer(
        line="Euclid",
        state="READY",
        site_hash=record.site_hash,
        config_hash="today",
        recorder=RecorderReport(folder=str(run)),
        live=live,
    )
    found = Sources(
        parameters=record,
        checked=CheckedSite(site=record.site),
        answer=answer if on_service else None,
        windows=(RunWindow(folder=run, from_s=span[0], to_s=span[1]),),
    )
    return gather(STEP, found, LOAD, ())


@pytest.mark.parametrize("on_service", [True, False], ids=["running", "ended"])
@pytest.mark.parametrize("record", [A, B], ids=["file A", "file B"])
@pytest.mark.parametrize("which", WINDOWS)
def test_a_window_counts_on_the_settings_that_were_in_force_in_it(
    edited, which, record, on_service
):
    ran = A if which == "before" else B
    if ran is record:
        inputs = gathered(edited, WINDOWS[which], record, on_service=on_service).inputs
        assert inputs.site_hash == ran.site_hash
    else:
        with pytest.raises(RefusedError, match=rf"other settings \({ran.site_hash[:SHORT]}"):
            gathered(edited, WINDOWS[which], record, on_service=on_service)


def test_where_it_cannot_be_told_the_time_of_the_change_is(tmp_path):
    run = run_of(tmp_path, [f"{EDIT_S},,,EDIT,,settle_s\n"])  # nobody noted that it was taken
    assert in_force(window(run, *WINDOWS["before"])).site == A.site_hash[:SHORT]
    with pytest.raises(RefusedError, match="cannot be told: they were changed at 20 s"):
        in_force(window(run, *WINDOWS["after"]))
    with pytest.raises(RefusedError, match="settings were changed in it"):
        in_force(window(run, 10.0, 30.0))


def test_settings_that_were_taken_back_within_a_window_are_seen(tmp_path):
    run = run_of(tmp_path, [applied(0.0, A), applied(10.0, B), applied(12.0, A)])
    with pytest.raises(RefusedError, match="settings were changed in it"):
        in_force(window(run, *WINDOWS["before"]))
    assert in_force(window(run, *WINDOWS["after"])).site == A.site_hash[:SHORT]


def test_a_response_that_is_taken_within_a_window_is_seen(tmp_path):
    """The edit is noted before the window begins, and is taken within it."""
    learned = [f"unwind: response {digit * SHORT} (probed here)" for digit in "12"]
    edit = "9.9,,,EDIT,,unwind.json\n"
    run = run_of(tmp_path, [applied(0.0, A, learned[0]), edit, applied(10.1, A, learned[1])])
    with pytest.raises(RefusedError, match="settings were changed in it"):
        in_force(window(run, 10.0, 20.0))
    assert in_force(window(run, 10.2, 20.0)).responses == {"unwind": "2" * SHORT}


def test_a_window_that_is_named_rests_on_its_own_roll_and_response(tmp_path):
    was = text_digest(THEN)[:SHORT]
    learned = f"unwind: response {was} (probed here), shape {'9' * SHORT}; swrap: no response"
    run = run_of(tmp_path, [applied(0.0, A, learned)])
    inputs = gathered(run, WINDOWS["before"], A, on_service=True).inputs
    assert (inputs.roll_id, inputs.config_hash) == ("3", "c" * SHORT)
    assert (inputs.responses, inputs.shapes) == ({"unwind": was}, {"unwind": "9" * SHORT})
    today = replace(inputs, responses={"unwind": text_digest(TODAY)}, roll_id="7")
    assert len(list(changed(step_of(12), inputs, today))) == 2
    back = replace(inputs, responses={"unwind": text_digest(THEN)})
    assert list(changed(step_of(12), inputs, back)) == []


def test_a_response_that_no_record_names_is_unknown(tmp_path):
    inputs = gathered(run_of(tmp_path, []), WINDOWS["before"], A, on_service=True).inputs
    assert inputs.responses == {"unwind": UNKNOWN}
    assert (inputs.roll_id, inputs.config_hash) == ("3", "")
