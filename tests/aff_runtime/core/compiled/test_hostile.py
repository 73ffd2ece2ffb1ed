"""Whatever is given to the compiled law, it raises or works out numbers.

Mistakes of a kind are tried in a process of their own, so that a crash is one failed test.
"""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.compiled.binary import chosen
from tests.each_case import each_case

pytestmark = pytest.mark.skipif(chosen() is None, reason="no binary was built")
N, BLOCK, LENGTH = 3, 16, 48
ROW = 4 * N
SIZE = 4 * N + 1


def reals(*shape: int) -> np.ndarray:
    return np.ones(shape)


def pairs(*shape: int) -> np.ndarray:
    return np.ones(shape, dtype=np.complex128)


def wholes(*values: int) -> np.ndarray:
    return np.array(values, dtype=np.int64)


def flags(count: int) -> np.ndarray:
    return np.zeros(count, dtype=np.bool_)


class Phase:
    """A roll as the basis reads it."""

    radius_m, theta_rad, omega_rad_s = 0.2, 0.3, 5.0


LOOP = [reals(2 * LENGTH, ROW), reals(2, BLOCK, ROW), reals(BLOCK + LENGTH), wholes(5, 1)]
LOOP += [reals(ROW)]
FILTER = [reals(N), reals(SIZE), np.eye(SIZE), reals(SIZE), reals(SIZE), reals(SIZE), reals(N)]
MONITOR = [reals(N), pairs(N), *(reals(N) for _ in range(9)), flags(N), flags(N), reals(N)]
MONITOR += [reals(8)]
BASIS = [reals(N), reals(N), wholes(0, 0, 1), reals(6, 2), pairs(N), reals(6, N), pairs(2, N)]
BASIS += [pairs(2, N), pairs(N), reals(N), reals(N), reals(6)]
NEWTON = [pairs(N), reals(N), pairs(N), pairs(N)]
SEND = [*(pairs(N) for _ in range(4)), *(reals(N) for _ in range(5)), pairs(N), pairs(N)]
SEND += [reals(2), wholes(0, 1, -1), reals(2, 5), reals(2, 5), reals(8 + 40)]
CALLS = {
    "loop_push": (LOOP, [pairs(N), pairs(N), 1.0, 2]),
    "loop_read": (LOOP, []),
    "filter_update": (FILTER, [pairs(N), pairs(N), 1.0, 0.1, 6.0, 0, 2]),
    "filter_predict": (FILTER, [pairs(N), reals(N), reals(5), 0.04, 0.005, 0.1, 20.0]),
    "monitor_hear": (MONITOR, [reals(N), 0.04, 0.005]),
    "monitor_follow": (MONITOR, [pairs(N), 0.5]),
    "monitor_judge": (MONITOR, [reals(N), pairs(N), pairs(N), 0.04, 0.005, 0.1, 0, 2]),
    "basis_step": (BASIS, [[Phase(), Phase()], 1.0, 0.0, 0.005]),
    "newton_step": (NEWTON, [reals(N), reals(N), flags(N), 0.5, 0.3, 2.0, 0.01, 0.005]),
    "send": (SEND, [ActuatorStep, reals(N), 1.0, 0.5, 1.1, 0]),
}
"""Every function, with arrays and arguments that it takes."""


def copied(value):
    if isinstance(value, np.ndarray):
        return value.copy()
    return list(value) if isinstance(value, list) else value


def call(name: str, own: list, given: list):
    arithmetic = chosen()
    return getattr(arithmetic, name)(arithmetic.Arrays(*own), *given)


def hostile_arrays(array: np.ndarray) -> list:
    """Return what is no such array: other numbers, sizes, orders in memory, no array at all."""
    other = np.int64 if array.dtype != np.int64 else np.float64
    swapped = array.dtype.newbyteorder() if array.dtype != np.bool_ else np.uint8
    twice = np.zeros((array.size, 2), dtype=array.dtype)
    locked = array.copy()
    locked.setflags(write=False)
    return [
        np.ones(array.shape, np.float32),
        np.ones(array.shape, other),
        array.astype(object),
        np.ones(array.shape, swapped),
        twice[:, 0],
        twice.ravel()[::-2],
        np.zeros(0, dtype=array.dtype),
        np.zeros(array.size - 1, dtype=array.dtype),
        np.zeros(array.size + 1, dtype=array.dtype),
        np.zeros(7 * array.size, dtype=array.dtype),
        np.zeros((), dtype=array.dtype),
        locked,
        array.view(np.matrix) if array.ndim == 2 else array.view(np.recarray),
        bytearray(array.nbytes),
        memoryview(bytearray(array.nbytes)),
        list(array.ravel()),
        "text",
        object(),
    ]


def refused(name: str, own: list, given: list, what: object) -> None:
    try:
        call(name, own, given)
    except (TypeError, ValueError, BufferError, OverflowError):
        return
    raise AssertionError(f"{name} took {what!r}")


def try_arrays(name: str) -> None:
    """Put every hostile array into every place."""
    own, given = CALLS[name]
    for at, good in enumerate(own):
        for bad in hostile_arrays(good):
            mine = [copied(each) for each in own]
            mine[at] = bad
            refused(name, mine, [copied(each) for each in given], bad)
    for at, good in enumerate(given):
        for bad in hostile_arrays(good) if isinstance(good, np.ndarray) else ():
            mine = [copied(each) for each in given]
            mine[at] = bad
            refused(name, [copied(each) for each in own], mine, bad)


class Late:
    """A number that does as it likes when it is asked for its value."""

    def __float__(self) -> float:
        raise AssertionError("asked")

    __index__ = __int__ = __float__


def try_arguments(name: str) -> None:
    """Leave arrays or arguments out, put more in, and put in what is no number."""
    own, given = CALLS[name]
    for count in range(len(own)):
        refused(name, [copied(each) for each in own[:count]], given, count)
    for count in (*range(len(given)), len(given) + 1):
        refused(name, own, (given * 2)[:count] if given else [1.0], count)
    for at, good in enumerate(given):
        for bad in (Late(), "1", None, [], 1j, object(), int, 10**400):
            if isinstance(good, np.ndarray) and bad is None and name == "newton_step":
                continue  # no column rests, or is held
            mine = [copied(each) for each in given]
            mine[at] = bad
            refused(name, [copied(each) for each in own], mine, bad)
    arithmetic = chosen()
    for hold in (None, object(), own, np.zeros(3)):
        with pytest.raises(TypeError):
            getattr(arithmetic, name)(hold, *given)


def try_numbers(name: str) -> None:
    """Let every number be none, endless or absurd: the call is refused or goes through."""
    own, given = CALLS[name]
    bad = (np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 0.0, -1.0)
    for value in bad:
        for at, good in enumerate((*own, *given)):
            mine = [copied(each) for each in own]
            theirs = [copied(each) for each in given]
            here, place = (mine, at) if at < len(own) else (theirs, at - len(own))
            if isinstance(good, np.ndarray) and good.dtype in (np.float64, np.complex128):
                here[place][...] = value
            elif isinstance(good, float):
                here[place] = value
            call(name, mine, theirs)


def try_places(name: str) -> None:
    """Let every index point out of its array."""
    own, given = CALLS[name]
    for at, good in enumerate(own):
        if not (isinstance(good, np.ndarray) and good.dtype == np.int64):
            continue
        for value in (-(2**63), -(2**31), -1, 2, LENGTH, 2**31, 2**62, 2**63 - 1):
            for spot in range(good.size):
                mine = [copied(each) for each in own]
                mine[at][spot] = value
                try_one(name, mine, given)
    for at, good in enumerate(given):
        for value in (-(2**63), -2, -1, N, 2**31, 2**63 - 1) if type(good) is int else ():
            theirs = [copied(each) for each in given]
            theirs[at] = value
            try_one(name, [copied(each) for each in own], theirs)


def try_one(name: str, own: list, given: list) -> None:
    """Call with an index that may be wrong: refused, or within its array."""
    try:
        call(name, own, [copied(each) for each in given])
    except ValueError:
        return


TRIES = {each.__name__: each for each in (try_arrays, try_arguments, try_numbers, try_places)}


def test_no_input_ends_the_process():
    """A crash is a process that ends by a signal; what it tried last stands in its output."""
    code = (
        f"from {__name__} import CALLS, TRIES\n"
        "for kind in TRIES:\n    for name in CALLS:\n"
        "        print(kind, name, flush=True)\n        TRIES[kind](name)\n"
        "print('all tried')"
    )
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", code],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-100:] + done.stderr[-1500:]
    assert done.stdout.endswith("all tried\n")


@each_case("name", CALLS)
def test_what_is_taken_goes_through(name):
    own, given = CALLS[name]
    call(name, [copied(each) for each in own], [copied(each) for each in given])


@pytest.mark.parametrize("at", [-1, LENGTH, 2**40])
def test_a_place_outside_the_ring_is_refused(at):
    own = [copied(each) for each in LOOP]
    own[3][0] = at
    with pytest.raises(ValueError, match="loop_read"):
        call("loop_read", own, [])


def test_a_column_of_no_roll_and_of_no_order_is_refused():
    own = [copied(each) for each in BASIS]
    own[2][1] = 2
    with pytest.raises(ValueError, match="no roll 2"):
        call("basis_step", own, CALLS["basis_step"][1])
    own = [copied(each) for each in SEND]
    own[12][0] = 2
    with pytest.raises(ValueError, match="no such order"):
        call("send", own, CALLS["send"][1])


def test_a_list_of_phases_that_empties_itself_while_it_is_read_is_survived():
    phases = []

    class Vanishing:
        theta_rad, omega_rad_s = 0.0, 1.0

        @property
        def radius_m(self):
            phases.clear()
            return 0.2

    phases += [Vanishing(), Vanishing()]
    with pytest.raises(IndexError):
        call("basis_step", [copied(each) for each in BASIS], [phases, 1.0, 0.0, 0.005])


@each_case("kind", [int, list, type, type(None), type(lambda: 0), np.ndarray, dict])
def test_a_step_is_made_of_plain_classes_alone(kind):
    with pytest.raises(TypeError, match="class"):
        call("send", [copied(each) for each in SEND], [kind, *CALLS["send"][1][1:]])


def test_more_ticks_than_any_pause_has_are_refused():
    own = [copied(each) for each in LOOP]
    with pytest.raises(ValueError, match="ticks"):
        call("loop_push", own, [pairs(N), pairs(N), 1.0, 2**40])


def test_more_arrays_than_places_are_refused():
    with pytest.raises(ValueError, match="at most"):
        chosen().Arrays(*(reals(1) for _ in range(33)))


def test_arrays_live_as_long_as_they_are_held_and_no_longer():
    array = reals(N)
    before = sys.getrefcount(array)
    held = chosen().Arrays(array, reals(N))
    assert sys.getrefcount(array) > before
    del held
    assert sys.getrefcount(array) == before
