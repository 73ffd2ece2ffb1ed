import gzip
import hashlib

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.refine.records.read import read_record
from tests.closed_folder import closed

ROWS = 200


def text(header="time_s,line_speed_ref_m_s,unwind_tension_N", change=lambda k, row: row):
    rows = [change(k, [f"{0.01 * k:.4f}", "1.0", f"{90 + k % 7}"]) for k in range(ROWS)]
    return "\n".join([header, *(",".join(r) for r in rows if r is not None)]) + "\n"


def test_a_plain_file_comes_back_as_it_is(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(text())
    record = read_record(path)
    assert record.samples == ROWS
    assert record.sample_time_s == pytest.approx(0.01)
    assert record.columns["unwind_tension_N"][8] == 91.0
    assert record.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_gzip_and_plain_files_read_alike(tmp_path):
    (tmp_path / "r.csv").write_text(text())
    (tmp_path / "r.csv.gz").write_bytes(gzip.compress(text().encode()))
    plain, packed = read_record(tmp_path / "r.csv"), read_record(tmp_path / "r.csv.gz")
    for name, values in plain.columns.items():
        np.testing.assert_array_equal(values, packed.columns[name])


def test_units_in_the_header_are_converted(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(text("time [ms],line_speed_ref [fpm],unwind_tension [lbf]"))
    record = read_record(path)
    assert record.sample_time_s == pytest.approx(1e-5)
    assert record.columns["line_speed_ref_m_s"][0] == pytest.approx(0.00508)
    assert record.columns["unwind_tension_N"][0] == pytest.approx(90 * 4.4482216152605)


def drop_rows(k, row):
    return None if 50 <= k < 60 else row


def blank(k, row):
    return [row[0], row[1], ""] if k == 30 else row


def word(k, row):
    return [row[0], row[1], "open"] if k == 30 else row


def word_behind_a_blank(k, row):
    return [row[0], "  ", "open"] if k == 30 else row


def ragged(k, row):
    return row[:2] if k == 30 else row


def twice(k, row):
    return ["0.3", *row[1:]] if k in (31, 32, 33) else row


def backwards(k, row):
    return ["0.0", *row[1:]] if k == 30 else row


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (drop_rows, "gaps in time_s, the first after line 51"),
        (blank, "column unwind_tension_N: 1 value is missing or not a number, in line 32"),
        (word, "line 32: column unwind_tension_N: read 'open'"),
        (word_behind_a_blank, "line 32: column unwind_tension_N: read 'open'"),
        (ragged, "line 32: 2 values under 3 columns"),
        (backwards, "time_s goes back; sort the rows"),
        (twice, "3 rows have the time_s of the row before, the first is line 33; give"),
    ],
)
def test_what_cannot_be_judged_is_refused_with_its_place(tmp_path, change, said):
    path = tmp_path / "r.csv"
    path.write_text(text(change=change))
    with pytest.raises(PlantError) as raised:
        read_record(path)
    assert said in str(raised.value)
    assert str(path) in str(raised.value)


def test_an_unknown_unit_is_refused(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(text("time_s,line_speed_ref [furlong/h],unwind_tension_N"))
    with pytest.raises(PlantError, match="unit 'furlong_h' is unknown"):
        read_record(path)


def test_a_record_without_time_is_refused(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(text("when,line_speed_ref_m_s,unwind_tension_N"))
    with pytest.raises(PlantError, match="no time column"):
        read_record(path)


def test_two_columns_of_one_name_are_refused(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(text("time_s,unwind_tension_N,unwind_tension_N"))
    with pytest.raises(PlantError, match="appears twice"):
        read_record(path)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(PlantError, match="cannot be read"):
        read_record(tmp_path / "none.csv")


@pytest.mark.parametrize(
    "spoil",
    [
        lambda plain: plain.replace(b"0.01,", b'0.01,"', 1) + b"1," * 70_000,  # an open quote
        lambda plain: plain + b"3.0,1.0," + b"1" * 200_000 + b"\n",
    ],
)
def test_a_value_without_end_is_refused(tmp_path, spoil):
    path = tmp_path / "r.csv"
    path.write_bytes(spoil(text().encode()))
    with pytest.raises(PlantError, match=r"r\.csv: "):
        read_record(path)


def test_every_flipped_bit_of_a_gzip_file_is_refused(tmp_path):
    """Some end in the checksum, some in the unpacking itself: two kinds of error."""
    path = tmp_path / "r.csv.gz"
    whole = gzip.compress(text().encode())
    for at in range(12, len(whole) - 8, 7):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1 :])
        with pytest.raises(PlantError, match="not a readable CSV file"):
            read_record(path)


def test_a_number_that_no_sensor_reads_is_refused(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text(text(change=lambda k, row: [*row[:2], "1e300"] if k == 30 else row))
    with pytest.raises(PlantError, match=r"1 value is too large for a reading, .* line 32"):
        read_record(path)


def test_an_angle_counts_from_its_first_row_and_keeps_what_was_taken_off(tmp_path):
    """An encoder that has counted for weeks: only its steps say something of this record."""
    path = tmp_path / "angle.csv"
    angles = [3000.25 + 0.25 * k for k in range(120)]
    rows = "\n".join(f"{0.01 * k},{angle},89.0" for k, angle in enumerate(angles))
    path.write_text(f"time_s,unwind_angle_rad,unwind_tension_N\n{rows}\n", encoding="utf-8")
    record = read_record(path)
    assert record.columns["unwind_angle_rad"] == pytest.approx([0.25 * k for k in range(120)])
    assert record.zeros_rad == {"unwind_angle_rad": 3000.25}
    assert record.columns["unwind_tension_N"] == pytest.approx(89.0)


@pytest.mark.parametrize("times", ["", "@1..2"])
@pytest.mark.parametrize("shut", [".", "run", "run/run.yaml"])
def test_a_run_that_may_not_be_looked_at_is_told_from_one_that_is_not_there(tmp_path, shut, times):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "run.yaml").write_text("columns: [time_s]\n")
    with (
        closed(tmp_path / shut),
        pytest.raises(PlantError, match=r"run.*: you may not look there"),
    ):
        read_record(f"{tmp_path / 'run'}{times}")
