"""How wide an interval is that holds the truth 95 times in 100."""

from __future__ import annotations

TWO_SIDED_95 = 1.959963984540054
"""95 % of a normal distribution are within so many standard deviations of its mean."""
