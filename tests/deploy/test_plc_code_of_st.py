"""The gateway block in Structured Text as the PLC of a line, by the shipped file of C++."""

from __future__ import annotations

import random
import shutil
import subprocess
from pathlib import Path

import pytest

from aff_runtime.base.signals import StateBits, Status
from sim_plant.base.shipped import shipped_plc
from sim_plant.servers.plc import ALL_WELL, Plc
from sim_plant.servers.plc_code import CodePlc
from tests.deploy.st_compilers import StCompiler, found
from tests.sim_plant.servers.fake_line import FakeLine, default_map, write_block

MAP = default_map()
SCAN_S = 0.005
COUNT_M_S = 1e-5
COMPILER = next((one for one in found() if one.name == "strucpp"), None)
pytestmark = pytest.mark.skipif(
    COMPILER is None, reason="strucpp (STRUCPP_INCLUDE names its headers), gcc, g++ not on PATH"
)
WORDS = ("", "watchdog", "state", "rearm", "permissive", "complement", "limit")


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build it as the head of the file says."""
    assert isinstance(COMPILER, StCompiler)
    folder = tmp_path_factory.mktemp("st")
    for name in ("AFF_GATEWAY.st", "aff_plc_strucpp.cpp", "aff_plc.h"):
        shutil.copy(shipped_plc(name), folder)
    text = (folder / "aff_plc_strucpp.cpp").read_text(encoding="utf-8")
    commands = [line[2:].split() for line in text.splitlines() if line.startswith(" *   ")]
    for command in commands[:2]:
        words = [str(COMPILER.library) if "STRUCPP" in word else word for word in command]
        words[0] = COMPILER.program if words[0] == "strucpp" else words[0]
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder / "plc.so"


@pytest.mark.parametrize("seed", range(3))
def test_the_block_as_the_line_s_plc_decides_what_the_simulated_program_decides(
    library: Path, seed: int
) -> None:
    """Refusals, status and words the same; corrections to the 32 bits that the block counts in."""
    dice = random.Random(seed)
    pair = CodePlc(MAP, library), Plc(MAP)
    measured = dict(FakeLine().step({}))
    heartbeat, state, accepted, seen = 0, 0, 0, set()
    for scan in range(1, 800):
        heartbeat += dice.random() > (0.97 if scan % 200 > 170 else 0.1)
        state = dice.choice((0, 4, 4, 8)) if dice.random() < 0.05 else state
        well = dice.random() > 0.05
        block = write_block(
            heartbeat,
            unwind=dice.choice((0, 900, -900, 15_001)) if dice.random() < 0.1 else 900,
            follower=-300,
            state=StateBits(state),
            broken_complement=dice.random() < 0.02,
        )
        for plc in pair:
            plc.set_status(Status.WEB_INTACT, well)
        code, plain = (plc.scan(scan * SCAN_S, measured, block) for plc in pair)
        number = WORDS.index(plain.refusal.partition(":")[0])
        assert code.refusal == (f"code {number} of --plc-code" if number else ""), scan
        assert code.read_words[:16] == plain.read_words[:16], scan
        for ours, theirs in zip(code.read_words[16:], plain.read_words[16:], strict=True):
            assert (ours - theirs + 1) & 0xFFFF <= 2, scan
        for name, value in plain.corrections_m_s.items():
            assert code.corrections_m_s[name] == pytest.approx(value, abs=0.05 * COUNT_M_S)
        accepted += not number
        seen.add(number)
    assert accepted > 100
    assert seen >= {0, 1, 2, 3, 4, 5}


def test_a_restarted_block_has_its_initial_values(library: Path) -> None:
    plc = CodePlc(MAP, library, status=ALL_WELL)
    for scan in range(1, 9):
        plc.scan(scan * SCAN_S, dict(FakeLine().step({})), write_block(scan, state=StateBits(0)))
    plc.restart()
    shown = plc.scan(9 * SCAN_S, dict(FakeLine().step({})), write_block(9)).read_words
    assert shown[0] == 1
