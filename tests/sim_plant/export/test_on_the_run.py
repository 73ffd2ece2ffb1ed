"""What an importer does to a running line: save it, change it, ask too much of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.arrays import Array
from sim_plant.export.binary import compiler
from sim_plant.export.description import OPTIONS
from sim_plant.export.fmu import settled_line
from sim_plant.line.declared.declaration import EffectEntry
from sim_plant.line.equations.kernel import measure, run_frames
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.running.simulation import LineSimulation

pytest.importorskip("fmpy", reason="FMPy, of the extra dev, runs the FMUs")
from fmpy.fmi1 import FMICallException

from benchmarks.fmu.beside import by_fmu, by_kernel, differences, exported, moving_references
from benchmarks.fmu.imported import Imported

pytestmark = pytest.mark.skipif(compiler() is None, reason="no C compiler on this machine")
LINE = load_declaration(Path(__file__).parents[3] / "config" / "lines" / "euclid.yaml")
STEP_S = LINE.sample_time_s
SEEN = ["unwind_tension_N", "true_pullroll_tension_N", "unwind_radius_m", "rewind_speed_rad_s"]
SPEED = "line_speed_ref_m_s"


@pytest.fixture
def line(fmu: Path) -> Iterator[Imported]:
    made = Imported(fmu)
    yield made
    made.close()


def run(line: Imported, first: int, samples: int, **inputs: float) -> Array:
    """Return what is seen after each sample; inputs are set before the first."""
    line.set(inputs)
    rows = []
    for k in range(first, first + samples):
        line.step(k * STEP_S, STEP_S)
        rows.append(line.get(SEEN))
    return np.array(rows)


def stepped(line: LineSimulation, samples: int, **inputs: float) -> Array:
    """Return the same of the line itself."""
    rows = []
    for _ in range(samples):
        found = line.step(inputs)
        rows.append([found[name] for name in SEEN])
    return np.array(rows)


def test_a_restored_line_does_the_same_again_also_in_another_instance(
    line: Imported, fmu: Path
) -> None:
    line.start({"noise": 1, "seed": 3})
    run(line, 0, 100, **{SPEED: 1.1})
    kept = line.saved()
    then = run(line, 100, 150, **{SPEED: 1.3}, roll_change=1)
    line.restore(kept)
    assert np.array_equal(run(line, 100, 150, **{SPEED: 1.3}, roll_change=1), then)
    with pytest.raises(FMICallException):
        line.restore(kept[:64].replace(b"{", b"[", 1) + kept[64:])
    assert "saved by another model" in line.said[-1]
    other = Imported(fmu)
    other.start()
    other.restore(kept)
    assert np.array_equal(run(other, 100, 150, **{SPEED: 1.3}, roll_change=1), then)
    other.close()


def test_a_reset_line_starts_again_as_exported(line: Imported) -> None:
    line.start()
    first = run(line, 0, 50, **{SPEED: 1.2})
    line.set({"splice.step_m": 0.001})
    line.reset()
    line.start()
    assert np.array_equal(run(line, 0, 50, **{SPEED: 1.2}), first)


def test_one_long_step_is_many_short_ones_from_any_start(line: Imported) -> None:
    line.start(start_s=12.5)
    line.set({SPEED: 1.2})
    line.step(12.5, 40 * STEP_S)
    assert line.get(["time"]) == [pytest.approx(12.5 + 40 * STEP_S)]
    whole = line.get(SEEN)
    line.reset()
    line.start()
    assert run(line, 0, 40, **{SPEED: 1.2})[-1].tolist() == whole


def test_a_roll_change_is_the_lines_own_and_waits_for_an_edge(line: Imported) -> None:
    mine = settled_line(LINE)
    line.start()
    assert np.array_equal(run(line, 0, 400), stepped(mine, 400))
    mine.change_rolls()
    changed = run(line, 400, 400, roll_change=1)
    assert np.array_equal(changed, stepped(mine, 400))
    full_m = LINE.initial_radii_m.unwind
    assert changed[0, 2] == pytest.approx(full_m, abs=1e-6)
    assert changed[-1, 2] < changed[0, 2]  # the input is still true: no second change


def test_a_roll_change_turns_a_soft_shaft_as_the_line_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the numbers are the same, and it compiles in a fifth of the time
    monkeypatch.setattr("sim_plant.export.binary.OPTIONS", (*OPTIONS, "-O0"))
    shaft = EffectEntry(
        effect="shaft_compliance_backlash",
        location="unwind",
        parameters={"compliance_rad_N_m": 6e-3, "backlash_rad": 0.004},
    )
    mine = settled_line(LINE.model_copy(update={"effects": (shaft,)}))
    lay, y = mine.layout, mine.state.y
    y[lay.radius] *= 0.6
    y[lay.omega] /= 0.6
    y[lay.motor] /= 0.6
    stepped(mine, 400)
    line = Imported(exported(tmp_path / "shaft.fmu", mine, "3.0"))
    line.start()
    assert np.array_equal(run(line, 0, 100), stepped(mine, 100))
    twist_rad, radius_m = float(y[lay.twist]), float(y[lay.radius])
    mine.change_rolls()
    share = float(y[lay.radius]) / radius_m
    assert share > 1.6
    assert y[lay.twist] + 0.002 == pytest.approx(share * (twist_rad + 0.002), rel=1e-9)
    assert np.array_equal(run(line, 100, 300, roll_change=1), stepped(mine, 300))
    line.close()


def spliced(line: LineSimulation, EA_ratio: float, thickness_ratio: float, step_m: float) -> None:
    """Let the unwind of a line go on with other web from now on."""
    web = line.arrays.web
    web["splice_m"] = line.state.y[line.layout.flow]
    web["splice_EA_ratio"], web["splice_thickness_ratio"] = EA_ratio, thickness_ratio
    web["splice_step_m"], web["splice_piece_m"] = step_m, 0.05


def test_a_splice_changes_the_web_as_the_lines_own_arrays_do(line: Imported) -> None:
    mine = settled_line(LINE)
    line.start()
    assert np.array_equal(run(line, 0, 100), stepped(mine, 100))
    line.set({"splice.EA_ratio": 0.8, "splice.thickness_ratio": 1.2, "splice.step_m": 1e-4})
    spliced(mine, 0.8, 1.2, 1e-4)
    assert np.array_equal(run(line, 100, 300, splice=1), stepped(mine, 300))


def test_a_second_splice_waits_until_the_seam_before_has_left_the_line(line: Imported) -> None:
    mine = settled_line(LINE)
    line.start({"splice.EA_ratio": 0.5})
    spliced(mine, 0.5, 1.0, 2e-4)
    run(line, 0, 10, splice=1)
    run(line, 10, 10, splice=0)
    assert np.array_equal(run(line, 20, 1, splice=1)[-1], stepped(mine, 21)[-1])
    assert "no splice: the seam at" in line.said[-1]
    line.set({"splice": 0})
    line.step(21 * STEP_S, 3200 * STEP_S)  # 16 s at 1 m/s: the line holds 13 m
    assert line.get(SEEN) == stepped(mine, 3200)[-1].tolist()
    mine.arrays.spans["EA_N"] *= 0.5
    mine.arrays.web["supply_strain"] /= 0.5
    spliced(mine, 0.5, 1.0, 2e-4)
    assert np.array_equal(run(line, 3221, 500, splice=1), stepped(mine, 500))
    assert len(line.said) == 1


def test_a_second_splice_moves_no_tension_when_it_is_taken(line: Imported) -> None:
    """The seam is on a wrap or a span until the last of it has passed the rewind."""
    names = [f"spans.{a.name}_{b.name}.tension_N" for a, b in pairwise(LINE.rollers)]
    line.start({"splice.EA_ratio": 0.5})
    run(line, 0, 1, splice=1)
    line.set({"splice.EA_ratio": 1.0, "splice.step_m": 0.0, "splice.piece_m": 0.05})
    line.set({"splice": 0})
    line.step(STEP_S, 2400 * STEP_S)  # 12 s at 1 m/s; the free spans alone are 13 m
    for at in range(2401, 6000, 2):
        run(line, at, 1, splice=0)
        before_N, said = line.get(names), len(line.said)
        run(line, at + 1, 1, splice=1)
        if len(line.said) == said:
            break
    else:
        pytest.fail("no second splice was taken")
    in_line_m = sum(span.length_m for span in LINE.spans) + wraps_m()
    come_m = (at + 1) * STEP_S * LINE.operating_point.line_speed_m_s
    assert in_line_m < come_m < in_line_m + 0.5  # the seam, and web is counted stretched
    assert np.max(np.abs(np.array(line.get(names)) - before_N)) < 1.0


def wraps_m() -> float:
    """Return the web on the rollers between unwind and rewind, m, by the file's own angles."""
    return sum(
        roller.radius_m * math.radians(roller.wrap_angle_deg or 0.0)
        for roller in LINE.rollers[1:-1]
    )


def test_changed_parameters_are_settled_as_the_line_settles(line: Imported) -> None:
    mine = settled_line(LINE)
    mine.arrays.spans["EA_N"] *= 7440.0 / LINE.web.EA_N
    mine.arrays.web["supply_strain"] /= 7440.0 / LINE.web.EA_N
    mine.arrays.web["viscosity_s"] = 0.002
    mine.arrays.drives["gain_rad_s"][0] = 12.0
    mine.settle()
    line.start(
        {
            "web.EA_N": 7440.0,
            "web.kelvin_voigt_eta_s": 0.002,
            "control.drives.unwind.K_ref_rad_s": 12.0,
        }
    )
    given = moving_references(LINE, 300)
    found = differences(by_kernel(mine, given), by_fmu(line, LINE, given))
    assert set(found.values()) == {0.0}, found


def test_another_roll_or_speed_at_the_start_is_the_line_that_is_declared_so(
    line: Imported,
) -> None:
    radii = LINE.initial_radii_m.model_copy(update={"unwind": 0.15})
    mine = settled_line(LINE.model_copy(update={"initial_radii_m": radii}), speed_m_s=1.4)
    line.start({"rollers.unwind.radius_m": 0.15, SPEED: 1.4})
    there, here = line.get(SEEN), [mine.readings()[name] for name in SEEN]
    assert there == pytest.approx(here, rel=2e-4)
    assert np.allclose(run(line, 0, 200), stepped(mine, 200), rtol=2e-4)


def test_a_stiffer_line_takes_finer_steps_and_a_senseless_one_is_refused(line: Imported) -> None:
    line.start({"web.EA_N": 10 * LINE.web.EA_N})
    after = run(line, 0, 200)
    assert np.allclose(after[-1, 0], LINE.operating_point.tension_N, rtol=0.01)
    line.reset()
    line.begin()
    line.set({"web.EA_N": 10 * LINE.web.EA_N, "web.kelvin_voigt_eta_s": 0.1})
    with pytest.raises(FMICallException):
        line.run()
    assert "steps per drive tick" in line.said[-1]


def test_a_tunable_gain_acts_at_the_next_sample(line: Imported) -> None:
    line.start()
    before = run(line, 0, 10)
    after = run(line, 10, 1, **{"sensors.unwind_tension_N.gain": 1.1})
    assert after[0, 0] == pytest.approx(1.1 * before[-1, 0], rel=1e-3)


REFUSED: list[tuple[Mapping[str, float], str]] = [
    ({"sample_time_s": 0.01}, "sample_time_s cannot be set: the line computes it"),
    ({"unwind_tension_N": 5.0}, "unwind_tension_N cannot be set"),
    ({"web.EA_N": 9000.0}, "web.EA_N cannot be set on the run"),
    ({"noise": 1}, "noise cannot be set on the run"),
    ({"control.drives.unwind.zeta": 0.0}, "control.drives.unwind.zeta = 0: give 0.1 to 10"),
    ({SPEED: math.nan}, "line_speed_ref_m_s = nan"),
]


@pytest.mark.parametrize(("values", "said"), REFUSED, ids=[said for _values, said in REFUSED])
def test_what_cannot_be_set_is_refused_in_words(
    line: Imported, values: Mapping[str, float], said: str
) -> None:
    line.start()
    with pytest.raises(FMICallException):
        line.set(values)
    assert said in line.said[-1]


def test_a_step_that_is_no_multiple_or_from_elsewhere_is_refused_and_the_line_stays(
    line: Imported,
) -> None:
    mine = settled_line(LINE)
    line.start()
    run(line, 0, 5)
    for now_s, step_s, said in (
        (0.025, 0.0075, "communication step of 0.0075 s: the line's sample time is 0.005 s"),
        (0.025, 0.0, "give a whole multiple"),
        (0.2, 0.005, "a step from 0.2 s is asked for, and the line is at 0.025 s"),
    ):
        with pytest.raises(FMICallException):
            line.step(now_s, step_s)
        assert said in line.said[-1]
    assert np.array_equal(run(line, 5, 20), stepped(mine, 25)[5:])


def normals(seed: int, rows: int, width: int) -> Array:
    """Return the noise of a seed: SplitMix64, then pairs by Box and Muller."""
    mask, state = 2**64 - 1, seed
    found = np.zeros((rows, width + width % 2))

    def word() -> int:
        nonlocal state
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        return z ^ (z >> 31)

    for row in found:
        for k in range(0, row.size, 2):
            length = math.sqrt(-2.0 * math.log(((word() >> 11) + 1) * 2.0**-53))
            turn = 2.0 * math.pi * ((word() >> 11) * 2.0**-53)
            row[k], row[k + 1] = length * math.cos(turn), length * math.sin(turn)
    return found[:, :width].copy()


def test_noise_follows_its_seed_and_the_line_under_it_is_the_kernels(line: Imported) -> None:
    mine, samples = settled_line(LINE), 300
    p, at = mine.arrays, mine.log
    width = p.cells.size + p.drives.size * (1 + mine.timing.ticks_per_frame)
    noise = normals(7, samples + 1, width)
    p.timing["noisy"] = 1
    measure(p, mine.layout, mine.state, noise[0])
    speed = np.full((samples, 2), LINE.operating_point.line_speed_m_s)
    tension = np.full((samples, p.loops.size), LINE.operating_point.tension_N)
    out, none = np.zeros((samples, at.width)), np.zeros((samples, p.drives.size))
    run_frames(p, mine.layout, mine.state, mine.work, speed, tension, none, noise[1:], out)
    line.start({"noise": 1, "seed": 7})
    seen = run(line, 0, samples)
    assert np.array_equal(seen[:, 0], out[:, at.measured_N])
    assert np.array_equal(seen[:, 1], out[:, at.true_N + 1])
    shaken = out[:, at.measured_N] - out[:, at.true_N]
    assert np.std(shaken) == pytest.approx(LINE.sensors[0].noise_sd_N, rel=0.15)  # type: ignore[union-attr]
    line.reset()
    line.start({"noise": 1, "seed": 8})
    assert not np.array_equal(run(line, 0, 20)[:, 0], seen[:20, 0])
