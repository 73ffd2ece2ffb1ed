"""The table of drawn cases: when two verdicts are alike, and what a row says."""

from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.config.loader import load_site
from sim_plant.demo.loop.drawn import IDLER, drawn, write_files
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.model.record_match import twin_of
from sim_plant.refine.records.read import read_record
from sim_plant.refine.report.verdict import ChannelRms, UnknownFinding
from tests.sim_plant.refine.run_cases import (
    FURTHER,
    Case,
    alike,
    clean_records,
    files_in,
    row,
    size_error,
    with_channels,
)
from tests.sim_plant.refine.small import finding, verdict_with

CASE = Case(IDLER, 1)
STATE = UnknownFinding(unknown_class="state", coordinate={"number": "zeta"}, chi2_reduction=1.0)


def told(size_share=1.0, location="R9", **more):
    """Return a verdict with the idler of case 1, and the size it has there."""
    place = (IDLER, "R9")
    size_m = size_share * CASE.hidden[place]["eccentricity_m"]
    return verdict_with(finding(IDLER, location, {"eccentricity_m": size_m}), **more)


def test_a_verdict_is_alike_whatever_size_it_tells_and_not_at_another_place():
    assert alike(told(), told(0.9))
    assert not alike(told(), told(location="R8"))
    assert not alike(told(), told(answer="unknown", unknown=(STATE,)))


def test_a_row_says_both_errors_of_size_and_whether_the_verdicts_are_alike():
    rms = {"unwind_tension_N": ChannelRms(before=1.0, after=0.3, noise_floor=0.25)}
    service = replace(told(1.03), residual_rms=rms)
    cells = [cell.strip() for cell in row(CASE, service, told(location="R8")).split("|")[1:-1]]
    assert cells == [
        *("1", f"out_of_round_roll at unwind; {IDLER} at R9"),
        *(f"traced: {IDLER} at R9", "+3.0 %", f"traced: {IDLER} at R8", "-", "1.20", "no"),
    ]
    assert size_error(CASE, told(0.5)) == pytest.approx(-0.5)


def test_a_clean_record_has_all_channels_of_the_owners_line_under_the_same_references(tmp_path):
    files = write_files(tmp_path, drawn(IDLER, 1))
    scans = "sample_time_s: 0.005", "sample_time_s: 0.02"  # of a shorter file
    text = files.plant.read_text()
    assert scans[0] in text
    files.plant.write_text(text.replace(*scans))
    first, _ = clean_records(files, tmp_path, 1)
    names = first.read_text().partition("\n")[0].split(",")
    channels = [sensor.channel for sensor in load_declaration(files.line).sensors]
    assert names == ["time_s", "line_speed_ref_m_s", "tension_ref_N", *channels]
    columns = dict(zip(names, np.loadtxt(first, delimiter=",", skiprows=1).T, strict=True))
    assert columns["unwind_tension_N"][-250:].mean() == pytest.approx(95.0, abs=0.3)


@pytest.mark.long  # quick: the owner's line
def test_a_clean_record_with_the_shipped_site_files_channels_is_one_of_the_line(tmp_path):
    files = write_files(tmp_path, drawn(IDLER, 1))
    fewer = replace(files, line=with_channels(files, tmp_path / "l.yaml", service=False))
    first, _ = clean_records(fewer, tmp_path, 1)
    shipped = {*load_site("config/euclid.yaml").gateway.read.channels, "rewind_tension_N"}
    names = set(first.read_text().partition("\n")[0].split(","))
    assert names == {"time_s", "line_speed_ref_m_s", *shipped}
    twin = twin_of(load_declaration(fewer.line), read_record(first))
    assert set(twin.channels) == shipped - {"tension_ref_N"}
    assert {s.channel for s in load_declaration(files.line).sensors} >= FURTHER


def test_files_of_a_case_are_found_again(tmp_path):
    files = write_files(tmp_path, drawn(IDLER, 1))
    assert replace(files_in(tmp_path), plant_arguments=files.plant_arguments) == files
