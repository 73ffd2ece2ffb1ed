"""The law knows after how much the counter of an angle starts over, on every wire."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import pytest

from aff_runtime.app.check.validate import check_result
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.wiring.assemble import controller_of_record

CONFIG = Path(__file__).parents[4] / "config"
COUNT_RAD = math.tau / 4096
BITS = {"euclid.yaml": 32, "euclid_can.yaml": 28, "euclid_canopen.yaml": 32}
"""Of the counter: its register, its signal in the DBC file, object 0x6064 in the EDS file."""


@pytest.mark.parametrize("name", BITS)
def test_each_wire_says_after_how_much_its_counter_starts_over(name: str) -> None:
    record = check_result(CONFIG / name).parameters
    assert record is not None
    passed = ParameterRecord.from_json(record.for_control().to_json())
    for roll in controller_of_record(passed).site.rolls:
        assert roll.angle_modulus_rad == pytest.approx(2 ** BITS[name] * COUNT_RAD, rel=1e-12)


@pytest.mark.parametrize(("high", "range_rad"), [(360, math.tau), (359, math.tau), (179, math.pi)])
def test_a_signal_whose_range_is_narrower_than_its_bits_starts_over_after_that(
    tmp_path: Path, high: int, range_rad: float
) -> None:
    for file in ("euclid_can.yaml", "euclid.dbc"):
        shutil.copy(CONFIG / file, tmp_path)
    dbc, site = tmp_path / "euclid.dbc", tmp_path / "euclid_can.yaml"
    bits = "SG_ UnwindAngle : 0|28@1- (1,0) [-134217728|134217727]"
    text = dbc.read_text()
    assert bits in text
    dbc.write_text(text.replace(bits, f"SG_ UnwindAngle : 0|28@1- (1,0) [0|{high}]"))
    scale = "UnwindAngle, scale: 4096 counts/turn"
    assert scale in site.read_text()
    site.write_text(site.read_text().replace(scale, "UnwindAngle, scale: 360 counts/turn"))
    found = check_result(site)
    assert found.parameters is not None, found.findings
    unwind = controller_of_record(found.parameters).site.rolls[0]
    assert unwind.angle_modulus_rad == pytest.approx(range_rad, rel=1e-12)
