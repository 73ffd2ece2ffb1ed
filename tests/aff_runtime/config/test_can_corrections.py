"""A correction on CAN must be able to rest at 0, to reach its limit, and to end with us."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from aff_runtime.config.check import Report, check_site
from tests.aff_runtime.config.shipped import EUCLID

CONFIG = EUCLID.parent
UNWIND = "SG_ Unwind : 32|16@1- (1E-05,0) [-0.32767|0.32767]"


def with_signal(folder: Path, signal: str) -> Report:
    dbc = folder / "euclid.dbc"
    assert dbc.read_text().count(UNWIND) == 1
    dbc.write_text(dbc.read_text().replace(UNWIND, signal))
    return check_site(folder / "euclid_can.yaml")


@pytest.mark.parametrize(
    ("signal", "carries"),
    [
        # at rest AFF would have sent 0.1 m/s, the least count allowed
        ("SG_ Unwind : 32|16@1- (1E-05,0) [0.1|0.32767]", "0.1 to 0.32767"),
        # 32767 counts of 0.00001 less 0.4: at rest -0.07233 m/s, the largest there is
        ("SG_ Unwind : 32|16@1- (1E-05,-0.4) [-1|1]", "-0.72768 to -0.07233"),
        ("SG_ Unwind : 32|16@1+ (1E-05,0) [0|0.65535]", "0 to 0.65535"),
    ],
)
def test_a_signal_that_cannot_rest_at_zero_is_refused_at_its_line(
    folder: Path, signal: str, carries: str
) -> None:
    (error,) = with_signal(folder, signal).errors
    assert error.path == "gateway.write.corrections.unwind.signal"
    assert f"AFF_UNWIND.Unwind: carries {carries}, but a correction has a sign" in error.text


@pytest.mark.parametrize(
    ("signal", "carries"),
    [
        ("SG_ Unwind : 32|16@1- (1E-05,0) [-0.05|0.05]", "-0.05 to 0.05"),
        # 12 bits: -2048 .. 2047 counts
        ("SG_ Unwind : 32|12@1- (1E-05,0) [-1|1]", "-0.02048 to 0.02047"),
        # -0.32768 + 0.2 .. 0.32767 + 0.2
        ("SG_ Unwind : 32|16@1- (1E-05,0.2) [-1|1]", "-0.12768 to 0.52767"),
    ],
)
def test_a_limit_beyond_what_the_signal_carries_is_refused(
    folder: Path, signal: str, carries: str
) -> None:
    if "|12@" in signal:
        dbc = folder / "euclid.dbc"
        copy = "SG_ UnwindComplement : 48|16@"
        assert copy in dbc.read_text()
        dbc.write_text(dbc.read_text().replace(copy, copy.replace("16", "12")))
    (error,) = with_signal(folder, signal).errors
    assert error.path == "actuators.unwind.limit_m_s"
    assert f"0.15 m/s does not fit AFF_UNWIND.Unwind, which carries {carries} m/s" in error.text


@pytest.mark.parametrize(("bits", "accepted"), [(24, True), (18, True), (14, False)])
def test_the_room_of_a_correction_is_that_of_its_own_signal(
    folder: Path, bits: int, accepted: bool
) -> None:
    # 0.15 m/s in counts of 1 um/s are 150 000: more than 16 bits hold, 18 with a sign do not
    # (131 071), so that a scale of 2 um/s is taken there: 75 000; 14 bits hold 8191
    scale = {24: "1E-06", 18: "2E-06", 14: "2E-06"}[bits]
    dbc, site = folder / "euclid.dbc", folder / "euclid_can.yaml"
    copy = next(line for line in dbc.read_text().splitlines() if "SG_ UnwindComplement" in line)
    dbc.write_text(dbc.read_text().replace(copy + "\n", ""))
    text = site.read_text()
    assert text.count("scale: 0.00001,") == 2
    text = text.replace("scale: 0.00001,", f"scale: {float(scale):.6f},", 1)
    text = re.sub(r"\n +complement_signal: AFF_UNWIND.UnwindComplement,?", "", text)
    site.write_text(text)
    report = with_signal(folder, f"SG_ Unwind : 32|{bits}@1- ({scale},0) [-1|1]")
    said = [(error.path, error.text) for error in report.errors]
    if accepted:
        assert said == []
    else:
        ((path, text),) = said
        assert path == "actuators.unwind.limit_m_s"
        assert "carries -0.016384 to 0.016382 m/s" in text  # 8192 counts of 2 um/s


def test_an_object_of_32_bits_takes_a_fine_scale(folder: Path) -> None:
    site = folder / "euclid_canopen.yaml"
    shipped, place = site.read_text(), "unwind: { signal: unwind_drive.0x60B1, scale: "
    assert shipped.count(f"{place}0.00001 ") == 1
    for scale in ("0.000001", "0.000000001"):  # 0.15 m/s: 1.5e5 and 1.5e8 of 2.1e9 counts
        site.write_text(shipped.replace(f"{place}0.00001 ", f"{place}{scale} "))
        assert check_site(site).errors == ()


def test_a_signal_that_counts_the_other_way_is_taken(folder: Path) -> None:
    assert with_signal(folder, UNWIND.replace("(1E-05", "(-1E-05")).ok


def test_a_rest_that_is_not_count_zero_is_warned_of(folder: Path) -> None:
    # 0 = count * 0.00001 + 0.1 at -10000 counts
    report = with_signal(folder, "SG_ Unwind : 32|16@1- (1E-05,0.1) [-1|1]")
    (warning,) = [w for w in report.warnings if "offset" in w.text]
    assert warning.path == "gateway.write.corrections.unwind.signal"
    assert "rest is sent as -10000 counts" in warning.text


def test_a_drive_that_is_told_nothing_for_our_loss_is_warned_of(folder: Path) -> None:
    path = folder / "euclid_canopen.yaml"
    about = [w for w in check_site(path).warnings if "lost heartbeat" in w.text]
    assert about == []  # the shipped file tells both; the line node takes no correction
    told = ', objects: [{ object: "0x6007", value: -1 }]'
    path.write_text(path.read_text().replace(told, "", 1))
    (warning,) = [w for w in check_site(path).warnings if "lost heartbeat" in w.text]
    assert warning.path == "gateway.canopen_402.nodes.unwind_drive"
    assert "neither set nor verified" in warning.text


def test_a_message_that_is_not_there_is_named(folder: Path) -> None:
    dbc = folder / "euclid.dbc"
    dbc.write_text(dbc.read_text().replace("BO_ 388 PLC_STATUS", "BO_ 388 PLC_STATE"))
    (error,) = check_site(folder / "euclid_can.yaml").errors
    assert "there is no message PLC_STATUS; the messages are PLC_TENSION" in error.text
