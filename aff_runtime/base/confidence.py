"""How many standard deviations hold the truth 95 times in 100."""

from __future__ import annotations

TWO_SIDED_95 = 1.959963984540054
"""95 % of a normal distribution are within so many standard deviations of its mean."""
ONE_SIDED_95 = 1.645
"""95 % of a normal distribution are below so many standard deviations above its mean."""
