import numba
import numpy as np
import pytest

from sim_plant.base.jit import compiled, compiled_inside


def test_compiled_code_cannot_allocate():
    """Without reference counts there is nothing to count: an allocation must not compile."""

    def grow(size):
        return np.zeros(size)

    with pytest.raises(numba.core.errors.NumbaError):
        compiled(grow)(3)


def test_what_compiled_functions_alone_call_is_refused_to_python():
    """Such a function has no code that would take Python's arguments: a call would crash."""

    def twice(x):
        return 2.0 * x

    inside = compiled_inside(twice)

    def four_times(x):
        return inside(inside(x))

    assert compiled(four_times)(3.0) == 12.0
    with pytest.raises(TypeError, match="twice: compiled functions alone"):
        inside(3.0)
