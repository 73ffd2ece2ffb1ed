"""The kernel for lines side by side: its C is fresh, and its mathematics is right."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.kernel_sources import kernel_hash, kernel_sources
from sim_plant.codegen import write
from sim_plant.codegen.__main__ import LANES_C
from sim_plant.codegen.write import lanes_source
from sim_plant.lanes import library
from sim_plant.line.equations import derivative, kernel
from tests.sim_plant.codegen.compiling import compiled_library

LANES = 4
"""Enough for the plain build of any machine."""
PRELUDE = Path(write.__file__).with_name("prelude_lanes.h")
"""Its mathematics; that the kernel's source begins with it: below."""
WAVES = """
#define APPLY(name) void apply_##name(floats *x, int64_t n) \\
    { for (int64_t i = 0; i < n; i++) x[i] = lanes_##name(x[i]); }
APPLY(sin) APPLY(cos) APPLY(exp) APPLY(tanh) APPLY(floor)
void apply_turn(floats *x, int64_t n)
    { for (int64_t i = 0; i < n; i++) x[i] = modulo_floats(x[i], each_float(6.283185307179586)); }
void apply_back(floats *x, int64_t n)
    { for (int64_t i = 0; i < n; i++) x[i] = modulo_floats(x[i], each_float(-6.283185307179586)); }
"""


@pytest.fixture(scope="module")
def mathematics(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    folder = tmp_path_factory.mktemp("lanes")
    return compiled_library(
        folder,
        PRELUDE.read_text() + WAVES,  # without the kernel, which takes two seconds
        "-std=gnu11",
        "-O0",  # the numbers are the same, and it compiles in a fifth of the time
        "-ffp-contract=off",
        "-Wno-psabi",
        f"-DLANES={LANES}",
    )


def applied(mathematics: ctypes.CDLL, name: str, values: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
    """Return a function of the lanes at some values."""
    memory = np.empty(values.size + 8)
    first = (-memory.ctypes.data % 64) // 8
    x = memory[first : first + values.size]
    x[:] = values
    function = getattr(mathematics, f"apply_{name}")
    function(ctypes.c_void_p(x.ctypes.data), ctypes.c_int64(values.size // LANES))
    return x.copy()


def test_the_c_that_is_built_was_made_from_the_kernel_as_it_is() -> None:
    assert LANES_C.read_text() == lanes_source(), "run: python -m sim_plant.codegen"
    assert PRELUDE.read_text().strip() in lanes_source()


def test_the_hash_covers_every_file_with_a_function_of_the_kernel() -> None:
    covered = {path.name for path in kernel_sources()}
    for module in (kernel, derivative):
        for thing in vars(module).values():
            plain = getattr(thing, "py_func", None)
            if plain is not None:
                assert Path(plain.__code__.co_filename).name in covered


def test_a_binary_of_other_source_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    if library.loaded("plain") is None:
        pytest.skip("no binary here")
    monkeypatch.setattr(library, "kernel_hash", lambda: kernel_hash()[::-1])
    assert library.loaded("plain") is None


def test_none_are_used_where_the_environment_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(library.VARIABLE, "none")
    library.available.cache_clear()
    try:
        assert library.fitting(1) is None
        assert library.widest() == 1
    finally:  # what was found under this environment is not true of the next test's
        library.available.cache_clear()


def test_a_group_takes_the_narrowest_binary_that_holds_it(monkeypatch: pytest.MonkeyPatch) -> None:
    some = tuple(library.Lanes(name=str(n), width=n, functions=None) for n in (8, 4))  # type: ignore[arg-type]
    monkeypatch.setattr(library, "available", lambda: some)
    assert [library.fitting(n).width for n in (1, 4, 5, 8, 20)] == [4, 4, 8, 8, 8]  # type: ignore[union-attr]


@pytest.mark.parametrize("name", ["sin", "cos"])
@pytest.mark.parametrize("reach", [1.0, 10.0, 1e3, 9.9e5, 1e9])
def test_waves_are_within_two_units_of_the_last_place(
    name: str, reach: float, mathematics: ctypes.CDLL
) -> None:
    values = np.random.default_rng(5).uniform(-reach, reach, 40000)
    values[:8] = (0.0, -0.0, reach, -reach, np.pi, np.pi / 2, np.pi / 4, -3 * np.pi / 4)
    found = applied(mathematics, name, values)
    exact = getattr(np, name)(values.astype(np.longdouble))
    away = np.abs(found - exact) / np.spacing(np.abs(exact.astype(float)))
    big = np.abs(exact) > 1e-6  # at its zeros an absolute error of 1e-22 counts
    assert away[big].max() < 2.0
    assert np.abs(found - exact)[~big].max(initial=0.0) < 3e-22


def test_powers_are_within_two_units_of_the_last_place(mathematics: ctypes.CDLL) -> None:
    values = np.random.default_rng(6).uniform(-740.0, 700.0, 40000)
    values[::2] *= 0.01
    exact = np.exp(values.astype(np.longdouble))
    away = np.abs(applied(mathematics, "exp", values) - exact)
    assert np.all(away < 2.0 * np.spacing(exact.astype(float)))


def test_levels_of_friction_are_right_to_the_last_bits_of_one(mathematics: ctypes.CDLL) -> None:
    values = np.random.default_rng(7).uniform(-30.0, 30.0, 40000)
    exact = np.tanh(values.astype(np.longdouble))
    assert np.abs(applied(mathematics, "tanh", values) - exact).max() < 3e-16


def test_a_floor_is_a_floor(mathematics: ctypes.CDLL) -> None:
    values = np.array(
        [0.0, -0.0, 0.5, -0.5, 2.0, -2.0, 1e300, -1e300, 2.0**50 + 0.5, 3.0, 1e15, -7.5]
    )
    assert np.array_equal(applied(mathematics, "floor", values), np.floor(values))


@pytest.mark.parametrize(("name", "divisor"), [("turn", 2.0 * np.pi), ("back", -2.0 * np.pi)])
@pytest.mark.parametrize("reach", [6.28, 100.0])
def test_a_rest_is_pythons_to_the_last_bit(
    name: str, divisor: float, reach: float, mathematics: ctypes.CDLL
) -> None:
    values = np.random.default_rng(8).uniform(-reach, reach, 4000)
    ends = (0.0, -0.0, 5e-324, -5e-324, 1e-17, -1e-17, divisor, -divisor, reach, 1.0, -1.0, 3.0)
    values[: len(ends)] = ends
    found = applied(mathematics, name, values)
    exact = np.array([value % divisor for value in values.tolist()])
    assert found.tobytes() == exact.tobytes()  # zeros with their signs


def test_no_number_stays_none_and_disturbs_no_neighbour(mathematics: ctypes.CDLL) -> None:
    values = np.array([np.nan, 1.0, np.inf, 2.0])
    assert np.isnan(applied(mathematics, "turn", values)[::2]).all()
    for name in ("sin", "exp", "tanh"):
        found = applied(mathematics, name, values)
        assert np.isnan(found[0])
        with np.errstate(invalid="ignore"):
            assert np.allclose(
                found[1:], getattr(np, name)(values[1:]), rtol=1e-14, equal_nan=True
            )
