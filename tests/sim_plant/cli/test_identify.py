"""`sim-plant identify` prints parameters with intervals, or why a record cannot tell."""

from pathlib import Path

import numpy as np
import pytest

from sim_plant.cli.main import main
from sim_plant.identify.roller_run import run_up_and_coast, simulate_roller, with_sensor
from sim_plant.line.record_file import write_columns


def roller_record(path: Path) -> Path:
    torque = run_up_and_coast(2.0, 4.0, 20.0, 0.01)
    run = simulate_roller(
        inertia_kg_m2=0.35,
        constant_N_m=0.15,
        viscous_N_m_s=0.01,
        torque_N_m=torque,
        sample_time_s=0.01,
    )
    run = with_sensor(run, 5e-4, 2e-3, 1)
    columns = {"time_s": 0.01 * np.arange(torque.size), "speed_rad_s": run.speed_rad_s}
    write_columns(path, columns | {"torque_N_m": torque})
    return path


def value_of(text: str, name: str) -> float:
    (line,) = [row for row in text.splitlines() if row.startswith(name)]
    return float(line.split("= ")[1].split()[0])


def test_inertia_is_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", "inertia", str(roller_record(tmp_path / "r.csv.gz"))]) == 0
    text = capsys.readouterr().out
    assert value_of(text, "inertia") == pytest.approx(0.35, rel=0.01)
    assert "95 %" in text


def test_driven_friction_is_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(roller_record(tmp_path / "r.csv"))
    assert main(["identify", "driven-friction", path, "--inertia-kg-m2", "0.35"]) == 0
    text = capsys.readouterr().out
    assert value_of(text, "constant friction c") == pytest.approx(0.15, rel=0.05)
    assert value_of(text, "viscous friction b") == pytest.approx(0.01, rel=0.05)


def idler_record(path: Path, speeds_m_s: list[float]) -> Path:
    rng = np.random.default_rng(0)
    time = 0.01 * np.arange(3000 * len(speeds_m_s))
    speed = np.repeat(speeds_m_s, 3000)
    drop = 6.0 / 0.0381 * (0.0172 + 1.43e-4 * speed / 0.0381)
    noise = 0.25 * rng.standard_normal((2, time.size))
    columns = {"time_s": time, "line_speed_m_s": speed}
    write_columns(
        path,
        columns | {"unwind_tension_N": 89.0 + noise[0], "r3_tension_N": 89.0 - drop + noise[1]},
    )
    return path


def test_idler_friction_is_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = idler_record(tmp_path / "r.csv.gz", [0.5, 1.0, 1.5, 1.8])
    assert main(["identify", "idler-friction", str(path)]) == 0
    text = capsys.readouterr().out
    assert value_of(text, "constant friction c") == pytest.approx(0.0172, rel=0.05)
    assert value_of(text, "viscous friction b") == pytest.approx(1.43e-4, rel=0.05)


def test_one_speed_is_refused_with_the_reason(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = idler_record(tmp_path / "r.csv.gz", [1.0])
    assert main(["identify", "idler-friction", str(path)]) == 2
    assert "one speed only" in capsys.readouterr().err


def test_an_uneven_time_column_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "r.csv"
    path.write_text("time_s,speed_rad_s,torque_N_m\n0,1,1\n0.1,2,1\n0.3,3,1\n", encoding="ascii")
    assert main(["identify", "inertia", str(path)]) == 2
    assert "not even" in capsys.readouterr().err
