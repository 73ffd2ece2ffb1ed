"""Whether 95 % intervals of refine hold what they say."""
