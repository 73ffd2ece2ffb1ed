"""The copies that the demo makes of site file and PLC map: another limit, on both sides."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.config.loader import load_site
from sim_plant.base.shipped import shipped
from sim_plant.demo.wires import FILM_SITES, SITES, wire_up
from sim_plant.servers.map_file import load_plc_map


# the DBC's word of what is applied carries 0.2047 m/s
@pytest.mark.parametrize(
    ("wire", "limit_m_s"),
    [("modbus", 0.3), ("can", 0.2), pytest.param("canopen", 0.3, marks=pytest.mark.long)],
)
def test_another_limit_stands_on_both_sides_and_nothing_else_changes(wire, limit_m_s, tmp_path):
    (tmp_path / "plain").mkdir()
    plain = load_site(wire_up(wire, shipped(SITES[wire]), tmp_path / "plain").site)
    wired = wire_up(wire, shipped(SITES[wire]), tmp_path, limit_m_s)
    site = load_site(wired.site)
    before, after = plain.actuators["unwind"], site.actuators["unwind"]
    assert (before.limit_m_s, before.slew_m_s2) == (0.15, 10.0)
    assert (after.limit_m_s, after.slew_m_s2) == (
        limit_m_s,
        pytest.approx(limit_m_s / 0.015, rel=1e-5),
    )
    assert site.actuators["swrap_follower"] == plain.actuators["swrap_follower"]
    at = wired.plant_arguments.index("--plc")
    found = load_plc_map(Path(wired.plant_arguments[at + 1]))
    own = load_plc_map(shipped("plc/gateway_block.yaml"))
    limits = {row.item.name: row.limit_m_s for row in found.corrections}
    assert limits == {row.item.name: row.limit_m_s for row in own.corrections} | {
        "unwind": limit_m_s
    }


def test_without_a_limit_the_plant_keeps_its_own_map(tmp_path):
    assert "--plc" not in wire_up("modbus", shipped(SITES["modbus"]), tmp_path).plant_arguments


@pytest.mark.parametrize("wire", ["modbus", "can"])
def test_a_site_file_that_allows_more_gets_a_plc_that_does_too(wire, tmp_path):
    """The film line's corrections pass 0.15 m/s; a PLC that refuses them takes AFF to zero."""
    site = shipped(FILM_SITES[wire])
    wired = wire_up(wire, site, tmp_path)
    found = load_plc_map(Path(wired.plant_arguments[wired.plant_arguments.index("--plc") + 1]))
    (unwind,) = (row.limit_m_s for row in found.corrections if row.item.name == "unwind")
    assert unwind == load_site(wired.site).actuators["unwind"].limit_m_s > 0.15


@pytest.mark.parametrize("limit_m_s", [0.4, 0.0, -0.1])
def test_a_limit_that_no_word_can_carry_is_refused(limit_m_s, tmp_path):
    with pytest.raises(PlantError, match=r"give above 0 to 0\.328 m/s"):
        wire_up("modbus", shipped(SITES["modbus"]), tmp_path, limit_m_s)


def test_a_site_file_in_plant_units_is_refused_by_name(tmp_path):
    odd = tmp_path / "odd.yaml"
    text = shipped(SITES["modbus"]).read_text()
    odd.write_text(text.replace("limit_m_s: 0.15\n", "limit_m_s: 9 m/min\n"))
    folder = tmp_path / "out"
    folder.mkdir()
    with pytest.raises(PlantError, match=r"odd\.yaml: expected 'limit_m_s:'"):
        wire_up("modbus", odd, folder, 0.3)


@pytest.mark.parametrize(
    ("was", "becomes", "said"),
    [
        ("actuators:\n", "other:\n", r"odd\.yaml: expected 'limit_m_s:'"),
        ("  modbus_tcp:\n", "  modbus_udp:\n", r"odd\.yaml: expected 'gateway\.modbus_tcp'"),
        ("actuators:\n", "actuators: [\n", r"odd\.yaml"),
    ],
)
def test_a_site_file_that_lacks_what_is_changed_is_refused_by_name(was, becomes, said, tmp_path):
    odd = tmp_path / "odd.yaml"
    odd.write_text(shipped(SITES["modbus"]).read_text().replace(was, becomes))
    folder = tmp_path / "out"
    folder.mkdir()
    with pytest.raises(PlantError, match=said):
        wire_up("modbus", odd, folder, 0.3)


def test_a_map_beside_the_site_file_is_the_plc_that_it_was_written_from(tmp_path):
    folder, out = tmp_path / "site", tmp_path / "demo"
    folder.mkdir()
    out.mkdir()
    site = folder / "euclid.yaml"
    site.write_text(shipped(SITES["modbus"]).read_text("utf-8"), "utf-8")
    plc = folder / "plc.yaml"
    plc.write_text(shipped("plc/gateway_block.yaml").read_text("utf-8"), "utf-8")
    arguments = wire_up("modbus", site, out).plant_arguments
    assert arguments[arguments.index("--plc") + 1] == str(plc)
    limited = wire_up("modbus", site, out, 0.3).plant_arguments
    assert limited[limited.index("--plc") + 1] == str(out / "plc.yaml")
    rows = load_plc_map(out / "plc.yaml").corrections
    assert {row.item.name: row.limit_m_s for row in rows}["unwind"] == 0.3
