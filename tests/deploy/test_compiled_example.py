"""The shipped example of the call, by a real compiler, beside the simulated PLC word by word."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from aff_runtime.base.signals import StateBits, Status
from sim_plant.servers.plc import ALL_WELL, Plc
from tests.deploy.st_compilers import CompiledExample, StCompiler, found, why_not
from tests.sim_plant.servers.fake_line import default_map

if why_not():
    pytest.skip(why_not(), allow_module_level=True)

DEPLOY = Path(__file__).parents[2] / "deploy" / "plc"
MAP = default_map()
SCAN_S = 0.005
COUNTS_PER_TURN = 4096
SAID = {
    "LineRuns": Status.LINE_RUN,
    "Remote": Status.REMOTE,
    "WebIntact": Status.WEB_INTACT,
    "Splicing": Status.SPLICE_ACTIVE,
    "TensionValid": Status.TENSION_VALID,
    "EstopOk": Status.ESTOP_OK,
    "OperatorWants": Status.AFF_ENABLE_REQUEST,
}


@pytest.fixture(params=list(found()), ids=lambda one: one.name)
def example(request: pytest.FixtureRequest, tmp_path: Path) -> CompiledExample:
    compiler: StCompiler = request.param
    block, program = DEPLOY / "AFF_GATEWAY.st", DEPLOY / "AFF_EXAMPLE.st"
    return CompiledExample(compiler, block, program, tmp_path)


def test_the_example_has_a_place_for_every_word_that_the_simulated_plc_has(
    example: CompiledExample,
) -> None:
    shown = {f"%QW{at}" for at in range(MAP.read_start, MAP.read_start + MAP.read_count)}
    addresses = [MAP.write["aff_heartbeat"], MAP.write["state"]]
    for row in MAP.corrections:
        addresses += [row.item.address, row.complement_address]
    assert set(example.located) == shown | {f"%IW{at}" for at in addresses}


def test_the_example_shows_what_the_simulated_plc_shows_and_adds_what_it_adds(
    example: CompiledExample,
) -> None:
    dice = random.Random(5)
    plc = Plc(MAP)
    heartbeat, accepted = 0, 0
    for scan in range(1, 600):
        heartbeat = (heartbeat + (dice.random() > 0.2)) & 0xFFFF
        state = 0 if scan < 5 or dice.random() < 0.01 else int(StateBits.ACTIVE)
        one, two = dice.randrange(-15_000, 15_001), dice.randrange(-5_000, 5_001)
        plc.status = ALL_WELL if dice.random() > 0.1 else Status(dice.randrange(128))
        plc.roll_id = scan // 100
        line = _line(dice)
        words = [heartbeat, state, 0, one & 0xFFFF, ~one & 0xFFFF, 0, 0, 0, two & 0xFFFF]
        seen = plc.scan(scan * SCAN_S, _measured(line), [*words, ~two & 0xFFFF])
        out = example.call(
            **line,
            **{name: bit in plc.status for name, bit in SAID.items()},
            Splices=plc.roll_id,
            WAffHeartbeat=heartbeat,
            WAffState=state,
            WCorrection1=one,
            WCopy1=~one & 0xFFFF,
            WCorrection2=two,
            WCopy2=~two & 0xFFFF,
            RampedUnwind_m_s=1.0,
            RampedFollower_m_s=2.0,
        )
        shown = [int(out[example.located[f"%QW{at}"]]) & 0xFFFF for at in range(18)]
        assert shown[:16] == seen.read_words[:16], scan
        for ours, theirs in zip(shown[16:], seen.read_words[16:], strict=True):
            assert (ours - theirs + 1) & 0xFFFF <= 2  # 32 bits may round a half away
        added = list(seen.corrections_m_s.values())
        assert out["UnwindReference_m_s"] == pytest.approx(1.0 + added[0], abs=1e-6)
        assert out["FollowerReference_m_s"] == pytest.approx(2.0 + added[1], abs=1e-6)
        accepted += not seen.refusal
    assert accepted > 100


def _line(dice: random.Random) -> dict[str, float]:
    """Return values of which every count is exact in 32 bits."""
    return {
        "UnwindTension_N": dice.randrange(-2_000, 4_000) / 8.0,
        "PullrollTension_N": dice.randrange(0, 4_000) / 8.0,
        "TensionRef_N": dice.randrange(0, 1_200) / 4.0,
        "LineSpeed_m_s": dice.randrange(-30, 80) / 8.0,
        "FollowerSpeed_m_s": dice.randrange(-30, 80) / 8.0,
        "UnwindRadius_m": dice.randrange(1, 20) / 16.0,
        "UnwindCounts": dice.randrange(-(2**31), 2**31),
        "FollowerCounts": dice.randrange(-(2**31), 2**31),
    }


def _measured(line: dict[str, float]) -> dict[str, float]:
    turn_rad = next(c.scale for c in MAP.channels if c.name == "unwind_angle_rad")
    return {
        "unwind_tension_N": line["UnwindTension_N"],
        "pullroll_tension_N": line["PullrollTension_N"],
        "tension_ref_N": line["TensionRef_N"],
        "line_speed_m_s": line["LineSpeed_m_s"],
        "swrap_follower_speed_m_s": line["FollowerSpeed_m_s"],
        "unwind_radius_m": line["UnwindRadius_m"],
        "unwind_angle_rad": line["UnwindCounts"] * turn_rad,
        "swrap_follower_angle_rad": line["FollowerCounts"] * turn_rad,
    }
