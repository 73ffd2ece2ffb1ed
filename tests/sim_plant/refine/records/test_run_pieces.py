"""What a run is read as where it lacks readings, a line speed, or what the correction was."""

import numpy as np
import pytest
import yaml

from aff_runtime.base.errors import PlantError
from sim_plant.refine.records.read import read_record
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE, recorded, switched


def finding_on(record, name):
    (found,) = [text for text in record.findings if text.startswith(name)]
    return found


@pytest.mark.parametrize(("read", "said"), [(1500, "read in 30 % of the rows only"), (0, "never")])
def test_a_channel_that_is_left_out_says_in_how_many_rows_it_was_read(tmp_path, read, said):
    columns, _ = switched(25.0, [])  # 5000 rows
    columns["swrap_follower_speed_m_s"][read:] = np.nan
    record = read_record(recorded(tmp_path, columns))
    assert "swrap_follower_speed_m_s" not in record.columns
    assert f"is left out: {said}" in finding_on(record, "swrap_follower_speed_m_s")


@pytest.mark.parametrize("is_there", [True, False])
def test_a_run_without_its_line_speed_says_that_no_ramp_is_looked_for(tmp_path, is_there):
    columns, _ = switched(25.0, [])
    columns["line_speed_m_s"][2500:] *= 1.5
    if not is_there:
        columns["line_speed_m_s"][:] = np.nan
    record = read_record(recorded(tmp_path, columns))
    said = [text for text in record.findings if "ramps of it are not looked for" in text]
    assert (record.run.activity.ramp_s > 0.0) == is_there == (not said)


@pytest.mark.parametrize(("delay_ms", "from_s"), [(500, 0.495), (15_000, None), (60_000, None)])
@pytest.mark.sweep(every=2)
def test_where_no_row_tells_what_acted_no_piece_is_taken(tmp_path, delay_ms, from_s):
    """A tick of 5 ms sends at once what acts ``delay_ms`` after: so long no one knows it."""
    columns, _ = switched(25.0, [(0.0, 25.0)])
    columns["echo_age"][:] = np.nan
    for name in [name for name in columns if name.startswith("plc_applied_")]:
        del columns[name]
    site = yaml.safe_load(SITE_FILE.read_text())
    site["actuators"]["swrap_follower"]["drive"] = {"transport_ms": delay_ms}
    path = recorded(tmp_path, columns, site_text=yaml.safe_dump(site))
    if from_s is None:
        with pytest.raises(PlantError, match=r"not known until .* s which correction acted"):
            read_record(path)
    else:
        assert read_record(path).run.from_s == pytest.approx(from_s)
