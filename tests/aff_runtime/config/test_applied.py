"""The optional applied corrections: which sites have them, where they may be, what they hold."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.errors import ConfigError
from aff_runtime.config.can_wire import can_map_of, wire_files
from aff_runtime.config.loader import load_site, read_site
from aff_runtime.config.wire_table import wire_lines
from aff_runtime.safety.params import AppliedParams
from tests.aff_runtime.config.shipped import EUCLID, edited, without_applied

CONFIG = EUCLID.parent
SITES = ("euclid.yaml", "euclid_blocks.yaml", "euclid_can.yaml", "euclid_canopen.yaml")
UNWIND = "unwind: { register: 16, scale: 0.00001 }"


@pytest.mark.parametrize("name", SITES)
def test_every_shipped_site_reads_what_is_applied_of_every_correction(name: str) -> None:
    site = load_site(CONFIG / name)
    assert list(site.gateway.applied) == list(site.actuators)
    text = "\n".join(wire_lines(site, CONFIG))
    assert len(re.findall(r"applied", text)) == 2


@pytest.mark.parametrize("name", SITES)
def test_a_site_of_before_is_as_valid_and_reads_nothing_of_it(folder: Path, name: str) -> None:
    path = folder / name
    path.write_text(without_applied(path.read_text()))
    reading, shipped = read_site(path), read_site(CONFIG / name)
    assert [f.text for f in reading.warnings] == [f.text for f in shipped.warnings]
    params = guard_params(reading.site).applied
    assert params.tolerances == ()
    if reading.site.gateway.modbus is not None:
        words = register_map(reading.site)
        assert (words.applied, words.read_count) == ((), 16)
    else:
        assert can_map_of(reading.site, wire_files(reading.site, folder)).applied == ()


def test_on_modbus_they_are_two_words_more_of_the_one_block(tmp_path: Path) -> None:
    words = register_map(load_site(edited(tmp_path)))
    assert [(r.address, r.type, r.scale) for r in words.applied if r is not None] == [
        (16, "i16", 0.00001),
        (17, "i16", 0.00001),
    ]
    assert (words.read_start, words.read_count) == (0, 18)


def test_one_of_two_may_be_shown(tmp_path: Path) -> None:
    path = edited(tmp_path, (f"      {UNWIND}\n", ""))
    site = load_site(path)
    first, second = register_map(site).applied
    assert first is None
    assert second is not None
    assert guard_params(site).applied.tolerances == (None, pytest.approx(2e-5))


@pytest.mark.parametrize(
    ("new", "said"),
    [
        ("unwind: { signal: PLC.Applied, scale: 0.00001 }", "register is missing; modbus_tcp"),
        ("unwind: { register: 8, scale: 0.00001 }", "wire address 8 is taken by gateway.read"),
        ("unwinder: { register: 16, scale: 0.00001 }", "unwinder is no actuator"),
        ("unwind: { register: 16, scale: 0.000001 }", "0.05 m/s is 50000 counts of 0.000001; "),
        ("unwind: { register: 16, scale: 1 mNm }", '"1 mNm" is a torque, expected a speed'),
        ("unwind: { register: 16, scale: 0 }", "unwind.scale"),
    ],
)
def test_a_word_that_cannot_show_it_is_refused(new: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=re.escape(said)):
        load_site(edited(tmp_path, (UNWIND, new)))


def test_without_the_echo_there_is_nothing_to_compare_it_with(tmp_path: Path) -> None:
    path = edited(tmp_path, ("    aff_echo: { register: 15 }\n", ""))
    with pytest.raises(ConfigError, match=r"read\.applied: needs aff_echo"):
        load_site(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("(0.0001,0) [-0.2048|0.2047]", "(0.00005,0) [-0.2048|0.2047]", "has 0.00005 per count"),
        ("[-0.2048|0.2047]", "[-0.1|0.1]", "carries -0.1 to 0.1 m/s, less than the limit 0.15"),
        ("40|12@1- (0.0001,0)", "40|12@1+ (0.0001,0)", "carries 0 to 0.2047 m/s, less than"),
    ],
)
def test_a_signal_that_cannot_show_it_is_refused_at_its_line(
    folder: Path, old: str, new: str, said: str
) -> None:
    dbc = folder / "euclid.dbc"
    dbc.write_text(dbc.read_text().replace(old, new, 1))
    with pytest.raises(ConfigError, match=r"gateway\.read\.applied\.unwind\..*" + re.escape(said)):
        load_site(folder / "euclid_can.yaml")


@pytest.mark.parametrize(
    ("name", "cycle_ms", "wanted"),
    [
        # a count of the correction, 0.00001 m/s, and one of the word
        ("euclid_blocks.yaml", 5, AppliedParams(tolerances=(2e-5, 2e-5), lag_ticks=3)),
        ("euclid_blocks.yaml", 7, AppliedParams(tolerances=(2e-5, 2e-5), lag_ticks=3, ticks=37)),
        ("euclid_can.yaml", 5, AppliedParams(tolerances=(1.1e-4, 1.1e-4), lag_ticks=3)),
    ],
)
def test_what_may_differ_is_a_count_of_each_word_and_the_time_of_a_ramp(
    name: str, cycle_ms: int, wanted: AppliedParams, folder: Path
) -> None:
    path = folder / name
    path.write_text(path.read_text().replace("cycle_ms: 5", f"cycle_ms: {cycle_ms}"))
    params = guard_params(load_site(path)).applied
    assert params.tolerances == pytest.approx(wanted.tolerances)
    assert params.units == ("m/s", "m/s")
    assert (params.lag_ticks, params.ticks) == (wanted.lag_ticks, wanted.ticks)
    # 100 ms of the PLC's ramp, and 80 ms by which a reading may be later than another
    assert params.between_s == pytest.approx(0.180)
    assert params.gap_s == pytest.approx(0.080)
