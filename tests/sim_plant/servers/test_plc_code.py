"""A library of the user's stands between the words of the wire and the line, by `aff_plc.h`."""

import re
import shutil

import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Status
from sim_plant.base.shipped import shipped_plc
from sim_plant.servers.plant import Plant
from sim_plant.servers.plc import ALL_WELL, Plc
from sim_plant.servers.plc_code import CodePlc
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.sim_plant.servers.built_code import built
from tests.sim_plant.servers.fake_line import FakeLine, N_PER_m_s, default_map, write_block

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler `cc` on PATH")
MAP = default_map()
CODE = r"""
#include "aff_plc.h"

static uint16_t scans;

void aff_plc_begin(void) { scans = 0; }

int aff_plc_scan(struct aff_plc_scan *scan)
{
    scan->shown[0] = ++scans;
    scan->shown[15] = scan->written[0];
    if (!(scan->status & AFF_WEB_INTACT))
        return 4;
    for (int at = 0; at < scan->corrections_count; at++)
        scan->corrections[at] = (at + 1) * 1e-5 * (int16_t)scan->written[3 + 5 * at];
    scan->shown[16] = scan->written_count * 1000 + scan->shown_count * 10 + scan->measured_count;
    double seen = 1e5 * scan->since_s + 1e3 * scan->time_s + 1e-3 * scan->measured[1];
    scan->shown[17] = (uint16_t)seen;
    return 0;
}
"""
NAN = CODE.replace("return 0;", "scan->corrections[1] = 0.0 / (scan->time_s * 0.0); return 0;")


@pytest.fixture
def plc(tmp_path):
    return CodePlc(MAP, built(tmp_path, CODE))


def measured():
    return dict(FakeLine().step({}))


def test_what_the_code_leaves_alone_is_shown_as_the_simulated_plc_shows_it(plc):
    simulated = Plc(MAP)
    for each in (plc, simulated):
        each.roll_id = 77
        each.status = ALL_WELL | Status.REMOTE
    block = write_block(513, state=0)  # refuses nothing: nothing is withdrawn
    theirs, ours = (each.scan(0.005, measured(), block).read_words for each in (simulated, plc))
    assert ours[1:15] == theirs[1:15]
    assert (ours[0], ours[15]) == (1, 513)


def test_the_code_gets_words_times_and_readings_and_its_corrections_count(plc):
    plc.scan(0.250, measured(), write_block(1))
    seen = plc.scan(0.255, measured(), write_block(2, unwind=1200, follower=-300))
    assert seen.corrections_m_s["unwind"] == pytest.approx(0.012)
    assert seen.corrections_m_s["swrap_follower"] == pytest.approx(-0.006)
    assert seen.refusal == ""
    assert seen.read_words[16] == 10 * 1000 + 18 * 10 + 8  # words written, shown, channels
    assert seen.read_words[17] == int(500 + 255 + 0.090)


def test_a_number_of_the_code_says_why_nothing_counts(plc):
    plc.set_status(Status.WEB_INTACT, False)
    seen = plc.scan(0.005, measured(), write_block(1, unwind=1200))
    assert seen.refusal == "code 4 of --plc-code"
    assert set(seen.corrections_m_s.values()) == {0.0}


def test_a_restart_begins_the_code_anew(plc):
    for scan in range(1, 4):
        assert plc.scan(0.005 * scan, measured(), write_block(1)).read_words[0] == scan
    plc.restart()
    words = plc.scan(0.020, measured(), write_block(1)).read_words
    assert words[0] == 1
    assert words[17] == int(500 + 20 + 0.090)  # since the scan before, not since time 0


def test_a_served_line_obeys_the_code_of_its_options(tmp_path):
    """The fake line answers a correction with N_PER_m_s newtons per m/s."""
    options = ServeOptions(port=0, plc_code=built(tmp_path, CODE))
    plants = [PlantService(FakeLine(), MAP, options).plant, Plant(FakeLine(), Plc(MAP))]
    for plant in plants:  # neither heartbeat nor state: the simulated program takes nothing
        plant.registers.write_words = list(write_block(0, unwind=-500))
        for _ in range(200):
            plant.step()
    with_code, without = (plant.measured["true_unwind_tension_N"] for plant in plants)
    assert with_code - without == pytest.approx(0.005 * N_PER_m_s, rel=1e-3)
    assert plants[0].applied_m_s["unwind"] == pytest.approx(-0.005)


def test_a_correction_that_is_no_number_ends_the_plant_with_its_name(tmp_path):
    plc = CodePlc(MAP, built(tmp_path, NAN))
    with pytest.raises(PlantError, match=r"at 0\.005 s it adds -?nan m/s .* of swrap_follower"):
        plc.scan(0.005, measured(), write_block(1))


def test_a_library_that_is_none_or_lacks_a_function_is_refused(tmp_path):
    (tmp_path / "text.so").write_text("no library")
    for name in ("text.so", "nowhere.so"):
        with pytest.raises(PlantError, match=rf"--plc-code .*{name}: cannot be loaded"):
            CodePlc(MAP, tmp_path / name)
    without = built(tmp_path, CODE.replace("void aff_plc_begin", "void begin"))
    with pytest.raises(PlantError, match="no function aff_plc_begin or aff_plc_scan"):
        CodePlc(MAP, without)


def test_the_header_has_the_bits_of_the_status_word():
    told = re.findall(
        r"^    AFF_(\w+) = (\d+)", shipped_plc("aff_plc.h").read_text(), re.MULTILINE
    )
    bits = {bit.name.removeprefix("AFF_"): bit.value for bit in Status}
    assert {name: int(value) for name, value in told} == bits
