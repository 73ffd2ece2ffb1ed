"""AFF blocks in the owner's site file: at their place, all else to the letter."""

import difflib
import re
import shutil

import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.base.units import accepted_units, plain, read_number
from aff_runtime.config.diff import diff_sites, may_apply_while_active
from aff_runtime.config.loader import load_site
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.report.aff_block import AffBlock
from sim_plant.refine.report.site_edit import SiteFile, proposed
from tests.parameter_records import CONFIG

LINE = load_declaration(CONFIG / "lines/euclid.yaml")
SITES = ("euclid.yaml", "euclid_blocks.yaml", "euclid_can.yaml", "euclid_canopen.yaml")


def site_file(tmp_path, name="euclid.yaml"):
    shutil.copytree(CONFIG, tmp_path / "config", dirs_exist_ok=True)
    return SiteFile.read(tmp_path / "config" / name)


def added(before, after):
    """Return the lines that came in; none may have gone."""
    found = list(difflib.ndiff(before.splitlines(), after.splitlines()))
    assert [line for line in found if line.startswith("- ")] == []
    return [line[2:] for line in found if line.startswith("+ ")]


@pytest.mark.parametrize("name", SITES)
@pytest.mark.sweep(every=3)
def test_an_idler_goes_to_the_actuator_of_its_zone_and_every_comment_stays(tmp_path, name):
    site = site_file(tmp_path, name)
    found = proposed(site, [AffBlock(roll="R6", orders=(1,))], LINE)
    assert added(site.text, found.text) == [
        "  r6: {radius_m: 0.0381}",
        "      - roll: r6",
        "        orders: [1]",
        "        settle_s: 6.0",
        "        amp_limit_m_s: 0.02",
    ]
    lines = found.text.splitlines()
    assert lines[lines.index("      - roll: r6") + 4] == "  swrap_follower:"
    assert lines[lines.index("  r6: {radius_m: 0.0381}") - 1] == "    #resets_on: never"
    written = tmp_path / "config" / "new.yaml"
    written.write_text(found.text)
    assert may_apply_while_active(diff_sites(load_site(site.path), load_site(written)))
    assert found.said == (
        "actuators.unwind.blocks: r6 added, and rolls.r6 with a radius of 38.1 mm",
    )


def test_an_idler_behind_the_s_wrap_goes_to_the_follower(tmp_path):
    found = proposed(site_file(tmp_path), [AffBlock(roll="R13", orders=(1,))], LINE)
    assert found.said[0].startswith("actuators.swrap_follower.blocks: r13 added")


def test_where_no_actuator_acts_nothing_is_added_and_it_is_said(tmp_path):
    site = site_file(tmp_path)
    found = proposed(site, [AffBlock(roll="R18", orders=(1,))], LINE)
    assert found.text == site.text
    assert found.said[0].startswith("R18: no actuator of the site file corrects the tension")


def test_of_a_roll_that_has_a_block_only_new_orders_come_in(tmp_path):
    site = site_file(tmp_path)
    same = proposed(site, [AffBlock(roll="unwind", orders=(1, 2, 3, 4))], LINE)
    assert same.text == site.text
    assert same.said == ("actuators.unwind.blocks: has all orders of unwind already",)
    more = proposed(site, [AffBlock(roll="unwind", orders=(1, 17), settle_s=99.0)], LINE)
    assert "orders 17 of unwind added" in more.said[0]
    assert len(list(difflib.unified_diff(site.text, more.text, n=0))) > 0
    before, after = site.text.splitlines(), more.text.splitlines()
    assert [b for a, b in zip(before, after, strict=True) if a != b] == [
        "        orders: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17]"
    ]


def test_the_radius_is_the_one_that_the_records_gave(tmp_path):
    blocks = [AffBlock(roll="R6", orders=(1,))]
    found = proposed(site_file(tmp_path), blocks, LINE, {"rollers.R6.radius_m": 0.001})
    assert "r6: {radius_m: 0.0381381}" in found.text


@pytest.mark.parametrize(("radius", "shown"), [("0.1", "100"), ("1.5 in", "38.1")])
def test_of_a_roll_that_has_a_radius_both_are_said(tmp_path, radius, shown):
    site = site_file(tmp_path)
    site.path.write_text(
        site.text.replace("rolls:\n", f"rolls:\n  r6: {{ radius_m: {radius} }}\n", 1)
    )
    found = proposed(SiteFile.read(site.path), [AffBlock(roll="R6", orders=(1,))], LINE)
    assert found.said == (
        f"actuators.unwind.blocks: r6 added, with the file's own radius of {shown} mm; by the "
        "records 38.1 mm",
    )


@pytest.mark.parametrize("unit", ["", *accepted_units("m/s")])
@pytest.mark.sweep(every=5)
def test_a_block_is_allowed_no_more_than_its_actuator_however_that_is_spelled(tmp_path, unit):
    """The usual 20 mm/s are more than the actuator's 15 mm/s; the service refuses such a file."""
    given = plain(0.015 / read_number(f"1 {unit}", "m/s")) if unit else "0.015"
    site = site_file(tmp_path)
    text = site.text.replace("    limit_m_s: 0.15", f"    limit_m_s: {given} {unit}".rstrip())
    assert text != site.text
    # the file's own blocks and its probe are allowed more than that
    site.path.write_text(re.sub(r"\b(amp_limit|amplitude)_m_s: [0-9.]+", r"\1_m_s: 0.01", text))
    before = load_site(site.path)
    found = proposed(SiteFile.read(site.path), [AffBlock(roll="R6", orders=(1,))], LINE)
    site.path.write_text(found.text)
    actuator = load_site(site.path).actuators["unwind"]
    assert actuator.limit_m_s == before.actuators["unwind"].limit_m_s
    assert actuator.blocks[-1].amp_limit_m_s == actuator.limit_m_s == pytest.approx(0.015)


def anchored(text):
    changed = re.sub(r"(?ms)^actuators:(.*)^  unwind:", r"actuators:\1  unwind: &u", text)
    return changed.replace("rolls:\n", "rolls: &all\n")


@pytest.mark.parametrize("name", ["euclid.yaml", "euclid_can.yaml"])
@pytest.mark.parametrize("write", [lambda text: text.replace("\n", "\r\n"), anchored])
@pytest.mark.sweep(every=3)
def test_every_line_of_the_owners_stays_however_the_file_is_written(tmp_path, name, write):
    site = site_file(tmp_path, name)
    plain_ends = proposed(site, [AffBlock(roll="R6", orders=(1,))], LINE)
    text = write(site.text)
    assert text != site.text
    site.path.write_bytes(text.encode())
    found = proposed(SiteFile.read(site.path), [AffBlock(roll="R6", orders=(1,))], LINE)
    assert found.text == write(plain_ends.text)
    assert is_within(text.splitlines(keepends=True), found.text.splitlines(keepends=True))
    site.path.write_bytes(found.text.encode())
    assert load_site(site.path).actuators["unwind"].blocks[-1].roll == "r6"


def is_within(lines, others):
    """Return whether all lines are among the others, in their order."""
    rest = iter(others)
    return all(line in rest for line in lines)


def with_list(site, orders):
    """Write the orders of the unwind's block another way; return the text."""
    text = re.sub(r"(?m)^        orders: \[1, 2, 3.*?\]", f"        orders: {orders}", site.text)
    assert text != site.text
    site.path.write_text(text)
    return text


def test_comments_beside_orders_stay(tmp_path):
    site = site_file(tmp_path)
    orders = "\n          - 1  # runout\n          - 2  # oval, re-ground in June\n          - 3"
    text = with_list(site, orders)
    found = proposed(SiteFile.read(site.path), [AffBlock(roll="unwind", orders=(1, 17))], LINE)
    assert added(text, found.text) == ["          - 17"]


def test_where_a_comment_would_be_lost_no_file_is_proposed(tmp_path):
    site = site_file(tmp_path)
    orders = "[  # those of the cam\n          1, 2,  # measured in May\n          3]"
    text = with_list(site, orders)
    found = proposed(SiteFile.read(site.path), [AffBlock(roll="unwind", orders=(1, 17))], LINE)
    assert (found.text, found.adds) == (text, False)
    (said,) = found.said
    assert "2 comments of the file would be lost, the first is '# those of the cam'" in said


@pytest.mark.parametrize("orders", [(1,), (1, 17)])
def test_an_entry_that_is_switched_off_is_named_and_left_as_it_is(tmp_path, orders):
    site = site_file(tmp_path)
    lines = site.text.replace(
        "      - roll: unwind\n", "      - roll: unwind\n        enabled: false\n"
    )
    assert lines != site.text
    site.path.write_text(lines)
    found = proposed(SiteFile.read(site.path), [AffBlock(roll="unwind", orders=orders)], LINE)
    assert (found.text, found.adds) == (lines, False)
    (said,) = found.said
    assert said.startswith(
        "actuators.unwind.blocks: unwind is there, switched off (enabled: false)"
    )


OTHER_NAMES = (
    (r"\bunwind_tension_N\b", "web_tension_N"),
    (r"\bpullroll_tension_N\b", "cell_2_N"),
    # actuators alone, each at its three places; their drives say which roll they turn
    (r"(?m)^      unwind:(?= )", "      brake:"),
    (r"(?ms)^actuators:(.*)^  unwind:", r"actuators:\1  brake:"),
)


@pytest.mark.parametrize(
    ("roll", "orders"),
    [("R6", (1,)), ("R13", (1,)), ("unwind", (1, 17)), ("swrap_follower", (1, 2))],
)
@pytest.mark.sweep(every=3)
def test_the_proposal_is_the_same_by_whatever_names_the_site_has(tmp_path, roll, orders):
    site = site_file(tmp_path)
    renamed = site.text
    for old, new in OTHER_NAMES:
        assert re.search(old, renamed), old
        renamed = re.sub(old, new, renamed)
    other = tmp_path / "config" / "renamed.yaml"
    other.write_text(renamed)
    load_site(other)
    blocks = [AffBlock(roll=roll, orders=orders)]
    own, its = (proposed(one, blocks, LINE) for one in (site, SiteFile.read(other)))
    assert own.adds
    assert added_or_changed(renamed, its.text) == added_or_changed(site.text, own.text)
    assert [t.replace("actuators.brake", "actuators.unwind") for t in its.said] == [*own.said]


def added_or_changed(before, after):
    lines = difflib.unified_diff(before.splitlines(), after.splitlines(), n=0, lineterm="")
    return [line for line in lines if line[0] in "+-" and line[:3] not in ("+++", "---")]


def test_the_roll_of_a_declared_drive_goes_before_the_actuators_name(tmp_path):
    """The two actuators of the file have changed names."""
    site = site_file(tmp_path)
    text = re.sub(
        r"(?ms)^actuators:(.*)^  unwind:(.*)^  swrap_follower:",
        r"actuators:\1  swrap_follower:\2  unwind:\n    drive: { roll: swrap_follower }",
        site.text,
    )
    site.path.write_text(text)
    found = proposed(
        SiteFile.read(site.path), [AffBlock(roll="swrap_follower", orders=(1, 9))], LINE
    )
    assert found.said == ("actuators.unwind.blocks: orders 9 of swrap_follower added",)


@pytest.mark.parametrize(
    "text", ["", "rolls: {}\n", "rolls: {}\nactuators: { unwind: 1 }\n", "- 1\n", "a: [\n"]
)
def test_what_is_no_site_file_is_refused_before_the_work(tmp_path, text):
    path = tmp_path / "site.yaml"
    path.write_text(text)
    with pytest.raises(PlantError, match=r"site\.yaml"):
        SiteFile.read(path)
