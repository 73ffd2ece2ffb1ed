"""The shipped file of C++ counts the words before it takes them; the block is the test's own."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from sim_plant.base.shipped import shipped_plc
from sim_plant.servers.plc_code import CodePlc
from sim_plant.servers.plc_map import PlcMap
from tests.sim_plant.servers.fake_line import FakeLine, default_map, write_block

pytestmark = pytest.mark.skipif(shutil.which("g++") is None, reason="no g++ on PATH")
MAP = default_map()
BLOCK = """
#include <cstdint>
namespace strucpp {
struct AFF_GATEWAY {
    uint16_t AFFHEARTBEAT = 0, AFFSTATE = 0, COPY1 = 0, COPY2 = 0, PLCHEARTBEAT = 0, AFFECHO = 0;
    int16_t WORD1 = 0, WORD2 = 0, APPLIED1 = 0, APPLIED2 = 0, REFUSAL = 0;
    bool WANTED = false, PERMISSIVES = false, RESET = false, ENABLEREQUEST = true;
    float SCANTIME = 0.0f, CORRECTION1 = 0.0f, CORRECTION2 = 0.0f;
    void operator()() { PLCHEARTBEAT++; APPLIED1 = WORD1; CORRECTION1 = WORD1; REFUSAL = 0; }
};
}
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("counts")
    (folder / "gateway.cpp").write_text(BLOCK, encoding="utf-8")
    words = [
        "g++",
        "-std=c++17",
        "-shared",
        "-fPIC",
        "-I",
        str(folder),
        "-I",
        str(shipped_plc("")),
    ]
    words += [str(shipped_plc("aff_plc_strucpp.cpp")), "-o", str(folder / "plc.so")]
    subprocess.run(words, check=True, timeout=120)
    return folder / "plc.so"


def shorter_read() -> PlcMap:
    """Return the shipped map without the last words that the file writes."""
    return replace(MAP, applied=(), read_count=16)


def one_actuator() -> PlcMap:
    return replace(MAP, applied=MAP.applied[:1], corrections=MAP.corrections[:1])


@pytest.mark.parametrize("plc_map", [shorter_read(), one_actuator()], ids=["shown", "corrections"])
def test_another_map_is_refused_and_no_word_is_touched(library: Path, plc_map: PlcMap) -> None:
    plc = CodePlc(plc_map, library)
    scan = plc.scan(0.005, dict(FakeLine().step({})), write_block(7, unwind=100))
    assert scan.refusal == "code -1 of --plc-code"
    assert scan.read_words[0] == 0
    assert set(scan.corrections_m_s.values()) == {0.0}


def test_a_write_block_that_is_too_short_is_refused(library: Path) -> None:
    scan = CodePlc(MAP, library).scan(0.005, dict(FakeLine().step({})), write_block(7)[:9])
    assert scan.refusal == "code -1 of --plc-code"


def test_the_shipped_map_is_taken(library: Path) -> None:
    plc = CodePlc(MAP, library)
    scan = plc.scan(0.005, dict(FakeLine().step({})), write_block(7, unwind=100))
    assert (scan.refusal, scan.read_words[0], scan.read_words[16]) == ("", 1, 100)
    assert scan.corrections_m_s["unwind"] == pytest.approx(0.001)
