"""Ripple, orders and noise of the line that probes are tried on."""

import random

from aff_runtime.core.params import BlockParams

RIPPLE = {("unwind", 1): 2.0 + 1j, ("unwind", 2): 1.0j, ("unwind", 3): 0.7, ("swrap", 1): 1.2}
BLOCKS = BlockParams(roll="unwind", orders=(1, 2, 3, 4), settle_s=8.0, amp_limit=0.02)


def noise(sigma, seed=5):
    """Return a source of normal noise; the same seed, the same noise."""
    rng = random.Random(seed)
    return lambda: rng.gauss(0.0, sigma)
