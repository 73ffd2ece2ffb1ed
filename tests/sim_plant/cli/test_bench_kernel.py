from sim_plant.cli.bench_kernel import bench_kernel, convergence
from tests.sim_plant.line.lines import declared, with_effect


def test_the_bench_states_line_step_and_convergence(monkeypatch, capsys):
    monkeypatch.setattr("sim_plant.cli.bench_kernel.SIMULATED_S", 0.5)
    monkeypatch.setattr("sim_plant.cli.bench_kernel.REPEATS", 2)
    found = bench_kernel()
    assert found["rollers"] == 21
    assert found["shaped_bodies"] == 2
    assert found["step_s"] == 1e-3
    assert found["convergence"] < 1e-3
    assert found["times_real_time"] > 0.0
    text = capsys.readouterr().out
    assert "1 ms" in text
    assert "x real time (target 100)" in text


def test_a_rougher_roll_converges_less():
    smooth = with_effect(declared("euclid"), "eccentric_roller", "unwind", eccentricity_m=1e-3)
    rough = with_effect(declared("euclid"), "out_of_round_roll", "unwind", size_m=0.012)
    assert convergence(smooth, 1.5) < convergence(rough, 1.5) < 1e-3
