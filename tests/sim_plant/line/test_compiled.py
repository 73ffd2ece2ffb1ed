import numba
import numpy as np
import pytest

from sim_plant.base.jit import compiled


def test_compiled_code_cannot_allocate():
    """Without reference counts there is nothing to count: an allocation must not compile."""

    def grow(size):
        return np.zeros(size)

    with pytest.raises(numba.core.errors.NumbaError):
        compiled(grow)(3)
